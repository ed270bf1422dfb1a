"""One TOML text: its data, the place of each key, and the lines that break it.

tomllib gives values without their places, and stops at the first mistake. So keys are found line by line, as a scenario
has them; and a line that breaks the text is reported and left out, so that one report names them all.
"""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, NamedTuple

from rubnoise.scenario import limits
from rubnoise.scenario.problems import Path, Place, Problem

_STRING: Final = r""""(?:[^"\\\n]|\\.)*+"|'[^'\n]*+\'"""
_NAME: Final = rf"(?:[A-Za-z0-9_-]++|{_STRING})"
_DOTTED: Final = rf"{_NAME}(?:[ \t]*+\.[ \t]*+{_NAME})*+"
_NAMES: Final = re.compile(_NAME)
_HEADER: Final = re.compile(rf"[ \t]*\[\[?[ \t]*(?P<key>{_DOTTED})")
_SETTING: Final = re.compile(rf"[ \t]*(?P<key>{_DOTTED})[ \t]*=[ \t]*(?P<value>(?:{_STRING}|[^#\"'])*+)")
_ELEMENT: Final = re.compile(rf"""(?:{_STRING}|\[[^\[\]]*+\]|\{{[^{{}}]*+\}}|[^\s,"'\[\]{{}}])++""")
_PLACE: Final = re.compile(
    r"(?P<why>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)", re.DOTALL
)
_COMMA: Final = re.compile(r"=\s*(?P<all>(?P<whole>[+-]?[0-9]+),(?P<part>[0-9]+)\s*(?P<unit>[^\s#\"']*))")
_BARE_QUANTITY: Final = re.compile(
    r"=\s*(?P<all>(?!0[xob])[+-]?[0-9][0-9.+-]*(?:[eE][+-]?[0-9]+)?\s*[A-Za-z\u00b5\u03bc%][^=#\"']*?)\s*(?:#.*)?$"
)
_BARE_WORD: Final = re.compile(r"=\s*(?P<all>[A-Za-z][A-Za-z-]*)\s*(?:#.*)?$")
_UNCLOSED: Final = ("Illegal character '\\n'", "Unterminated string", 'Expected "\'"')
_TWICE: Final = ("Cannot overwrite a value", "Duplicate inline table key", "Cannot declare", "Cannot mutate immutable")


class _Named(NamedTuple):
    """A header or a setting: its path, and where its key and its value stand."""

    path: Path
    key: Place
    value: Place


