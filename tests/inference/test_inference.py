"""From a trace back to its junctions: expectations against theory, intervals against the truth, and what is refused."""

import json
import re
import tracemalloc
from dataclasses import replace
from math import inf
from statistics import NormalDist
from typing import Any, Literal

import numpy as np
import pytest

from rubnoise.cli.infer import contents
from rubnoise.cli.layout import json_text
from rubnoise.contact.laws import LAWS
from rubnoise.contact.off_centre import OFF_CENTRE_LENS
from rubnoise.contact.pulses import LENS, PARABOLA, Pulse
from rubnoise.inference.assumed import Assumed
from rubnoise.inference.estimates import Estimate, reach_beyond, widened
from rubnoise.inference.fitting import FitPoint, FitProblem, climb, starts, whittle
from rubnoise.inference.honesty import steadiness_test, third_cumulant, third_test
from rubnoise.inference.inference import InferenceResult, infer_signal
from rubnoise.inference.periodogram import Expectation, banded, tukey
from rubnoise.inference.populations import POPULATIONS, energy_table, life_energy, mean_life_energy
from rubnoise.inference.sensor import Sensor
from rubnoise.inference.signal import Signal, strokes
from rubnoise.scenario.scenario import RAYLEIGH
from rubnoise.theory.periodogram import expected_periodogram
from rubnoise.theory.second_order import area_noise
from tests.inference.traces import contact, signal

SHAPES = {"fixed": 0.0, "normal": 0.2, "lognormal": 0.5, "exponential": 1.0, "gamma": 0.4}
WIDE = {"normal": 0.9, "lognormal": 0.9, "gamma": 1.2}
BOUND = 4.0
NORMAL = NormalDist()


def z(found: InferenceResult, name: str, truth: float) -> float:
    """Return how many standard errors of its logarithm an estimate lies from the truth."""
    each = found.estimates[name]
    return float(np.log(each.value / truth)) * each.value / each.standard_error


@pytest.fixture(scope="module")
def normal() -> Signal:
    return signal(contact("normal", 0.2, 20, 450), 5)


@pytest.fixture(scope="module")
def found(normal: Signal) -> InferenceResult:
    return infer_signal(normal, zero="known", law="normal")


@pytest.mark.parametrize(("name", "shape"), [*SHAPES.items(), *WIDE.items()])
def test_moments_are_those_of_the_laws(name: str, shape: float) -> None:
    population = POPULATIONS[name]
    law = population.law(3.0, shape)
    for power in (1, 2, 3, 5, 6, 7):
        assert population.moment(power, shape) == pytest.approx(law.moment(power) / 3.0**power, rel=1e-12)
    assert population.relative_spread(shape) == pytest.approx(
        np.sqrt(max(law.moment(2) / law.moment(1) ** 2 - 1.0, 0.0)), abs=1e-12
    )


@pytest.mark.parametrize("pulse", [LENS, OFF_CENTRE_LENS, PARABOLA])
@pytest.mark.parametrize(("name", "shape"), [*SHAPES.items(), *WIDE.items()])
def test_energies_are_those_of_theory(name: str, shape: float, pulse: Pulse) -> None:
    z = np.geomspace(2e-3, 200.0, 60)
    model = replace(contact("fixed", 0.0, 20.0, 1500), sizes=POPULATIONS[name].law(1.0, shape), pulse=pulse)
    exact = area_noise(model).alone(z) / model.birth_rate
    energy = energy_table(name, shape, pulse).at(z)[0]
    rel = 4e-4 if pulse is OFF_CENTRE_LENS else 1e-5  # far out its level is known to first order
    assert energy == pytest.approx(exact, rel=rel, abs=2e-12 if pulse is PARABOLA else 0.0), "parabolas reach 0"
    other = {"fixed": "normal", "exponential": "gamma"}.get(name, name)
    assert energy_table(other, 1.05 * shape or 0.05, pulse).at(z)[0] != pytest.approx(exact, rel=1e-3)


