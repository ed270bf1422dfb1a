"""The lines in the spectrum of a contact with regular births, and what of them a finite record leaves."""

from functools import lru_cache
from math import ceil, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.theory.pulse_energy import mean_life_transform, mean_transform
from rubnoise.theory.quadrature import size_range
from rubnoise.theory.random_births import are_at_random

Doubles = NDArray[np.float64]
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
    mean is rounding and given as 0: of triangles of one size every second line, or all of them, have none.
    Source: the Fourier series of E[A_r | phase]; Cox and Lewis, The Statistical Analysis of Series of Events (1966).
    """
    if are_at_random(model):
        return np.empty(0), np.empty(0)
    return _area_lines(model)


def count_lines(model: Model) -> Lines:
    """Return the lines of the live count as `spectral_lines`, with power lam^2 |E[(exp(2ikd) - 1)/(ik)]|^2, a number.

    They fall off as 1/k_n^2, since the count jumps.
    """
    if are_at_random(model):
        return np.empty(0), np.empty(0)
    return _count_lines(model)


def line_covariance(lines: Lines, lag: Doubles) -> Doubles:
    """Return 2 sum of power cos(k_n tau) for lags tau in um of any shape."""
    wavenumbers, power = lines
    flat = lag.ravel()
    result = np.zeros(flat.size)
    for rows in np.array_split(np.arange(flat.size), 1 + flat.size * power.size // _AT_ONCE):
        result[rows] = 2.0 * np.cos(np.multiply.outer(flat[rows], wavenumbers)) @ power
    return result.reshape(lag.shape)


def variance_of_line_mean(model: Model, lines: Lines, distance: float | None = None) -> float:
    """Return what the lines add to the variance of the mean over a record whose phase is uniform; exact.

    A line keeps (sin(k T/2) / (k T/2))^2 of its power over a continuous record of ``distance`` T um, and over the
    model's n ticks h apart (sin(n k h/2) / (n sin(k h/2)))^2: all of it where ticks always meet the same phase.
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
    """Return the root of the variance of a mean, or 0 where it is below 1e-12 of the mean and rounding decides."""
    error = sqrt(max(variance, 0.0))
    return error if error > _ROUNDING * mean else 0.0


def _wavenumbers(model: Model) -> Doubles:
    most = _MOST_OF_ONE_SIZE if np.ptp(size_range(model.sizes)) == 0.0 else _MOST
    sparseness = model.births.mean / (4.0 * model.sizes.moment(1))
    count = min(_FEWEST * max(1, ceil(sparseness)), most)
    return 2.0 * pi * model.birth_rate * np.arange(1.0, count + 1.0)


@lru_cache(maxsize=8)
def _area_lines(model: Model) -> Lines:
    k = _wavenumbers(model)
    power = np.square(model.birth_rate * np.abs(mean_transform(model.sizes, model.pulse, k)))
    return k, np.where(power > _NO_POWER * model.stationary_mean_area**2, power, 0.0)


@lru_cache(maxsize=8)
def _count_lines(model: Model) -> Lines:
    k = _wavenumbers(model)
    return k, np.square(model.birth_rate * np.abs(mean_life_transform(model.sizes, k)))
