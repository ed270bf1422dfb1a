"""Pictures of sweeps, and stretches of a result with what is left of them."""

from collections.abc import Iterator, Sequence
from itertools import product
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.figures import stretch as stretches
from rubnoise.figures.axis_labels import key_label, quantity_label
from rubnoise.figures.stretch import MOST_POINTS, Stretch
from rubnoise.figures.study import PointRuns, Study, StudyLine, exact_at, exact_of, study_of_points
from rubnoise.figures.study_picture import draw_study, study_picture
from rubnoise.figures.style import house_style
from rubnoise.scenario import Scenario, build
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.theory.cumulants import area_cumulants
from tests.verification.scores import seed_of

# Pictures of sweeps: what goes along the axis, what theory draws through the points, and what is refused.
STD = "real_contact_area_std"
COUNT, AREA, SHAPE = "interface.mean_junction_count", "interface.mean_real_contact_area", "pulse.shape"
SPEED, DISTANCE, SPREAD = "sliding.speed", "sliding.distance", "diameter.spread"
UNITS = {COUNT: "1", AREA: "um^2", SHAPE: "", SPEED: "um/s", DISTANCE: "um", SPREAD: "%", "slider.coupling": ""}


def _scenario(values: dict[str, Any]) -> Scenario:
    tables: dict[str, dict[str, Any]] = {
        "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
        "sliding": {"distance": "5 mm", "speed": "1 mm/s"},
        "diameter": {"law": "normal", "spread": "4 %"},
        "strength": {"mean": "250 MPa"},
        "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
    }
    for key, value in values.items():
        table, _, name = key.partition(".")
        tables.setdefault(table, {})[name] = value
    return build({"format": 1, **tables})


def _points(
    grid: dict[str, Sequence[Any]], quantity: str = STD, *, runs: int = 8, scatter: float = 0.02
) -> list[PointRuns]:
    """Return points whose runs scatter about the exact value."""
    rng = np.random.Generator(np.random.PCG64(seed_of("study/points")))
    found = []
    for chosen in product(*grid.values()):
        values = dict(zip(grid, chosen, strict=True))
        scenario = _scenario(values)
        told = {key: _number(scenario, key) for key in values}
        exact = exact_of(scenario, quantity)
        found.append(
            PointRuns(
                values=values,
                numbers={key: number for key, number in told.items() if number is not None},
                scenario=scenario,
                figures=(exact * rng.normal(1.0, scatter, runs)).tolist(),
                standard_error=scatter * exact,
            )
        )
    return found


def _number(scenario: Scenario, key: str) -> float | None:
    table, _, name = key.partition(".")
    value = getattr(getattr(scenario, table), name)
    return float(value) if isinstance(value, int | float) else None


def _study(grid: dict[str, Sequence[Any]], quantity: str = STD, side_by_side: Sequence[str] = (), **how: Any) -> Study:
    units = {key: UNITS[key] for key in grid}
    return study_of_points(
        _points(grid, quantity, **how), quantity, title="a study", units=units, side_by_side=side_by_side
    )


def _rejected(line: StudyLine) -> bool:
    """Whether an exact value lies far outside of what the runs allow."""
    return any(abs(spot.seen.value - spot.exact) > 5.0 * spot.seen.standard_error for spot in line.spots)


def test_the_key_with_the_most_numbers_goes_along_the_axis() -> None:
    study = _study({COUNT: [10, 20], AREA: ["100 um^2", "200 um^2", "400 um^2"]})
    assert (study.key, study.unit, study.others) == (AREA, "um^2", (COUNT,))
    assert [line.label for line in study.lines] == ["10", "20"]
    assert [spot.place for spot in study.lines[0].spots] == [100.0, 200.0, 400.0]
    assert _study({AREA: ["100 um^2", "200 um^2"], COUNT: [10, 20]}).key == AREA


def test_points_are_put_in_order() -> None:
    study = _study({COUNT: [40, 10, 20]})
    assert [spot.place for spot in study.lines[0].spots] == [10.0, 20.0, 40.0]


