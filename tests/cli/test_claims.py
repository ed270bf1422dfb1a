"""`rubnoise claims`: what is printed, and the exit code."""

import json
from dataclasses import replace

import pytest

from rubnoise.claims import catalogue
from rubnoise.claims.claim import Verdict
from tests.cli.terminal import call
from tests.cli.test_json_contract import A_CLAIM


@pytest.fixture
def verdict_if_agreed(monkeypatch: pytest.MonkeyPatch) -> list[Verdict]:
    """Settle one claim at once, with the verdict that stands in the list."""
    verdicts = [Verdict.HOLDS]
    monkeypatch.setattr(catalogue, "evaluate_claims", lambda tell: (replace(A_CLAIM, verdict=verdicts[0]),))
    return verdicts


def test_a_claim_is_told_with_its_numbers_and_verdict(verdict_if_agreed: list[Verdict]) -> None:
    done = call("claims")
    assert done.out.splitlines()[0] == "Eq. (1): holds"
    assert "mean (um)" in done.out
    assert "1 +- 0.2" in done.out
    assert max(map(len, done.out.splitlines())) <= 80
    assert done.err == ""


def test_simulation_and_theory_that_disagree_are_told_by_the_exit_code(verdict_if_agreed: list[Verdict]) -> None:
    verdict_if_agreed[0] = Verdict.UNSETTLED
    done = call("claims", "--json")
    assert done.code == 3
    assert json.loads(done.out)["claims"][0]["verdict"] == "unsettled"
