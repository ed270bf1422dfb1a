"""Infer the junctions of a trace: number, size, spread and strength with intervals, or why they are unknown."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import sqrt
from typing import Final, Literal

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Offset, Pulse, Shape, pulse_of
from rubnoise.inference.estimates import NOTHING, Assumed, Estimate, IfSpread, assumptions, by_spread, estimated, wider
from rubnoise.inference.fitting import STEPS, Contact, Fit, FitProblem, Given, covariance, deviance, score, whittle
from rubnoise.inference.honesty import HonestyTest, honesty_tests, spectrum_test, third_cumulant
from rubnoise.inference.passes import passed
from rubnoise.inference.periodogram import Bands, banded
from rubnoise.inference.populations import POPULATIONS, shot_sizes
from rubnoise.inference.signal import Signal, course, half_width_of, half_width_under_drift, ramp_of, strokes

LAWS: Final = tuple(POPULATIONS)
OTHER_OFFSETS: Final[dict[Offset, Offset]] = {"none": "uniform", "uniform": "none"}
OTHER_SHAPES: Final[dict[Shape, Shape]] = {"lens": "parabola", "parabola": "lens"}
"""The passes and the lives that are tried beside those that are assumed; the keys are all that can be read."""
FEWEST_SIZES: Final = 20.0  # mean diameters of sliding below which a record is refused
FEWEST_SAMPLES: Final = 3.0  # samples per mean diameter below which a record is refused: no life is resolved
_LEAST_GAIN = 25.0
_SHORTEST = 64
_NOISE_BANDS = 10
_HOPELESS = 100.0  # of the deviance: exp(-50) as likely
_FEWEST_ALIVE, _MOST_ALIVE = 0.1, 1e5
FURTHEST_OFF: Final = 0.1
"""Relative difference of an estimate above which another shape of lives is said to matter."""
_BY_SHAPE = ("junction_count", "diameter", "mean_real_contact_area", "shear_strength")
_APART = 4.0  # of a deviance: two standard errors of one more parameter, which laws that hold each other differ by


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """The fit of a law and a pulse, compared with the best fit of the assumed pulse.

    ``criterion`` is the Whittle deviance plus twice the number of parameters; ``worse_by`` its excess over that of the
    best, with the standard error that the excess has; ``told_apart`` whether the deviance alone is larger, of another
    pulse larger or smaller, by more than 4 and by more than twice this error. ``estimates`` are those that it gives,
    ``off`` relative differences of number, diameter, area and strength for another pulse.
    """

    law: str
    pulse: Pulse
    criterion: float
    worse_by: float
    error: float
    told_apart: bool
    estimates: Mapping[str, Estimate]
    off: Mapping[str, float] = field(default_factory=dict)

    @property
    def diameter_off(self) -> float:
        """Relative difference of the diameter."""
        return self.off["diameter"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class InferenceResult:
    """What a trace shows about its junctions.

    ``estimates`` by name; ``intervals`` of 95 %; ``covariance`` of the logarithms of ``parameters``; ``laws`` compared;
    ``tests`` of the trace against the model; ``not_identified`` names what it cannot show, with what would show it;
    ``law_free`` are numbers that lean on no law. ``refused_because`` says why there are no estimates.
    ``bootstrap`` is empty, or how estimates of simulated traces scatter. ``assumptions`` says what was taken for
    granted, a sentence for each thing; ``by_strength_spread`` is how number and strength move with the spread of
    strengths; ``other_offset`` and ``other_shape`` are how other passes and other lives fit, if they were tried.
    """

    estimates: Mapping[str, Estimate] = field(default_factory=dict)
    not_identified: Mapping[str, str] = field(default_factory=dict)
    law: str = ""
    laws: tuple[Tried, ...] = ()
    tests: tuple[HonestyTest, ...] = ()
    law_free: Mapping[str, float] = field(default_factory=dict)
    parameters: tuple[str, ...] = ()
    covariance: Doubles = field(repr=False, default_factory=lambda: np.empty((0, 0)))
    refused_because: str | None = None
    signal: Signal = field(repr=False)
    fit: Fit | None = field(repr=False, default=None)
    bootstrap: Mapping[str, Estimate] = field(repr=False, default_factory=dict)
    assumptions: Mapping[str, str] = field(default_factory=dict)
    other_offset: Tried | None = None
    other_shape: Tried | None = None
    by_strength_spread: tuple[IfSpread, ...] = ()

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """The 95 % interval of each estimate."""
        return {name: each.interval for name, each in self.estimates.items()}

    shape_chosen: bool = True

    @property
    def flags(self) -> list[str]:
        """Findings against the model, one sentence each."""
        return [each.words for each in self.tests if each.flagged] + self._doubt_of_shape()

    def _doubt_of_shape(self) -> list[str]:
        """Return that lives may have the other shape: if no option chose one, and numbers would differ."""
        other = self.other_shape
        if self.shape_chosen or other is None or max(map(abs, other.off.values())) <= FURTHEST_OFF:
            return []
        found = {name: each for name, each in self.estimates.items() if name in _BY_SHAPE and name in other.estimates}
        numbers = ", ".join(
            f"{name} {other.estimates[name].value:.3g} for {each.value:.3g} {each.unit.strip('1')}".rstrip()
            for name, each in found.items()
        )
        shape, choose = other.pulse.shape, "pulse= says which is right"
        if not other.told_apart:
            return [f"the trace does not tell the shape of lives: a {shape} would give {numbers}; {choose}"]
        return [f"lives of the shape {shape} fit better, and give {numbers}; {choose}"] if other.worse_by < 0.0 else []


def infer_signal(
    signal: Signal,
    *,
    zero: Literal["known", "unknown"] = "unknown",
    strength: float | None = None,
    law: str = "auto",
    masked: tuple[tuple[float, float], ...] = (),
    drift: bool = False,
    assumed: Assumed = NOTHING,
    tests: bool = True,
) -> InferenceResult:
    """Return the inference of a signal from its spectrum, and from its mean if the zero of the sensor is known.

    Strokes of both ways show the zero themselves. ``strength`` in MPa is E[psi], if it is known; ``masked`` are
    ranges in cycles per um that are left out; ``drift`` adds a random walk; ``assumed`` are the assumptions.
    """
    values = np.asarray(signal.values, dtype=np.float64)
    if reason := _no_trace(values, signal, zero):
        return InferenceResult(signal=signal, refused_because=reason)
    if min(signal.ways) > 0:
        zero = "known"
    scale = float(values.std())
    values = values / scale
    half_width = half_width_under_drift(values) if drift else half_width_of(values)
    left_out = tuple((low * signal.tick, high * signal.tick) for low, high in masked)
    bands = banded(values, half_width, left_out, signal.ways)
    mean = float(values.mean()) if zero == "known" else None
    known = Given(
        mean=mean,
        strength=_strength_in_ticks(signal, strength, scale),
        inequality=1.0 + assumed.strength_spread**2,
        ramp=0.0 if mean is None or drift else ramp_of(values),
    )
    level = course(values, half_width) if drift else np.broadcast_to(values.mean(), values.shape)
    third = third_cumulant(values, level)
    names = tuple(POPULATIONS) if law == "auto" else (law,)
    sensor = assumed.sensor(signal.tick)

    def fitted(pulse: Pulse) -> list[Fit]:
        problems = [FitProblem(bands, POPULATIONS[name], drift=drift, pulse=pulse, sensor=sensor) for name in names]
        return _fitted(problems, half_width, known, third)

    fits = fitted(assumed.pulse)
    best = min(fits, key=_criterion)
    if reason := _too_little(best, signal):
        return InferenceResult(signal=signal, refused_because=reason)
    compared = len(fits) > 1
    laws = tuple(_beside(each, best, estimated(each, signal, scale, compared=compared)) for each in fits)
    of_best = laws[names.index(best.problem.population.name)].estimates
    open_to = [each.estimates for each in laws if not each.told_apart]
    spoken = honesty_tests(values, level, best, zero_known=zero == "known") if tests else ()
    pulse, doubtful = assumed.pulse, any(test.flagged for test in spoken if test.name == "spectrum")

    def tried(shape: Shape, offset: Offset, *, asked: bool) -> Tried | None:
        if not tests or not (asked or doubtful):
            return None
        other = min(fitted(pulse_of(shape, offset)), key=_criterion)
        found = estimated(other, signal, scale, compared=compared)
        known = [name for name in _BY_SHAPE if name in of_best and name in found]
        off = {name: found[name].value / of_best[name].value - 1.0 for name in known}
        return replace(_beside(other, best, found), off=off)

    estimates = {name: wider(each, [law[name] for law in open_to]) for name, each in of_best.items()}
    return InferenceResult(
        estimates=estimates,
        not_identified=_not_identified(estimates, best, signal),
        law=best.problem.population.name,
        laws=laws,
        tests=spoken,
        law_free=_law_free(best, signal),
        parameters=best.names,
        covariance=best.covariance,
        signal=signal,
        fit=best,
        assumptions=assumptions(assumed, best, signal),
        other_offset=tried(pulse.shape, OTHER_OFFSETS[pulse.offset], asked=pulse.offset != "none"),
        other_shape=tried(OTHER_SHAPES[pulse.shape], pulse.offset, asked=True),
        shape_chosen=assumed.shape_chosen,
        by_strength_spread=() if signal.is_area else by_spread(estimates, best.known),
    )


def _no_trace(values: Doubles, signal: Signal, zero: str) -> str:
    """Return why values are no trace of one stroke, or of strokes that were joined; empty if they are."""
    if values.size < _SHORTEST:
        return f"the record has {values.size} samples; it needs at least {_SHORTEST}"
    if not values.std() > 1e-12 * np.abs(values).max():
        return "the trace is constant; a sensor that moves is needed"
    return "" if min(signal.ways) > 0 else strokes(values, zero)


def _strength_in_ticks(signal: Signal, strength: float | None, scale: float) -> float | None:
    """Return a known strength in the units of the fit: values over ``scale``, lengths in ticks."""
    given = 1.0 if signal.is_area else strength
    return None if given is None or signal.scale is None else given * signal.tick**2 / (signal.scale * scale)


def _fitted(problems: list[FitProblem], half_width: float, known: Given, third: float) -> list[Fit]:
    """Return the fit of each law; a law with a hopeless Whittle deviance stays at its least deviance."""
    bands = problems[0].bands
    floor = 10.0 * max(problem.floor for problem in problems)
    noise = max(0.5 * float(np.median(bands.energy[-_NOISE_BANDS:])), floor)
    begun = [(problem, *whittle(problem, half_width, noise)) for problem in problems]
    least = min(worth for _, _, worth in begun)
    fits = []
    for problem, place, worth in begun:
        own = known
        if known.free == ("strength",):
            own = replace(known, births=_births_by_skewness(problem, place, third, known.inequality))
        fit = score(problem, place, own, steps=STEPS if worth < least + _HOPELESS else 0)
        if deviance(bands, fit.expected.mean) > worth + _HOPELESS:  # the steps have lost their way
            fit = score(problem, place, own, steps=0)
        fits.append(fit)
    return fits


def _births_by_skewness(problem: FitProblem, contact: Contact, third: float, inequality: float) -> float:
    """Return lam per tick for which the third cumulant lam psi^3 w^3 c_3 E[d^7] is as measured, given lam psi^2 w."""
    sizes, probability, _ = shot_sizes(problem.population, contact.shape)
    seen = passed(problem.pulse, problem.sensor, contact.diameter * sizes, probability)[1]
    single = problem.pulse.life_integral(3) * problem.population.moment(7, contact.shape) * contact.diameter**7 * seen
    births = contact.rate**3 * single**2 * inequality**3 / max(third, 1e-12) ** 2
    return float(np.clip(births, _FEWEST_ALIVE / contact.diameter, _MOST_ALIVE / contact.diameter))


def _criterion(fit: Fit) -> float:
    return deviance(fit.problem.bands, fit.expected.mean) + 2.0 * len(fit.names)


def _too_little(fit: Fit, signal: Signal) -> str:
    """Return why a record shows too little, with the number that it would need; empty if it is enough."""
    bands, contact = fit.problem.bands, fit.contact
    flat = np.full(bands.energy.size, np.average(bands.energy, weights=bands.weight))
    without = [flat] if fit.problem.walk is None else [flat, _walk_alone(bands, fit.problem.walk, flat)]
    gain = min(deviance(bands, each) for each in without) - deviance(bands, fit.expected.mean)
    if gain < _LEAST_GAIN:
        return (
            f"no signal of junctions beyond noise and drift: it improves the fit by {max(gain, 0.0):.1f}, and"
            f" {_LEAST_GAIN:g} are needed"
        )
    size = contact.diameter * signal.tick
    if contact.diameter < FEWEST_SAMPLES and (test := spectrum_test(fit)).flagged:
        return (
            f"the trace may hold no junctions: no size and spread has its spectrum (chi-square {test.statistic:.3g})."
            " Fading noise, 1/f noise and a sawtooth look so: compare with a trace at rest; mask= leaves out a line,"
            " drift=True fits a sensor that drifts"
        )
    if contact.diameter < FEWEST_SAMPLES:
        return (
            f"junctions of {size:.3g} um are {contact.diameter:.2g} samples long; {FEWEST_SAMPLES:g} are needed: a tick"
            f" of {size / FEWEST_SAMPLES:.3g} um or less"
        )
    piece, samples = ("each stroke", bands.samples) if min(signal.ways) > 0 else ("the record", bands.span)
    sizes = samples / contact.diameter
    if sizes < FEWEST_SIZES:
        return (
            f"{piece} is {sizes:.3g} sizes of {size:.3g} um long; {FEWEST_SIZES:g} are needed, that is"
            f" {FEWEST_SIZES * size:.4g} um of sliding"
        )
    return ""


def _walk_alone(bands: Bands, walk: Doubles, flat: Doubles) -> Doubles:
    """Return the bands of the random walk and white noise that fit best, by a few scoring steps from a ``flat`` one."""
    columns, mean = np.stack([walk, np.ones(walk.size)], axis=-1), flat
    for _ in range(20):
        weights = np.sqrt(bands.weight) / mean
        found = np.linalg.lstsq(columns * weights[:, None], bands.energy * weights)[0]
        mean = np.maximum(columns @ np.maximum(found, 0.0), 1e-6 * flat)
    return mean


def _not_identified(estimates: Mapping[str, Estimate], fit: Fit, signal: Signal) -> dict[str, str]:
    """Return why the trace does not show what has no estimate, and what would show it."""
    either = 'a trusted zero of the sensor (zero="known") or the strength (strength="250 MPa") would identify it'
    strength = 'needs a trusted zero of the sensor (zero="known") and a unit of force (unit="mN")'
    spread = 'needs a trusted zero (zero="known") and the mean strength (strength="250 MPa") together'
    if fit.known.strength is not None:
        strength = "it was given"
    if signal.is_area:
        strength = spread = "a trace of area has no strengths"
    reasons = {
        "junction_count": f"spectrum alone gives births times strength squared; {either}",
        "mean_real_contact_area": f"follows from the number of junctions; {either}",
        "relative_spread": f'the law {fit.problem.population.name} has none to find; law="auto" compares laws',
        "shear_strength": strength,
        "strength_spread": spread,
    }
    return {name: reason for name, reason in reasons.items() if name not in estimates}


def _beside(fit: Fit, best: Fit, estimates: Mapping[str, Estimate]) -> Tried:
    """Return a fit compared with the best one: Vuong's test on the difference of their Whittle likelihoods.

    Twice the number of parameters chooses the best law; it is no evidence against another, and is not tested.
    Source: Vuong (1989), doi:10.2307/1912557, with the covariance of the bands instead of that of independent values.
    """
    bands = best.problem.bands
    slope = 2.0 * bands.weight * (1.0 / fit.expected.mean - 1.0 / best.expected.mean)
    scatter = covariance(best.problem, best.contact, best.expected.mean)[1:, 1:]
    error = sqrt(max(float(slope @ scatter @ slope), 0.0))
    excess = deviance(bands, fit.expected.mean) - deviance(bands, best.expected.mean)
    far = excess if fit.problem.pulse == best.problem.pulse else abs(excess)
    return Tried(
        law=fit.problem.population.name,
        pulse=fit.problem.pulse,
        criterion=_criterion(fit),
        worse_by=_criterion(fit) - _criterion(best),
        error=error,
        told_apart=fit is not best and far > max(_APART, 2.0 * error),
        estimates=estimates,
    )


def _law_free(fit: Fit, signal: Signal) -> dict[str, float]:
    """Return numbers that depend on no law: m_6/m_5 from S(0) over the variance, and N for equal sizes from the mean.

    d_eff = S(0) c_2 / (variance E[(int a)^2]), N_eff = L c_2 / c_1^2 mean^2 / variance, for the lens 1.5124 of them,
    L the mean life of unit diameter; S(0) is the mean of the bands below a tenth of k d, the variance that of the trace
    less its noise, before the sensor.
    """
    bands, contact, pulse = fit.problem.bands, fit.contact, fit.problem.pulse
    sizes, probability, _ = shot_sizes(fit.problem.population, contact.shape)
    seen = passed(pulse, fit.problem.sensor, contact.diameter * sizes, probability)[0]
    variance = max(1.0 - contact.noise, 1e-12) / seen
    typical = contact.diameter * sqrt(fit.moment(8) / fit.moment(6))
    low = np.maximum(bands.wavenumber * typical < 0.6, np.arange(bands.energy.size) < 5)
    zero = float(np.sum((bands.weight * bands.energy)[low]) / np.sum(bands.weight[low])) - contact.noise
    second = pulse.life_integral(2)
    found = {"effective_diameter": max(zero, 0.0) * second / (variance * pulse.integral_moment(2)) * signal.tick}
    if fit.known.mean is not None:
        equal = pulse.mean_life * second / pulse.life_integral(1) ** 2 * fit.contact.inequality
        found["effective_count"] = equal * fit.known.mean**2 / variance
    return found
