"""A file holds what memory holds, and what is heard is what was simulated."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from math import ceil, sqrt
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.signal import firwin, resample_poly

import rubnoise
from rubnoise.analysis.resampling import CROSSINGS, PASSED, RIPPLE, output_count, resampled
from rubnoise.analysis.sound import Sound, level_of, samples_of
from rubnoise.analysis.spectra import Spectrum, WelchSum, band_powers, hann
from rubnoise.errors import Refused
from rubnoise.scenario.reading import loads
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.wave_file import STEPS
from rubnoise.theory.load import load_motion
from rubnoise.theory.periodogram import expected_periodogram
from tests.architecture.sources import ROOT
from tests.verification.scores import BOUND, REJECTED, seed_of

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
    sound = Sound.of(run, what, rate=RATE, speed_up=speed_up, seconds=None)
    level = level_of(sound, lambda: None)
    assert sound.speed_up == speed_up
    samples = np.concatenate(list(samples_of(sound, level, lambda: None)))
    assert samples.size == sound.samples
    step = level.full_scale / STEPS
    return np.rint(samples * STEPS) * step, step


def _nearest(run: RunFile, what: str, speed_up: float) -> np.ndarray:
    """Return what resampling without a filter would make: the control that must be rejected."""
    values = _record(run, what)
    apart = SPEED * speed_up / (TICK * RATE)
    places = np.arange(int((values.size - 1) / apart) + 1) * apart
    return values[np.rint(places).astype(int)] - values.mean()


def _record(run: RunFile, what: str) -> np.ndarray:
    return run.column("slider", {"force": "friction_force"}.get(what, what))


def _amplitudes(values: np.ndarray, count: int) -> np.ndarray:
    """Return the transforms of segments, each a row, scaled so that rows of any rate compare; none at either end."""
    starts = range(count // 2, values.size - count - count // 2, count // 2)
    parts = np.stack([values[start : start + count] for start in starts])
    return np.fft.rfft((parts - parts.mean(axis=1, keepdims=True)) * hann(count), axis=1) / count


def _bands(last: int) -> list[slice]:
    edges = np.unique(np.geomspace(3, last, BANDS + 1).astype(int))
    return [slice(first, stop) for first, stop in pairwise(edges.tolist())]


def _excess(heard: np.ndarray, record: np.ndarray, step: float, counts: tuple[int, int]) -> list[float]:
    """Return by how much each band's amplitude is off, over what ripple and rounding allow."""
    sound, seen = _amplitudes(heard, counts[0]), _amplitudes(record, counts[1])
    segments = min(len(sound), len(seen))
    # White rounding noise of variance step^2/12; four times its power is beyond what chance makes of it.
    rounding = 4.0 * step**2 / 12.0 * float(np.square(hann(counts[0])).sum()) / counts[0] ** 2
    found = []
    for band in _bands(int(PASSED * 0.5 * min(counts))):
        powers = [float(np.square(np.abs(each[:segments, band])).mean(axis=0).sum()) for each in (sound, seen)]
        allowed = RIPPLE * sqrt(powers[1]) + sqrt(rounding * (band.stop - band.start))
        found.append(abs(sqrt(powers[0]) - sqrt(powers[1])) / allowed)
    return found


@pytest.mark.parametrize("what", ["velocity", "force", "displacement"])
@pytest.mark.parametrize(("speed_up", "counts"), [(1.0, (19_200, 4000)), (20.0, (1200, 5000))])
def test_the_sound_has_the_spectrum_of_the_run(
    run: RunFile, what: str, speed_up: float, counts: tuple[int, int]
) -> None:
    heard, step = _heard(run, what, speed_up)
    assert max(_excess(heard, _record(run, what), step, counts)) < 1.0


@pytest.mark.parametrize(("speed_up", "counts"), [(1.0, (19_200, 4000)), (20.0, (1200, 5000))])
def test_a_sound_without_a_filter_has_another_spectrum(run: RunFile, speed_up: float, counts: tuple[int, int]) -> None:
    _, step = _heard(run, "force", speed_up)
    excess = _excess(_nearest(run, "force", speed_up), _record(run, "force"), step, counts)
    assert max(excess) > 100.0


def test_there_is_nothing_beyond_what_the_run_can_tell(run: RunFile) -> None:
    heard, _ = _heard(run, "force", 1.0)
    beyond = int(1.001 * 0.5 * 4000)
    powers = [
        np.square(np.abs(_amplitudes(each, 19_200))).mean(axis=0) for each in (heard, _nearest(run, "force", 1.0))
    ]
    sound, nearest = (float(power[beyond:].sum() / power.sum()) for power in powers)
    assert sound < 1e-10
    assert nearest > 1e-7


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


def _cut(spectrum: Spectrum, bins: int) -> Spectrum:
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
SCENARIO_TEXT = """
format = 1
title = "{name}"
[interface]
mean_real_contact_area = "{area} um^2"
calibration = "exact"
mean_junction_count = {count}
[diameter]
law = "{law}"
{spread}
[strength]
mean = "250 MPa"
[sliding]
speed = "{speed} mm/s"
distance = "{distance} um"
start = "{start}"
[slider]
mass = "5 g"
stiffness = "300 N/m"
damping = "0.05 N*s/m"
[output]
tick = "{tick} um"
"""


