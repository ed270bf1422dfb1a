"""Contacts with regular births: their lines in the spectrum, averages over their phase, cumulants and counts.

The phase of regular births is uniform over one spacing. Formulas that hold only for random births refuse others here.
"""

from collections.abc import Callable
from functools import lru_cache
from math import ceil, comb, floor, pi, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import Law
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.birth_noise import has_noise_of_its_own, jittered_lines, line_power, raw_moments
from rubnoise.theory.log_table import LogTable, log_table
from rubnoise.theory.mean_life import ORDERS, age_table, area_by_age, cumulants_by_age
from rubnoise.theory.quadrature import (
    complementary_error,
    cut_size_rule,
    is_one_size,
    longest_life,
    panels,
    size_edges,
)


def need_random_births(model: Model, quantity: str, *, centred: bool = False) -> None:
    """Raise Refused unless births are a Poisson process, which every formula of filtered shot noise assumes.

    With ``centred`` also for passes off the centre line, whose single lives differ more than their sizes say.
    """
    if not isinstance(model.births, PoissonBirths):
        raise Refused(f"{quantity} is known for Poisson births alone (birth.law)")
    if centred and model.pulse.offset != "none":
        raise Refused(f"{quantity} is known for passes through both centres alone (pulse.offset)")


def are_at_random(model: Model) -> bool:
    """Return whether births are a Poisson process; raises Refused for passes off the centre line that are not."""
    if isinstance(model.births, PoissonBirths):
        return True
    if model.pulse.offset != "none":
        raise Refused("passes off the centre line (pulse.offset) are known for Poisson births alone (birth.law)")
    return False


Lines = tuple[Doubles, Doubles]

_FEWEST = 4096
_MOST, _MOST_OF_ONE_SIZE = 2**14, 2**18
_AT_ONCE = 2**20
_ROUNDING = 1e-12
_NO_POWER = 1e-32


def spectral_lines(model: Model) -> Lines:
    """Return wavenumbers k_n = 2 pi n lam in rad/um, n = 1, 2, ..., and the power of A_r in each line, in um^4.

    The power at k_n is lam^2 |E[A^(k_n)]|^2, and as much lies at -k_n, so that the lines add 2 sum of power to the
    variance and 2 sum of power cos(k_n tau) to the autocovariance. There are enough of them to leave less than 1e-9 of
    that out, from one junction in a hundred spacings on; none for Poisson births. A power below 1e-32 of the squared
    mean is rounding and given as 0: of triangles of one size every second line, or all of them, have none. Jittered
    births keep the part of each that their law says, and others none.
    Source: the Fourier series of E[A_r | phase]; Cox and Lewis, The Statistical Analysis of Series of Events (1966).
    """
    return _lines(model, of_count=False)


def count_lines(model: Model) -> Lines:
    """Return the lines of the live count as `spectral_lines`, with power lam^2 |E[(exp(2ikd) - 1)/(ik)]|^2, a number.

    They fall off as 1/k_n^2, since the count jumps.
    """
    return _lines(model, of_count=True)


@lru_cache(maxsize=16)
def _lines(model: Model, *, of_count: bool) -> Lines:
    if are_at_random(model):
        return np.empty(0), np.empty(0)
    if has_noise_of_its_own(model):
        return jittered_lines(model, of_count=of_count)
    most = _MOST_OF_ONE_SIZE if is_one_size(model.sizes) else _MOST
    sparseness = model.births.mean / (4.0 * model.sizes.moment(1))
    count = min(_FEWEST * max(1, ceil(sparseness)), most)
    k = 2.0 * pi * model.birth_rate * np.arange(1.0, count + 1.0)
    power = line_power(model, k, of_count=of_count)
    return k, power if of_count else np.where(power > _NO_POWER * model.stationary_mean_area**2, power, 0.0)


