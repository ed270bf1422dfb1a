"""One TOML text: its data, the place of each key, and the lines that break it; and keys written as such a text.

tomllib gives values without their places, and stops at the first mistake. So keys are found line by line, as the tables
of a scenario are flat; and a line that breaks the text is reported and left out, so that one report names them all.
"""

import json
import re
import tomllib
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal, NamedTuple

Path = tuple[str, ...]
_SHOWN_CHARACTERS = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A place in a text: source name, the line (from 1), its text, and the columns (from 0)."""

    source: str
    line: int
    text: str
    start: int
    end: int
    rank: int = 0  # order of the sources in a report


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """An error or a warning about a key, with advice if there is any.

    ``forbids_run`` marks an error that stops a run, but not the theory of the scenario.
    """

    path: Path
    message: str
    place: Place
    hint: str = ""
    severity: Literal["error", "warning"] = "error"
    forbids_run: bool = False

    @property
    def key(self) -> str:
        """The key as written in TOML, with dots."""
        return ".".join(_shown_text(str(part)) for part in self.path)

    @property
    def is_missing(self) -> bool:
        """Whether a scenario lacks the key."""
        return self.message.startswith("missing")

    def __str__(self) -> str:
        place = self.place
        source = _shown_text(place.source)
        where = f"{source}:{place.line}" if place.line else source
        head = f"{where}: {self.severity}: " + (f"{self.key}: " if self.path else "") + _shown_text(self.message)
        advice = [f"    {_shown_text(self.hint)}"] if self.hint else []
        return "\n".join([head, *_shown_line(place), *advice])


def in_order(problems: Iterable[Problem]) -> tuple[Problem, ...]:
    """Return the problems by source, line and column, each once; without warnings about keys with errors."""
    unique = dict.fromkeys(problems)
    wrong = {problem.path for problem in unique if problem.severity == "error"}
    shown = (problem for problem in unique if problem.severity == "error" or problem.path not in wrong)
    return tuple(sorted(shown, key=lambda p: (p.place.rank, p.place.line, p.place.start, p.severity)))


def report(problems: Iterable[Problem]) -> str:
    """Return all problems as one text, in order."""
    return "\n".join(map(str, in_order(problems)))


def _shown_line(place: Place) -> list[str]:
    """Return the line cropped around the caret, and the caret; nothing for an empty line."""
    if not place.text.strip():
        return []
    first = max(0, place.start - _SHOWN_CHARACTERS // 2)
    last = min(len(place.text), first + _SHOWN_CHARACTERS)
    before = ("..." if first else "") + _shown_text(place.text[first : place.start])
    marked = _shown_text(place.text[place.start : min(place.end, last)])
    after = _shown_text(place.text[min(place.end, last) : last]) + ("..." if last < len(place.text) else "")
    return [f"    {before}{marked}{after}".rstrip(), "    " + " " * _width(before) + "^" * max(1, _width(marked))]


def _shown_text(text: str) -> str:
    """Escape characters that do not print as themselves: control characters, and those that change the direction."""
    return "".join(c if c.isprintable() else " " if c == "\t" else c.encode("unicode_escape").decode() for c in text)


def _width(text: str) -> int:
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text if not unicodedata.combining(c))


class Origin(NamedTuple):
    """Where a key and its value stand, what gave it, and in which layer, counted from the most basic one."""

    key: Place
    value: Place
    kind: Literal["file", "setting", "values"]
    layer: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Layers:
    """Keys with their origins, of one source or of several that were laid over each other, and what is wrong with them.

    ``name`` and ``text`` are those of the requested source, ``files`` the files that were read; the origin of ``()`` is
    that of any key which is nowhere named.
    """

    name: str
    data: dict[str, Any]
    origins: Mapping[Path, Origin]
    text: str = ""
    files: tuple[str, ...] = ()
    problems: tuple[Problem, ...] = ()
    depth: int = 1

    def table(self, name: str) -> dict[str, Any]:
        """Return a table; an empty one if there is none, or if the key has another value."""
        table = self.data.get(name)
        return table if isinstance(table, dict) else {}

    def origin(self, path: Path) -> Origin:
        """Return the origin of a key, or of the nearest table above it."""
        return next(self.origins[path[:end]] for end in range(len(path), -1, -1) if path[:end] in self.origins)

    def value_place(self, path: Path) -> Place:
        """Return the place of the value that counts for a key, or of the nearest key or header above it."""
        return self.origin(path).value

    def key_place(self, path: Path) -> Place:
        """Return the place where the key that counts is named."""
        return self.origins[path].key if path in self.origins else self.value_place(path)

    def problem(self, path: Path, message: str, hint: str = "", *, place: Place | None = None) -> Problem:
        """Return what is wrong with a key, shown at its value if no other place is given."""
        return Problem(path=path, message=message, place=place or self.value_place(path), hint=hint)


FILE_BYTES: Final = 64 * 1024
LONGEST_LINE: Final = 1000
SYNTAX_ERRORS: Final = 20
"""A text with a mistake is read once more without its line, so often at most."""

_STRING: Final = r""""(?:[^"\\\n]|\\.)*+"|'[^'\n]*+\'"""
_NAME: Final = rf"(?:[A-Za-z0-9_-]++|{_STRING})"
_DOTTED: Final = rf"{_NAME}(?:[ \t]*+\.[ \t]*+{_NAME})*+"
_HEADER: Final = re.compile(rf"[ \t]*\[\[?[ \t]*(?P<key>{_DOTTED})")
_SETTING: Final = re.compile(rf"[ \t]*(?P<key>{_DOTTED})[ \t]*=[ \t]*(?P<value>(?:{_STRING}|[^#\"'])*+)")
_PLACE: Final = re.compile(
    r"(?P<why>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)", re.DOTALL
)
_SLIPS: Final = {
    "a comma in a number": re.compile(r"=\s*(?P<all>(?P<a>[+-]?[0-9]+),(?P<b>[0-9]+)\s*(?P<c>[^\s#\"']*))"),
    "a value with a unit needs quotation marks": re.compile(
        r"=\s*(?P<all>(?!0[xob])(?P<a>[+-]?[0-9][0-9.+-]*(?:[eE][+-]?[0-9]+)?)(?P<b>)\s*"
        r"(?P<c>[A-Za-z\u00b5\u03bc%][^=#\"']*?))\s*(?:#.*)?$"
    ),
    "a text needs quotation marks": re.compile(r"=\s*(?P<all>(?P<a>)(?P<b>)(?P<c>[A-Za-z][A-Za-z-]*))\s*(?:#.*)?$"),
}
"""Usual slips: in each ``a`` is a number, ``b`` its decimals, ``c`` its unit or a word."""
_UNCLOSED: Final = ("Illegal character '\\n'", "Unterminated string", 'Expected "\'"')
_TWICE: Final = ("Cannot overwrite a value", "Duplicate inline table key", "Cannot declare", "Cannot mutate immutable")

