"""Where the keys and values of a TOML text stand, since tomllib does not tell."""

import re
import tomllib
from contextlib import suppress
from dataclasses import dataclass, field

from rubnoise.scenario.problems import Path

_BLANK = re.compile(r"[ \t]*")
_FILLER = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_STRING = re.compile(
    r"""
      \"{3} (?: [^"\\] | \\. | "{1,2}(?!") )* "{3,5}
    | '{3} .*? '{3,5}
    | " (?: [^"\\\n] | \\. )* "
    | ' [^'\n]* '
    """,
    re.DOTALL | re.VERBOSE,
)
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")
_BARE_VALUE = re.compile(r"[^,\]}#\n\r]+")


class Unlocatable(Exception):  # noqa: N818  (not an error of anybody: such a text is reported by tomllib)
    """The text is no TOML from some point on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A stretch of text: offsets of its first character and of the one behind its last."""

    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Spans:
    """Where things stand: the first mention of each key, and the value of each key that has one."""

    keys: dict[Path, Span] = field(default_factory=dict)
    values: dict[Path, Span] = field(default_factory=dict)


def locate(text: str) -> Spans:
    """Return the spans of all keys and values; of a broken text, those before the break."""
    return _scanned(text).spans


def last_key(text: str) -> tuple[Path, Spans]:
    """Return the key or header that a text names last, whatever comes behind it, and the spans of all before it."""
    scanner = _scanned(text)
    return scanner.last, scanner.spans


def _scanned(text: str) -> "_Scanner":
    scanner = _Scanner(text)
    with suppress(Unlocatable, RecursionError):
        scanner.document()
    return scanner


class _Scanner:
    """Walks over a TOML text once, holding the place and the table it is in."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.spans = Spans()
        self.last: Path = ()
        self.array_lengths: dict[Path, int] = {}

    def document(self) -> None:
        table: Path = ()
        while self.skip(_FILLER) < len(self.text):
            if self.text.startswith("[", self.at):
                table = self.header()
            else:
                self.assignment(table)

    def skip(self, pattern: re.Pattern[str]) -> int:
        found = pattern.match(self.text, self.at)
        self.at = found.end() if found else self.at
        return self.at

    def take(self, pattern: re.Pattern[str]) -> Span:
        found = pattern.match(self.text, self.at)
        if not found:
            raise Unlocatable
        self.at = found.end()
        return Span(start=found.start(), end=found.end())

    def expect(self, literal: str) -> None:
        if not self.text.startswith(literal, self.at):
            raise Unlocatable
        self.at += len(literal)

    def header(self) -> Path:
        brackets = "[[" if self.text.startswith("[[", self.at) else "["
        self.expect(brackets)
        path = self.key(())
        self.expect("]" * len(brackets))
        if brackets == "[[":
            index = self.array_lengths[path] = self.array_lengths.get(path, -1) + 1
            path = (*path, index)
        return path

    def assignment(self, table: Path) -> None:
        path = self.key(table)
        self.expect("=")
        self.skip(_BLANK)
        self.value(path)

    def key(self, table: Path) -> Path:
        """Read a dotted key; each part is noted with the span from the first part to itself."""
        path = table
        self.skip(_BLANK)
        start = self.at
        while True:
            part = self.take(_STRING if self.text[self.at : self.at + 1] in {'"', "'"} else _BARE_KEY)
            self.skip(_BLANK)
            path = self.in_last_element((*path, _unquoted(self.text[part.start : part.end])))
            self.spans.keys.setdefault(path, Span(start=start, end=part.end))
            self.last = path
            if not self.text.startswith(".", self.at):
                return path
            self.expect(".")
            self.skip(_BLANK)

    def in_last_element(self, path: Path) -> Path:
        """A header below an array of tables speaks of its last table."""
        following = self.text[self.at : self.at + 1] not in {"]", "="} and path in self.array_lengths
        return (*path, self.array_lengths[path]) if following else path

    def value(self, path: Path) -> None:
        start = self.at
        first = self.text[start : start + 1]
        if first == "[":
            self.array(path)
        elif first == "{":
            self.inline_table(path)
        elif first in {'"', "'"}:
            self.take(_STRING)
        else:
            bare = self.take(_BARE_VALUE)
            self.at = start + len(self.text[start : bare.end].rstrip())
        self.spans.values.setdefault(path, Span(start=start, end=self.at))

    def array(self, path: Path) -> None:
        self.expect("[")
        index = 0
        while not self.text.startswith("]", self.skip(_FILLER)):
            self.value((*path, index))
            index += 1
            self.separator("]")
        self.expect("]")

    def inline_table(self, path: Path) -> None:
        self.expect("{")
        while not self.text.startswith("}", self.skip(_FILLER)):
            self.assignment(path)
            self.separator("}")
        self.expect("}")

    def separator(self, closing: str) -> None:
        self.skip(_FILLER)
        if not self.text.startswith(closing, self.at):
            self.expect(",")


def _unquoted(part: str) -> str:
    if part[0] not in "\"'":
        return part
    if "\\" not in part and not part.startswith(('""', "'''")):
        return part[1:-1]
    try:
        return next(iter(tomllib.loads(f"{part} = 0")))
    except tomllib.TOMLDecodeError:
        raise Unlocatable from None
