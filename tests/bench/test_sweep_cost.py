"""The cost of a sweep is printed only if all its runs are there and right."""

from pathlib import Path
from types import SimpleNamespace
from typing import Self

import pytest

import rubnoise
from tests.architecture.sources import ROOT
from tools.studies import sweep_cost

SCENARIO = ROOT / "scenarios" / "paper" / "fig9.toml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep of two points and two replicates."""
    place = tmp_path_factory.mktemp("sweep") / "folder"
    counts = "sweep.grid.interface.mean_junction_count=[10, 20]"
    changes = ["sweep.replicates=2", "sliding.distance=3 mm", "output.tick=0.5 um", counts]
    sweep = rubnoise.load_sweep(SCENARIO, changes)
    rubnoise.run_sweep(sweep, place, jobs=1).close()
    return place


def altered(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    """Let an opened sweep tell its standard deviations as so many times of what they are."""
    load = rubnoise.open_sweep

    class Altered:
        def __init__(self, sweep: rubnoise.SweepResult) -> None:
            self.sweep = sweep

        def __enter__(self) -> Self:
            return self

        def __exit__(self, *_: object) -> None:
            self.sweep.close()

        def to_xarray(self):
            grid = self.sweep.to_xarray()
            grid["real_contact_area_std"] = factor * grid["real_contact_area_std"]
            return grid

    monkeypatch.setattr(rubnoise, "open_sweep", lambda place: Altered(load(place)))


def test_right_runs_are_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sweep_cost.tell_spreads(folder)
    assert "worst of 2 points: " in capsys.readouterr().out


@pytest.mark.parametrize("factor", [3.0, float("nan")])
def test_wrong_runs_end_the_program(folder: Path, factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    altered(monkeypatch, factor)
    with pytest.raises(SystemExit, match="no costs of wrong runs"):
        sweep_cost.tell_spreads(folder)


def test_a_run_that_is_left_out_ends_the_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Made(SimpleNamespace):
        def __enter__(self) -> Self:
            return self

        def __exit__(self, *_: object) -> None: ...

    monkeypatch.setattr(rubnoise, "run_sweep", lambda *_, **__: Made(count=lambda state: 9 if state == "done" else 0))
    with pytest.raises(SystemExit, match="only 9 of 10 runs were made"):
        sweep_cost.swept(SCENARIO, 2, tmp_path, jobs=1)
