"""How typer's commands behave here: help is shown as it is written, and output cannot steer the terminal.

Files, names and titles may come from anywhere, so all that is printed is escaped.
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

from rubnoise.cli.layout import printable

_TAG = re.compile(r"(\\*)(\[[a-z#/@][^\[]*?\])")
"""What the library that draws help takes for a style or a colour, and leaves out: `[sweep]`."""


def literal(text: str) -> str:
    """Return a text in which that library finds no styles, each paragraph in one line for it to break."""
    paragraphs = (" ".join(paragraph.split()) for paragraph in cleandoc(text).split("\n\n"))
    return "\n\n".join(_TAG.sub(r"\1\1\\\2", paragraph) for paragraph in paragraphs)


def literal_texts(styled: bool, help_text: str | None, params: Any) -> str | None:
    """Make the help of parameters literal when the library looks for styles; return that of their command."""
    if not styled:
        return help_text
    for param in params or ():
        if getattr(param, "help", None):
            param.help = literal(param.help)
    return literal(help_text) if help_text else help_text


def without_types(params: Any) -> Any:
    """Return parameters of which only options with a value say what they take.

    To a flag nothing is given, and an argument has its name and its help.
    """
    for param in params:
        if getattr(param, "is_flag", False):
            param.metavar = ""
        if param.param_type_name == "argument":
            param.display_type_rich = lambda **_context: None
    return params


def files_only(params: Any) -> None:
    """Let options for a file refuse the name of a folder, of which a path would not keep the last slash."""
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
    """Return a text with its lines, and all else that does not print as itself escaped: controls, bidi overrides.

    A carriage return may come first: so a line of progress is written over the one before.
    """
    if text.replace("\n", "").isprintable():
        return text
    start = "\r" if text.startswith("\r") else ""
    return start + "\n".join(map(printable, text[len(start) :].split("\n")))


class Escaping:
    """A stream that escapes what is written to it, and is otherwise the stream beneath."""

    def __init__(self, stream: TextIO) -> None:
        """Stand before a stream."""
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
    """Escape whatever is printed meanwhile, on both streams."""
    out, err = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = Escaping(out), Escaping(err)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = out, err


class Commands(TyperGroup):
    """The commands, whose output is escaped; help and usage, which come from the library, are coloured by it."""

    def __init__(self, *, help: str | None = None, **rest: Any) -> None:  # noqa: A002  (click's name)
        """Make the group of commands (see click)."""
        super().__init__(help=literal_texts(rest.get("rich_markup_mode") == "rich", help, rest.get("params")), **rest)

    def get_params(self, ctx: Any) -> Any:
        """Return the options (see click)."""
        return without_types(super().get_params(ctx))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return a command that prints escaped text (see click)."""
        name, command, rest = super().resolve_command(ctx, args)
        if command is not None and command.callback is not None:
            command.callback = _escaped_call(command.callback)
        return name, command, rest

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        """Return the context of a call (see click); what is said of its arguments is escaped."""
        with _escaped_usage():
            return super().make_context(*arguments, **options)

    def invoke(self, ctx: Any) -> Any:
        """Call the command (see click); what it says of its arguments is escaped."""
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
    """Escape the message of a usage error: an argument may be the name of a file from anywhere."""
    try:
        yield
    except Exception as problem:
        if isinstance(getattr(problem, "message", None), str):
            text = problem.message.removeprefix(_PREFIX)  # type: ignore[attr-defined]
            problem.message = escaped(text).replace("\n", "\\n")  # type: ignore[attr-defined]
        raise