@dataclass(frozen=True)
class Source:
    """A text with its name in reports and its rank among the sources of a scenario."""

    name: str
    text: str
    rank: int = 0

    @property
    def data(self) -> dict[str, Any]:
        """The TOML data; of a broken text, the data of its other lines."""
        return self._parsed[0]

    @property
    def problems(self) -> tuple[Problem, ...]:
        """The lines that break the text, or why it is not read at all."""
        return self._parsed[1]

    def value_place(self, path: Path) -> Place:
        """Return the place of a key's value, or of the nearest key or header above it."""
        for end in range(len(path), 0, -1):
            if named := self._places.get(path[:end]):
                return _inside(named.value, path[end:])
        return self._on(1, 0, 1)

    def key_place(self, path: Path) -> Place:
        """Return the place where a key is first named."""
        return self._places[path].key if path in self._places else self.value_place(path)

    @cached_property
    def _lines(self) -> list[str]:
        return self.text.replace("\r\n", "\n").split("\n")

    @cached_property
    def _parsed(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        if refused := self._refused():
            return {}, refused
        lines, found = list(self._lines), list[Problem]()
        while len(found) < limits.SYNTAX_ERRORS:
            try:
                return tomllib.loads("\n".join(lines)), tuple(found)
            except tomllib.TOMLDecodeError as error:
                problem = self._broken(str(error), lines)
            except RecursionError:
                return {}, (*found, Problem(path=(), message="nested too deeply", place=self._on(1, 0, 1)))
            found.append(problem)
            line = lines[problem.place.line - 1].strip()
            # Without its header the keys of a table would be blamed for being in the wrong one.
            if not line or line.startswith("["):
                break
            lines[problem.place.line - 1] = ""
        return {}, tuple(found)

    def _refused(self) -> tuple[Problem, ...]:
        """Return why a text is not read at all: half a surrogate pair, which no file can hold, or too much of it."""
        whole = Place(source=self.name, line=0, text="", start=0, end=0, rank=self.rank)
        if any("\ud800" <= character <= "\udfff" for character in self.text):
            return (Problem(path=(), message="not UTF-8 text", place=whole),)
        if len(self.text.encode()) > limits.FILE_BYTES:
            return (Problem(path=(), message=f"larger than {limits.FILE_BYTES // 1024} kB", place=whole),)
        message = f"a line of more than {limits.LINE_CHARACTERS} characters"
        long = [number for number, line in enumerate(self._lines, 1) if len(line) > limits.LINE_CHARACTERS]
        return tuple(
            Problem(path=(), message=message, place=self._on(number, 0, 1)) for number in long[: limits.SYNTAX_ERRORS]
        )

    def _broken(self, error: str, lines: list[str]) -> Problem:
        """Return what is wrong with the line that breaks the text, by the words of tomllib."""
        at = _PLACE.fullmatch(error)
        last = max((number for number, line in enumerate(lines, 1) if line.strip()), default=1)
        line, column = (int(at["line"] or last), int(at["column"] or 1)) if at else (last, 1)
        line, why = min(line, last), at["why"] if at else error
        path, text = self._last_named(line), lines[line - 1]
        if why.startswith(_TWICE):
            first = self._places[path].key.line
            hint = f"first given in line {first}; keep one of the two" if first < line else "keep one"
            place = self._on(line, len(text) - len(text.lstrip()), len(text.partition("=")[0].rstrip()))
            return Problem(path=path, message="given twice", place=place, hint=hint)
        for message, slip, written in _slips(text):
            return Problem(path=path, message=message, place=self._on(line, *slip), hint=f"write {written}")
        hint = "is the closing quotation mark missing?" if why.startswith(_UNCLOSED) else ""
        message = f"not valid TOML: {why[:1].lower()}{why[1:]}"
        return Problem(path=path, message=message, place=self._on(line, column - 1, column), hint=hint)

    @cached_property
    def _places(self) -> dict[Path, _Named]:
        """Each key and each part of a dotted one, where it is first named."""
        found: dict[Path, _Named] = {}
        for each in self._named:
            for end in range(1, len(each.path) + 1):
                found.setdefault(each.path[:end], each)
        return found

    def _last_named(self, line: int) -> Path:
        return next((each.path for each in reversed(self._named) if each.key.line <= line), ())

    @cached_property
    def _named(self) -> list[_Named]:
        return list(self._headers_and_settings())

    def _headers_and_settings(self) -> Iterator[_Named]:
        table: Path = ()
        for number, line in enumerate(self._lines, 1):
            if found := _HEADER.match(line):
                table = _parts(found["key"])
                place = self._on(number, *found.span("key"))
                yield _Named(table, place, place)
            elif found := _SETTING.match(line):
                start, value = found.start("value"), found["value"].rstrip()
                key = self._on(number, *found.span("key"))
                yield _Named((*table, *_parts(found["key"])), key, self._on(number, start, start + len(value)))

    def _on(self, line: int, start: int, end: int) -> Place:
        text = self._lines[line - 1]
        first, last = min(start, len(text)), min(end, len(text))
        return Place(source=self.name, line=line, text=text, start=first, end=last, rank=self.rank)


def _inside(value: Place, further: Path) -> Place:
    """Return the place of an element of a list, if the line of its key has it; otherwise that of the list."""
    if not (further and isinstance(further[0], int) and value.text.startswith("[", value.start)):
        return value
    elements = [each.span() for each in _ELEMENT.finditer(value.text, value.start + 1, value.end - 1)]
    if further[0] >= len(elements):
        return value
    start, end = elements[further[0]]
    return replace(value, start=start, end=end)


def _parts(dotted: str) -> Path:
    """Return the names of a dotted key; tomllib itself reads those in quotation marks."""
    names = _NAMES.findall(dotted)
    try:
        return tuple(name if name[0] not in "\"'" else next(iter(tomllib.loads(f"{name} = 0"))) for name in names)
    except tomllib.TOMLDecodeError:
        return tuple(names)


def _slips(line: str) -> Iterator[tuple[str, tuple[int, int], str]]:
    """Yield the usual slip of a line that breaks the text: what it is, where, and what to write."""
    if comma := _COMMA.search(line):
        number = f"{comma['whole']}.{comma['part']}"
        yield "a comma in a number", comma.span("all"), f'"{number} {comma["unit"]}"' if comma["unit"] else number
    if bare := _BARE_QUANTITY.search(line):
        number, unit = re.match(r"([+-]?[0-9][0-9.+-]*(?:[eE][+-]?[0-9]+)?)\s*(.*)", bare["all"]).groups()  # type: ignore[union-attr]
        yield "a value with a unit needs quotation marks", bare.span("all"), f'"{number} {unit}"'
    if word := _BARE_WORD.search(line):
        yield "a text needs quotation marks", word.span("all"), f'"{word["all"]}"'