_On = Callable[[int, int, int], Place]
_Named = list[tuple[Path, Place, Place]]


def read_toml(name: str, text: str, rank: int = 0) -> Layers:
    """Return the keys of a TOML text, without its broken lines; ``rank`` is its place in a report."""
    lines = text.replace("\r\n", "\n").split("\n")

    def on(line: int, start: int, end: int) -> Place:
        """Return a place on a line, which is counted from 1; 0 is the whole text."""
        shown = lines[line - 1] if line else ""
        start, end = min(start, len(shown)), min(end, len(shown))
        return Place(source=name, line=line, text=shown, start=start, end=end, rank=rank)

    refused = [Problem(path=(), message=message, place=on(line, 0, 1)) for line, message in _refused(text, lines)]
    named = [] if refused else list(_named(lines, on))
    data, problems = ({}, refused) if refused else _parsed(lines, named, on)
    origins: dict[Path, Origin] = {(): Origin(on(1, 0, 1), on(1, 0, 1), "file")}
    given = list(paths_of(data))
    for path, key, value in named:
        parts = (path[:end] for end in range(1, len(path) + 1))
        origins |= {each: Origin(key, value, "file") for each in parts if each in given and each not in origins}
    for path in given:  # the keys of a table in braces stand where it does
        origins.setdefault(path, origins[path[:-1]]._replace(key=origins[path[:-1]].value))
    return Layers(name=name, data=data, origins=origins, text=text, files=(name,), problems=tuple(problems))


def paths_of(data: Mapping[str, Any], above: Path = ()) -> Iterator[Path]:
    """Yield the path of every table and key, tables before their keys."""
    for key, value in data.items():
        yield (*above, key)
        if isinstance(value, Mapping):
            yield from paths_of(value, (*above, key))


def _refused(text: str, lines: list[str]) -> list[tuple[int, str]]:
    """Return why a text is not read at all, by lines: half a surrogate pair, which no file can hold, or too much."""
    if any("\ud800" <= character <= "\udfff" for character in text):
        return [(0, "not UTF-8 text")]
    if len(text.encode()) > FILE_BYTES:
        return [(0, f"larger than {FILE_BYTES // 1024} kB")]
    long = [number for number, line in enumerate(lines, 1) if len(line) > LONGEST_LINE]
    return [(number, f"a line of more than {LONGEST_LINE} characters") for number in long[:SYNTAX_ERRORS]]


