"""`rubnoise claims`: what is printed, and the exit code."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from rubnoise.claims import catalogue, ledger
from rubnoise.claims.claim import Verdict
from rubnoise.claims.field import FieldClaim
from tests.cli.terminal import call
from tests.cli.test_json_contract import A_CLAIM, A_ROW


@pytest.fixture
def evaluated(monkeypatch: pytest.MonkeyPatch) -> list[Verdict]:
    """Settle one claim at once, with the verdict that stands in the list."""
    verdicts = [Verdict.HOLDS]
    monkeypatch.setattr(catalogue, "evaluate_claims", lambda tell: (replace(A_CLAIM, verdict=verdicts[0]),))
    return verdicts


def test_a_claim_is_told_with_its_numbers_and_verdict(evaluated: list[Verdict]) -> None:
    done = call("claims")
    assert done.out.splitlines()[0] == "Eq. (1): holds"
    assert "mean (um)" in done.out
    assert "1 +- 0.2" in done.out
    assert max(map(len, done.out.splitlines())) <= 80
    assert done.err == ""


def test_simulation_and_theory_that_disagree_are_told_by_the_exit_code(evaluated: list[Verdict]) -> None:
    evaluated[0] = Verdict.UNSETTLED
    done = call("claims", "--json")
    assert done.code == 3
    assert json.loads(done.out)["claims"][0]["verdict"] == "unsettled"


@pytest.fixture
def rows(monkeypatch: pytest.MonkeyPatch) -> list[FieldClaim]:
    """Settle the ledger at once, with the rows that stand in the list."""
    found = [A_ROW]
    monkeypatch.setattr(ledger, "evaluate_field", lambda tell: tuple(found))
    return found


def test_the_ledger_is_told_with_source_numbers_and_verdict(rows: list[FieldClaim]) -> None:
    done = call("claims", "--field")
    assert done.out.splitlines()[0] == "someone1956: not yet (abstract alone)"
    assert "Published: above 0.5; the numbers agree." in done.out
    assert max(map(len, done.out.splitlines())) <= 80
    assert (done.code, done.err) == (0, "")


def test_the_ledger_is_written_as_a_page_and_as_json(rows: list[FieldClaim], tmp_path: Path) -> None:
    done = call("claims", "--field", "-o", str(tmp_path))
    assert done.out.split() == [str(tmp_path / name) for name in ("field.md", "field.json")]
    kept = json.loads((tmp_path / "field.json").read_text(encoding="utf-8"))["claims"]
    assert kept == json.loads(call("claims", "--field", "--json").out)["claims"]
    assert kept[0]["published"] == [0.5, None]
    assert "### someone1956" in (tmp_path / "field.md").read_text(encoding="utf-8")
    again = call("claims", "--field", "-o", str(tmp_path))
    assert again.code == 2
    assert "--force replaces it" in again.err
    assert call("claims", "--field", "-o", str(tmp_path), "--force").code == 0


def test_no_ledger_is_written_where_simulation_and_theory_disagree(rows: list[FieldClaim], tmp_path: Path) -> None:
    quantity = A_ROW.quantity
    assert quantity is not None
    rows[0] = replace(A_ROW, quantity=replace(quantity, exact=3.0))
    done = call("claims", "--field", "-o", str(tmp_path))
    assert done.code == 3
    assert "simulation and theory disagree: someone1956" in done.err
    assert list(tmp_path.iterdir()) == []


def test_the_paper_s_claims_go_to_no_folder(evaluated: list[Verdict], tmp_path: Path) -> None:
    done = call("claims", "-o", str(tmp_path))
    assert done.code == 2
    assert "need --field" in done.err
