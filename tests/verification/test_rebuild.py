"""The traces rebuilt from the rows of /junctions alone, one junction and one tick at a time."""

from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

import rubnoise
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.record.memory import MemoryRecord
from tests.models import UNEQUAL, bare, model, recorded
from tests.oracle.slow_contact import Doubles, Rows, lens_area, traces, triangle_area
from tests.verification.seeds import seed_of

FIGURE_5 = Path(__file__).parents[2] / "scenarios" / "paper" / "fig5.toml"
AREA_BOUND = 1e-9
SPEED, STRENGTH = 1000.0, 250.0


def around(rows: Rows, low: float, high: float) -> Rows:
    """Return the junctions that may live between two distances; births are in order, no life is longer than 4 d_m."""
    first = np.searchsorted(rows.birth, low - 2.0 * rows.diameter.max())
    last = np.searchsorted(rows.birth, high, side="right")
    part = slice(first, last)
    return Rows(
        birth=rows.birth[part], diameter=rows.diameter[part], strength=rows.strength[part], death=rows.death[part]
    )


def rebuilt(
    rows: Rows, distance: Doubles, together: int, area_of: Callable[[float, float], float] = lens_area
) -> Iterator[tuple[slice, Doubles, NDArray[np.int64], Doubles]]:
    """Yield area, count and force of the slow reference for so many ticks at a time."""
    for first in range(0, distance.size, together):
        part = slice(first, first + together)
        ticks = distance[part]
        yield part, *traces(around(rows, ticks[0], ticks[-1]), ticks.tolist(), area_of)


@pytest.fixture(scope="module")
def figure_5(tmp_path_factory: pytest.TempPathFactory) -> Iterator[h5py.File]:
    """Run Figure 5 as the paper's scenario has it and open the file with h5py alone."""
    path = tmp_path_factory.mktemp("rebuild") / "fig5.h5"
    rubnoise.run(rubnoise.load(FIGURE_5), path).close()
    with h5py.File(path, "r") as file:
        yield file


def rows_of(file: h5py.File) -> Rows:
    names = {"birth": "birth_distance", "diameter": "diameter", "strength": "shear_strength", "death": "death_distance"}
    return Rows(**{name: file["junctions"][column][:] for name, column in names.items()})


def rows_in_memory(record: MemoryRecord) -> Rows:
    columns = record["junctions"]
    return Rows(
        birth=columns["birth_distance"],
        diameter=columns["diameter"],
        strength=columns.get("shear_strength", np.ones(columns["diameter"].size)),
        death=columns["death_distance"],
    )


def test_rows_of_a_file_hold_whole_lives(figure_5: h5py.File) -> None:
    columns = {name: dataset[:] for name, dataset in figure_5["junctions"].items()}
    birth, diameter = columns["birth_distance"], columns["diameter"]
    assert columns["junction"].tolist() == list(range(birth.size))
    assert np.all(np.diff(birth) >= 0.0)
    assert birth[-1] <= 20_000.0
    assert np.array_equal(columns["death_distance"], birth + 2.0 * diameter)
    assert np.array_equal(columns["life_distance"], 2.0 * diameter)
    assert np.allclose(columns["max_area"], np.pi * diameter**2 / 4.0, rtol=1e-15, atol=0.0)
    assert np.array_equal(columns["birth_time"], birth / SPEED)
    assert np.array_equal(columns["death_time"], columns["death_distance"] / SPEED)
    assert np.all(columns["shear_strength"] == STRENGTH)
    alive = (birth < 0.0).astype(int) + 2 * (columns["death_distance"] > 20_000.0)
    assert np.array_equal(columns["state"], alive)


def test_ticks_of_a_file_are_where_they_were_asked_for(figure_5: h5py.File) -> None:
    distance = figure_5["trace"]["distance"][:]
    assert np.array_equal(distance, np.arange(200_001) * 0.1)
    assert np.array_equal(figure_5["slider"]["distance"][:], distance)
    assert np.array_equal(figure_5["slider"]["time"][:], distance / SPEED)
    assert np.array_equal(figure_5["slider"]["friction_force"][:], figure_5["trace"]["friction_force"][:])


@pytest.mark.parametrize("quarter", range(4))
def test_every_tick_of_a_file_follows_from_its_rows(figure_5: h5py.File, quarter: int) -> None:
    rows, trace = rows_of(figure_5), figure_5["trace"]
    ticks = slice(50_000 * quarter, 50_000 * (quarter + 1) + 1)
    distance, found_area, found_count, found_force = (
        trace[name][ticks] for name in ("distance", "real_contact_area", "junction_count", "friction_force")
    )
    for part, area, count, force in rebuilt(rows, distance, together=40):
        assert np.abs(found_area[part] - area).max() < AREA_BOUND
        assert np.array_equal(found_count[part], count)
        assert np.abs(found_force[part] - force).max() < AREA_BOUND * STRENGTH


LAWS = {
    "triangles": (model(pulse=TRIANGLE, distance=2_000.0, tick=0.3), triangle_area),
    "regular births": (model(births="regular", distance=2_000.0, tick=0.3), lens_area),
    "unequal strengths": (model(strength=UNEQUAL, distance=2_000.0, tick=0.3), lens_area),
    "all three, wide sizes": (
        model(pulse=TRIANGLE, births="regular", strength=UNEQUAL, spread=Spread(relative=0.6), distance=2e3, tick=0.3),
        triangle_area,
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_every_tick_of_other_laws_follows_from_the_rows(name: str) -> None:
    run, area_of = LAWS[name]
    record = recorded(run, seed_of(f"rebuild/{name}"))
    rows, trace = rows_in_memory(record), record["trace"]
    assert (np.unique(rows.strength).size > 1) == (run.strengths is UNEQUAL)
    for part, area, count, force in rebuilt(rows, trace["distance"], together=40, area_of=area_of):
        assert np.abs(trace["real_contact_area"][part] - area).max() < AREA_BOUND
        assert np.array_equal(trace["junction_count"][part], count)
        assert np.abs(trace["friction_force"][part] - force).max() < AREA_BOUND * rows.strength.max()


def test_equal_strengths_in_place_of_unequal_ones_are_seen() -> None:
    trace = recorded(LAWS["unequal strengths"][0], seed_of("rebuild/unequal strengths"))["trace"]
    share = trace["friction_force"] / trace["real_contact_area"]
    assert share.min() < 0.8 * STRENGTH
    assert share.max() > 1.2 * STRENGTH


def test_a_birth_moved_by_a_nanometre_is_seen(figure_5: h5py.File) -> None:
    rows, trace = rows_of(figure_5), figure_5["trace"]
    rows.birth[1000] += 1e-3
    death = rows.death[1000]
    near = slice(int(rows.birth[1000] / 0.1) - 5, int(death / 0.1) + 5)
    area = traces(around(rows, rows.birth[1000], death), trace["distance"][near].tolist())[0]
    assert np.abs(trace["real_contact_area"][near] - area).max() > 1e5 * AREA_BOUND


def test_a_metre_away_nothing_has_been_lost() -> None:
    run = bare(count=4.0, distance=1e6, tick=250.0)
    record = recorded(run, seed_of("metre"))
    rows, trace = rows_in_memory(record), record["trace"]
    for part, area, count, _ in rebuilt(rows, trace["distance"], together=1):
        assert np.abs(trace["real_contact_area"][part] - area).max() < AREA_BOUND
        assert np.array_equal(trace["junction_count"][part], count)