def test_parabolas_are_read_and_told_from_lenses() -> None:
    """A lens that is fitted to parabolic lives misreads their size; lenses are not read as parabolas either."""
    model = contact("lognormal", 0.3, 20.0, 1500)
    lives = signal(replace(model, pulse=PARABOLA), 3, noise=0.02)
    right = infer_signal(lives, zero="known", law="lognormal", assumed=Assumed(pulse=PARABOLA))
    truths = {"junction_count": 20.0, "diameter": 5.5, "shear_strength": 250.0}
    assert max(abs(z(right, name, truth)) for name, truth in truths.items()) <= BOUND
    lens = right.other_shape
    assert lens is not None
    assert (lens.pulse, lens.worse_by > BOUND * lens.error) == (LENS, True)
    assert abs(lens.diameter_off) > 0.03
    assert z(infer_signal(lives, zero="known", law="lognormal", tests=False), "junction_count", 20.0) > BOUND
    lenses = signal(model, 3, noise=0.02)
    unlike = infer_signal(lenses, zero="known", law="lognormal", assumed=Assumed(pulse=PARABOLA)).other_shape
    assert unlike is not None
    assert unlike.worse_by < -BOUND * unlike.error


def test_both_shapes_are_fitted_and_what_is_not_decided_is_said() -> None:
    """Parabolas of Rayleigh's sizes are what rough surfaces have; read as lenses they are more, and weaker."""
    unchosen = Assumed(shape_chosen=False)
    wide = signal(replace(contact("weibull", RAYLEIGH / 100.0, 20.0, 450), pulse=PARABOLA), 0)
    found = infer_signal(wide, zero="known", law="gamma", assumed=unchosen)
    other = found.other_shape
    assert other is not None
    assert other.pulse is PARABOLA
    assert abs(other.estimates["junction_count"].value - 20.0) < abs(found.estimates["junction_count"].value - 20.0) / 3
    assert abs(other.estimates["shear_strength"].value - 250.0) < abs(found.estimates["shear_strength"].value - 250.0)
    assert any("parabola" in flag for flag in found.flags)
    chosen = infer_signal(wide, zero="known", law="gamma", assumed=Assumed(pulse=PARABOLA))
    assert chosen.other_shape is not None
    assert chosen.other_shape.furthest > 0.2
    assert chosen.flags == []
    assert chosen.estimates["junction_count"].value == pytest.approx(other.estimates["junction_count"].value, rel=1e-6)
    equal = infer_signal(signal(contact("fixed", 0.0, 20.0, 450), 0), zero="known", law="fixed", assumed=unchosen)
    assert equal.other_shape is not None
    assert (equal.other_shape.told_apart, equal.other_shape.worse_by > 0.0, equal.flags) == (True, True, [])


def test_bands_are_expected_as_an_estimate_sees_them() -> None:
    """Leakage of the taper, aliases and the removed mean are in the exact mean of the periodogram."""
    model = contact("normal", 0.2, 20, 40)
    values = np.zeros(40 * 64)
    values[0] = 1.0
    bands = banded(values, 32.0)
    table = energy_table("normal", 0.2)
    diameter = model.sizes.mean / model.tick
    rate = model.birth_rate * model.tick
    mean = Expectation(bands).population(table, diameter)[0] * rate * model.tick**4
    exact = expected_periodogram(model, model.tick, tukey(values.size))[1] / model.tick
    for band, (first, last) in enumerate(zip(bands.first, bands.last, strict=True)):
        assert mean[band] == pytest.approx(exact[first : last + 1].mean(), rel=2e-3), band
    plain = table.at(2.0 * np.pi / values.size * diameter * np.array([float(bands.last[-1])]))[0]
    assert plain * diameter**6 * rate * model.tick**4 != pytest.approx(mean[-1], rel=0.1), "aliases count at the end"


