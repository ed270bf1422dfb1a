"""A few of the single changes of `tools/fuzz_verify.py`, and proof that one that goes unseen would be noticed."""

from pathlib import Path
from random import Random

import h5py
import pytest
from fuzz.changing import Place, Places
from fuzz_verify import Judge, Tally, folders_judged, judged

FEW = 24


def test_single_changes_are_named() -> None:
    tally = judged(1, range(FEW))
    assert tally.found == []
    assert (tally.named + tally.refused + tally.hidden).total() == FEW
    assert tally.named.total() > FEW / 2


def test_single_changes_of_a_sweep_folder_are_named() -> None:
    tally = folders_judged(1, range(FEW))
    assert tally.found == []
    assert (tally.named + tally.refused).total() == FEW


def test_a_change_that_goes_unseen_would_be_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A verify that looks at nothing stands for one that misses something."""

    def another_unit(file: h5py.File, _random: Random) -> Places:
        file["trace/distance"].attrs["units"] = "mm"
        return (Place(path="/trace/distance", attribute="units"),)

    judge, tally = Judge(tmp_path), Tally()
    judge.judge(another_unit, "bare", Random(1), sealed=True, tally=tally)  # noqa: S311  (no secret)
    assert (tally.named["another_unit"], tally.found) == (1, [])
    monkeypatch.setattr("rubnoise.cli.verify.format_verification", lambda *_: ["nothing"])
    monkeypatch.setattr("rubnoise.analysis.verifying.findings.Verification.different", ())
    judge.judge(another_unit, "bare", Random(1), sealed=True, tally=tally)  # noqa: S311  (no secret)
    (found,) = tally.found
    assert found == "another_unit of bare, sealed, /trace/distance units: unnoticed"
