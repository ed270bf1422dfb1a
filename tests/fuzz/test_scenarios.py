"""A few of the damaged scenarios of `tools/fuzz_scenarios.py`, and proof that the script would notice."""

from pathlib import Path
from random import Random

import pytest
from fuzz.words import CHANGES, Change, changed
from fuzz_scenarios import scenarios, thrown

from rubnoise.cli import check

pytestmark = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the limits are those of Linux")
FEW = 40


def test_damaged_scenarios_are_accepted_or_refused() -> None:
    tally = thrown(1, range(FEW))
    assert tally.found == []
    assert tally.ends.keys() == {0, 2}
    assert tally.ends.total() == tally.changes.total() == FEW


def test_another_ending_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*arguments: object, **options: object) -> None:
        raise KeyError("nobody foresaw this")

    numbers = [number for number in range(FEW) if number % 3 == 0][:2]
    monkeypatch.setattr(check, "_checked", fail)
    tally = thrown(1, numbers)
    assert [text.partition(": ")[2].partition(":")[0] for text in tally.found] == ["internal error"] * len(numbers)


@pytest.mark.parametrize("change", CHANGES, ids=lambda each: each.__name__)
def test_every_kind_of_change_changes_a_scenario(change: Change) -> None:
    content = scenarios()[0].read_bytes()
    assert any(change(content, Random(n)) != content for n in range(5))  # noqa: S311  (damage is no secret)


def test_changes_can_be_made_again() -> None:
    content = scenarios()[0].read_bytes()
    first, second = (changed(content, Random(3)) for _ in range(2))  # noqa: S311
    assert first == second