@pytest.mark.parametrize(
    ("name", "options"),
    [
        *[(name, {}) for name in ("normal", "lognormal", "gamma", "exponential", "fixed")],
        ("normal", {"pulse": OFF_CENTRE_LENS}),
        ("normal", {"sensor": Sensor(corner=0.5)}),
    ],
)
def test_derivatives_are_those_of_the_expectation(name: str, options: dict[str, Any]) -> None:
    bands = banded(np.random.default_rng(1).standard_normal(6400), 32.0)
    problem = FitProblem(bands, POPULATIONS[name], drift=True, **options)
    place = FitPoint(rate=1e-9, diameter=30.0, shape=SHAPES[name], noise=3e-3, drift=1e-6)
    at = problem.expected(place)
    for column, parameter in enumerate(at.names):
        step = 1e-4
        ends = [
            problem.expected(replace(place, **{parameter: getattr(place, parameter) * np.exp(s)}))
            for s in (step, -step)
        ]
        slope = (ends[0].mean - ends[1].mean) / (2.0 * step)
        # The slope by the shape is that of a table; it steers steps and weights, and biases nothing.
        assert at.by[:, column] == pytest.approx(slope, rel=1e-2, abs=2e-4 * np.abs(slope).max()), parameter


@pytest.mark.parametrize("name", ["normal", "lognormal", "gamma", "exponential", "fixed"])
def test_bands_at_their_expectation_give_back_the_population(name: str) -> None:
    bands = banded(np.random.default_rng(1).standard_normal(12800), 32.0)
    problem = FitProblem(bands, POPULATIONS[name], drift=False)
    true = FitPoint(rate=1e-9, diameter=30.0, shape=SHAPES[name], noise=2e-3)
    given = replace(bands, energy=problem.expected(true).mean)
    place, deviance = whittle(FitProblem(given, POPULATIONS[name], drift=False), 35.0, 1e-3)
    assert deviance < 1e-4
    assert place.diameter == pytest.approx(30.0, rel=1e-3)
    assert place.rate == pytest.approx(1e-9, rel=1e-2)
    assert place.noise == pytest.approx(2e-3, rel=1e-3)


@pytest.mark.parametrize(("law", "seed"), [("normal", 5), ("lognormal", 6), ("exponential", 7)])
def test_number_size_spread_and_strength_lie_where_they_are(law: str, seed: int) -> None:
    model = contact(law, SHAPES[law], 20, 450)
    got = infer_signal(signal(model, seed), zero="known", law=law)
    truth = {"junction_count": 20.0, "diameter": model.sizes.mean, "shear_strength": 250.0}
    truth["mean_real_contact_area"] = model.stationary_mean_area
    if law != "exponential":
        truth["relative_spread"] = POPULATIONS[law].relative_spread(SHAPES[law])
    for name, value in truth.items():
        assert abs(z(got, name, value)) <= BOUND, name
        assert abs(z(got, name, 2.0 * value)) > BOUND, name
    assert got.refused_because is None
    assert got.flags == []


def test_scaling_the_trace_scales_strengths_and_scaling_ticks_scales_sizes(
    normal: Signal, found: InferenceResult
) -> None:
    twice = infer_signal(replace(normal, values=2.0 * normal.values), zero="known", law="normal", tests=False)
    wider = infer_signal(replace(normal, tick=3.0 * normal.tick), zero="known", law="normal", tests=False)
    ratios = {
        name: (twice.estimates[name].value / each.value, wider.estimates[name].value / each.value)
        for name, each in found.estimates.items()
    }
    assert ratios["junction_count"] == pytest.approx((1.0, 1.0))
    assert ratios["diameter"] == pytest.approx((1.0, 3.0))
    assert ratios["shear_strength"] == pytest.approx((2.0, 1.0 / 9.0))
    assert ratios["mean_real_contact_area"] == pytest.approx((1.0, 9.0))
    assert ratios["noise"] == pytest.approx((2.0, 1.0))


def test_a_third_cumulant_is_wrong_below_zero_and_right_above_it(normal: Signal) -> None:
    """A long record puts it many errors above zero, where junctions have it, or as far below for a mirrored force."""
    fit = infer_signal(normal, law="normal", tests=False).fit
    assert fit is not None
    values = normal.values / normal.values.std()
    third = third_cumulant(values, float(values.mean()))
    assert third > 0.0
    for sign in (1.0, -1.0):
        test = third_test(sign * third, 100 * values.size, fit, zero_known=False)
        assert sign * test.statistic > BOUND
        assert test.flagged == (sign < 0.0)


def test_without_a_zero_and_a_strength_number_and_strength_are_not_told(normal: Signal) -> None:
    got = infer_signal(normal, law="normal")
    assert set(got.estimates) == {"diameter", "relative_spread", "noise"}
    assert 'zero="known"' in got.not_identified["junction_count"]
    assert set(got.not_identified) == {"junction_count", "mean_real_contact_area", "shear_strength", "strength_spread"}


