"""What reaches a terminal is text: nothing that steers it, whatever file, name or title it comes from."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, TextIO

from typer.core import TyperGroup

from rubnoise.cli.helping import texts, without_types

_PREFIX = "Value error, "
"""What the library puts before its own words about a value."""


def escaped(text: str) -> str:
    """Return a text with its lines, and all else that does not print as itself escaped: controls, bidi overrides.

    A carriage return may come first: so a line of progress is written over the one before.
    """
    if text.replace("\n", "").isprintable():
        return text
    start = "\r" if text.startswith("\r") else ""
    kept = (c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text[len(start) :])
    return start + "".join(kept)


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
        super().__init__(help=texts(rest.get("rich_markup_mode") == "rich", help, rest.get("params")), **rest)

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
            told = problem.message.removeprefix(_PREFIX)  # type: ignore[attr-defined]
            problem.message = escaped(told).replace("\n", "\\n")  # type: ignore[attr-defined]
        raise
