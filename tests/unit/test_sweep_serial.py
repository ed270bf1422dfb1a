"""Points run in memory are the runs that their scenarios say."""

from math import sqrt
from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.tally import Tally
from rubnoise.scenario.sweep import expand
from rubnoise.sweep.execution import Measure, measured, run_points
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.sampling import standard_errors
from tests.unit.sweeps import sweep_of

TABLE = "[sweep]\nreplicates = 2\n[sweep.grid]\ninterface.mean_junction_count = [10, 40]\n"


def _area(model: Model, record: MemoryRecord) -> np.ndarray:
    return record["trace"]["real_contact_area"]


def _std(model: Model, tally: Tally) -> float:
    return tally.moments["real_contact_area"].std


TRACES = Measure(sink=MemoryRecord, read=_area)
STDS = Measure(sink=lambda extent: Tally(), read=_std)


def test_a_point_is_the_run_of_its_scenario(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, TABLE, "sliding.distance=500 um"))
    told = list(run_points(points, TRACES))
    assert [point for point, _ in told] == list(points)
    for point, area in told:
        alone = rubnoise.simulate(point.scenario)["trace"]["real_contact_area"]
        assert np.array_equal(area, alone)
    assert not np.array_equal(told[0][1], told[1][1])


def test_the_order_of_points_changes_no_result(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, TABLE, "sliding.distance=500 um"))
    forwards = [std for _, std in run_points(points, STDS)]
    assert [std for _, std in run_points(points[::-1], STDS)][::-1] == forwards
    assert [measured(point, STDS) for point in points] == forwards


def test_a_point_runs_only_when_its_result_is_wanted(tmp_path: Path) -> None:
    points = iter(expand(sweep_of(tmp_path, TABLE, "sliding.distance=100 um")))
    next(run_points(points, STDS))
    assert len(list(points)) == 3


def test_replicates_are_independent_runs_of_one_theory(tmp_path: Path) -> None:
    table = TABLE.replace("replicates = 2", "replicates = 8")
    for count in (10, 40):
        points = [point for point in expand(sweep_of(tmp_path, table, "sliding.distance=3 mm"))
                  if point.values["interface.mean_junction_count"] == count]  # fmt: skip
        model = points[0].scenario.model()
        found = np.array([std for _, std in run_points(points, STDS)])
        error = standard_errors(model).std / sqrt(len(points))
        assert abs(found.mean() - area_cumulants(model).std) <= 4.0 * error
        assert found.std(ddof=1) == pytest.approx(standard_errors(model).std, rel=1.2)
        assert np.unique(found).size == len(points)
