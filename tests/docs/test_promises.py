"""Each promise of three pages stands there, has its test, and the fault that this test notices: tests/promises.toml."""

import tomllib
from pathlib import Path

import pytest
from mutants import MUTANTS

from tests.architecture.sources import ROOT

PROMISES = tomllib.loads(Path(__file__).parents[1].joinpath("promises.toml").read_text(encoding="utf-8"))["promise"]


def breach(page: str, says: str, test: str, fault: str = "") -> str:
    """Return what is wrong with a promise; empty where nothing is."""
    file, _, name = test.partition("::")
    if says not in " ".join((ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8").split()):
        return f"docs/{page}.md does not say so"
    if f"\ndef {name}(" not in (ROOT / file).read_text(encoding="utf-8"):
        return f"{file} has no {name}"
    noticed_by = {mutant.name: mutant.test.rpartition("::")[2].partition("[")[0] for mutant in MUTANTS}
    return "" if not fault or noticed_by.get(fault) == name else f"{name} does not notice the fault {fault!r}"


@pytest.mark.parametrize("promise", PROMISES, ids=lambda promise: promise["says"])
def test_a_promise_stands_on_its_page_and_is_tested(promise: dict[str, str]) -> None:
    assert breach(**promise) == ""


def test_breaches_are_found() -> None:
    right = next(each for each in PROMISES if "fault" in each)
    for wrong in ({"says": "nothing is promised"}, {"test": right["test"] + "s"}, {"fault": "no such fault"}):
        assert breach(**right | wrong) != ""


def test_each_page_has_promises() -> None:
    assert {each["page"] for each in PROMISES} == {"reproducibility", "survival", "data-format"}
    assert len({each["says"] for each in PROMISES}) == len(PROMISES) > 30
