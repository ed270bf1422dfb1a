"""Typer's commands with our changes: help lists them under headings, and output cannot control the terminal.

Files, names and titles may come from anywhere, so all output is escaped.
"""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from itertools import groupby
from pathlib import Path
from typing import Any, TextIO

import typer
from typer.core import TyperCommand, TyperGroup

from rubnoise.answer import printable


def as_wanted(params: Any) -> None:
    """Show arguments without a type; make options for a file refuse a slash at the end, which a Path would drop."""
    for param in params:
        if param.param_type_name == "argument":
            param.display_type_rich = lambda **_context: ""
        elif param.metavar != "DIR":
            param.process_value = _file_only(param.process_value)


def _file_only(process: Callable[..., Any]) -> Callable[..., Any]:
    def processed(context: Any, value: Any) -> Any:
        found = process(context, value)
        if isinstance(found, Path) and isinstance(value, str) and value.endswith(("/", os.sep)):
            raise typer.BadParameter(f"{value}: names a folder; name a file")
        return found

    return processed


class Command(TyperCommand):
    """A command whose options for a file refuse the name of a folder."""

    def __init__(self, *names: Any, **rest: Any) -> None:
        """Make a command (see click)."""
        super().__init__(*names, **rest)
        as_wanted(self.params)


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
        self.beneath = stream

    def write(self, text: str) -> int:
        """Write a text, escaped (see escaped)."""
        return self.beneath.write(escaped(text))

    def writelines(self, lines: Iterator[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.beneath, name)


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
    """The group of commands: their output is escaped, and --help lists them under their headings."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names that are shown and suggested: those of commands that are not hidden."""
        return [name for name in super().list_commands(ctx) if not self.commands[name].hidden]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands with a line each, under their headings (see click)."""
        shown = [self.commands[name] for name in self.list_commands(ctx)]
        for heading, some in groupby(shown, key=lambda command: str(getattr(command, "rich_help_panel", ""))):
            with formatter.section(heading):
                formatter.write_dl([(str(each.name), each.get_short_help_str(formatter.width)) for each in some])

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
