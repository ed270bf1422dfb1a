"""Traces made outside the package have the moments of their closed forms, and `infer` reads their options."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rubnoise.contact.pulses import LENS, OFF_CENTRE_LENS
from rubnoise.inference.estimates import NOTHING, Assumed
from rubnoise.inference.honesty import drift_test
from rubnoise.inference.inference import InferenceResult, infer_signal
from rubnoise.inference.passes import Sensor, energies, first_integrals, life_integrals, offsets
from rubnoise.inference.signal import Signal, joined, reversals
from tools.studies import right_traces
from tools.studies.right_traces import Contact, trace, without_junctions

BOUND = 4.0
LONG = Contact(lives=1500, per_life=16, noise=0.0)


@pytest.mark.parametrize(
    ("contact", "mean", "ratio"),
    [
        (LONG, 20.0 / 3.0 * 5.5**2 * 250.0, 1.2298),
        (replace(LONG, off_centre=True), 20.0 * np.pi / 16.0 * 5.5**2 * 250.0, 1.35591),
        (replace(LONG, strength_spread=0.5), 20.0 / 3.0 * 5.5**2 * 250.0, 1.2298 * np.sqrt(1.25)),
    ],
)
def test_mean_and_spread_are_those_of_campbell(contact: Contact, mean: float, ratio: float) -> None:
    """A mean of T lives has the variance S(0)/T, here at most 1.6 lives' worth of the variance itself."""
    force = trace(contact, np.random.default_rng(2))
    error = ratio / np.sqrt(20.0) * np.sqrt(1.0 / contact.lives)
    assert abs(force.mean() / mean - 1.0) <= BOUND * error
    assert abs(force.mean() / (1.3 * mean) - 1.0) > BOUND * error
    spread = float(force.std()) / float(force.mean()) * np.sqrt(20.0)
    assert abs(spread / ratio - 1.0) <= BOUND * np.sqrt(1.5 / contact.lives)


@pytest.mark.parametrize("poles", [1, 2])
def test_a_pole_takes_half_the_energy_at_its_corner_and_nothing_of_the_mean(poles: int) -> None:
    place = 2.0 * np.pi * 50.0 / 4096.0 * np.arange(4096)
    seen = right_traces.filtered(3.0 + np.sin(place), 2.0 * np.pi * 50.0 / 4096.0, poles)
    assert seen.mean() == pytest.approx(3.0)
    assert seen.std() == pytest.approx(np.sin(0.25 * np.pi) * 0.5 ** (0.5 * poles))
    late = np.sin(place - 0.25 * np.pi * poles)
    assert np.mean(late * seen) == pytest.approx(0.5 * 0.5 ** (0.5 * poles))


def _read(contact: Contact, seed: int, assumed: Assumed = NOTHING, **options: Any) -> InferenceResult:
    values = trace(contact, np.random.default_rng(seed))
    signal = Signal(values=values, tick=contact.tick, unit="uN", scale=1.0)
    return infer_signal(signal, **{"zero": "known", "law": "fixed", **options}, assumed=assumed)


def _scores(found: InferenceResult) -> dict[str, float]:
    """Return how many standard errors number, size and strength lie from the truth."""
    truth = {"junction_count": 20.0, "diameter": 5.5, "shear_strength": 250.0}
    return {
        name: float(np.log(found.estimates[name].value / value) * found.estimates[name].value)
        / found.estimates[name].standard_error
        for name, value in truth.items()
    }


