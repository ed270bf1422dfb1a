"""Births and the junctions that they bring beside their laws: how many, where, how large, how strong, and their sums.

Each function takes what was measured and yields figures, relations that must hold, or what is left out and why.
"""

from collections.abc import Callable, Iterator
from math import sqrt
from typing import Final

import numpy as np

from rubnoise.analysis import findings
from rubnoise.analysis.measured import STRETCHES, UNITS, MeasuredRun
from rubnoise.analysis.records import longer
from rubnoise.answer import Row, left_out
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Law
from rubnoise.model import Model
from rubnoise.theory.second_order import need_random_births
from rubnoise.theory.sizes import panels

ROUNDING: Final = 2.0**-50
AREA_ROUNDING: Final = 1e-9
"""In diameters squared: what formulas of a life's area lose near its ends."""

FEWEST_GAPS: Final = 1000  # births from which the spread of their gaps, a mean of squares of exponentials, has a score

_NARROW: Final = 1e-3
_RARE: Final = 1e-9


def births(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the number of births, their gaps and their places beside their law."""
    model, found = seen.model, seen.births
    expected = model.birth_rate * model.distance
    if isinstance(model.births, RegularBirths):
        rounding = 2.0 * ROUNDING * (expected + found.count)  # a place is a sum of gaps, each rounded
        yield findings.identity("birth_count", abs(found.count - expected), 1.0 + rounding, "")
        return
    if isinstance(model.births, PoissonBirths):
        yield findings.poisson_figure("birth_count", found.count, expected)
        yield _gap_variation(seen)
    else:
        yield from _windows(seen)
    if found.count < findings.FEWEST:
        yield findings.too_short("births", findings.FEWEST * model.mean_birth_spacing)
    yield from _laws(seen, "birth_gap", "birth_place")


def _laws(seen: MeasuredRun, *names: str) -> Iterator[Row]:
    """Yield how far the distribution functions of independent values are from their laws, of those with enough."""
    for name in names:
        sample = seen.births.samples[name]
        if sample.count >= findings.FEWEST:
            yield findings.kolmogorov_figure(f"{name}_kolmogorov", sample)


def _gap_variation(seen: MeasuredRun) -> Row:
    """Return variance over squared mean of the n + 1 gaps into which n births divide the run.

    The births of a Poisson process are uniform on the run once their number is known, and so the sum of squared shares
    G has the mean 2/(n + 2) and the variance 4n / ((n + 2)^2 (n + 3)(n + 4)). Its skewness tends to 10/sqrt(n).
    Source: Moran (1947), doi:10.1111/j.2517-6161.1947.tb01572.x.
    """
    model, found, n = seen.model, seen.births, seen.births.count
    name = "birth_gap_variation"
    if n < FEWEST_GAPS:
        return findings.too_short(name, (FEWEST_GAPS + 1) * model.mean_birth_spacing)
    value = (n + 1) * (found.squares + (model.distance - found.last) ** 2) / model.distance**2 - 1.0
    error = 2.0 * (n + 1) / (n + 2) * (n / ((n + 3) * (n + 4))) ** 0.5
    return findings.judged(name, value, (n + 1) * 2.0 / (n + 2) - 1.0, error, length=model.distance, skewness=5.0)


def _windows(seen: MeasuredRun) -> Iterator[Row]:
    """Yield the number of births, and the variance of their numbers in windows, whose errors are from its scatter."""
    model, found = seen.model, seen.births
    needed = STRETCHES * 2.0 * model.births.memory
    if model.distance < needed:
        yield findings.too_short("birth_count", needed)
        return
    if model.births.dispersion > 0.0:
        # Long beside what births remember, their number varies by its dispersion; near the ends they lack neighbours.
        expected = model.birth_rate * model.distance
        error = (model.births.dispersion * expected) ** 0.5
        yield findings.figure("birth_count", float(found.count), expected, error)
    for windows in found.windows:
        name = f"birth_count_variance_{windows.length:.3g}"
        if windows.stretches.length < STRETCHES:
            yield findings.too_short(name, STRETCHES * STRETCHES * windows.length)
        else:
            yield scattered(name, windows.squares(), number_variance(model, windows.length))


def number_variance(model: Model, length: float) -> float:
    """Return the variance of the number of births in a length L: (1/2 pi) int S_N (2 sin(kL/2)/k)^2 dk, and lines."""
    k, weights = panels(np.arange(400) * (np.pi / length), 8)
    lines = 2.0 * np.pi * model.birth_rate * np.arange(1, 1000, dtype=np.float64)
    smooth, sharp = (np.square(2.0 * np.sin(0.5 * length * each) / each) for each in (k, lines))
    more = float(weights @ (model.births.excess(k) * smooth)) / np.pi
    kept = float(model.births.line_share(lines) @ sharp)
    return model.birth_rate * (length + more + 2.0 * model.birth_rate * kept)


def scattered(name: str, means: Doubles, expected: float, unit: str = "") -> Row:
    """Return the mean of independent stretches with the error of their scatter; its score is Student's t."""
    from scipy.special import stdtr

    error = float(means.std(ddof=1)) / sqrt(means.size)
    t = (float(means.mean()) - expected) / error if error else 0.0
    deviate = findings.normal_deviate(float(stdtr(means.size - 1, t)), float(stdtr(means.size - 1, -t)))
    return findings.figure(name, float(means.mean()), expected, error, deviate, unit=unit)


def start(seen: MeasuredRun) -> Iterator[Row]:
    """Yield number, ages and diameters at the start beside their laws; raises Refused unless births are random.

    The number is Poisson(lam E[life]), ages are uniform over a life, diameters have a density proportional to d f(d),
    offsets one proportional to the life, (2/pi) sqrt(1 - (b/d)^2); an empty start has no junctions to compare.
    """
    if seen.model.start == "stationary":
        need_random_births(seen.model, "who is alive at the start")
        yield findings.poisson_figure("start_count", seen.births.at_start, seen.model.mean_live_junctions)
        yield from _laws(seen, "start_age", "start_diameter", "start_offset")


def marks(seen: MeasuredRun) -> Iterator[Row]:
    """Yield mean, spread and law of the diameters and strengths that junctions are born with."""
    model, found = seen.model, seen.births
    if not found.count:
        findings.need(0.0, findings.FEWEST * model.mean_birth_spacing)
    for name, law in (("diameter", model.sizes), ("shear_strength", model.strengths)):
        if law is not None and not isinstance(law, Fixed):
            yield from _drawn(seen, name, law, UNITS[name])
    yield from _laws(seen, "diameter", "offset")


def _drawn(seen: MeasuredRun, name: str, law: Law, unit: str) -> Iterator[Row]:
    """Yield mean and std of independent values: errors std/sqrt(n), and sqrt((mu_4 - mu_2^2)/n) over 2 std."""
    found = seen.births.moments[name]
    mean, length = law.moment(1), found.count * seen.model.mean_birth_spacing
    second, third, fourth = central_moments(law.moment)
    std, skewness = sqrt(second), abs(third) / second**1.5 / sqrt(found.count)
    near = findings.Tail(skewness=0.0, needed=longer(length, skewness, findings.LARGEST_SKEWNESS))
    error = std / sqrt(found.count)
    yield findings.judged(f"{name}_mean", found.mean, mean, error, length=length, skewness=0.0, tail=near, unit=unit)
    if std < _NARROW * mean:
        yield left_out(f"{name}_std", "the law is too narrow for its moments to show it")
        return
    error = sqrt((fourth - second**2) / found.count) / (2.0 * std)
    tail = findings.tail_of_squares(law, mean, found.count, length)
    yield findings.judged(f"{name}_std", found.std, std, error, length=length, tail=tail, unit=unit)


def central_moments(moment: Callable[[int], float]) -> tuple[float, float, float]:
    """Return the second, third and fourth central moments of a law from its moments about 0, E[x^n]."""
    m1, m2, m3, m4 = (moment(n) for n in (1, 2, 3, 4))
    second, third = m2 - m1**2, m3 - 3 * m1 * m2 + 2 * m1**3
    return second, third, m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4


def sums(seen: MeasuredRun) -> Iterator[Row]:
    """Yield how far area, count and force of the trace are from the sums over lives; only rounding is allowed."""
    model, largest = seen.model, seen.largest
    area, count, force = np.abs(seen.sampled - seen.sums).max(axis=1, initial=0.0).tolist()
    reach, most_alive = model.distance + 2.0 * largest, max(1.0, float(seen.sums[1].max(initial=0.0)))
    # Distances are known to a rounding of the farthest; so are ages, and areas by their slope of at most pi d/2.
    rounding = most_alive * largest * (AREA_ROUNDING * largest + 4.0 * ROUNDING * reach)
    yield findings.identity("area_from_rows", area, rounding, "um^2")
    yield findings.identity("count_from_rows", count, 0.0, "")
    if model.strengths is not None and model.held is None and not isinstance(model.strengths, Fixed):
        strongest = float(model.strengths.quantile(np.array([1.0 - _RARE]))[0])
        yield findings.identity("force_from_rows", force, strongest * rounding, "uN")
