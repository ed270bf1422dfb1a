"""The pictures of a run show what the run and the theory say, with nothing cut off."""

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from scipy.signal import welch

import rubnoise
from rubnoise.figures import style
from rubnoise.figures.catalogue import PICTURES, drawing
from rubnoise.figures.pictures import covariance_band
from rubnoise.figures.tracks import Stretch
from rubnoise.storage.reader import open_run
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import autocovariance, spectral_density
from tests.figures.papers import band_of

SCENARIO: dict[str, Any] = {
    "format": 1,
    "title": "a contact",
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "0.2 um"},
    "strength": {"mean": 250.0},
    "sliding": {"distance": 4000.0, "speed": 1000.0},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
    "output": {"tick": "0.1 um"},
}


def _stretch(folder: Path, values: dict[str, Any]) -> Iterator[Stretch]:
    rubnoise.run(rubnoise.build(values), folder / "run$5.h5", seed=3).close()
    with open_run(folder / "run$5.h5") as file:
        yield Stretch.of(file)


@pytest.fixture(scope="module")
def full(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    yield from _stretch(tmp_path_factory.mktemp("full"), SCENARIO)


def _lines(name: str, stretch: Stretch) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return what the labelled lines of a picture hold."""
    axes = drawing(name, stretch).axes
    return {str(line.get_label()): line.get_data() for each in axes for line in each.lines}


def pixels_of(png: bytes) -> np.ndarray:
    return np.asarray(matplotlib.image.imread(BytesIO(png)))[:, :, :3]


def of_colour(pixels: np.ndarray, colour: str) -> int:
    wanted = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    return int(np.all(np.abs(pixels - wanted) < 0.02, axis=2).sum())


WITHOUT_THEORY = {"overview", "contact"}
PALE = {"histogram", "sizes", "life_distances", "gaps", "contact"}
"""Pictures in which nothing is exact, and those whose colours are mixed."""


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in PICTURES if name not in {"landmarks", "load"}])
def test_it_shows_simulation_and_theory_and_cuts_nothing_off(full: Stretch, name: Any) -> None:
    png = style.as_bytes(drawing(name, full))
    pixels = pixels_of(png)
    border = np.concatenate([pixels[:2].reshape(-1, 3), pixels[-2:].reshape(-1, 3), pixels[:, :2].reshape(-1, 3)])
    assert np.all(border == 1.0)
    assert name in WITHOUT_THEORY or of_colour(pixels, style.VERMILION) > 200
    assert name in PALE or of_colour(pixels, style.BLUE) > 200
    assert style.as_bytes(drawing(name, full)) == png


def test_the_junction_at_a_glance_is_of_about_the_mean_size(full: Stretch) -> None:
    life = drawing("overview", full).axes[1]
    peak = max(life.lines[0].get_ydata())
    assert peak == pytest.approx(0.25 * np.pi * full.model.sizes.moment(1) ** 2, rel=0.05)


def test_lives_add_up_to_the_trace(full: Stretch) -> None:
    distance, total = _lines("lives", full)["their sum, the simulated area"]
    trace = np.interp(distance, *(full.file.column("trace", name) for name in ("distance", "real_contact_area")))
    np.testing.assert_allclose(total, trace, atol=0.5)  # kinks between ticks
    assert total.std() > 10.0


def test_the_spectrum_is_that_of_scipy_beside_the_exact_one(full: Stretch) -> None:
    lines = _lines("psd", full)
    k, density = next(data for label, data in lines.items() if label.startswith("simulated ("))
    ticks = round(2.0 * np.pi / ((k[1] - k[0]) * full.model.tick))
    area = full.file.column("trace", "real_contact_area")
    cycles, twice = welch(area, 1.0 / full.model.tick, "hann", ticks, ticks // 2, detrend="constant")
    np.testing.assert_allclose(k, 2.0 * np.pi * cycles[2:], rtol=1e-12)
    np.testing.assert_allclose(density[:-1], 0.5 * twice[2:-1], rtol=1e-9)
    k, density = lines["exact"]
    np.testing.assert_allclose(density, spectral_density(full.model, k), rtol=1e-12)
    k, expected = lines["expected of the estimate"]
    middle = (k > 0.1) & (k < 1.0)
    np.testing.assert_allclose(expected[middle], spectral_density(full.model, k[middle]), rtol=0.2)
    assert expected[-1] > 1.5 * spectral_density(full.model, k[-1])  # the aliases of the ticks


def test_the_autocovariance_is_that_of_the_record(full: Stretch) -> None:
    lines = _lines("acf", full)
    lag, covariance = lines["simulated"]
    area = full.file.column("trace", "real_contact_area")
    assert covariance[0] == pytest.approx(area.var(), rel=1e-9)
    steps = round(lag[20] / full.model.tick)
    away = area - area.mean()
    assert covariance[20] == pytest.approx(np.mean(away[steps:] * away[:-steps]), rel=1e-3)
    lag, exact = lines["exact"]
    np.testing.assert_allclose(exact, autocovariance(full.model, lag), rtol=1e-12)


def test_the_band_of_the_autocovariance_holds_the_record(full: Stretch) -> None:
    seen_at, seen = _lines("acf", full)["simulated"]
    exact = autocovariance(full.model, seen_at)
    low, high = covariance_band(full, seen_at, exact)
    middle, error = 0.5 * (low + high), (high - low) / (2.0 * style.CONFIDENCE)
    life = full.model.mean_life_distance
    some = [int(np.argmin(np.abs(seen_at - place * life))) for place in (0.0, 0.3, 0.6, 1.0, 1.5)]
    assert np.all(np.abs(seen[some] - middle[some]) < 4.0 * error[some])
    assert np.any(np.abs(1.5 * seen[some] - middle[some]) > 4.0 * error[some]), "half as much again is noticed"
    variance_of_mean = spectral_density(full.model, np.zeros(1))[0] / (full.stop - full.start)
    np.testing.assert_allclose(exact - middle, variance_of_mean, rtol=1e-9)


def test_the_shares_of_live_junctions_are_those_of_the_run(full: Stretch) -> None:
    count = full.file.column("trace", "junction_count")
    bars = drawing("count", full).axes[1].patches
    heights = {round(bar.get_x() + 0.5): bar.get_height() for bar in bars}
    assert sum(heights.values()) == pytest.approx(1.0)
    assert heights[20] == pytest.approx(np.mean(count == 20))
    numbers, exact = _lines("count", full)["exact: Poisson"]
    mean = float(numbers @ exact)
    assert mean == pytest.approx(20.0, abs=0.05)


def test_the_spectrum_of_the_displacement_is_one_sided_and_per_hertz(full: Stretch) -> None:
    motion = drawing("slider", full).axes
    assert len(motion) == 3
    lines = {str(line.get_label()): line.get_data() for line in motion[2].lines}
    frequency, exact = lines["exact"]
    assert np.trapezoid(exact, frequency) == pytest.approx(response(full.model).displacement_std ** 2, rel=0.02)
    seen = full.file.column("slider", "displacement")
    frequency, simulated = next(data for label, data in lines.items() if label.startswith("simulated"))
    assert np.trapezoid(simulated, frequency) == pytest.approx(seen.var(), rel=0.2)


# Life-lines and the ratio of spectra: lanes without overlaps, the count as bars crossed, estimate over expected.
VALUES = {
    "format": 1,
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "1 um"},
    "sliding": {"distance": "6 mm"},
    "output": {"tick": "0.5 um"},
    "run": {"engine": "batch"},
}


@pytest.fixture(scope="module")
def full_lives(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    path = tmp_path_factory.mktemp("lifelines") / "run.h5"
    rubnoise.run(rubnoise.build(VALUES), path, seed=5).close()
    with open_run(path) as file:
        yield Stretch.of(file)


def lives(stretch: Stretch) -> tuple[np.ndarray, np.ndarray]:
    return stretch.file.column("junctions", "birth_distance"), stretch.file.column("junctions", "death_distance")


def test_the_line_crosses_as_many_bars_as_junctions_are_alive(full_lives: Stretch) -> None:
    stretch = Stretch.of(full_lives.file, 1000.0, 1040.0)
    birth, death = lives(full_lives)
    above, _ = drawing("lifelines", stretch).axes
    names = {str(each.get_label()): each for each in above.collections}
    bars = np.array([path.get_extents().get_points() for path in names["other lives"].get_paths()])
    alive = int(np.sum((birth <= 1020.0) & (death > 1020.0)))
    assert f"{alive} alive at the line" in names
    assert len(names[f"{alive} alive at the line"].get_paths()) == alive
    assert not np.any((bars[:, 0, 0] <= 1020.0) & (bars[:, 1, 0] > 1020.0))
    assert len(bars) + alive == int(np.sum((birth <= 1040.0) & (death >= 1000.0)))


def test_the_ratio_of_the_spectrum_is_one_within_its_band(full_lives: Stretch) -> None:
    _, ratio = drawing("psd", full_lives).axes
    place, values = ratio.lines[-1].get_data()
    band = np.array([band_of(ratio)[float(each)] for each in place])
    # Of values with two standard errors some 5 % are outside.
    assert np.mean(np.abs(values - 1.0) > band) < 0.15
    assert np.mean(np.abs(1.5 * values - 1.0) > band) > 0.3, "a spectrum half as high again is noticed"