def scenario(
    name: str,
    *,
    area: float = 200,
    count: float = 20,
    spread: str = "0.2 um",
    distance: float = 100,
    tick: float = 0.1,
    speed: float = 1,
    start: str = "stationary",
) -> str:
    law, line = ("normal", f'spread = "{spread}"') if spread else ("fixed", "")
    return SCENARIO_TEXT.format(
        name=name,
        area=area,
        count=count,
        law=law,
        spread=line,
        distance=distance,
        tick=tick,
        speed=speed,
        start=start,
    )


RUNS = {
    text.split('"')[1]: text
    for text in (
        scenario("thin", count=0.01, distance=50_000, tick=10, speed=100),
        scenario("one in ten", count=0.1, distance=5_000, tick=5),
        scenario("figure 5", distance=2_000),
        scenario("a thousand", count=1_000, distance=20, tick=0.02),
        scenario("dense", count=5_000, distance=2, tick=0.005),
        scenario("shorter than a life", distance=0.7),
        scenario("a single step", distance=0.19),
        scenario("no birth", count=0.01, distance=5, start="empty"),
        scenario("one size", spread=""),
        scenario("spread above the mean", area=3, count=1, spread="8 um", distance=2_000, tick=0.5),
        scenario("relative spread", spread="30 %"),
    )
}


@pytest.mark.parametrize("name", RUNS)
def test_a_file_holds_what_memory_holds(tmp_path: Path, name: str) -> None:
    given = loads(RUNS[name])
    record = rubnoise.simulate(given)
    path = tmp_path / "run.h5"
    with rubnoise.run(given, path) as run:
        names = {group: set(columns.names) for group, columns in run.groups().items() if group != "life_curve"}
        assert names == {group: set(columns) for group, columns in record.reader().groups.items()}
        for group, columns in record.reader().groups.items():
            for column, values in columns.items():
                assert run.groups()[group][column][:].tobytes() == values.tobytes()
        assert run.scenario.model() == given.model()
        assert all(np.isfinite(figure.observed) for figure in run.summary)
    with h5py.File(path, "r") as file:
        assert file["junctions/diameter"].shape == record["junctions"]["diameter"].shape
        assert file["trace/real_contact_area"].shape == (given.model().tick_count + 1,)


def test_the_runs_are_what_they_are_called() -> None:
    records = {name: rubnoise.simulate(loads(RUNS[name])) for name in ("no birth", "one size", "spread above the mean")}
    assert records["no birth"].extent.junctions == 0
    assert np.unique(records["one size"]["junctions"]["diameter"]).size == 1
    law = loads(RUNS["spread above the mean"]).model()
    assert law.calibrated_diameter < 8.0
    assert records["spread above the mean"]["junctions"]["diameter"].min() > 0.0
    assert loads(RUNS["shorter than a life"]).model().distance < 11.0
    assert loads(RUNS["a single step"]).model().tick_count == 1


def test_the_start_of_normal_motion_is_not_heard(tmp_path: Path) -> None:
    """It begins at rest, and comes to its spread by swings far above it: the loudest of the run, if they were heard."""
    scenario = ROOT / "scenarios" / "load" / "fig5_smooth.toml"
    exact = load_motion(rubnoise.load(scenario).model()).velocity_std
    rubnoise.run(rubnoise.load(scenario, ["sliding.distance=300 um"]), tmp_path / "x.h5").close()
    with open_run(tmp_path / "x.h5") as file:
        sound = Sound.of(file, "normal-velocity", rate=RATE, speed_up=1.0, seconds=None)
        heard = np.concatenate(list(sound.chunks()))
        left_out = file.column("load", "velocity", 0, sound.first)
    assert heard.size == sound.rows
    # Of motion as good as normal, one value in 5e8 lies beyond six standard deviations.
    assert np.abs(heard).max() < 6.0 * exact
    assert np.abs(left_out).max() > 12.0 * exact


def test_a_run_within_the_start_of_normal_motion_is_refused(tmp_path: Path) -> None:
    scenario = rubnoise.load(ROOT / "scenarios" / "load" / "fig5_smooth.toml", ["sliding.distance=10 um"])
    rubnoise.run(scenario, tmp_path / "x.h5").close()
    with open_run(tmp_path / "x.h5") as file, pytest.raises(Refused, match=r"too short: the first \d+\.\d+ um are the"):
        Sound.of(file, "normal-velocity", rate=RATE, speed_up=1.0, seconds=None)


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
    found = np.concatenate(list(resampled(lambda first, stop: inputs[first:stop], inputs.size, ratio)))
    known = resample_poly(inputs, up, down, window=taps)
    inside = slice(ceil(half / down), output_count(inputs.size, ratio) - ceil(half / down))
    # Each sum of n products is right to n roundings of the sum of their sizes, in either program.
    count = 2 * half // up + 1
    bound = 2.0 * count * np.finfo(np.float64).eps * float(np.abs(inputs).max()) * float(np.abs(up * taps).sum() / up)
    assert np.abs(found[inside] - known[inside]).max() < 4.0 * bound
    assert np.abs(found[inside] - np.roll(known, 1)[inside]).max() > 4.0 * bound