def test_a_known_strength_tells_the_number_without_the_mean(normal: Signal) -> None:
    got = infer_signal(replace(normal, values=normal.values - 1e4), strength=250.0, law="normal")
    assert abs(z(got, "junction_count", 20.0)) <= BOUND
    wrong = infer_signal(normal, strength=150.0, law="normal", tests=False)
    assert abs(z(wrong, "junction_count", 20.0)) > BOUND


def test_zero_and_strength_together_tell_the_spread_of_strengths() -> None:
    unequal = LAWS["lognormal"].make(250.0, 150.0, {})
    got = infer_signal(
        signal(contact("normal", 0.2, 20, 900, strengths=unequal), 3), zero="known", strength=250.0, law="normal"
    )
    low, high = got.estimates["strength_spread"].interval
    each = got.estimates["strength_spread"]
    assert abs(each.value - 0.6) <= BOUND * each.standard_error
    assert low > 0.0
    assert abs(each.value - 1.5) > BOUND * each.standard_error
    assert high < 1.5
    assert abs(z(got, "junction_count", 20.0)) <= BOUND


def test_laws_are_compared_and_intervals_hold_those_not_told_apart(normal: Signal) -> None:
    got = infer_signal(normal, zero="known")
    told = {each.law: each.told_apart for each in got.laws}
    assert told["exponential"]
    assert told["fixed"]
    assert not told["normal"]
    low, high = got.estimates["diameter"].interval
    for each in got.laws:
        below, above = each.estimates["diameter"].interval
        middle = each.estimates["diameter"].value
        # 1.645 of the 1.96 standard errors at least, for each law that is open.
        within = low <= middle - 0.83 * (middle - below) and middle + 0.83 * (above - middle) <= high
        assert within or each.told_apart


@pytest.fixture(scope="module")
def unequal() -> InferenceResult:
    return infer_signal(signal(contact("exponential", 1.0, 20, 450), 7), zero="known")


def test_a_law_of_one_spread_brings_it_into_the_interval(unequal: InferenceResult) -> None:
    """Exponential sizes have the spread 1 and no error of it: 1 is in the interval while that law is open."""
    laws = {each.law: each for each in unequal.laws}
    assert not laws["exponential"].told_apart
    assert laws["fixed"].told_apart
    assert laws["exponential"].estimates["relative_spread"].interval == (1.0, 1.0)
    low, high = unequal.estimates["relative_spread"].interval
    assert 0.0 < low < 1.0 < high
    assert unequal.estimates["relative_spread"].standard_error > 0.0
    assert not laws["gamma"].told_apart, (
        "it holds the exponential law, and one more parameter is no evidence against it"
    )


def test_a_law_at_its_widest_stays_there(unequal: InferenceResult) -> None:
    """Half a normal law is the nearest to exponential sizes: a step beyond its bound once moved all else instead."""
    normal = next(each for each in unequal.laws if each.law == "normal")
    assert normal.worse_by < 100.0
    assert normal.estimates["diameter"].value == pytest.approx(10.0, rel=0.3)


def test_laws_that_differ_by_much_reach_beyond_one_end_only() -> None:
    """C falls from 1.96 to 1.645 with the distance of estimates, and holds 95 % at either end of it."""

    def at(value: float, error: float = 0.1) -> Estimate:
        reach = 1.959964 * error
        return Estimate(value=value, standard_error=error, interval=(value - reach, value + reach), unit="1")

    none = Estimate(value=0.0, standard_error=0.0, interval=(0.0, 0.0), unit="1")
    same = widened(at(5.0), [at(5.0), at(5.0)]).interval
    assert same == pytest.approx(at(5.0).interval, rel=1e-4)
    low, high = widened(at(5.0), [at(5.0), at(9.0)]).interval
    assert np.log(5.0 / low) == pytest.approx(1.645 / 1.96 * np.log(5.0 / at(5.0).interval[0]), rel=1e-3)
    assert np.log(high / 9.0) == pytest.approx(1.645 / 1.96 * np.log(at(9.0).interval[1] / 9.0), rel=1e-3)
    assert widened(at(5.0), [at(5.0)]) == at(5.0)
    low, high = widened(none, [none, at(0.1)]).interval
    assert low == 0.0
    assert 0.2 < high < at(0.1).interval[1]
    for apart in (0.1, 0.5, 1.0, 3.0):
        assert NORMAL.cdf(reach_beyond(apart) + apart) - NORMAL.cdf(-reach_beyond(apart)) == pytest.approx(
            0.95, abs=1e-5
        )


