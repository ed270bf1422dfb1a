"""What docs/teaching.md has for a teacher: numbers, answers and mistakes, lesson by lesson."""

import re
from dataclasses import dataclass

from tests.architecture.sources import ROOT

PAGE = ROOT / "docs" / "teaching.md"
SECTION = re.compile(r"^## (\d)\. (.+?)\n(.*?)(?=^## )", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"\*\*(\d[\d.]*)[^*]*\*\*")


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One question of a lesson: what is right and what is not, as a student would write it."""

    right: list[str]
    wrong: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Lesson:
    """One lesson as the page for teachers has it; numbers are those in bold, in order, as they are written."""

    title: str
    numbers: list[str]
    rows: list[Row]


def lessons() -> list[Lesson]:
    """Return the lessons in order."""
    text = PAGE.read_text(encoding="utf-8")
    return [
        Lesson(title=f"{number}. {title}", numbers=NUMBER.findall(body), rows=_rows(body))
        for number, title, body in SECTION.findall(text)
    ]


def pushing_back() -> list[Row]:
    """Return the questions of the second half of the lesson on the slider."""
    text = PAGE.read_text(encoding="utf-8")
    return _rows(text.partition("## Lesson 7, second half")[2].partition("\n## ")[0])


def other_numbers() -> list[str]:
    """Return the numbers in bold outside of the lessons."""
    return NUMBER.findall(SECTION.sub("", PAGE.read_text(encoding="utf-8")))


def minutes() -> list[int]:
    """Return the minutes of the plan."""
    plan = PAGE.read_text(encoding="utf-8").partition("## The plan")[2].partition("\n## ")[0]
    return [int(found) for found in re.findall(r"^\| (\d+) \|", plan, re.MULTILINE)]


def _rows(body: str) -> list[Row]:
    table = body.partition("| question |")[2]
    cells = [line.strip("|").split("|") for line in table.splitlines() if line.startswith("| ")]
    return [Row(right=_listed(right), wrong=_listed(wrong)) for _, right, wrong in cells]


def _listed(cell: str) -> list[str]:
    return [each.strip() for each in cell.split(";")]
