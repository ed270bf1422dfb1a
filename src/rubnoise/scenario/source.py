"""One TOML text: its data, the place of each key, and the problems that are found before keys are read.

tomllib gives values without their places, and stops at the first mistake. So keys are located here, and each broken
line is reported, with advice for common mistakes; the rest is still read.
"""

import re
import tomllib
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from rubnoise.scenario import limits
from rubnoise.scenario.problems import Path, Place, Problem

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


class Unlocatable(Exception):  # noqa: N818  (not an error by itself: tomllib reports such a text)
    """The text is not TOML from some point on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A stretch of text: the offsets of its first character and of the one after its last."""

    start: int
    end: int


@dataclass(slots=True)
class Spans:
    """The spans of keys and values: the first mention of each key, the value of each that has one, and the last key."""

    keys: dict[Path, Span] = field(default_factory=dict)
    values: dict[Path, Span] = field(default_factory=dict)
    last: Path = ()


def locate(text: str) -> Spans:
    """Return the spans of all keys and values; for a broken text, those before the break."""
    scanner = _Scanner(text)
    with suppress(Unlocatable, RecursionError):
        scanner.document()
    return scanner.spans


class _Scanner:
    """Scanner of a TOML text, with its present place and table."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.at = 0
        self.spans = Spans()
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
        """Read a dotted key; note each part with the span from the first part to itself."""
        path = table
        self.skip(_BLANK)
        start = self.at
        while True:
            part = self.take(_STRING if self.text[self.at : self.at + 1] in {'"', "'"} else _BARE_KEY)
            self.skip(_BLANK)
            path = (*path, _unquoted(self.text[part.start : part.end]))
            if path in self.array_lengths and self.text[self.at : self.at + 1] not in {"]", "="}:
                path = (*path, self.array_lengths[path])  # a header below an array of tables speaks of its last one
            self.spans.keys.setdefault(path, Span(start=start, end=part.end))
            self.spans.last = path
            if not self.text.startswith(".", self.at):
                return path
            self.expect(".")
            self.skip(_BLANK)

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


_POSITION = re.compile(r"(.*?) \(at (?:line (\d+), column (\d+)|end of document)\)$", re.DOTALL)
_AT_END = "(at end of document)"
_KEY = re.compile(r"[ \t]*\[.*|[^#=]+=")
_COMMA_NUMBER = re.compile(r"=\s*([+-]?[0-9]+),([0-9]+)\s*([^\s#\"']*)")
_BARE_QUANTITY = re.compile(
    r"=\s*(?!0[xob])([+-]?[0-9][0-9.+-]*(?:[eE][+-]?[0-9]+)?)\s*([A-Za-z\u00b5\u03bc%][^=#\"']*?)\s*(?:#.*)?$"
)
_BARE_WORD = re.compile(r"=\s*([A-Za-z][A-Za-z-]*)\s*(?:#.*)?$")
# A part of a dotted key: possessive, so that no text makes the search go back. A long string is not: before 3.11.5
# Python finds no match if something possessive looks ahead (CPython issue 106052). It matches in one way only.
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\[^\n])*+"|'[^'\n]*+')"""
_TOKENS = re.compile(
    rf"""
      \#[^\n]*+
    | \"{{3}}(?:[^"\\]|\\.|"(?!""))*"{{3,5}} | '{{3}}(?:[^']|'(?!''))*'{{3,5}}
    | (?P<long>{_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{limits.KEY_DOTS + 1},}})
    | {_PART}
    | (?P<broken>["'])
    """,
    re.DOTALL | re.VERBOSE,
)
_UNCLOSED = ("Illegal character '\\n'", "Unterminated string", 'Expected "\'"')
_DUPLICATES = ("Cannot overwrite a value", "Duplicate inline table key", "Cannot declare", "Cannot mutate immutable")


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """A fault that breaks the text: a line (from 1), columns (from 0), its key if known, message and advice."""

    line: int
    start: int = 0
    end: int = 1
    message: str
    path: Path = ()
    hint: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parsed:
    """The data of a text, its faults, and its lines, with the faulty ones empty."""

    data: dict[str, Any]
    lines: list[str]
    faults: tuple[Fault, ...]


def parse(lines: list[str]) -> Parsed:
    """Parse TOML, leaving out each line that breaks it, so that one report can name them all."""
    long_lines = f"a line of more than {limits.LINE_CHARACTERS} characters"
    too_much = [
        Fault(line=number, message=long_lines)
        for number, line in enumerate(lines, 1)
        if len(line) > limits.LINE_CHARACTERS
    ] or _long_keys("\n".join(lines))
    if too_much:
        return Parsed(data={}, lines=[], faults=tuple(too_much[: limits.SYNTAX_ERRORS]))
    return _parse_leaving_out(list(lines))


def _long_keys(text: str) -> list[Fault]:
    """Return the keys with too many parts; a part in quotation marks may contain any character.

    The search ends at a quotation mark that begins no string, where the parser ends, too.
    """
    found: list[Fault] = []
    for token in _TOKENS.finditer(text):
        if token["broken"]:
            break
        if token["long"]:
            line = text.count("\n", 0, token.start()) + 1
            found.append(Fault(line=line, message=f"a key of more than {limits.KEY_DOTS + 1} parts"))
    return found