@pytest.mark.slow
def test_unequal_strengths_are_undone_by_their_spread() -> None:
    contact = Contact(strength_spread=0.5)
    given = _scores(_read(contact, 5, Assumed(strength_spread=0.5)))
    assert max(map(abs, given.values())) <= BOUND
    equal = _read(contact, 5)
    assert _scores(equal)["junction_count"] < -BOUND
    assert _scores(equal)["shear_strength"] > BOUND
    assert "equally strong" in equal.assumptions["strengths"]
    told = {each.strength_spread: each for each in equal.by_strength_spread}
    assert told[0.0].junction_count == pytest.approx(equal.estimates["junction_count"].value)
    assert told[0.5].junction_count == pytest.approx(1.25 * told[0.0].junction_count)
    assert told[0.5].shear_strength == pytest.approx((told[0.0].shear_strength or 0.0) / 1.25)
    known = _read(contact, 5, Assumed(strength_spread=0.5), zero="unknown", strength=250.0)
    assert abs(known.estimates["junction_count"].value / 20.0 - 1.0) < 0.2
    assert known.by_strength_spread[0].junction_count == pytest.approx(1.25 * known.estimates["junction_count"].value)


@pytest.mark.slow
@pytest.mark.parametrize(("cycles", "poles"), [(5.0, 1), (10.0, 1), (8.0, 2)])
def test_a_filter_is_undone_by_its_corner(cycles: float, poles: int) -> None:
    contact = Contact(bandwidth=cycles, poles=poles, lives=900)
    given = _read(contact, 7, Assumed(bandwidth=cycles / 11.0, poles=poles))
    assert max(map(abs, _scores(given).values())) <= BOUND
    assert given.flags == []
    said = re.findall(r"at ([0-9.]+) cycles per life", given.assumptions["sensor"])
    assert float(said[0]) == pytest.approx(cycles, rel=0.03)
    without = _read(contact, 7)
    assert _scores(without)["junction_count"] > BOUND
    assert _scores(without)["shear_strength"] < -BOUND
    assert "40 cycles per life or more" in without.assumptions["sensor"]


def test_what_a_filter_takes_bends_as_its_slopes_say() -> None:
    sensor, step = Sensor(corner=0.3, poles=2), 1e-4
    k = np.array([0.01, 0.2, 0.3, 1.0, 5.0])
    below, here, above = (sensor.energy(k * np.exp(s)) for s in (-step, 0.0, step))
    first, second = sensor.slopes(k)
    assert first == pytest.approx((above - below) / (2.0 * step), rel=1e-6)
    assert second == pytest.approx((above - 2.0 * here + below) / step**2, rel=1e-4, abs=1e-6)
    assert np.square(np.abs(sensor.response(k))) == pytest.approx(here)


def test_single_passes_add_up_to_the_average_of_all() -> None:
    chance = offsets(OFF_CENTRE_LENS)[1]
    assert chance @ first_integrals(OFF_CENTRE_LENS) == pytest.approx(OFF_CENTRE_LENS.life_integral(1))
    for pulse in (LENS, OFF_CENTRE_LENS):
        second, third = life_integrals(pulse, Sensor(corner=1e4), np.array([2.0]))
        assert (second @ offsets(pulse)[1])[0] == pytest.approx(pulse.life_integral(2) * 2.0**5, rel=2e-3)
        assert (third @ offsets(pulse)[1])[0] == pytest.approx(pulse.life_integral(3) * 2.0**7, rel=2e-3)
    z, width = np.log(np.array([0.5, 3.0, 20.0])), np.full(3, 0.1)
    single = energies(OFF_CENTRE_LENS, z, width)
    assert single @ chance == pytest.approx([0.14226532766, 0.0388, 1.7e-6], rel=0.5)
    assert np.ptp(single[1]) > 0.5 * single[1].mean(), "passes near the edge hold less"


@pytest.mark.slow
def test_passes_off_the_centre_are_read_and_told_from_those_through_it() -> None:
    contact = Contact(off_centre=True)
    right = _read(contact, 8, Assumed(pulse=OFF_CENTRE_LENS))
    assert max(map(abs, _scores(right).values())) <= BOUND
    assert right.flags == []
    assert right.other_offset is not None
    assert (right.other_offset.pulse.offset, right.other_offset.worse_by > BOUND * right.other_offset.error) == (
        "none",
        True,
    )
    wrong = _read(contact, 8)
    assert _scores(wrong)["junction_count"] > BOUND
    assert wrong.other_offset is not None
    assert (wrong.other_offset.pulse.offset, wrong.other_offset.worse_by < -BOUND * wrong.other_offset.error) == (
        "uniform",
        True,
    )
    assert _read(Contact(), 8).other_offset is None, "what fits is not compared unasked"