def line_covariance(lines: Lines, lag: Doubles) -> Doubles:
    """Return 2 sum of power cos(k_n tau) for lags tau in um of any shape."""
    wavenumbers, power = lines
    flat = lag.ravel()
    result = np.zeros(flat.size)
    for rows in np.array_split(np.arange(flat.size), 1 + flat.size * power.size // _AT_ONCE):
        result[rows] = 2.0 * np.cos(np.multiply.outer(flat[rows], wavenumbers)) @ power
    return result.reshape(lag.shape)


def variance_of_line_mean(model: Model, lines: Lines, distance: float | None = None) -> float:
    """Return the part of the lines in the variance of the mean over a record whose phase is uniform; exact.

    A line keeps (sin(k T/2) / (k T/2))^2 of its power over a continuous record of ``distance`` T um, and over the
    model's n ticks h apart (sin(n k h/2) / (n sin(k h/2)))^2: all of it if ticks always meet the same phase.
    """
    wavenumbers, power = lines
    turns = wavenumbers / (2.0 * pi)
    if distance is not None:
        return 2.0 * float(power @ np.square(np.sinc(turns * distance)))
    ticks = model.tick_count + 1
    missed = turns * model.tick - np.rint(turns * model.tick)
    kept = np.sinc(ticks * missed) / np.sinc(missed)
    return 2.0 * float(power @ np.square(kept))


def resolved_error(variance: float, mean: float) -> float:
    """Return the root of the variance of a mean, or 0 if it is below 1e-12 of the mean, where it is rounding."""
    error = sqrt(max(variance, 0.0))
    return error if error > _ROUNDING * mean else 0.0


_NODES = 20
_WINDOW = 3.0  # width of the step that leaves old lives out, in spacings
_WINDOW_REACH = 9.0  # widths of the step from its middle to its end
_SMOOTH = 8.0  # spacings in a panel of the mean life that is smooth on the scale of one
_PHASES_AT_ONCE = 2**16


def phase_rule(model: Model) -> tuple[Doubles, Doubles]:
    """Return phases in um, which are the age of the youngest possible junction, and their probabilities.

    Panels end where a life begins, is at its middle or ends, or, for more than one size, at those edges of the mean
    life's panels that lie closer together than a spacing.
    """
    spacing = model.births.mean
    if is_one_size(model.sizes):
        turns = 0.5 * longest_life(model) * np.arange(3.0)
    else:
        ages = np.exp(age_table(model.sizes, model.pulse).edges)
        narrow = np.diff(ages) < spacing
        turns = ages[np.append(narrow, False) | np.append(False, narrow)]
    ends = np.unique(np.concatenate([[0.0], turns % spacing, [spacing]]))
    phases, weights = panels(ends, _NODES, rooted=True)
    return phases, weights / spacing


def mean_cumulants(model: Model, strength_moments: tuple[float, ...]) -> Doubles:
    """Return the means over the phase of the cumulants given it, lam int kappa_n[psi A(a; d)] da, n = 1 ... 6."""
    if is_one_size(model.sizes):
        ages, weights = panels(0.5 * longest_life(model) * np.arange(3.0), _NODES, rooted=True)
    else:
        logs, weights = panels(age_table(model.sizes, model.pulse).edges, _NODES)
        ages = np.exp(logs)
        weights = weights * ages
    moments = area_by_age(model.sizes, model.pulse, ages)
    return model.birth_rate * (cumulants_by_age(moments, strength_moments) @ weights)


def cumulant_ripple(model: Model, phases: Doubles, strength_moments: tuple[float, ...]) -> Doubles:
    """Return the cumulants of sum psi A given the phase up to a constant each, of order 1 to 6 the first axis.

    Given the phase, lives are independent: the one that began last has the phase for its age, the one before a spacing
    more, and so on. Ages from which on the mean life is smooth on the scale of a spacing add the same at every phase,
    and are left out along an error function three spacings wide, which turns the sum's ripple down by exp(-170).
    """
    sharp = _sharp_until(model)
    width = _WINDOW * model.births.mean
    if sharp + 2.0 * _WINDOW_REACH * width > longest_life(model):
        return _summed(model, phases, strength_moments, reach=longest_life(model), window=None)
    centre = sharp + _WINDOW_REACH * width

    def window(ages: Doubles) -> Doubles:
        return np.asarray(0.5 * complementary_error((ages - centre) / (np.sqrt(2.0) * width)), dtype=np.float64)

    return _summed(model, phases, strength_moments, reach=centre + _WINDOW_REACH * width, window=window)


def _summed(
    model: Model,
    phases: Doubles,
    strength_moments: tuple[float, ...],
    *,
    reach: float,
    window: Callable[[Doubles], Doubles] | None,
) -> Doubles:
    spacing = model.births.mean
    most, together = ceil(reach / spacing), max(1, _PHASES_AT_ONCE // phases.size)
    total = np.zeros((ORDERS, phases.size))
    for first in range(0, most, together):
        ages = phases[:, None] + spacing * np.arange(first, min(first + together, most))
        terms = cumulants_by_age(area_by_age(model.sizes, model.pulse, ages), strength_moments)
        total += (terms if window is None else terms * window(ages)).sum(axis=-1)
    return total


def _sharp_until(model: Model) -> float:
    """Return the age in um beyond which the mean life has no feature as narrow as a spacing."""
    if is_one_size(model.sizes):
        return longest_life(model)
    ages = np.exp(age_table(model.sizes, model.pulse).edges)
    narrow = np.diff(ages) < _SMOOTH * model.births.mean
    return float(ages[1:][narrow].max(initial=0.0))


_NODES_OF_SIZE = 24
_YOUNGEST = 1e-13
_TOLERANCE = 4e-14
_SHARED_TOLERANCE = 2e-13
_WHOLE = 1e-12  # by which a number of equal lives may miss a whole number, as a part of itself
_MOST_SUMMED = 4096


def unphased_count_covariance(model: Model, lag: Doubles) -> Doubles:
    """Return lam E[(2d - tau)+] - lam int G(a) G(a + tau) da, G(a) = P(2d > a): the covariance given the phase.

    Lags tau >= 0 in um of any shape; 0 for one size, whose lives the phase fixes.
    """
    if is_one_size(model.sizes):
        return np.zeros_like(lag)
    reach = lag[..., None]
    diameters, probabilities = cut_size_rule(model.sizes, 0.5 * reach, _NODES_OF_SIZE)
    left = np.sum(probabilities * np.maximum(2.0 * diameters - reach, 0.0), axis=-1)
    return model.birth_rate * (left - _shared(model.sizes, lag))


def phased_count_covariance(model: Model, lag: Doubles) -> Doubles:
    """Return the covariance of E[N | phase] at lags tau >= 0 in um of any shape, of period one spacing.

    lam sum over all j of int G(a) G(a + |tau + j spacing|) da, less the square of the mean; one size has a whole number
    of lives and one more with probability f, and covariance max(0, f - t) + max(0, f - 1 + t) - f^2 at t spacings.
    Lives very long on the scale of a spacing are summed as lines, with B_2(t)/2 for the births.
    """
    turns = lag / model.births.mean
    part = turns - np.floor(turns)
    if is_one_size(model.sizes):
        f = _fraction(longest_life(model) / model.births.mean)
        return np.maximum(0.0, f - part) + np.maximum(0.0, f - 1.0 + part) - f * f
    most = ceil(longest_life(model) / model.births.mean)
    if most > _MOST_SUMMED:
        return _from_lines(model, lag, part)
    total = np.zeros_like(lag)
    for j in range(-most - 1, most + 1):
        total += _shared(model.sizes, np.abs(part + j) * model.births.mean)
    mean = model.birth_rate * 2.0 * model.sizes.moment(1)
    return model.birth_rate * total - mean * mean


def _from_lines(model: Model, lag: Doubles, part: Doubles) -> Doubles:
    wavenumbers, power = count_lines(model)
    births = np.square(model.birth_rate / wavenumbers)
    sawtooth = 0.5 * (part * part - part + 1.0 / 6.0)
    return sawtooth + line_covariance((wavenumbers, power - births), lag)


def _fraction(lives: float) -> float:
    """Return the fractional part of a number, 0 if it is only rounding."""
    nearest = round(lives)
    return 0.0 if abs(lives - nearest) <= _WHOLE * lives else lives - floor(lives)


def _shared(law: Law, lag: Doubles) -> Doubles:
    """Return int G(a) G(a + tau) da = E[min(2d, (2d' - tau)+)] in um, d and d' independent."""
    table = _shared_table(law)
    return np.asarray(table(np.maximum(lag, np.exp(table.edges[0])))[0])


@lru_cache(maxsize=8)
def _shared_table(law: Law) -> LogTable:
    edges = size_edges(law)[0]
    turns = np.append(_YOUNGEST * edges[0], np.union1d(edges, 2.0 * edges))
    mean = np.array([law.moment(1)])
    shorter = log_table(lambda x: _shorter(law, x)[None], turns, _TOLERANCE * mean)

    def shared(lag: Doubles) -> Doubles:
        diameters, probabilities = cut_size_rule(law, 0.5 * lag[..., None], _NODES_OF_SIZE)
        rest = np.maximum(2.0 * diameters - lag[..., None], 0.0)
        return np.sum(probabilities * shorter(rest)[0], axis=-1)[None]

    return log_table(shared, turns, _SHARED_TOLERANCE * mean)


def _shorter(law: Law, distance: Doubles) -> Doubles:
    """Return E[min(2d, x)]."""
    diameters, probabilities = cut_size_rule(law, 0.5 * distance[..., None], _NODES_OF_SIZE)
    return np.sum(probabilities * np.minimum(2.0 * diameters, distance[..., None]), axis=-1)


CONSTANT = 1e-12
"""Standard deviation over mean below which a quantity is constant: what is left is rounding."""


def regular_cumulants(model: Model, strength_moments: tuple[float, ...]) -> tuple[float, ...]:
    """Return the cumulants of order 1 to 6 of sum psi A over live junctions in (MPa um^2)^n, births regular.

    E[psi^n], n = 0 ... 6, are given. With K_n(phase) the cumulants given the phase, sums over independent lives,
    kappa_n = E[K_n] + c_n, c_n the n-th cumulant of the mixture of K_n - E[K_n]; nothing cancels, and the mean is
    Campbell's. A ripple of one size below 1e-12 of the mean is taken for none.
    Source: the law of total cumulance, Brillinger (1969), doi:10.1007/BF02532246.
    """
    mean = strength_moments[1] * model.stationary_mean_area
    higher = mean_cumulants(model, strength_moments)[1:]
    if _ripples(model):
        phases, probabilities = phase_rule(model)
        ripple = cumulant_ripple(model, phases, strength_moments)
        higher += _mixture(ripple - (ripple @ probabilities)[:, None], probabilities)[1:]
    return (mean, *(float(value) for value in higher))


def _ripples(model: Model) -> bool:
    """Return whether the mean given the phase varies; it always does for lives of many sizes."""
    if not is_one_size(model.sizes):
        return True
    return 2.0 * float(spectral_lines(model)[1].sum()) > (CONSTANT * model.stationary_mean_area) ** 2


def _mixture(cumulants: Doubles, probabilities: Doubles) -> Doubles:
    """Return the cumulants of a mixture of laws whose own cumulants of order 1 to 6 are the rows."""
    moments = raw_moments(cumulants) @ probabilities
    found = np.zeros(ORDERS)
    for n in range(1, ORDERS + 1):
        found[n - 1] = moments[n] - sum(comb(n - 1, i) * found[i] * moments[n - 1 - i] for i in range(n - 1))
    return found