def test_json_has_null_for_an_end_that_an_interval_lacks(found: InferenceResult) -> None:
    number = found.estimates["junction_count"]
    endless = replace(number, standard_error=inf, interval=(number.interval[0], inf))
    answer = contents(replace(found, estimates={**found.estimates, "junction_count": endless}), "trace.csv")
    read = json.loads(json_text(answer))["estimates"]
    assert read["junction_count"]["interval"] == [number.interval[0], None]
    assert read["junction_count"]["standard_error"] is None
    assert read["diameter"]["interval"] == list(found.estimates["diameter"].interval)


def test_noise_is_found_and_none_where_there_is_none(found: InferenceResult, normal: Signal) -> None:
    true = 0.05 / np.sqrt(1.0 + 0.05**2) * float(normal.values.std())
    assert abs(z(found, "noise", true)) <= BOUND
    assert abs(z(found, "noise", 1.5 * true)) > BOUND


def test_a_masked_line_does_no_harm(normal: Signal) -> None:
    place = np.arange(normal.values.size)
    humming = replace(normal, values=normal.values + 0.3 * normal.values.std() * np.sin(0.9 * place))
    assert any("largest line" in words for words in infer_signal(humming, zero="known", law="normal").flags)
    cycles = 0.9 / (2.0 * np.pi) / normal.tick
    got = infer_signal(humming, zero="known", law="normal", masked=((0.99 * cycles, 1.01 * cycles),))
    assert got.flags == []
    assert abs(z(got, "diameter", 5.5)) <= BOUND


def test_a_drift_is_told_from_junctions(normal: Signal) -> None:
    steps = np.random.default_rng(3).standard_normal(normal.values.size)
    drifting = replace(normal, values=normal.values + 0.04 * normal.values.std() * np.cumsum(steps))
    got = infer_signal(drifting, law="normal", drift=True, tests=False)
    assert abs(z(got, "diameter", 5.5)) <= BOUND
    assert "drift" in got.parameters
    without = infer_signal(drifting, law="normal", tests=False)
    assert abs(z(without, "diameter", 5.5)) > BOUND


def _other(kind: str) -> np.ndarray:
    from scipy.signal import lfilter

    rng = np.random.default_rng(11)
    n, decay = 450 * 64, np.exp(-4.0 / 64.0)
    if kind == "white noise":
        return 50.0 + rng.standard_normal(n)
    if kind == "sine":
        return 50.0 + np.sin(0.1 * np.arange(n)) + 0.05 * rng.standard_normal(n)
    pushes = rng.standard_normal(n) if kind == "lorentzian" else rng.poisson(20.0 / 64.0, n)
    values = lfilter([1.0], [1.0, -decay], pushes)
    return 50.0 + values + 0.05 * values.std() * rng.standard_normal(n)


@pytest.mark.parametrize("kind", ["white noise", "sine", "lorentzian", "exponential pulses"])
def test_what_is_no_contact_is_flagged_or_refused(kind: str) -> None:
    got = infer_signal(Signal(values=_other(kind), tick=0.17, unit="uN", scale=1.0))
    assert got.flags or got.refused_because


def test_a_trace_backwards_in_a_mirror_is_the_same_trace(normal: Signal, found: InferenceResult) -> None:
    again = infer_signal(replace(normal, values=normal.values[::-1].copy()), zero="known", law="normal")
    for name, each in found.estimates.items():
        assert again.estimates[name].value == pytest.approx(each.value, rel=1e-4), name


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        (np.ones(1000), "constant"),
        (np.arange(10.0), "10 samples"),
        (
            np.sign(np.sin(0.01 * np.arange(5000.0))) + 0.1 * np.random.default_rng(1).standard_normal(5000),
            "several strokes",
        ),
        (-50.0 - np.random.default_rng(1).standard_normal(5000), "not positive"),
    ],
)
def test_what_is_no_trace_of_one_stroke_is_refused(values: np.ndarray, reason: str) -> None:
    got = infer_signal(Signal(values=values, tick=0.1, unit="uN", scale=1.0), zero="known", law="normal")
    assert reason in str(got.refused_because)
    assert got.estimates == {}


