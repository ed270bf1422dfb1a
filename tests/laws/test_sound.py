"""A file holds what memory holds, and what is heard is what was simulated."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.signal import firwin, resample_poly

import rubnoise
from rubnoise.analysis.sound import CROSSINGS, PASSED, Sound, output_count, resampled
from rubnoise.analysis.spectra import WelchSum, band_powers
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.sound import STEPS
from rubnoise.theory.coupling import load_motion
from rubnoise.theory.sampling import EstimatedSpectrum, expected_periodogram, hann
from tests.architecture.sources import ROOT
from tests.laws.scores import BOUND, REJECTED, seed_of

# What is heard is what was simulated: the sound's spectrum beside the run's and beside the exact one, band by band.
SPEED, TICK, LENGTH, STRENGTH = 1000.0, 0.1, 8000.0, 250.0
RATE = 48_000
BANDS = 12
SCENARIO: dict[str, Any] = {
    "format": 1,
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "0.2 um"},
    "strength": {"mean": STRENGTH},
    "sliding": {"distance": LENGTH, "speed": SPEED},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
    "output": {"tick": "0.1 um"},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunFile]:
    path = tmp_path_factory.mktemp("sound") / "run.h5"
    rubnoise.run(rubnoise.build(SCENARIO), path, seed=seed_of("sound")).close()
    with open_run(path) as file:
        yield file


def _heard(run: RunFile, what: Any, speed_up: float) -> tuple[np.ndarray, float]:
    """Return the samples as the file holds them, in the unit of the column, and the step of their rounding."""
    sound = Sound.of(run, what, rate=RATE, speed_up=speed_up)
    assert sound.speed_up == speed_up
    samples = np.concatenate(list(sound.pieces(sound.full_scale, lambda: None)))
    assert samples.size == sound.samples
    step = sound.full_scale / STEPS
    return np.rint(samples * STEPS) * step, step


def _nearest(run: RunFile, what: str, speed_up: float) -> np.ndarray:
    """Return what resampling without a filter would make: the control that must be rejected."""
    values = _record(run, what)
    apart = SPEED * speed_up / (TICK * RATE)
    places = np.arange(int((values.size - 1) / apart) + 1) * apart
    return values[np.rint(places).astype(int)] - values.mean()


def _record(run: RunFile, what: str) -> np.ndarray:
    return run.column("slider", {"force": "friction_force"}.get(what, what))


def _scores(run: RunFile, heard: np.ndarray) -> list[float]:
    """Return the scores of the bands of a sound of the force, at true speed, beside the exact spectrum of the area."""
    model = rubnoise.build(SCENARIO).model()
    total = WelchSum(19_200, SPEED / RATE)
    total.add(heard / STRENGTH)
    bins = int(PASSED * 2000)
    seen = _cut(total.spectrum(), bins)
    _, expected = expected_periodogram(model, TICK, hann(4000))
    found = band_powers(model, seen, expected[:bins], LENGTH, BANDS)
    return [(band.observed - band.expected) / band.standard_error for band in found]


def _cut(spectrum: EstimatedSpectrum, bins: int) -> EstimatedSpectrum:
    arrays = {name: getattr(spectrum, name)[:bins] for name in ("wavenumber", "density", "standard_error")}
    return replace(spectrum, **arrays)


def test_the_sound_has_the_exact_spectrum(run: RunFile) -> None:
    heard, _ = _heard(run, "force", 1.0)
    scores = _scores(run, heard)
    assert len(scores) == BANDS
    assert max(map(abs, scores)) <= BOUND


def test_a_sound_without_a_filter_has_not(run: RunFile) -> None:
    assert max(map(abs, _scores(run, _nearest(run, "force", 1.0)))) > REJECTED


def test_a_sound_played_a_tenth_too_fast_has_not(run: RunFile) -> None:
    heard, _ = _heard(run, "force", 1.1)
    assert max(map(abs, _scores(run, heard))) > REJECTED


# From a scenario's text to a file anyone opens: the same bytes as in memory, for thin, dense, short and empty runs.


@pytest.mark.slow
def test_the_start_of_normal_motion_is_not_heard(tmp_path: Path) -> None:
    """It begins at rest, and comes to its spread by swings far above it: the loudest of the run, if they were heard."""
    scenario = ROOT / "scenarios" / "load" / "fig5_smooth.toml"
    exact = load_motion(rubnoise.load(scenario).model()).velocity_std
    rubnoise.run(rubnoise.load(scenario, ["sliding.distance=300 um"]), tmp_path / "x.h5").close()
    with open_run(tmp_path / "x.h5") as file:
        sound = Sound.of(file, "normal-velocity", rate=RATE, speed_up=1.0)
        heard = sound.values
        left_out = file.column("load", "velocity", 0, sound.first)
    # Of motion as good as normal, one value in 5e8 lies beyond six standard deviations.
    assert np.abs(heard).max() < 6.0 * exact
    assert np.abs(left_out).max() > 12.0 * exact


@pytest.mark.slow
def test_impacts_are_heard_when_they_happen(tmp_path: Path) -> None:
    scenario = rubnoise.load(ROOT / "scenarios" / "load" / "bouncing.toml", ["sliding.distance=4 mm"])
    rubnoise.run(scenario, tmp_path / "x.h5").close()
    with open_run(tmp_path / "x.h5") as file:
        time, load = file.column("load", "time"), file.column("load", "load")
        samples, _ = _heard(file, "load", 1.0)
    hardest = np.flatnonzero(load > 0.5 * load.max())
    heard = time[0] + np.flatnonzero(samples + load.mean() > 0.5 * load.max()) / RATE
    # Within a sample, the spacing at which both are seen.
    assert heard.min() == pytest.approx(time[hardest[0]], abs=1.0 / RATE)
    assert heard.max() == pytest.approx(time[hardest[-1]], abs=1.0 / RATE)
    # Off the surface there is silence: nothing bears.
    aloft = np.flatnonzero(load == 0.0)
    quiet = np.interp(time[aloft], time[0] + np.arange(samples.size) / RATE, samples)
    assert np.median(np.abs(quiet + load.mean())) < 1e-3 * load.max()


@pytest.mark.parametrize(
    "ratio", [Fraction(3, 2), Fraction(441, 1000), Fraction(1000, 441), Fraction(2, 37), Fraction(64)]
)
def test_samples_are_those_of_a_filter_made_and_applied_by_another_program(ratio: Fraction) -> None:
    up, down = ratio.numerator, ratio.denominator
    half = CROSSINGS * max(up, down)
    edge = 0.5 * (1.0 + PASSED) / max(up, down)
    taps = firwin(2 * half + 1, edge, window=("kaiser", 10.06))
    inputs = np.random.default_rng(5).standard_normal(12_000)
    found = resampled(inputs, ratio)
    known = resample_poly(inputs, up, down, window=taps)
    inside = slice(ceil(half / down), output_count(inputs.size, ratio) - ceil(half / down))
    # Each sum of n products is right to n roundings of the sum of their sizes, in either program.
    count = 2 * half // up + 1
    bound = 2.0 * count * np.finfo(np.float64).eps * float(np.abs(inputs).max()) * float(np.abs(up * taps).sum() / up)
    assert np.abs(found[inside] - known[inside]).max() < 4.0 * bound
    assert np.abs(found[inside] - np.roll(known, 1)[inside]).max() > 4.0 * bound
