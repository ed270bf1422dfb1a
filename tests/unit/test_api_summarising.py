"""What a sweep keeps of a run without keeping the run."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.agreement import from_attributes
from rubnoise.analysis.run_summary import CURVES
from rubnoise.api.sweeping import keep_summary, summary_theory
from rubnoise.scenario.sweep import expand
from tests.unit.sweeps import GRID, sweep_of


def test_a_summary_is_that_of_the_run_with_a_file(tmp_path: Path) -> None:
    for point in expand(sweep_of(tmp_path, GRID))[:2]:
        row = keep_summary(point)
        with rubnoise.run(point.scenario, tmp_path / f"{point.run_id}.h5") as run:
            assert from_attributes(row.figures) == run.summary
            assert row.arrays["histogram"].sum() > 0.0
            lag_0 = row.arrays["autocovariance"][0]
            assert lag_0 == pytest.approx(run.trace["real_contact_area"][:].var(), rel=1e-10)
        assert row.run_id == point.run_id
        assert row.file == ""


def test_it_fits_in_a_few_kilobytes_and_goes_through_a_pipe(tmp_path: Path) -> None:
    row = keep_summary(expand(sweep_of(tmp_path, GRID))[0])
    assert sum(values.nbytes for values in row.arrays.values()) <= 4096
    assert {name: values.size for name, values in row.arrays.items()} == CURVES
    again = pickle.loads(pickle.dumps(row))  # noqa: S301  (what was pickled the moment before)
    assert again.figures == row.figures


def test_what_is_expected_comes_once_a_point(tmp_path: Path) -> None:
    first, second = (keep_summary(point) for point in expand(sweep_of(tmp_path, GRID))[:2])
    assert second.of_point == {}
    assert not set(first.of_point) & set(first.arrays)
    theory = summary_theory(expand(sweep_of(tmp_path, GRID))[0].scenario.model())
    assert {name: values.tobytes() for name, values in first.of_point.items()} == {
        name: values.tobytes() for name, values in theory.items()
    }


def test_a_run_can_be_stopped_on_its_way(tmp_path: Path) -> None:
    def stop(_distance: float, _junctions: int, _live: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        keep_summary(expand(sweep_of(tmp_path, GRID))[0], watch=stop)


def test_what_is_expected_lies_where_the_curves_do(tmp_path: Path) -> None:
    point = expand(sweep_of(tmp_path, GRID))[0]
    row, told = keep_summary(point), summary_theory(point.scenario.model())
    assert set(told) == {
        "histogram_place",
        "histogram_expected",
        *(f"{name}_{part}" for name in ("spectrum", "autocovariance")
          for part in ("place", "expected", "standard_error")),
    }  # fmt: skip
    for name in ("spectrum", "autocovariance"):
        assert np.array_equal(np.isnan(row.arrays[name]), np.isnan(told[f"{name}_expected"]))
        score = (row.arrays[name] - told[f"{name}_expected"]) / told[f"{name}_standard_error"]
        assert 0.1 < float(np.nanstd(score)) < 2.5