def test_the_curve_is_exact_at_the_points_and_between_them() -> None:
    study = _study({COUNT: [10, 20, 40]})
    assert study.lines[0].curve is not None
    across, exact = study.lines[0].curve
    assert set(across) >= {10.0, 20.0, 40.0}
    for x, value in list(zip(across.tolist(), exact.tolist(), strict=True))[::9]:
        assert value == pytest.approx(area_cumulants(_scenario({COUNT: x}).model()).std, rel=1e-9)
    assert not _rejected(study.lines[0])


def test_the_curve_of_another_contact_is_rejected() -> None:
    points = _points({COUNT: [10, 20, 40]})
    wrong = [
        PointRuns(
            values=point.values,
            numbers=point.numbers,
            scenario=_scenario({COUNT: 1.2 * point.numbers[COUNT]}),
            figures=point.figures,
            standard_error=point.standard_error,
        )
        for point in points
    ]
    assert _rejected(study_of_points(wrong, STD, title="", units={COUNT: "1"}).lines[0])
    assert not _rejected(study_of_points(points, STD, title="", units={COUNT: "1"}).lines[0])


def test_a_percentage_stays_one_between_the_points() -> None:
    scenario = _scenario({SPREAD: "10 %"})
    assert exact_at(scenario, {SPREAD: 0.2}, STD) == pytest.approx(
        area_cumulants(_scenario({SPREAD: "20 %"}).model()).std, rel=1e-12
    )


