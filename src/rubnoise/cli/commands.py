"""Typer's commands with our changes: help is shown as it is written, and output cannot control the terminal.

Files, names and titles may come from anywhere, so all output is escaped.
"""

import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from inspect import cleandoc
from pathlib import Path
from typing import Any, TextIO

import typer
from typer.core import TyperCommand, TyperGroup

from rubnoise.answer import printable

_TAG = re.compile(r"(\\*)(\[[a-z#/@][^\[]*?\])")
"""What the library that draws help takes for a style or a colour, and leaves out: `[sweep]`."""


def literal(text: str) -> str:
    """Return a text without markup of that library, each paragraph in one line, which it breaks."""
    paragraphs = (" ".join(paragraph.split()) for paragraph in cleandoc(text).split("\n\n"))
    return "\n\n".join(_TAG.sub(r"\1\1\\\2", paragraph) for paragraph in paragraphs)


def literal_texts(styled: bool, help_text: str | None, params: Any) -> str | None:
    """Make the help of parameters literal if the library interprets markup; return the help of their command."""
    if not styled:
        return help_text
    for param in params or ():
        if getattr(param, "help", None):
            param.help = literal(param.help)
    return literal(help_text) if help_text else help_text


def without_types(params: Any) -> Any:
    """Return parameters that show a type only if they are options with a value.

    A flag takes no value, and an argument has its name and its help.
    """
    for param in params:
        if getattr(param, "is_flag", False):
            param.metavar = ""
        if param.param_type_name == "argument":
            param.display_type_rich = lambda **_context: None
    return params


def files_only(params: Any) -> None:
    """Make options for a file refuse a name with a slash at its end, which a Path would drop."""
    for param in params:
        if param.param_type_name == "option" and param.metavar != "DIR":
            param.process_value = _file_only(param.process_value)


def _file_only(process: Callable[..., Any]) -> Callable[..., Any]:
    def processed(context: Any, value: Any) -> Any:
        found = process(context, value)
        if isinstance(found, Path) and isinstance(value, str) and value.endswith(("/", os.sep)):
            raise typer.BadParameter(f"{value}: names a folder; name a file")
        return found

    return processed


class Command(TyperCommand):
    """A command whose help is shown as it is written."""

    def __init__(self, name: str | None, *, help: str | None = None, **rest: Any) -> None:  # noqa: A002  (click's name)
        """Make a command (see click)."""
        styled = rest.get("rich_markup_mode") == "rich"
        super().__init__(name, help=literal_texts(styled, help, rest.get("params")), **rest)
        files_only(self.params)

    def get_params(self, ctx: Any) -> Any:
        """Return arguments and options (see click)."""
        return without_types(super().get_params(ctx))


_PREFIX = "Value error, "
"""What the library puts before its own words about a value."""


def escaped(text: str) -> str:
    """Return a text with its line ends, and other characters that do not print as themselves escaped (controls, bidi).

    A carriage return may come first, with which a line of progress overwrites the one before.
    """
    if text.replace("\n", "").isprintable():
        return text
    start = "\r" if text.startswith("\r") else ""
    return start + "\n".join(map(printable, text[len(start) :].split("\n")))


class Escaping:
    """A stream that escapes the texts written to it, and is otherwise the stream beneath."""

    def __init__(self, stream: TextIO) -> None:
        """Take the stream beneath."""
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text, escaped (see escaped)."""
        return self._stream.write(escaped(text))

    def writelines(self, lines: Iterator[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


@contextmanager
def escaping() -> Iterator[None]:
    """Escape all output on both streams in this context."""
    out, err = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = Escaping(out), Escaping(err)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = out, err


class Commands(TyperGroup):
    """The group of commands, whose output is escaped; the library itself colours help and usage."""

    def __init__(self, *, help: str | None = None, **rest: Any) -> None:  # noqa: A002  (click's name)
        """Make the group of commands (see click)."""
        super().__init__(help=literal_texts(rest.get("rich_markup_mode") == "rich", help, rest.get("params")), **rest)

    def get_params(self, ctx: Any) -> Any:
        """Return the options (see click)."""
        return without_types(super().get_params(ctx))

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names that are shown and suggested: those of commands that are not hidden."""
        return [name for name in super().list_commands(ctx) if not self.commands[name].hidden]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return a command that prints escaped text (see click)."""
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None and command.callback is not None:
            command.callback = _escaped_call(command.callback)
        return name, command, rest

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        """Return the context of a call (see click); messages about its arguments are escaped."""
        with _escaped_usage():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: Any) -> Any:
        """Call the command (see click); messages about its arguments are escaped."""
        with _escaped_usage():
            return super().invoke(ctx)


def _escaped_call(callback: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(callback)
    def called(*arguments: Any, **options: Any) -> Any:
        with escaping():
            return callback(*arguments, **options)

    return called


@contextmanager
def _escaped_usage() -> Iterator[None]:
    """Escape the message of a usage error, since an argument may be any file name."""
    try:
        yield
    except Exception as problem:
        if isinstance(getattr(problem, "message", None), str):
            text = problem.message.removeprefix(_PREFIX)  # type: ignore[attr-defined]
            problem.message = escaped(text).replace("\n", "\\n")  # type: ignore[attr-defined]
        raise
