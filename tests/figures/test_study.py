"""Pictures of sweeps, and stretches of a result with what is left of them."""

import json
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.figures.study import Study, draw_study, exact_of, study_of_sweep
from rubnoise.figures.style import as_bytes, house_style
from rubnoise.figures.tracks import MOST_POINTS, Stretch, Track
from rubnoise.scenario import Scenario, build
from rubnoise.storage.index import Filled, Index
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import Dataset
from rubnoise.theory.moments import area_cumulants
from tests.laws.scores import seed_of

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


def _index(grid: dict[str, Sequence[Any]], *, runs: int = 8, scatter: float = 0.02, off: float = 1.0) -> Index:
    """Return the index of a sweep whose runs scatter about the exact value of STD, or about ``off`` times it."""
    rng = np.random.Generator(np.random.PCG64(seed_of("study/points")))
    points = [dict(zip(grid, chosen, strict=True)) for chosen in product(*grid.values())]
    scenarios = [_scenario(values) for values in points]
    exact = np.array([exact_of(scenario, STD) for scenario in scenarios])
    seen = off * exact[:, np.newaxis] * rng.normal(1.0, scatter, (len(points), runs))
    columns = {key: np.array([_number(scenario, key) for scenario in scenarios]) for key in grid}
    columns["values"] = np.array([json.dumps(values) for values in points])
    of_runs = {"point": np.repeat(np.arange(len(points)), runs), STD: seen.ravel()}
    of_runs[f"{STD}_standard_error"] = np.repeat(scatter * exact, runs)
    texts = {
        "scenario_resolved": json.dumps(_scenario({}).resolved()),
        "side_by_side": "[]",
        "grid": json.dumps([*grid]),
    }
    return Index(texts=texts, points=_filled(columns), runs=_filled(of_runs), summaries={})


def _filled(columns: dict[str, np.ndarray]) -> dict[str, Filled]:
    return {name: Filled(about=Dataset(name, UNITS.get(name, "1"), "", ""), values=columns[name]) for name in columns}


def _number(scenario: Scenario, key: str) -> float | None:
    table, _, name = key.partition(".")
    value = getattr(getattr(scenario, table), name)
    return float(value) if isinstance(value, int | float) else None


def _study(grid: dict[str, Sequence[Any]], **how: Any) -> Study:
    return study_of_sweep(_index(grid, **how), "a study", STD)


def _is_rejected(study: Study) -> bool:
    """Whether an exact value lies far outside of what the runs allow."""
    known = zip(study.seen, study.exact.tolist(), strict=True)
    return any(abs(seen.value - exact) > 5.0 * seen.standard_error for seen, exact in known)


def test_the_key_with_the_most_numbers_goes_along_the_axis() -> None:
    study = _study({COUNT: [10, 20], AREA: ["100 um^2", "200 um^2", "400 um^2"]})
    assert (study.key, study.unit, study.others) == (AREA, "um^2", (COUNT,))
    assert [*study.lines] == ["10", "20"]
    assert study.place[study.lines["10"]].tolist() == [100.0, 200.0, 400.0]
    assert _study({AREA: ["100 um^2", "200 um^2"], COUNT: [10, 20]}).key == AREA


def test_the_curve_is_exact_at_the_points_and_between_them() -> None:
    study = _study({COUNT: [10, 20, 40]})
    assert study.has_curves
    across, exact = study.curve(study.lines[""])
    assert set(across) >= {10.0, 20.0, 40.0}
    for x, value in list(zip(across.tolist(), exact.tolist(), strict=True))[::9]:
        assert value == pytest.approx(area_cumulants(_scenario({COUNT: x}).model()).std, rel=1e-9)
    assert not _is_rejected(study)


def test_the_curve_of_another_contact_is_rejected() -> None:
    other = np.sqrt(1.2)  # of a contact with 20 % more junctions
    assert _is_rejected(_study({COUNT: [10, 20, 40]}, off=other))
    assert not _is_rejected(_study({COUNT: [10, 20, 40]}))


@pytest.mark.slow
@pytest.mark.parametrize("runs", [1, 2])
def test_the_same_study_is_the_same_picture(runs: int) -> None:
    drawn = house_style()(draw_study)
    first, again, other = (as_bytes(drawn(_study({COUNT: [10, 20, n]}, runs=runs)), "svg") for n in (40, 40, 41))
    assert first == again != other
    assert first.startswith(b"<?xml")


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


def test_of_many_rows_the_extremes_are_kept(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rubnoise.arrays.CHUNK_ROWS", 999)
    whole = Stretch.of(file)
    distance, area = Track.of(whole, "area").curve()
    values = file.column("trace", "real_contact_area")
    assert area.size <= MOST_POINTS + 2
    assert distance.size == area.size
    assert (area.min(), area.max()) == (values.min(), values.max())
    np.testing.assert_array_equal(area[:2], [values[:22].min(), values[:22].max()])
    assert distance[0] == distance[1] == pytest.approx(1.05)
    assert np.all(np.diff(distance) >= 0.0)
    monkeypatch.undo()
    np.testing.assert_array_equal(area, Track.of(whole, "area").curve()[1])
