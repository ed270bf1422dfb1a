"""What a fault is: texts of the program, what stands in their place, and the test that has to notice it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Edit:
    """A text that stands exactly once in the program, whatever file holds it, and what stands there instead.

    Blanks and line ends are all one, so that a text is found however it is indented or wrapped; further lines of
    ``new`` are indented as the line is in which the text begins.
    """

    old: str
    new: str


@dataclass(frozen=True)
class Mutant:
    """A fault by its name, the edits that make it, and the test that notices it, wherever in tests that stands.

    ``test`` is the name of a test function, with [parameters] for one case of it, and behind "test_file.py::" where
    several files have a test of that name. ``chance``: whether that test scores figures, so that it has to show
    |z| >= 8 and not only fail.
    """

    name: str
    edits: tuple[Edit, ...]
    test: str
    chance: bool = False


def one(name: str, test: str, old: str, new: str, *, chance: bool = False) -> Mutant:
    """Return a mutant of a single edit."""
    return Mutant(name, (Edit(old, new),), test, chance)
