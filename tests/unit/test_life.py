"""One junction's life as told from its file, and its picture."""

from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.junctions import Life, life_of
from rubnoise.api.run import Run
from rubnoise.contact.pulses import LENS
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.figures import pictures, style
from rubnoise.figures.catalogue import drawing
from rubnoise.figures.tracks import Stretch
from rubnoise.record.rows import JunctionState
from rubnoise.storage.reader import RunFile, open_run
from tests.architecture.sources import ROOT
from tests.unit.tampering import BIRTH, DEPARTURE, DIAMETER, RECORD_END, STRENGTH, bare_file, lives_file


def life_in(file: RunFile, number: int) -> Life:
    return life_of(file, Run(file).junction(number))


# One junction's life as told from its file, held to sums over all rows that are written out here.
DEATH = np.minimum(DEPARTURE, BIRTH + 2.0 * DIAMETER)


@pytest.fixture
def file(tmp_path: Path) -> Iterator[RunFile]:
    with lives_file(tmp_path / "x.h5") as opened:
        yield opened


def _areas(distance: float, *, just_before: bool = False) -> np.ndarray:
    """Return the area of every row, by the rule birth <= s < death or the limit from below."""
    alive = (distance > BIRTH) & (distance <= DEATH) if just_before else (distance >= BIRTH) & (distance < DEATH)
    return np.where(alive, LENS.area(distance - BIRTH, DIAMETER), 0.0)


PEAKS = {0: 0.0, 1: 1.0, 2: 8.0, 3: 8.0, 4: 10.0, 5: 11.0, 6: 25.0, 7: 30.0}


@pytest.mark.parametrize("number", range(8))
def test_the_peak_and_its_shares_are_those_of_the_rows(file: RunFile, number: int) -> None:
    life = life_in(file, number)
    assert life.peak.distance == PEAKS[number]
    areas = _areas(life.peak.distance, just_before=number in {3, 5})
    assert life.peak.area == pytest.approx(areas[number], rel=1e-14)
    assert life.peak.real_contact_area == pytest.approx(areas.sum(), rel=1e-14)
    assert life.peak.area_share == pytest.approx(areas[number] / areas.sum(), rel=1e-13)
    forces = STRENGTH * areas
    assert life.peak.force == pytest.approx(forces[number], rel=1e-14)
    assert life.peak.friction_force == pytest.approx(forces.sum(), rel=1e-14)
    assert life.peak.force_share == pytest.approx(forces[number] / forces.sum(), rel=1e-13)
    assert life.peak.beside.rows.tolist() == [row for row in np.flatnonzero(areas) if row != number]


def test_a_life_ended_early_has_the_peak_that_it_reached(file: RunFile) -> None:
    before, at, after = (life_in(file, number) for number in (3, 5, 4))
    assert before.mid_life_distance is None
    assert before.peak.area == pytest.approx(float(LENS.area(4.0, 5.0)), rel=1e-14)
    assert before.peak.area < before.max_area
    assert (at.mid_life_distance, after.mid_life_distance) == (11.0, 10.0)
    assert at.peak.area == pytest.approx(at.max_area, rel=1e-14)
    assert after.peak.area == pytest.approx(after.max_area, rel=1e-14)


def test_a_bare_run_has_neither_times_nor_forces(tmp_path: Path) -> None:
    with bare_file(tmp_path / "x.h5") as file:
        life = life_in(file, 2)
    assert list(life.curve()) == ["distance", "area"]
    assert life.time(3.0) is None
    assert (life.peak.force, life.peak.friction_force, life.peak.force_share) == (None, None, None)
    assert life.peak.area_share > 0.0


