"""The estimates of a fit by name and unit, with 95 % intervals: for one law, and for all laws not distinguished."""

from dataclasses import dataclass
from math import erf, exp, log, sqrt
from typing import Final

from rubnoise.inference.scoring import Fit
from rubnoise.inference.signal import Signal

Z: Final = 1.959963984540054


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A number with its standard error and 95 % interval, in a unit."""

    value: float
    standard_error: float
    interval: tuple[float, float]
    unit: str


def estimates_of(fit: Fit, signal: Signal, scale: float, *, compared: bool) -> dict[str, Estimate]:
    """Return the estimates of a fit by name, in um, MPa and the unit of the trace.

    A law of one spread, such as exponential, has an estimate of it only if laws are ``compared``: alone, its spread is
    an assumption.
    """
    contact, place, tick = fit.contact, fit.contact.place, signal.tick
    population = fit.problem.population
    found = {"diameter": _positive(place.diameter * tick, fit.error({"diameter": 1.0}), "um")}
    spread = population.relative_spread(place.shape)
    if population.spread:
        found["relative_spread"] = _spread(fit, spread)
    elif compared:
        found["relative_spread"] = Estimate(value=spread, standard_error=0.0, interval=(spread, spread), unit="1")
    found["noise"] = _noise(fit, scale, signal.unit)
    free = fit.known.free
    if free != ("strength",):
        powers = {"births": 1.0, "diameter": 1.0}
        found["junction_count"] = _positive(
            fit.problem.pulse.mean_life * contact.births * place.diameter, fit.error(powers), "1"
        )
    if "births" in free:
        area = contact.births * fit.problem.pulse.life_integral(1) * fit.moment(3) * place.diameter**3 * tick**2
        powers = {"births": 1.0, "diameter": 3.0, "shape": fit.by_shape(3)}
        found["mean_real_contact_area"] = _positive(area, fit.error(powers), "um^2")
    if signal.scale is not None and "strength" in free and "births" in free and not signal.is_area:
        unit = scale * signal.scale / tick**2
        found["shear_strength"] = _positive(contact.strength * unit, fit.error({"strength": 1.0}), "MPa")
    if "inequality" in free and not signal.is_area:
        found["strength_spread"] = _strength_spread(contact.inequality, fit.error({"inequality": 1.0}))
    return found


def _positive(value: float, error: float, unit: str) -> Estimate:
    """Return an estimate whose logarithm has an error."""
    reach = min(Z * error, 700.0)
    return Estimate(
        value=value, standard_error=value * error, interval=(value * exp(-reach), value * exp(reach)), unit=unit
    )


def _spread(fit: Fit, spread: float) -> Estimate:
    """Return the spread with its interval; for the narrowest law, from 0 to the least spread that could be seen."""
    population, shape = fit.problem.population, fit.contact.place.shape
    step = 1e-4 * shape
    slope = (population.relative_spread(shape + step) - population.relative_spread(shape - step)) / (2.0 * step)
    if "shape" not in fit.names:
        return Estimate(value=0.0, standard_error=0.0, interval=(0.0, spread), unit="1")
    error = fit.error({"shape": 1.0})
    value = population.relative_spread(shape)
    log_error = error * shape * slope / value
    # A spread whose error is as large as itself may be none.
    low = max(0.0, value * (1.0 - Z * log_error)) if log_error > 0.35 else value * exp(-Z * log_error)
    high = value * (1.0 + Z * log_error) if log_error > 0.35 else value * exp(Z * log_error)
    return Estimate(value=value, standard_error=value * log_error, interval=(low, high), unit="1")


def _noise(fit: Fit, scale: float, unit: str) -> Estimate:
    value = sqrt(fit.contact.place.noise) * scale
    if "noise" not in fit.names:
        return Estimate(value=0.0, standard_error=0.0, interval=(0.0, sqrt(fit.problem.floor) * scale), unit=unit)
    return _positive(value, 0.5 * fit.error({"noise": 1.0}), unit)


def _strength_spread(inequality: float, error: float) -> Estimate:
    """Return the relative spread of strengths, sqrt(w - 1)."""
    low, high = (sqrt(max(inequality * exp(sign * Z * error) - 1.0, 0.0)) for sign in (-1.0, 1.0))
    value = sqrt(max(inequality - 1.0, 0.0))
    return Estimate(value=value, standard_error=0.5 * (high - low) / Z, interval=(low, high), unit="1")


def widened(best: Estimate, laws: list[Estimate]) -> Estimate:
    """Return an estimate with its 95 % interval, given the estimates of all laws that are not distinguished.

    It reaches C standard errors beyond the estimates of all laws, Phi(C + range / error) - Phi(-C) = 0.95: C is 1.96
    if laws agree, and 1.64 if they differ by much, because the truth can lie beyond one end only.
    Source: Imbens and Manski (2004), doi:10.1111/j.1468-0262.2004.00555.x.
    """
    if len(laws) == 1:
        return best
    ratios = all(each.interval[0] > 0.0 for each in laws)

    def placed(value: float) -> float:
        return log(value) if ratios else value

    ends = [(placed(each.interval[0]), placed(each.value), placed(each.interval[1])) for each in laws]
    middles = [middle for _, middle, _ in ends]
    error = max(high - low for low, _, high in ends) / (2.0 * Z)
    reach = reach_beyond((max(middles) - min(middles)) / error if error > 0.0 else 0.0) / Z
    low = min(middle - reach * (middle - low) for low, middle, _ in ends)
    high = max(middle + reach * (high - middle) for _, middle, high in ends)
    # If an interval reaches down to 0, so does that of all laws.
    interval = (exp(low), exp(high)) if ratios else (0.0, high)
    # A law of one spread has no error of its own.
    own = best.standard_error or (interval[1] - interval[0]) / (2.0 * Z)
    return Estimate(value=best.value, standard_error=own, interval=interval, unit=best.unit)


def reach_beyond(apart: float) -> float:
    """Return C of Imbens and Manski for estimates at a distance in standard errors, by bisection."""
    low, high = 1.6, Z
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        held = 0.5 * (erf((middle + apart) / sqrt(2.0)) + erf(middle / sqrt(2.0)))
        low, high = (middle, high) if held < 0.95 else (low, middle)
    return high
