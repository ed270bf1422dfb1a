"""Pictures of a slider's motion show what its rows hold: sticks, paths, lengths, spectra, and one run over another."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import welch

import rubnoise
from rubnoise.figures.catalogue import drawing
from rubnoise.figures.tracks import Stretch
from rubnoise.record.rows import Phase
from rubnoise.storage.reader import open_run
from rubnoise.theory.motion import response
from tests.architecture.sources import ROOT
from tests.figures.papers import band_of

FIG5 = ROOT / "scenarios" / "paper" / "fig5.toml"


def _opened(folder: Path, name: str, *changes: str) -> Iterator[Stretch]:
    path = folder / f"{name}.h5"
    scenario = rubnoise.load(FIG5, ['sliding.distance="2.5 mm"', "run.engine=batch", *changes])
    rubnoise.run(scenario, path).close()
    with open_run(path) as file:
        yield Stretch.of(file)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("motion")


@pytest.fixture(scope="module")
def two_way(folder: Path) -> Iterator[Stretch]:
    yield from _opened(folder, "two", "slider.coupling=two-way")


@pytest.fixture(scope="module")
def one_way(folder: Path) -> Iterator[Stretch]:
    yield from _opened(folder, "one")


@pytest.fixture(scope="module")
def fast(folder: Path) -> Iterator[Stretch]:
    """Return a two-way run that is too fast to stick."""
    yield from _opened(folder, "fast", "slider.coupling=two-way", 'sliding.speed="100 mm/s"')


@pytest.fixture(scope="module")
def force_alone(folder: Path) -> Iterator[Stretch]:
    """Return a run without a slider, whose force is in /trace."""
    scenario = rubnoise.load(FIG5, ['sliding.distance="2.5 mm"', 'output.tick="0.1 um"', "run.engine=batch"])
    rubnoise.run(scenario.replace(slider=None), folder / "force.h5").close()
    with open_run(folder / "force.h5") as file:
        yield Stretch.of(file)


def _column(stretch: Stretch, name: str) -> np.ndarray:
    return stretch.file.column("slider", name)


def _line(axes: Any, label: str) -> tuple[np.ndarray, np.ndarray]:
    (found,) = (line for line in axes.lines if str(line.get_label()).startswith(label))
    return found.get_data()


def _shaded(axes: Any) -> list[tuple[float, float]]:
    """Return where sticks are shaded, in s."""
    found = [each for each in axes.collections if each.get_label() == "stick"]
    corners = [path.vertices[:, 0] for each in found for path in each.get_paths()]
    return [(float(x.min()), float(x.max())) for x in corners]


# Motions and their stretches


def test_a_stretch_is_passed_for_the_first_time(two_way: Stretch) -> None:
    distance = _column(two_way, "distance")
    first, last = Stretch.of(two_way.file, 400.0, 900.0).rows("slider")
    assert distance[first - 1] < 400.0 <= distance[first]
    assert distance[last - 1] <= 900.0 < distance[last]
    assert two_way.rows("slider") == (0, distance.size)
    assert two_way.rows("trace") != two_way.rows("slider")
    beyond = Stretch.of(two_way.file, 2000.0, 9999.0).rows("slider")
    assert beyond == (int(np.flatnonzero(distance >= 2000.0)[0]), distance.size)


# Pictures


def test_the_slider_is_drawn_as_it_moves_and_shaded_where_it_sticks(two_way: Stretch) -> None:
    force, place, spectrum = drawing("slider", two_way).axes
    time, shown = _line(place, "simulated")
    rows = np.round(time / 1e-4).astype(int)
    extremes = _column(two_way, "displacement")
    assert shown.max() == extremes[: rows[-1] + 9].max()
    assert shown.min() == extremes[: rows[-1] + 9].min()
    assert _line(force, "simulated")[1].max() == 1e-3 * _column(two_way, "friction_force")[: rows[-1] + 9].max()
    shaded = _shaded(place)
    assert shaded == _shaded(force)
    assert len(shaded) > 10
    at = np.arange(rows[-1]) * 1e-4
    stuck = np.any([(at > begin) & (at < end) for begin, end in shaded], axis=0)
    assert np.array_equal(stuck, _column(two_way, "phase")[: at.size] == Phase.STICK)
    labels = [str(line.get_label()) for line in spectrum.lines]
    assert "exact, one-way" in labels
    assert not any("mean" in str(each.get_label()) for axes in (force, place) for each in axes.patches)


def test_one_way_motion_has_its_exact_band_and_no_sticks(one_way: Stretch) -> None:
    place = drawing("slider", one_way).axes[1]
    path, *_ = drawing("phase", one_way).axes
    assert _shaded(place) == []
    exact = response(one_way.model)
    assert any(np.allclose(line.get_ydata(), exact.mean_displacement) for line in place.lines)
    x, v = _line(path, "exact standard deviations")
    assert np.ptp(x) == pytest.approx(2.0 * exact.displacement_std, rel=1e-3)
    assert np.ptp(v) == pytest.approx(2e-3 * exact.velocity_std, rel=1e-3)


@pytest.mark.parametrize(
    ("heard", "column", "scale"),
    [("velocity", "velocity", 1e-3), ("displacement", "displacement", 1.0), ("force", "friction_force", 1e-3)],
)
def test_spectra_over_frequency_are_those_of_scipy(
    one_way: Stretch, two_way: Stretch, heard: Any, column: str, scale: float
) -> None:
    for stretch, label in ((one_way, "exact"), (two_way, "exact, one-way")):
        axes = drawing("psd", stretch, heard=heard).axes[0]
        frequency, density = _line(axes, "simulated")
        count = round(2.0 / (frequency[0] * 1e-4))
        values = scale * _column(stretch, column)
        hertz, expected = welch(values, 1e4, "hann", count, count // 2, detrend="constant")
        np.testing.assert_allclose(frequency, hertz[2 : frequency.size + 2], rtol=1e-9)
        np.testing.assert_allclose(density, expected[2 : frequency.size + 2], rtol=1e-6)
        _, exact = _line(axes, label)
        assert exact.max() > 0.0
        assert axes.figure.axes[-1].get_xlabel() == "frequency (Hz)"
        assert "/Hz)" in axes.get_ylabel()


@pytest.mark.parametrize(
    ("run", "heard"),
    [("one_way", "velocity"), ("one_way", "displacement"), ("one_way", "force"), ("force_alone", "force")],
)
def test_a_one_way_spectrum_is_what_is_expected_of_it(run: str, heard: Any, request: pytest.FixtureRequest) -> None:
    figure = drawing("psd", request.getfixturevalue(run), heard=heard)
    _, below = figure.axes
    frequency, ratio = _line(below, "simulated over expected")
    error = 0.5 * np.array([band_of(below)[float(each)] for each in frequency])
    weight = error**-2 / np.sum(error**-2)
    known, of_mean = float(np.sum(weight * ratio)), float(np.sqrt(np.sum((weight * error) ** 2)))
    assert known == pytest.approx(1.0, abs=4.0 * of_mean)
    assert 0.8 * known != pytest.approx(1.0, abs=4.0 * of_mean), "a spectrum a fifth too low is noticed"


def test_one_run_is_laid_over_another_at_the_same_times(one_way: Stretch, two_way: Stretch) -> None:
    force, place, spectrum = drawing("slider", one_way, beside=two_way).axes
    (plane,) = drawing("phase", one_way, beside=two_way).axes
    heard, _ = drawing("psd", one_way, heard="velocity", beside=two_way).axes
    title = str(drawing("slider", one_way, beside=two_way).get_suptitle())
    assert title.endswith("\none.h5, and over it two.h5")
    end = place.get_xlim()[1]
    for stretch, label in ((one_way, "one-way coupling"), (two_way, "two-way coupling")):
        time, shown = _line(place, label)
        values = _column(stretch, "displacement")[: round(end / 1e-4) + 1]
        assert (shown.min(), shown.max()) == (values.min(), values.max())
        assert time.max() <= end
        assert np.array_equal(_line(plane, label)[0], values)
    assert _shaded(force) == _shaded(place) != []
    labels = {str(line.get_label()) for line in spectrum.lines}
    assert {"one-way coupling", "two-way coupling", "exact"} <= labels
    assert {str(line.get_label()) for line in heard.lines} == labels
