"""The problems of a scenario, and how they are shown: `file:line: error: key: message`, the line, a caret, advice."""

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

Path = tuple[str | int, ...]
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
        """Return the problem as it is printed."""
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