@pytest.mark.slow
def test_a_drift_is_flagged_or_allowed_for() -> None:
    """A ramp of 0.3 moves N by 9 %: z of its line has the mean 2.1 in a trace so long, and 8.5 in one of 16 times."""
    moved = _read(Contact(drift=0.3), 9)
    test = next(each for each in moved.tests if each.name == "drift")
    low, high = moved.intervals["junction_count"]
    assert test.flagged or low <= 20.0 <= high
    still = _read(Contact(), 9)
    assert still.flags == []
    assert np.diff(np.log(moved.intervals["junction_count"])) > np.diff(np.log(still.intervals["junction_count"]))
    long = Contact(drift=0.3, lives=7200, per_life=16)
    assert any("drift: a line" in words for words in _read(long, 9).flags)


@pytest.mark.slow
def test_the_line_through_right_traces_rises_as_far_as_it_says() -> None:
    """Over 200 short traces z has the mean 0 and the variance 1."""
    contact = Contact(lives=50, per_life=16)
    rng = np.random.default_rng(10)
    fit = _read(replace(contact, lives=2000), 10, tests=False).fit
    assert fit is not None
    forces = [trace(contact, rng) for _ in range(200)]
    spread = np.std(forces)
    z = [drift_test(force / spread, fit).statistic for force in forces]
    assert abs(np.mean(z)) <= BOUND / np.sqrt(200)
    assert abs(np.var(z) - 1.0) <= BOUND * np.sqrt(2.0 / 200)
    assert abs(np.var(np.multiply(2.0, z)) - 1.0) > BOUND * np.sqrt(2.0 / 200)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["ar1", "pink", "sawtooth"])
def test_a_trace_without_junctions_is_told_so(kind: str) -> None:
    values = without_junctions(kind, 5000, np.random.default_rng(1))
    found = infer_signal(Signal(values=values, tick=0.05, unit="mN", scale=1e3), zero="known")
    assert "the trace may hold no junctions" in str(found.refused_because)
    assert "a tick of" not in str(found.refused_because)
    fixed = infer_signal(Signal(values=values, tick=0.05, unit="mN", scale=1e3), zero="known", law="fixed")
    assert any("may hold no junctions" in words for words in fixed.flags)
    coarse = _read(Contact(per_life=4, lives=2000), 1)
    assert "3 are needed: a tick of" in str(coarse.refused_because)


STROKES = Contact(strokes=6, lives=80, zero=0.4)


@pytest.mark.slow
def test_strokes_are_cut_at_their_reversals_and_tell_the_zero() -> None:
    values = trace(STROKES, np.random.default_rng(11))
    length = STROKES.lives * STROKES.per_life
    cut = reversals(values)
    assert len(cut) == 7
    assert np.abs(np.diff(cut) - length).max() < 0.02 * length
    signal = joined(Signal(values=values, tick=STROKES.tick, unit="uN", scale=1.0), 0.05)
    assert signal.ways == (3, 3)
    assert signal.values.size == pytest.approx(6 * 0.9 * length, rel=0.02)
    assert "5 % of each stroke" in signal.left_out[2]
    found = infer_signal(signal, law="fixed")
    assert max(map(abs, _scores(found).values())) <= BOUND
    assert found.flags == []
    lost = infer_signal(replace(signal, values=values), zero="known", law="fixed")
    assert lost.estimates == {} or abs(_scores(lost)["junction_count"]) > BOUND, "without cutting nothing is read"