def _named(lines: list[str], on: _On) -> Iterator[tuple[Path, Place, Place]]:
    """Yield what each header and each setting names, and the places of key and value."""
    table: Path = ()
    for number, line in enumerate(lines, 1):
        if seen := _HEADER.match(line):
            table = _parts(seen["key"])
            place = on(number, *seen.span("key"))
            yield table, place, place
        elif seen := _SETTING.match(line):
            start, value = seen.start("value"), seen["value"].rstrip()
            key = on(number, *seen.span("key"))
            yield (*table, *_parts(seen["key"])), key, on(number, start, start + len(value))


def _parts(dotted: str) -> Path:
    return tuple(part.strip("\"'") for part in re.findall(_NAME, dotted))


def _parsed(all_lines: list[str], named: _Named, on: _On) -> tuple[dict[str, Any], list[Problem]]:
    """Return the data of all lines but those that break the text, and these."""
    lines, found = list(all_lines), list[Problem]()
    while len(found) < SYNTAX_ERRORS:
        try:
            return tomllib.loads("\n".join(lines)), found
        except tomllib.TOMLDecodeError as error:
            problem = _broken(str(error), lines, named, on)
        except RecursionError:
            return {}, [*found, Problem(path=(), message="nested too deeply", place=on(1, 0, 1))]
        found.append(problem)
        line = lines[problem.place.line - 1].strip()
        # Without its header the keys of a table would be blamed for being in the wrong one.
        if not line or line.startswith("["):
            break
        lines[problem.place.line - 1] = ""
    return {}, found


def _broken(error: str, lines: list[str], named: _Named, on: _On) -> Problem:
    """Return what is wrong with the line that breaks the text, from what tomllib says."""
    at = _PLACE.fullmatch(error)
    last = max((number for number, line in enumerate(lines, 1) if line.strip()), default=1)
    line, column = (int(at["line"] or last), int(at["column"] or 1)) if at else (last, 1)
    line, why = min(line, last), at["why"] if at else error
    path = next((path for path, key, _ in reversed(named) if key.line <= line), ())
    text = lines[line - 1]
    if why.startswith(_TWICE):
        first = next(key.line for other, key, _ in named if other[: len(path)] == path)
        hint = f"first given in line {first}; keep one of the two" if first < line else "keep one"
        place = on(line, len(text) - len(text.lstrip()), len(text.partition("=")[0].rstrip()))
        return Problem(path=path, message="given twice", place=place, hint=hint)
    for message, slip in _SLIPS.items():
        if found := slip.search(text):
            number, unit = ".".join(filter(None, (found["a"], found["b"]))), found["c"]
            written = f'"{f"{number} {unit}".strip()}"' if unit else number
            return Problem(path=path, message=message, place=on(line, *found.span("all")), hint=f"write {written}")
    hint = "is the closing quotation mark missing?" if why.startswith(_UNCLOSED) else ""
    message = f"not valid TOML: {why[:1].lower()}{why[1:]}"
    return Problem(path=path, message=message, place=on(line, column - 1, column), hint=hint)


def text_of(scenario: Mapping[str, Any]) -> str:
    """Return the keys of a scenario as the text of a file."""
    return "\n".join(_table_lines("", scenario)) + "\n"


def _table_lines(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys of a table with simple values, then the tables in it; no key needs quotes."""
    inner = {key: value for key, value in table.items() if isinstance(value, Mapping)}
    plain = {key: value for key, value in table.items() if key not in inner}
    if name and (plain or not inner):
        yield from ("", f"[{name}]")
    yield from (f"{key} = {toml_value(value)}" for key, value in plain.items())
    for key, value in inner.items():
        yield from _table_lines(f"{name}.{key}" if name else key, value)


_IN_A_LINE: Final = 32  # lines of a file have a length at most


def toml_value(value: Any) -> str:
    """Return a text, number, boolean, or a list or table of these as TOML, which differs from JSON in one character."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {toml_value(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        each = list(map(toml_value, value))
        rows = [", ".join(each[at : at + _IN_A_LINE]) for at in range(0, len(each), _IN_A_LINE)]
        return "[" + ", ".join(rows) + "]" if len(rows) < 2 else "[\n    " + ",\n    ".join(rows) + ",\n]"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
