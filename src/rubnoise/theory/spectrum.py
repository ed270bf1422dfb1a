"""The spectral density of real contact area and friction force: two-sided, one-sided, its tail, corner and lines.

Each function names its convention: S(k) is two-sided, G(k) one-sided.
"""

from math import pi

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.birth_noise import excess_density, has_noise_of_its_own
from rubnoise.theory.drive import force_power
from rubnoise.theory.regular_births import are_at_random, need_random_births, spectral_lines
from rubnoise.theory.transform import energy_spread, mean_energy


def spectral_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return the two-sided spectral density S(k) of real contact area in um^4 per rad/um, for any shape of k in rad/um.

    S(k) = lam E[|A^(k)|^2], with R(tau) = (1/2 pi) int S(k) exp(i k tau) dk and lam the birth rate; |A^(k)| is
    pi d |H_1(k d)| / k^2 for the lens, (pi/4) d^3 (sin(k d/2) / (k d/2))^2 for the triangle and
    pi (sin(k d) - k d cos(k d)) / k^3 for the parabola; for passes off the centre line the mean includes offsets
    (`rubnoise.theory.off_centre`). S(0) is finite. Regular births have the continuous part
    S(k) = lam (E[|A^(k)|^2] - |E[A^(k)]|^2), A^ about the birth, and the lines of
    `rubnoise.theory.regular_births.spectral_lines`. Other births add `rubnoise.theory.birth_noise.excess_density`.
    Source: Carson's theorem (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x); for regular births Campbell's theorem
    given the phase, under which the lives are independent.
    """
    return _density(model, wavenumber, 1.0, 1.0, exact=True)


def mean_spectral_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return S(k) with the oscillation of its tail averaged over one period, in um^4 per rad/um; k in rad/um.

    The same as S(k) below k d = 32, and at every k whose sizes are spread enough to damp the swing; for integrals over
    panels of k wider than a swing. Of regular births it is S(k) itself, which a single size leaves 0.
    Source: as `spectral_density`, with the transform of `PulseTransform.mean_square`.
    """
    return _density(model, wavenumber, 1.0, 1.0, exact=False)


def force_spectral_density(model: Model, strengths: Law, wavenumber: ArrayLike, *, exact: bool = True) -> Doubles:
    """Return the two-sided spectral density of friction force in uN^2 per rad/um, strengths psi independent of sizes.

    lam E[psi^2] E[|A^|^2], less lam E[psi]^2 |E[A^]|^2 for regular births, whose lines carry that. Not ``exact``, it is
    averaged as `mean_spectral_density`. Under a load that weighs, Var[psi] + E[psi]^2 |r|^2 takes the place of E[psi^2]
    (`rubnoise.theory.drive.force_power`). Source: as `spectral_density`, for the pulse psi A of paper Eq. (1).
    """
    if model.separation is not None:
        k = np.abs(np.asarray(wavenumber, dtype=np.float64))
        return _density(model, k, 1.0, 1.0, exact=exact) * force_power(model, strengths, k)
    return _density(model, wavenumber, strengths.moment(2), strengths.mean**2, exact=exact)


def density_at_zero(model: Model) -> float:
    """Return S(0) in um^4 per rad/um: lam c_1^2 m_6, from the exact sixth moment of the size law.

    Regular births have lam c_1^2 (m_6 - m_3^2), passes off the centre line the mean square of int A ds for c_1^2.
    """
    if are_at_random(model):
        return model.birth_rate * model.pulse.squared_integral * model.sizes.moment(6)
    return float(spectral_density(model, 0.0))


def _density(model: Model, wavenumber: ArrayLike, square: float, squared_mean: float, *, exact: bool) -> Doubles:
    """Return the density for E[psi^2] and E[psi]^2; for regular births from parts of which none is negative."""
    k = np.abs(np.asarray(wavenumber, dtype=np.float64))
    if are_at_random(model) or has_noise_of_its_own(model):
        at_random = model.birth_rate * square * mean_energy(model.sizes, model.pulse, k, exact=exact)
        if not has_noise_of_its_own(model):
            return at_random
        return at_random + squared_mean * excess_density(model, k, exact=exact)
    unequal = squared_mean * energy_spread(model.sizes, model.pulse, k)
    if square > squared_mean:
        unequal = unequal + (square - squared_mean) * mean_energy(model.sizes, model.pulse, k, exact=exact)
    return model.birth_rate * unequal


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
    """Return the level about which S(k) falls off, in um^4 per rad/um, k > 0 in rad/um; two-sided.

    It is lam j m_2 / k^4 for passes through both centres, and lam (9 pi^2/16) m_1 / k^5 for those off the centre line.
    j is 4 for the lens, 3 pi^2 / 8 for the triangle and pi^2 / 2 for the parabola, the sum of the squares of the jumps
    of slope over a life of unit diameter. S swings about it, the lens by a factor 1 + 2.5 / sqrt(k d) for one size, the
    others wholly; spread damps that. Raises Refused unless births are a Poisson process.
    Source: Watson's lemma for the kinks of paper Eq. (2).
    """
    need_random_births(model, "the tail of the spectrum")
    k = np.asarray(wavenumber, dtype=np.float64)
    factor, power = model.pulse.tail
    return model.birth_rate * factor * model.sizes.moment(6 - power) / k**power


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


_ROUNDING = 1e-26


def visible_lines(model: Model) -> tuple[Doubles, Doubles]:
    """Return wavenumbers in rad/um and powers in um^4 of the lines above 1e-26 of the squared mean area.

    Of triangles of one size every second line, or all of them, should be 0 and is left over from sums that cancel.
    Equation and source are those of `rubnoise.theory.regular_births.spectral_lines`; none for births at random.
    """
    wavenumber, power = spectral_lines(model)
    seen = power > _ROUNDING * model.stationary_mean_area**2
    return wavenumber[seen], power[seen]