def test_keys_side_by_side_go_along_together(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rubnoise.figures.study.CURVE", 9)
    grid = {SPEED: ["1 mm/s", "4 mm/s", "16 mm/s"]}
    points = _points(grid, "displacement_std")
    distances = {1000.0: "5 mm", 4000.0: "20 mm", 16000.0: "80 mm"}
    both = [
        PointRuns(
            values=dict(point.values) | {DISTANCE: distances[point.numbers[SPEED]]},
            numbers=dict(point.numbers) | {DISTANCE: 5.0 * point.numbers[SPEED]},
            scenario=point.scenario,
            figures=point.figures,
            standard_error=nan,
        )
        for point in points
    ]
    units = {SPEED: "um/s", DISTANCE: "um"}
    study = study_of_points(both, "displacement_std", title="", units=units, side_by_side=tuple(units))
    assert (study.key, study.others, len(study.lines)) == (SPEED, (), 1)
    assert study.lines[0].curve is not None
    across, exact = study.lines[0].curve
    middle = int(np.argmin(np.abs(across - 2000.0)))
    assert exact[middle] == pytest.approx(
        exact_of(_scenario({SPEED: float(across[middle])}), "displacement_std"), rel=1e-9
    )
    assert study.logarithmic
    apart = study_of_points(both, "displacement_std", title="", units=units)
    assert len(apart.lines) == 3


def test_words_along_the_axis_have_exact_values_at_the_points_alone() -> None:
    study = _study({SHAPE: ["lens", "triangle"]})
    assert (study.numeric, study.key) == (False, SHAPE)
    assert [(spot.place, spot.label) for spot in study.lines[0].spots] == [(0.0, "lens"), (1.0, "triangle")]
    assert study.lines[0].curve is None
    both = _study({SHAPE: ["lens", "triangle"], COUNT: [10, 20]})
    assert (both.key, [line.label for line in both.lines]) == (COUNT, ["lens", "triangle"])


@pytest.mark.parametrize(
    ("counts", "logarithmic"),
    [([10, 20, 30, 40], False), ([5, 10, 20, 40], True), ([1, 2, 50], True), ([10, 20], False), ([10, 12, 30], False)],
)
def test_an_axis_is_logarithmic_where_the_points_are(counts: list[int], *, logarithmic: bool) -> None:
    assert _study({COUNT: counts}).logarithmic is logarithmic


def test_what_makes_no_picture_is_refused() -> None:
    with pytest.raises(Refused, match="nothing is swept"):
        _study({COUNT: [20]})
    points = [
        PointRuns(values=p.values, numbers=p.numbers, scenario=p.scenario, figures=[nan], standard_error=nan)
        for p in _points({COUNT: [10, 20]})
    ]
    with pytest.raises(Refused, match="real_contact_area_std: no run has it"):
        study_of_points(points, STD, title="", units={COUNT: "1"})


def test_a_gap_is_left_where_there_is_no_scenario() -> None:
    assert isnan(exact_at(_scenario({}), {COUNT: -5.0}, STD))


def test_every_axis_has_its_unit() -> None:
    assert quantity_label("displacement_std") == "standard deviation of the\ndisplacement (µm)"
    assert key_label(AREA, "um^2") == "mean real contact area (µm²)"
    assert key_label(COUNT, "1") == "mean junction count"
    assert key_label(SPEED, "um/s") == "sliding speed (µm/s)"
    assert key_label("slider.damping", "N*s/m") == "damping (N s/m)"


def _texts(study: Study) -> set[str]:
    with house_style():
        figure = draw_study(study)
        figure.draw_without_rendering()
        axes = figure.axes[0]
        legend = axes.get_legend()
        assert legend is not None
        told = [axes.get_xlabel(), axes.get_ylabel(), legend.get_title().get_text()]
        return {*told, *(text.get_text() for text in (*legend.get_texts(), *axes.get_xticklabels()))}


def test_the_axis_has_the_unit_in_which_values_are_written() -> None:
    study = _study({SPEED: ["1 mm/s", "4 mm/s", "16 mm/s"]}, "displacement_std")
    assert (study.unit, study.scale) == ("mm/s", pytest.approx(1e-3))
    with house_style():
        axes = draw_study(study).axes[0]
    assert axes.get_xlabel() == "sliding speed (mm/s)"
    assert axes.containers[0][0].get_xdata().tolist() == pytest.approx([1.0, 4.0, 16.0])
    curve = max(axes.lines, key=lambda line: len(line.get_xdata()))
    assert (min(curve.get_xdata()), max(curve.get_xdata())) == pytest.approx((1.0, 16.0))
    assert _study({COUNT: [10, 20]}).unit == "1"
    mixed = _study({SPEED: ["500 um/s", "1 mm/s"]}, "displacement_std")
    assert (mixed.unit, mixed.scale) == ("um/s", 1.0)
    shares = _study({SPREAD: ["4 %", "8 %"]})
    assert (shares.unit, shares.scale) == ("%", pytest.approx(100.0))


def test_the_law_of_weak_coupling_is_not_called_exact() -> None:
    speeds = {SPEED: ["60 mm/s", "100 mm/s"], "slider.coupling": ["one-way", "two-way"]}
    assert {"exact", "law of weak coupling"} <= _texts(_study(speeds, "displacement_std"))
    area = _texts(_study(speeds))
    assert "exact" in area
    assert "law of weak coupling" not in area


def test_a_picture_says_what_it_shows() -> None:
    texts = _texts(_study({AREA: ["100 um^2", "200 um^2", "300 um^2"], COUNT: [10, 20]}))
    assert {"10", "20", "exact", "mean real contact area (µm²)"} <= texts
    assert "simulated, 95 % interval,\nmean junction count:" in texts
    assert "standard deviation of the\nreal contact area (µm²)" in texts
    alone = _texts(_study({SHAPE: ["lens", "triangle"]}))
    assert {"lens", "triangle", "simulated, 95 % interval", "exact", "pulse shape"} <= alone


@pytest.mark.parametrize("runs", [1, 2])
def test_the_same_study_is_the_same_picture(runs: int) -> None:
    first, again = (study_picture(_study({COUNT: [10, 20, 40]}, runs=runs), "svg") for _ in range(2))
    assert first == again
    assert first.startswith(b"<?xml")
    assert study_picture(_study({COUNT: [10, 20, 41]}, runs=runs), "svg") != first


# A stretch of a result: which rows it holds, and what is left of them where there are many.
SCENARIO = {
    "format": 1,
    "title": "a contact",
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "sliding": {"distance": 3000.0},
    "output": {"tick": "0.1 um"},
}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stretch") / "run.h5"
    rubnoise.run(rubnoise.build(SCENARIO), path).close()
    return path


@pytest.fixture
def file(path: Path) -> Iterator[RunFile]:
    with open_run(path) as opened:
        yield opened


def test_all_of_a_run_is_shown_unless_somebody_chooses(file: RunFile) -> None:
    whole = Stretch.of(file)
    assert (whole.start, whole.stop, whole.rows("trace")) == (0.0, 3000.0, (0, 30_001))
    assert not whole.chosen
    assert whole.title == "a contact"
    chosen = Stretch.of(file, 1.0, 2.0)
    assert chosen.chosen
    assert chosen.rows("trace") == (10, 21)
    assert Stretch.of(file, stop=1e9).rows("trace") == (0, 30_001)


def test_narrowing_leaves_a_choice_alone(file: RunFile) -> None:
    whole = Stretch.of(file, None, None)
    assert (whole.narrowed(30.0).start, whole.narrowed(30.0).stop) == (0.0, 30.0)
    assert whole.narrowed(1e6) == whole
    chosen = Stretch.of(file, 500.0, None)
    assert chosen.narrowed(30.0) == chosen
    assert chosen.whole().rows("trace") == whole.rows("trace")


def test_the_ends_are_ticks_even_where_division_rounds(file: RunFile) -> None:
    for tick in (3, 7, 29, 57, 1234, 29_999):
        assert Stretch.of(file, 0.1 * tick, 0.1 * (tick + 1)).rows("trace") == (tick, tick + 2)


@pytest.mark.parametrize(
    ("start", "stop", "said"),
    [
        (5.0, 5.0, "nothing lies in 5 to 5 um; the run goes from 0 to 3000 um"),
        (6.0, 5.0, "nothing lies in 6 to 5 um"),
        (-1.0, 5.0, "nothing lies in -1 to 5 um"),
        (4000.0, None, "nothing lies in 4000 to 3000 um"),
        (1.0, 1.05, "1 to 1.05 um is too short to draw; the run has a tick every 0.1 um"),
    ],
)
def test_a_stretch_of_nothing_is_refused(file: RunFile, start: float, stop: float | None, said: str) -> None:
    with pytest.raises(Refused, match=said):
        Stretch.of(file, start, stop)


def test_few_rows_are_drawn_as_they_are(file: RunFile) -> None:
    distance, area = Stretch.of(file, 100.0, 200.0).curve("trace", "real_contact_area")
    np.testing.assert_array_equal(area, file.column("trace", "real_contact_area", 1000, 2001))
    np.testing.assert_allclose(distance, file.column("trace", "distance", 1000, 2001), rtol=1e-15)


def test_of_many_rows_the_extremes_are_kept(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rubnoise.arrays.CHUNK_ROWS", 999)
    whole = Stretch.of(file)
    distance, area = whole.curve("trace", "real_contact_area")
    values = file.column("trace", "real_contact_area")
    assert area.size <= MOST_POINTS + 2
    assert distance.size == area.size
    assert (area.min(), area.max()) == (values.min(), values.max())
    np.testing.assert_array_equal(area[:2], [values[:22].min(), values[:22].max()])
    assert distance[0] == distance[1] == pytest.approx(1.05)
    assert np.all(np.diff(distance) >= 0.0)
    monkeypatch.undo()
    np.testing.assert_array_equal(area, whole.curve("trace", "real_contact_area")[1])


def test_panels_are_the_rows_in_order(file: RunFile) -> None:
    panels = list(Stretch.of(file, 10.0, 20.0).chunks("trace", "junction_count", 40))
    assert [chunk.size for chunk in panels] == [40, 40, 21]
    np.testing.assert_array_equal(np.concatenate(panels), file.column("trace", "junction_count", 100, 201))


def test_of_a_long_record_the_beginning_is_read(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stretches, "MOST_READ", 50)
    record = Stretch.of(file, 10.0, 20.0).record("trace", "real_contact_area")
    np.testing.assert_array_equal(record, file.column("trace", "real_contact_area", 100, 150))