def _parse_leaving_out(lines: list[str]) -> Parsed:
    faults: list[Fault] = []
    characters = 0
    while len(faults) < limits.SYNTAX_ERRORS and characters < limits.SYNTAX_CHARACTERS:
        text = "\n".join(lines)
        characters += len(text)
        if faults and (long := _long_keys(text)):  # a line left out may have begun a string that they stood in
            return Parsed(data={}, lines=[], faults=(*faults, *long)[: limits.SYNTAX_ERRORS])
        try:
            return Parsed(data=tomllib.loads(text), lines=lines, faults=tuple(faults))
        except tomllib.TOMLDecodeError as error:
            fault, at_end = _fault(str(error), lines), _AT_END in str(error)
        except RecursionError:
            fault, at_end = Fault(line=1, message="nested too deeply"), True
        faults.append(fault)
        broken = lines[fault.line - 1].strip()
        # Without its header the keys of a table would be blamed for being in the wrong one.
        if at_end or not broken or broken.startswith("["):
            break
        lines[fault.line - 1] = ""
    return Parsed(data={}, lines=lines, faults=tuple(faults))


def _fault(error: str, lines: list[str]) -> Fault:
    found = _POSITION.match(error)
    last = max((number for number, line in enumerate(lines, 1) if line.strip()), default=1)
    line, column = (int(found[2] or last), int(found[3] or 1)) if found else (last, 1)
    reason, line = found[1] if found else error, min(line, len(lines))
    text = lines[line - 1]
    key = _KEY.match(text)
    spans = locate("\n".join([*lines[: line - 1], key[0]])) if key else Spans()
    if reason.startswith(_DUPLICATES):
        return _duplicate(line, lines, spans)
    return _usual_slip(spans.last, line, text) or Fault(
        line=line,
        start=column - 1,
        end=column,
        path=spans.last,
        message=f"not valid TOML: {reason[:1].lower()}{reason[1:]}",
        hint="is the closing quotation mark missing?" if reason.startswith(_UNCLOSED) else "",
    )


def _usual_slip(path: Path, line: int, text: str) -> Fault | None:
    if comma := _COMMA_NUMBER.search(text):
        number, unit = f"{comma[1]}.{comma[2]}", comma[3]
        hint = f'write "{number} {unit}"' if unit else f"write {number}"
        span = comma.start(1), comma.end(3) if unit else comma.end(2)
        return Fault(line=line, start=span[0], end=span[1], path=path, message="a comma in a number", hint=hint)
    if bare := _BARE_QUANTITY.search(text):
        hint = f'write "{bare[1]} {bare[2]}"'
        message = "a value with a unit needs quotation marks"
        return Fault(line=line, start=bare.start(1), end=bare.end(2), path=path, message=message, hint=hint)
    if word := _BARE_WORD.search(text):
        hint, (start, end) = f'write "{word[1]}"', word.span(1)
        return Fault(line=line, start=start, end=end, path=path, message="a text needs quotation marks", hint=hint)
    return None


def _duplicate(line: int, lines: list[str], spans: Spans) -> Fault:
    here = re.match(r"[ \t]*([^=]*[^= \t])", lines[line - 1])
    before = "\n".join(lines[: line - 1])
    first = spans.keys.get(spans.last)
    hint = "keep one"
    if first is not None and first.end <= len(before):
        hint = f"first given in line {before.count(chr(10), 0, first.start) + 1}; keep one of the two"
    start, end = here.span(1) if here else (0, 1)
    return Fault(line=line, start=start, end=end, path=spans.last, message="given twice", hint=hint)


@dataclass(frozen=True)
class Source:
    """A text with its name in reports and its rank among the sources of a scenario."""

    name: str
    text: str
    rank: int = 0

    @property
    def data(self) -> dict[str, Any]:
        """The TOML data; for a broken text, the data of its other lines."""
        return {} if self._refusal else self._parsed.data

    @property
    def problems(self) -> tuple[Problem, ...]:
        """The problems of a text that is not TOML within the limits."""
        if self._refusal:
            whole = Place(source=self.name, line=0, text="", start=0, end=0, rank=self.rank)
            return (Problem(path=(), message=self._refusal, place=whole),)
        return tuple(
            Problem(path=f.path, message=f.message, hint=f.hint, place=self._on_line(f.line, f.start, f.end))
            for f in self._parsed.faults
        )

    def value_place(self, path: Path) -> Place:
        """Return the place of a key's value, or of the nearest key or header above it."""
        for known in (path[:n] for n in range(len(path), 0, -1)):
            span = self._spans.values.get(known) or self._spans.keys.get(known)
            if span:
                return self._place(span)
        return self._on_line(1, 0, 1)

    def key_place(self, path: Path) -> Place:
        """Return the place where a key is first named."""
        span = self._spans.keys.get(path)
        return self._place(span) if span else self.value_place(path)

    @cached_property
    def _refusal(self) -> str:
        if any("\ud800" <= character <= "\udfff" for character in self.text):
            return "not UTF-8 text"  # half a surrogate pair can be written to no file
        return f"larger than {limits.FILE_BYTES // 1024} kB" if len(self.text.encode()) > limits.FILE_BYTES else ""

    @cached_property
    def _lines(self) -> list[str]:
        return self.text.replace("\r\n", "\n").split("\n")

    @cached_property
    def _parsed(self) -> Parsed:
        return parse(self._lines)

    @cached_property
    def _readable(self) -> str:
        return "\n".join(self._parsed.lines)

    @cached_property
    def _spans(self) -> Spans:
        return Spans() if self._refusal else locate(self._readable)

    def _place(self, span: Span) -> Place:
        line = self._readable.count("\n", 0, span.start)
        start = span.start - (self._readable.rfind("\n", 0, span.start) + 1)
        return self._on_line(line + 1, start, start + span.end - span.start)

    def _on_line(self, line: int, start: int, end: int) -> Place:
        text = self._lines[line - 1]
        first, last = min(start, len(text)), min(end, len(text))
        return Place(source=self.name, line=line, text=text, start=first, end=last, rank=self.rank)
