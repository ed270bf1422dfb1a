"""A precision asks for as many replicates as it takes, in a way that only their own figures decide."""

from math import inf, nan, sqrt
from pathlib import Path

import numpy as np
import pytest

from rubnoise.analysis.run_summary import SummarySink
from rubnoise.scenario import limits
from rubnoise.scenario.sweep_table import FEWEST, QUANTITIES, Precision
from rubnoise.simulation.run import simulate
from tests.models import model
from tests.unit.sweeps import GRID, HEAD, sweep_of, sweep_refusal
from tests.verification.seeds import seed_of

PRECISE = Precision(relative=0.01, quantity="real_contact_area_std", most_replicates=1000)
POINTS = GRID.replace("replicates = 2\n", "")


def _line(*lines: str) -> str:
    return POINTS.replace("[sweep]\n", "\n".join(["[sweep]", *lines, ""]))


def test_a_sweep_keeps_runs_without_end_of_replicates_unless_told(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, POINTS)
    assert (sweep.replicates, sweep.keep, sweep.precision) == (1, "runs", None)


def test_what_is_told_is_kept(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, _line('keep = "summary"', "precision = 0.005", "most_replicates = 40"))
    assert sweep.keep == "summary"
    assert sweep.replicates == FEWEST
    assert sweep.precision == Precision(relative=0.005, quantity="real_contact_area_std", most_replicates=40)
    assert sweep_of(tmp_path, _line("replicates = 20", "precision = 0.1")).replicates == 20


@pytest.mark.parametrize(
    ("lines", "said", "hint"),
    [
        (['keep = "all"'], 'sweep.keep: unknown value "all"', "available: runs, summary"),
        (["precision = 0"], "sweep.precision: must be above 0", "possible: 1e-06 to 1"),
        (['precision = "1 %"'], "sweep.precision: needs a number, not a text", ""),
        (['quantity = "displacement_std"'], "sweep.quantity: needs a precision",
         "add precision = 0.01"),
        (["most_replicates = 9"], "sweep.most_replicates: needs a precision",
         "add precision = 0.01"),
        (["precision = 0.1", "replicates = 4"],
         "sweep.replicates: too few to estimate the precision", "replicates = 8, or leave it out"),
        (["precision = 0.1", "replicates = 20", "most_replicates = 10"],
         "sweep.most_replicates: fewer than the replicates to begin with", "most_replicates = 20 or more"),
        (["precision = 0.1", 'quantity = "real_contact_area_st"'],
         'sweep.quantity: unknown value "real_contact_area_st"', 'did you mean "real_contact_area_std"?'),
        (["precision = 0.1", 'quantity = "displacement_std"'],
         "sweep.quantity: displacement_std is no quantity of a run without [slider]", "a table [slider]"),
        (["precision = 0.1", 'quantity = "friction_force_mean"'],
         "sweep.quantity: friction_force_mean is no quantity of a run without [strength]", "a table [strength]"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_where_it_stands(tmp_path: Path, lines: list[str], said: str, hint: str) -> None:
    report = sweep_refusal(tmp_path, _line(*lines)).splitlines()
    at = HEAD.count("\n") + 2 + [line.split(" ")[0] for line in lines].index(said.partition(":")[0].partition(".")[2])
    assert report[0] == f"s.toml:{at}: error: {said}"
    assert hint in report[-1]


def test_runs_that_a_precision_may_come_to_are_counted(tmp_path: Path) -> None:
    most = limits.SWEEP_RUNS // 6 + 1
    report = sweep_refusal(tmp_path, _line("precision = 0.1", f"most_replicates = {most}"))
    assert "sweep: too many: 6 points, 100,002 runs with replicates" in report
    assert "fewer values or most_replicates" in report
    sweep_of(tmp_path, _line("precision = 0.1", f"most_replicates = {most - 1}"))


def test_quantities_are_the_figures_of_a_run() -> None:
    run = model(distance=50.0)
    sink = SummarySink(run)
    simulate(run, 1, sink, engine="batch")
    assert [figure.name for figure in sink.finish().figures] == list(QUANTITIES)


def test_what_is_reached_is_the_relative_standard_error_of_the_mean() -> None:
    values = np.random.Generator(np.random.PCG64(seed_of("precision/reached"))).normal(50.0, 5.0, 40)
    error = values.std(ddof=1) / sqrt(40) / values.mean()
    assert PRECISE.reached(values.tolist()) == pytest.approx(error, rel=1e-12)
    assert PRECISE.reached([*values.tolist(), nan]) == pytest.approx(error, rel=1e-12)
    assert PRECISE.reached((-values).tolist()) == pytest.approx(error, rel=1e-12)
    assert PRECISE.reached([3.0]) == PRECISE.reached([]) == PRECISE.reached([nan, 3.0]) == inf
    assert PRECISE.reached([7.0] * 8) == 0.0
    assert PRECISE.reached([-1.0, 1.0]) == inf


def test_as_many_are_wanted_as_the_scatter_asks_for() -> None:
    values = [100.0 + (-1) ** n * 4.0 for n in range(16)]
    reached = PRECISE.reached(values)
    assert reached == pytest.approx(4.0 / sqrt(15.0) / 100.0)
    assert PRECISE.wanted(values) == int(np.ceil(16 * 1.1 * (reached / 0.01) ** 2))
    assert PRECISE.wanted(values * 2) == 32
    assert PRECISE.wanted([100.0 + (-1) ** n * 40.0 for n in range(16)]) == 32
    assert PRECISE.wanted([100.0 + (-1) ** n * 400.0 for n in range(990)]) == 1000
    assert PRECISE.wanted([100.0 + (-1) ** n * 400.0 for n in range(1000)]) == 1000
    assert PRECISE.wanted([nan] * 8) == 16


def _carried_out(values: np.ndarray, precision: Precision) -> int:
    count, wanted = 0, FEWEST
    while wanted > count:
        count = wanted
        wanted = precision.wanted(values[:count].tolist())
    return count


def test_stopping_early_costs_little_of_the_precision() -> None:
    """Of unit normals about 20 to a relative error of 0.01 one needs 25; what is got is as good as was asked for."""
    rng = np.random.Generator(np.random.PCG64(seed_of("precision/stopping")))
    precision = Precision(relative=0.01, quantity="real_contact_area_std", most_replicates=1000)
    counts, means = [], []
    for _ in range(400):
        values = rng.normal(20.0, 1.0, 1000)
        counts.append(_carried_out(values, precision))
        means.append(values[: counts[-1]].mean())
    assert np.mean(counts) == pytest.approx(25.0, rel=0.2)
    error = float(np.std(means) / 20.0)
    # The std of 400 means is known to 3.5 %; stopping on a lucky scatter may cost some 15 % more than was asked for.
    assert 0.7 * 0.01 <= error <= 1.2 * 0.01
    # Eight of each, which is what there is without a precision, are far from it.
    assert 1.0 / sqrt(8.0) / 20.0 > 0.01 * 1.7
