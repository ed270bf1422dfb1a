"""One TOML text: its data, where each key of it stands, and what is wrong before any key is looked at."""

import re
import tomllib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from rubnoise.scenario import limits
from rubnoise.scenario.locate import Span, Spans, last_key, locate
from rubnoise.scenario.problems import Path, Place, Problem

_POSITION = re.compile(r"(.*?) \(at (?:line (\d+), column (\d+)|end of document)\)$", re.DOTALL)
_KEY = re.compile(r'^[ \t]*([A-Za-z0-9_\-."\' \t]+?)[ \t]*=')
_COMMA_NUMBER = re.compile(r"=\s*([+-]?[0-9]+),([0-9]+)\s*([^\s#\"']*)")
_BARE_QUANTITY = re.compile(r"=\s*([+-]?[0-9][0-9.eE+-]*)\s+([A-Za-z\u00b5\u03bc%][^#\"']*?)\s*(?:#.*)?$")
_DUPLICATES = ("Cannot overwrite a value", "Duplicate inline table key", "Cannot declare", "Cannot mutate immutable")


@dataclass(frozen=True)
class Source:
    """A text with its name in reports and its rank among the sources of a scenario."""

    name: str
    text: str
    rank: int = 0

    @cached_property
    def _lines(self) -> list[str]:
        return self._normal.split("\n")

    @cached_property
    def _normal(self) -> str:
        return self.text.replace("\r\n", "\n")

    @cached_property
    def _spans(self) -> Spans:
        return locate(self._normal)

    @cached_property
    def _parsed(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        refused = self._too_large()
        return ({}, refused) if refused else self._parse_leaving_out_broken_lines()

    @property
    def data(self) -> dict[str, Any]:
        """The TOML data; of a broken text, what could be read without its broken lines."""
        return self._parsed[0]

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What keeps the text from being TOML within the limits."""
        return self._parsed[1]

    def value_place(self, path: Path) -> Place:
        """Return where the value of a key stands (its header or key, for a table)."""
        for known in (path[:n] for n in range(len(path), 0, -1)):
            span = self._spans.values.get(known) or self._spans.keys.get(known)
            if span:
                return self._place(span)
        return self._first_line()

    def key_place(self, path: Path) -> Place:
        """Return where a key is first named."""
        span = self._spans.keys.get(path)
        return self._place(span) if span else self.value_place(path)

    def _place(self, span: Span) -> Place:
        line = self._normal.count("\n", 0, span.start)
        start = span.start - (self._normal.rfind("\n", 0, span.start) + 1)
        return self._line_place(line + 1, start, start + span.end - span.start)

    def _first_line(self) -> Place:
        return self._line_place(1, 0, 1)

    def _line_place(self, line: int, start: int, end: int) -> Place:
        text = self._lines[line - 1]
        return Place(
            source=self.name, line=line, text=text, start=min(start, len(text)), end=min(end, len(text)), rank=self.rank
        )

    def _too_large(self) -> tuple[Problem, ...]:
        whole = Place(source=self.name, line=0, text="", start=0, end=0, rank=self.rank)
        if not _is_unicode(self.text):
            return (Problem(path=(), message="not UTF-8 text", place=whole),)
        if len(self.text.encode()) > limits.FILE_BYTES:
            return (Problem(path=(), message=f"larger than {limits.FILE_BYTES // 1024} kB", place=whole),)
        return tuple(
            Problem(path=(), message=message, place=self._line_place(number, 0, 1))
            for number, line in enumerate(self._lines, 1)
            if (message := _too_much_on(line))
        )[: limits.SYNTAX_ERRORS]

    def _parse_leaving_out_broken_lines(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        """Blank each line that breaks the parse and go on, so that one report names every broken line."""
        lines, problems = list(self._lines), list[Problem]()
        while len(problems) < limits.SYNTAX_ERRORS:
            try:
                return tomllib.loads("\n".join(lines)), tuple(problems)
            except tomllib.TOMLDecodeError as error:
                problem, at_end = self._syntax_problem(str(error)), "end of document" in str(error)
            except RecursionError:
                return {}, (Problem(path=(), message="nested too deeply", place=self._first_line()),)
            problems.append(problem)
            broken = lines[problem.place.line - 1]
            # Without its header the keys of a table would be blamed for being in the wrong one.
            if at_end or not broken.strip() or broken.lstrip().startswith("["):
                break
            lines[problem.place.line - 1] = ""
        return {}, tuple(problems)

    def _syntax_problem(self, error: str) -> Problem:
        found = _POSITION.match(error)
        last = len(self._normal.rstrip().split("\n"))
        line, column = (int(found[2] or last), int(found[3] or 1)) if found else (last, 1)
        return self._explained(found[1] if found else error, min(line, len(self._lines)), column)

    def _explained(self, reason: str, line: int, column: int) -> Problem:
        text = self._lines[line - 1]
        named = _KEY.match(text)
        path = last_key("\n".join(self._lines[:line])) if named else ()
        place = self._line_place(line, column - 1, column)
        if reason.startswith(_DUPLICATES):
            return self._duplicate(path, line)
        if comma := _COMMA_NUMBER.search(text):
            value = f"{comma[1]}.{comma[2]}" + (f" {comma[3]}" if comma[3] else "")
            place = self._line_place(line, comma.start(1), comma.end(3))
            written = f'"{value}"' if comma[3] else value
            return Problem(path=path, message="a comma in a number", place=place, hint=f"write {written}")
        if bare := _BARE_QUANTITY.search(text):
            place = self._line_place(line, bare.start(1), bare.end(2))
            hint = f'write "{bare[1]} {bare[2]}"'
            return Problem(path=path, message="a value with a unit needs quotation marks", place=place, hint=hint)
        return Problem(path=path, message=f"not valid TOML: {reason[:1].lower()}{reason[1:]}", place=place)

    def _duplicate(self, path: Path, line: int) -> Problem:
        here = re.match(r"[ \t]*([^=]*[^= \t])", self._lines[line - 1])
        place = self._line_place(line, here.start(1) if here else 0, here.end(1) if here else 1)
        first = self.key_place(path) if path in self._spans.keys else None
        hint = f"first given in line {first.line}; keep one of the two" if first and first.line < line else "keep one"
        return Problem(path=path, message="given twice", place=place, hint=hint)


def _is_unicode(text: str) -> bool:
    """Lone surrogates cannot be written to any file."""
    return not any("\ud800" <= character <= "\udfff" for character in text)


def _too_much_on(line: str) -> str:
    if len(line) > limits.LINE_CHARACTERS:
        return f"a line of more than {limits.LINE_CHARACTERS} characters"
    key = line.partition("=")[0]
    if key.count(".") > limits.KEY_DOTS and "," not in key and not key.lstrip().startswith("#"):
        return f"a key of more than {limits.KEY_DOTS + 1} parts"
    return ""
