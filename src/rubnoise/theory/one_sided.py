"""The one-sided spectral density of real contact area, its tail and its corner; conventions spelled out."""

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.model import Model
from rubnoise.theory.random_births import need_random_births
from rubnoise.theory.spectrum import spectral_density

Doubles = NDArray[np.float64]

_HALVINGS = 60


def one_sided_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return G(k) = S(k) / pi in um^4 per rad/um for k >= 0 in rad/um, so that int_0^inf G dk = Var[A_r].

    S is the two-sided density with R(tau) = (1/2 pi) int S(k) exp(i k tau) dk: folding it in two and leaving out the
    1/2 pi makes the factor 2 / (2 pi).
    """
    return spectral_density(model, wavenumber) / pi


def one_sided_density_per_cycle(model: Model, cycles: ArrayLike) -> Doubles:
    """Return 2 S(2 pi f) in um^4 per cycle/um at f >= 0 in cycles/um, so that int_0^inf df gives Var[A_r].

    It is what scipy.signal's "density" scaling estimates from ticks.
    """
    return 2.0 * spectral_density(model, 2.0 * pi * np.asarray(cycles, dtype=np.float64))


def tail(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return the level lam j m_2 / k^4 about which S(k) falls off, in um^4 per rad/um, k > 0 in rad/um; two-sided.

    j is 4 for the lens and 3 pi^2 / 8 for the triangle, the sum of the squares of the jumps of slope over a life of
    unit diameter. S swings about it, the lens by a factor 1 + 2.5 / sqrt(k d) for one size, the triangle wholly; spread
    damps that. Raises Refused unless births are a Poisson process.
    Source: Watson's lemma for the kinks of paper Eq. (2).
    """
    need_random_births(model, "the tail of the spectrum")
    k = np.asarray(wavenumber, dtype=np.float64)
    return model.birth_rate * model.pulse.squared_kinks * model.sizes.moment(2) / np.square(np.square(k))


def half_power_wavenumber(model: Model) -> float:
    """Return the smallest k in rad/um at which S(k) = S(0) / 2, to rounding.

    For lenses of one size it is 2.2522/d, so k L = 4.50, 0.72 cycles a life. Raises Refused unless births are a Poisson
    process: regular ones have their least density at k = 0.
    """
    need_random_births(model, "the corner of the spectrum")
    half = 0.5 * float(spectral_density(model, 0.0))
    low, high = 0.0, 0.25 / model.sizes.support[1]
    while float(spectral_density(model, high)) > half:
        low, high = high, 1.25 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(spectral_density(model, middle)) > half else (low, middle)
    return high
