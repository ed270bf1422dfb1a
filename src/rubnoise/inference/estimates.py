"""The assumptions about junctions that a trace cannot show, and the estimates of a fit with 95 % intervals.

Intervals are for one law, or for all laws that are not distinguished.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import erf, exp, inf, isinf, pi, sqrt
from typing import Final

import numpy as np

from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.inference.fitting import Fit, Given
from rubnoise.inference.passes import Sensor
from rubnoise.inference.signal import Signal

Z: Final = 1.959963984540054
SPREADS: Final = (0.0, 0.25, 0.5, 1.0)
"""Relative spreads of strengths for which number and strength are given beside the assumed one."""
_AS_LARGE: Final = 0.35  # error of a spread over itself beyond which it may be none
ENOUGH_CYCLES: Final = 40.0
"""Cycles per life that a sensor has to pass if its filter is not given; docs/inference.md has the measured table."""


NAMES: Final = (
    "junction_count",
    "diameter",
    "relative_spread",
    "shear_strength",
    "strength_spread",
    "mean_real_contact_area",
    "noise",
)
"""The estimates of an answer, in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumed:
    """The assumptions of an inference.

    ``strength_spread`` is the standard deviation over the mean of lognormal strengths, ``pulse`` the pulse of a
    junction's area, ``shape_chosen`` whether an option chose its shape, ``bandwidth`` the corner of each of the
    sensor's ``poles`` in cycles per um.
    """

    strength_spread: float = 0.0
    pulse: Pulse = LENS
    shape_chosen: bool = True
    bandwidth: float = inf
    poles: int = 1

    def sensor(self, tick: float) -> Sensor:
        """Return the filter of the sensor for samples every ``tick`` um."""
        return Sensor(corner=2.0 * pi * self.bandwidth * tick, poles=self.poles)