@pytest.fixture(scope="module")
def paper(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("lives") / "fig5.h5"
    changes = ["sliding.distance=300 um", "output.tick=0.05 um"]
    rubnoise.run(rubnoise.load(ROOT / "scenarios" / "paper" / "fig5.toml", changes), path).close()
    return path


@pytest.mark.parametrize("number", [0, 30, 200, -1])
def test_of_a_simulated_run_all_lives_sum_up_to_the_trace(paper: Path, number: int) -> None:
    with open_run(paper) as file:
        life = life_in(file, number % file.rows("junctions"))
        distance, area = file.column("trace", "distance"), file.column("trace", "real_contact_area")
    inside = (distance >= life.birth_distance) & (distance < life.death_distance)
    lived = distance[inside]
    assert lived.size > 5
    summed = life.area_at_age(lived - life.birth_distance) + life.others.areas(lived).sum(axis=0)
    np.testing.assert_allclose(summed, area[inside], rtol=1e-11)
    assert _between_ticks(life, distance, area)


def _between_ticks(life: Life, distance: np.ndarray, area: np.ndarray) -> bool:
    """Return whether the contact at the peak agrees with its neighbouring ticks within what a tick can change."""
    tick = np.searchsorted(distance, life.peak.distance)
    steepest = float(np.abs(np.diff(area)).max())
    return abs(life.peak.real_contact_area - area[min(tick, area.size - 1)]) <= 2.0 * steepest


@pytest.mark.parametrize(
    ("column", "value", "told"),
    [("diameter", np.nan, "nan"), ("diameter", 0.0, "0"), ("diameter", -5.0, "-5"), ("death_distance", np.inf, "inf")],
)
def test_rows_that_are_no_lives_are_refused_by_number(tmp_path: Path, column: str, value: float, told: str) -> None:
    lives_file(tmp_path / "x.h5").close()
    with h5py.File(tmp_path / "x.h5", "r+") as raw:
        raw["junctions"][column][4] = value
    with open_run(tmp_path / "x.h5") as damaged:
        for number in (4, 5):  # itself, and one that lived beside it
            with pytest.raises(RunFileRefused, match=rf"row 4 has the {column} {told}$"):
                life_in(damaged, number)
        assert life_in(damaged, 0).diameter == DIAMETER[0]


# The picture of one life: it is the picture of single lives, with this one in black from its birth to its death.
@pytest.mark.parametrize("number", range(8))
def test_every_life_can_be_drawn_as_much_of_it_as_the_run_has(file: RunFile, number: int) -> None:
    life = life_in(file, number)
    figure = drawing("lives", Stretch.of(file), life=life)
    (curve,) = (each for each in figure.axes[1].lines if each.get_label() == f"junction {number}")
    place, area = np.asarray(curve.get_data())
    np.testing.assert_allclose(area, life.area_at_age(place - life.birth_distance))
    step = 0.002 * life.life_distance
    assert max(life.birth_distance, 0.0) == pytest.approx(place[0], abs=step)
    assert min(life.death_distance, RECORD_END) == pytest.approx(place[-1], abs=step)
    title = figure.get_suptitle()
    assert title.startswith(f"Junction {number}: diameter {life.diameter:.4g} µm, born at {life.birth_distance:.2f} µm")
    assert ("ended early" in title) == (JunctionState.ENDED_EARLY in life.state)
    assert f"{100.0 * life.peak.area_share:.3g} % of the real contact area at its peak" in title


def test_of_a_crowd_those_nearest_to_a_life_are_drawn(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "MOST_DRAWN", 3)
    above, below = drawing("lives", Stretch.of(file), life=life_in(file, 3)).axes
    assert [line.get_label() for line in above.lines] == ["sum of the 3 nearest in time"]
    assert "junction 3" in [line.get_label() for line in below.lines]
    with pytest.raises(Refused, match=r"3 at most; rubnoise plot RUN\.h5 lives --from and --to choose a shorter one"):
        drawing("lives", Stretch.of(file))


def _luminance(colour: str) -> float:
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue


def test_colours_are_told_apart_in_grey() -> None:
    greys = sorted(map(_luminance, (style.INK, style.BLUE, style.VERMILION, style.FAINT, style.PALE, "#ffffff")))
    assert np.diff(greys).min() > 0.08
