"""One TOML text: its data, where each key of it stands, and what is wrong before any key is looked at."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from rubnoise.scenario import limits
from rubnoise.scenario.locate import Span, Spans, locate
from rubnoise.scenario.problems import Path, Place, Problem
from rubnoise.scenario.syntax import Parsed, parse


@dataclass(frozen=True)
class Source:
    """A text with its name in reports and its rank among the sources of a scenario."""

    name: str
    text: str
    rank: int = 0

    @property
    def data(self) -> dict[str, Any]:
        """The TOML data; of a broken text, what could be read without its broken lines."""
        return {} if self._refusal else self._parsed.data

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What keeps the text from being TOML within the limits."""
        if self._refusal:
            whole = Place(source=self.name, line=0, text="", start=0, end=0, rank=self.rank)
            return (Problem(path=(), message=self._refusal, place=whole),)
        return tuple(
            Problem(path=f.path, message=f.message, hint=f.hint, place=self._on_line(f.line, f.start, f.end))
            for f in self._parsed.faults
        )

    def value_place(self, path: Path) -> Place:
        """Return where the value of a key stands, or else the nearest key or header above it."""
        for known in (path[:n] for n in range(len(path), 0, -1)):
            span = self._spans.values.get(known) or self._spans.keys.get(known)
            if span:
                return self._place(span)
        return self._on_line(1, 0, 1)

    def key_place(self, path: Path) -> Place:
        """Return where a key is first named."""
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
