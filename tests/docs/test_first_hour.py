"""The page of the first hour: twenty things in Python, each in six lines or fewer (test_examples runs them)."""

import re

from tests.architecture.sources import ROOT

PAGE = (ROOT / "docs" / "first-hour.md").read_text(encoding="utf-8")
MOST_LINES = 6


def _lines(block: str) -> int:
    return sum(bool(line.strip()) for line in block.splitlines())


def test_there_are_twenty_things_of_six_lines() -> None:
    blocks = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    numbers = [int(number) for number in re.findall(r"^\*\*(\d+)\. ", PAGE, re.MULTILINE)]
    assert numbers == list(range(1, 21))
    assert len(blocks) == 20
    assert max(map(_lines, blocks)) <= MOST_LINES


def test_nothing_on_it_needs_a_checkout() -> None:
    assert "scenarios/" not in PAGE