NOTHING: Final = Assumed()  # equal strengths, passes through both centres, a sensor that passes everything


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A number with its standard error and 95 % interval, in a unit."""

    value: float
    standard_error: float
    interval: tuple[float, float]
    unit: str


def estimated(fit: Fit, signal: Signal, scale: float, *, compared: bool) -> dict[str, Estimate]:
    """Return the estimates of a fit by name, in um, MPa and the unit of the trace.

    A law of one spread, such as exponential, has an estimate of it only if laws are ``compared``: alone, its spread is
    an assumption.
    """
    contact, tick, pulse, free = fit.contact, signal.tick, fit.problem.pulse, fit.known.free
    found = {"diameter": _positive(fit, contact.diameter * tick, "um", diameter=1.0)}
    if fit.problem.population.spread or compared:
        found["relative_spread"] = _spread(fit)
    found["noise"] = _positive(fit, sqrt(contact.noise) * scale, signal.unit, noise=0.5)
    if "noise" not in fit.names:
        found["noise"] = replace(found["noise"], value=0.0, interval=(0.0, sqrt(fit.problem.floor) * scale))
    if free != ("strength",):
        count = pulse.mean_life * contact.births * contact.diameter
        found["junction_count"] = _positive(fit, count, "1", births=1.0, diameter=1.0)
    if "births" in free:
        area = contact.births * pulse.life_integral(1) * fit.moment(3) * contact.diameter**3 * tick**2
        powers = {"births": 1.0, "diameter": 3.0, "shape": fit.by_shape(3)}
        found["mean_real_contact_area"] = _positive(fit, area, "um^2", **powers)
    if signal.scale is not None and "strength" in free and "births" in free and not signal.is_area:
        strength = contact.strength * scale * signal.scale / tick**2
        found["shear_strength"] = _positive(fit, strength, "MPa", strength=1.0)
    if "inequality" in free and not signal.is_area:
        reach = Z * fit.error({"inequality": 1.0})
        low, value, high = (sqrt(max(contact.inequality * exp(by) - 1.0, 0.0)) for by in (-reach, 0.0, reach))
        error = 0.5 * (high - low) / Z
        found["strength_spread"] = Estimate(value=value, standard_error=error, interval=(low, high), unit="1")
    return found


def _positive(fit: Fit, value: float, unit: str, **powers: float) -> Estimate:
    """Return an estimate whose logarithm has the error of these powers of parameters."""
    error = fit.error(powers)
    reach = min(Z * error, 700.0)
    interval = (value * exp(-reach), value * exp(reach))
    return Estimate(value=value, standard_error=value * error, interval=interval, unit=unit)


def _spread(fit: Fit) -> Estimate:
    """Return the spread with its interval; for the narrowest law, from 0 to the least spread that could be seen."""
    population, shape = fit.problem.population, fit.contact.shape
    value = population.relative_spread(shape)
    if not population.spread:
        return Estimate(value=value, standard_error=0.0, interval=(value, value), unit="1")
    if "shape" not in fit.names:
        return Estimate(value=0.0, standard_error=0.0, interval=(0.0, value), unit="1")
    step = 1e-4 * shape
    slope = (population.relative_spread(shape + step) - population.relative_spread(shape - step)) / (2.0 * step)
    found = _positive(fit, value, "1", shape=shape * slope / value)
    if found.standard_error <= _AS_LARGE * value:
        return found
    reach = Z * found.standard_error
    return replace(found, interval=(max(0.0, value - reach), value + reach))


def wider(best: Estimate, laws: list[Estimate]) -> Estimate:
    """Return an estimate with its 95 % interval, given the estimates of all laws that are not distinguished.

    It reaches C standard errors beyond the estimates of all laws, Phi(C + range / error) - Phi(-C) = 0.95: C is 1.96
    if laws agree, and 1.64 if they differ by much, because the truth can lie beyond one end only.
    Source: Imbens and Manski (2004), doi:10.1111/j.1468-0262.2004.00555.x.
    """
    if len(laws) == 1:
        return best
    ends = np.array([(each.interval[0], each.value, each.interval[1]) for each in laws]).T
    ratios = bool(ends[0].min() > 0.0)
    lows, middles, highs = np.log(ends) if ratios else ends
    error = float((highs - lows).max()) / (2.0 * Z)
    reach = reach_beyond(float(np.ptp(middles)) / error if error > 0.0 else 0.0) / Z
    low = float((middles - reach * (middles - lows)).min())
    high = float((middles + reach * (highs - middles)).max())
    # If an interval reaches down to 0, so does that of all laws.
    interval = (exp(low), exp(high)) if ratios else (0.0, high)
    # A law of one spread has no error of its own.
    own = best.standard_error or (interval[1] - interval[0]) / (2.0 * Z)
    return replace(best, standard_error=own, interval=interval)


def reach_beyond(apart: float) -> float:
    """Return C of Imbens and Manski for estimates at a distance in standard errors, by bisection."""
    low, high = 1.6, Z
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        held = 0.5 * (erf((middle + apart) / sqrt(2.0)) + erf(middle / sqrt(2.0)))
        low, high = (middle, high) if held < 0.95 else (low, middle)
    return high


@dataclass(frozen=True, slots=True, kw_only=True)
class IfSpread:
    """Junction count and shear strength (MPa, if known) for another relative spread of strengths."""

    strength_spread: float
    junction_count: float
    shear_strength: float | None


def moves_with_spread(known: Given) -> bool:
    """Return whether an estimate depends on the spread of strengths, which has no estimate itself."""
    return "inequality" not in known.free and known.free != ("strength",)


def by_spread(estimates: Mapping[str, Estimate], known: Given) -> tuple[IfSpread, ...]:
    """Return how number and strength depend on the spread of strengths; empty if they do not.

    Mean and spectrum give A = lam E[psi] and B = lam E[psi^2]: the strength is B / (A (1 + v)), the number goes as
    A^2 (1 + v) / B. With a known strength and no mean the number goes as B / (psi^2 (1 + v)).
    """
    if not moves_with_spread(known) or "junction_count" not in estimates:
        return ()
    count, strength = estimates["junction_count"].value, estimates.get("shear_strength")
    return tuple(
        IfSpread(
            strength_spread=spread,
            junction_count=count * more if known.mean is not None else count / more,
            shear_strength=None if strength is None else strength.value / more,
        )
        for spread, more in ((spread, (1.0 + spread**2) / known.inequality) for spread in SPREADS)
    )


def assumptions(assumed: Assumed, fit: Fit, signal: Signal) -> dict[str, str]:
    """Return the assumptions by what they are about, one sentence each."""
    said = {}
    if moves_with_spread(fit.known) and not signal.is_area:
        said["strengths"] = (
            f"taken for lognormal with a spread of {100.0 * assumed.strength_spread:.3g} % of their mean"
            if assumed.strength_spread
            else "junctions are taken for equally strong (strength_spread= gives another spread)"
        )
    said["sensor"] = _of_sensor(assumed, 2.0 * fit.contact.diameter * signal.tick)
    shape = f"taken to have the shape {assumed.pulse.shape}"
    said["lives"] = shape if assumed.shape_chosen else f"{shape} (pulse= takes lens or parabola)"
    said["passes"] = (
        'taken to go through both centres (offset="uniform" for passes off it)'
        if assumed.pulse.offset == "none"
        else "taken to miss the centre by offsets uniform on -d to d"
    )
    if min(signal.ways) > 0:
        said["strokes"] = "each is taken to meet junctions of its own; where strokes repeat them, errors are larger"
    return said


def _of_sensor(assumed: Assumed, life: float) -> str:
    if isinf(assumed.bandwidth):
        return f"taken to pass {ENOUGH_CYCLES:g} cycles per life or more (bandwidth= gives its corner)"
    poles = "one pole" if assumed.poles == 1 else f"{assumed.poles} poles"
    return f"taken to have {poles} at {assumed.bandwidth * life:.3g} cycles per life, 2 d"