def test_strokes_are_seen_without_a_zero_too(normal: Signal) -> None:
    turned = np.where(np.arange(normal.values.size) // 6000 % 2 == 0, 1.0, -1.0) * normal.values + 3e5
    got = infer_signal(replace(normal, values=turned), law="normal")
    assert "several strokes in one trace: the force leaps between two levels 4 times" in str(got.refused_because)
    assert "first at samples 6,001, 12,001" in str(got.refused_because)
    assert infer_signal(normal, law="normal", tests=False).refused_because is None


@pytest.mark.parametrize(("law", "count"), [("fixed", 0.1), ("normal", 0.5), ("exponential", 2.0)])
def test_a_contact_that_comes_and_goes_has_one_stroke(law: str, count: float) -> None:
    """Where junctions are few, the trace leaves zero and comes back; it is not between strokes."""
    sparse = signal(contact(law, SHAPES[law], count, 450), 3)
    for zero in ("known", "unknown"):
        assert strokes(sparse.values, zero) == ""


def test_too_short_and_too_coarse_records_name_what_is_needed(normal: Signal) -> None:
    short = infer_signal(replace(normal, values=normal.values[:500]), law="fixed")
    assert "20 are needed" in str(short.refused_because)
    coarse = infer_signal(replace(normal, values=normal.values[::16].copy(), tick=16 * normal.tick), law="fixed")
    assert "3 are needed" in str(coarse.refused_because)


def test_a_contact_that_runs_in_is_named(normal: Signal) -> None:
    fading = 1.0 + 0.5 * np.exp(-np.arange(normal.values.size) / 6000.0)
    got = infer_signal(replace(normal, values=normal.values * fading), zero="known", law="normal")
    named = next(words for words in got.flags if "steadiness" in words)
    cut = int(re.findall("after a run-in of ([0-9,]+) samples", named)[0].replace(",", ""))
    rest = infer_signal(replace(normal, values=(normal.values * fading)[cut:]), zero="known", law="normal")
    assert not any("steadiness" in words for words in rest.flags)
    wearing = normal.values * np.linspace(1.5, 0.5, normal.values.size)
    worn = infer_signal(replace(normal, values=wearing), zero="known", law="normal")
    assert any("no part of it after a run-in is steady" in words for words in worn.flags)


def test_energies_of_single_junctions_leave_out_a_swing_that_goes_on_between_sizes() -> None:
    """An average over ln z by a dense sum; far out, where a double holds few digits of it, as well."""
    for z, width in ((0.01, 0.05), (3.0, 0.1), (30.0, 0.05), (30.0, 0.2), (300.0, 0.1), (3e4, 0.1)):
        inside = np.exp(np.log(z) + width * (np.linspace(-0.5, 0.5, 4001)))
        dense = np.mean(life_energy(inside) * (1.0 + inside**4)) / (1.0 + z**4)
        found = mean_life_energy(np.array([np.log(z)]), np.array([width]))
        assert found[0] == pytest.approx(dense, rel=2e-3), (z, width)
    at = np.linspace(29.0, 31.0, 50)
    swinging = life_energy(at) * (1.0 + at**4)
    assert np.ptp(swinging) > 0.5 * swinging.mean()
    still = mean_life_energy(np.log(at), np.full(at.size, 0.2)) * (1.0 + at**4)
    assert np.ptp(still) < 0.2 * still.mean()


def test_equal_sizes_without_noise_are_found_from_a_far_start() -> None:
    """The swing of equal sizes has a minimum of the deviance at each period; low bands lead to the right one."""
    made = signal(contact("fixed", 0.0, 20, 450), 4, noise=0.0)
    values = made.values / made.values.std()
    problem = FitProblem(banded(values, 30.0), POPULATIONS["fixed"], drift=False)
    noise = 0.5 * float(np.median(problem.bands.energy[-10:]))
    for far in (0.7, 1.0, 1.4):
        place, deviance = whittle(problem, far * 32.0, noise)
        assert place.diameter == pytest.approx(32.0, rel=0.01), far
        assert abs(deviance - problem.bands.energy.size) <= BOUND * np.sqrt(2.0 * problem.bands.energy.size)
    at_once = [climb(problem, start) for start in starts(problem, 1.4 * 32.0, noise)]
    assert any(abs(place.diameter / 32.0 - 1.0) > 0.05 for place, _ in at_once)
    assert all(worth > 2.0 * deviance for place, worth in at_once if abs(place.diameter / 32.0 - 1.0) > 0.05)


def test_a_walk_moves_the_means_of_quarters_as_the_test_of_steadiness_says(normal: Signal) -> None:
    """Over 400 walks the chi-square has the mean 3 and the variance 6; without the walk in its variance it has not."""
    got = infer_signal(normal, law="normal", tests=False)
    assert got.fit is not None
    place = got.fit.contact.place
    quiet = replace(place, rate=1e-12 * place.rate, noise=0.0, drift=1.0)
    walking = replace(got.fit, contact=replace(got.fit.contact, place=quiet))
    steps = np.random.default_rng(8).standard_normal((400, 800))
    found = np.array([steadiness_test(np.cumsum(each), walking).statistic for each in steps])
    assert abs(found.mean() - 3.0) <= BOUND * np.sqrt(6.0 / 400)
    parts = np.cumsum(steps, axis=1).reshape(400, 4, 200).mean(axis=2)
    independent = np.sum(np.square(parts - parts.mean(axis=1, keepdims=True)), axis=1) / 200.0
    assert abs(independent.mean() - 3.0) > BOUND * np.sqrt(6.0 / 400)


@pytest.mark.parametrize("zero", ["known", "unknown"])
def test_a_right_trace_that_drifts_is_not_flagged(normal: Signal, zero: Literal["known", "unknown"]) -> None:
    steps = np.random.default_rng(4).standard_normal(normal.values.size)
    drifting = replace(normal, values=normal.values + 0.02 * normal.values.std() * np.cumsum(steps))
    got = infer_signal(drifting, law="normal", drift=True, zero=zero)
    assert got.flags == []
    assert got.refused_because is None
    without = infer_signal(drifting, law="normal", zero=zero)
    assert without.flags or without.refused_because
    if zero == "known":
        # The walk makes the mean less certain by far, and the intervals know.
        assert got.estimates["junction_count"].standard_error > 5.0
        assert abs(z(got, "junction_count", 20.0)) <= BOUND


def test_a_long_trace_takes_a_few_bytes_a_sample(normal: Signal) -> None:
    peaks = []
    for copies in (100, 300):
        long = replace(normal, values=np.tile(normal.values, copies))
        tracemalloc.start()
        infer_signal(long, zero="known", law="normal")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert (peaks[1] - peaks[0]) / (200 * normal.values.size) <= 24.0
    assert peaks[0] < 24.0 * 100 * normal.values.size + 200e6


@pytest.mark.parametrize("law", ["normal", "lognormal", "exponential"])
def test_errors_are_as_large_as_they_say(law: str) -> None:
    """z over independent traces has mean 0 and variance 1: bounds 4/sqrt(n) and 4 sqrt(2/n) (1 + 1/2 for its tails)."""
    model, n = contact(law, SHAPES[law], 20, 450), 60
    scores = []
    for seed in range(100, 100 + n):
        got = infer_signal(signal(model, seed), zero="known", law=law, tests=False)
        scores.append(
            [z(got, "junction_count", 20.0), z(got, "diameter", model.sizes.mean), z(got, "shear_strength", 250.0)]
        )
    table = np.array(scores)
    assert np.all(np.abs(table.mean(axis=0)) <= BOUND / np.sqrt(n))
    assert np.all(np.abs(table.var(axis=0) - 1.0) <= 1.5 * BOUND * np.sqrt(2.0 / n))
    assert not np.all(np.abs((2.0 * table).var(axis=0) - 1.0) <= 1.5 * BOUND * np.sqrt(2.0 / n))
