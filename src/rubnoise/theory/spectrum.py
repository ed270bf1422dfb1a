"""The spectral density of real contact area and friction force: pulses of one shape and many sizes."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.pulse_energy import energy_spread, mean_energy
from rubnoise.theory.random_births import are_at_random

Doubles = NDArray[np.float64]


def spectral_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return the two-sided spectral density S(k) of real contact area in um^4 per rad/um, for any shape of k in rad/um.

    S(k) = lam E[|A^(k)|^2], with R(tau) = (1/2 pi) int S(k) exp(i k tau) dk and lam the birth rate; |A^(k)| is
    pi d |H_1(k d)| / k^2 for the lens and (pi/4) d^3 (sin(k d/2) / (k d/2))^2 for the triangle. S(0) is finite. Regular
    births have the continuous part S(k) = lam (E[|A^(k)|^2] - |E[A^(k)]|^2), A^ about the birth, and the lines of
    `rubnoise.theory.lines.spectral_lines`.
    Source: Carson's theorem (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x); for regular births Campbell's theorem
    given the phase, under which the lives are independent.
    """
    return _density(model, wavenumber, 1.0, 1.0, exact=True)


def mean_spectral_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return S(k) with the swing of its tail averaged over one period, in um^4 per rad/um; k in rad/um.

    The same as S(k) below k d = 32, and at every k whose sizes are spread enough to damp the swing; for integrals over
    panels of k wider than a swing. Of regular births it is S(k) itself, which a single size leaves 0.
    Source: as `spectral_density`, with the transform of `PulseTransform.mean_square`.
    """
    return _density(model, wavenumber, 1.0, 1.0, exact=False)


def force_spectral_density(model: Model, strengths: Law, wavenumber: ArrayLike, *, exact: bool = True) -> Doubles:
    """Return the two-sided spectral density of friction force in uN^2 per rad/um, strengths psi independent of sizes.

    lam E[psi^2] E[|A^|^2], less lam E[psi]^2 |E[A^]|^2 for regular births, whose lines carry that. Not ``exact``, it is
    averaged as `mean_spectral_density`. Source: as `spectral_density`, for the pulse psi A of paper Eq. (1).
    """
    return _density(model, wavenumber, strengths.moment(2), strengths.mean**2, exact=exact)


def density_at_zero(model: Model) -> float:
    """Return S(0) in um^4 per rad/um: lam c_1^2 m_6, from the exact sixth moment of the size law.

    Regular births have lam c_1^2 (m_6 - m_3^2).
    """
    if are_at_random(model):
        return model.birth_rate * model.pulse.life_integral(1) ** 2 * model.sizes.moment(6)
    return float(spectral_density(model, 0.0))


def _density(model: Model, wavenumber: ArrayLike, square: float, squared_mean: float, *, exact: bool) -> Doubles:
    """Return the density for E[psi^2] and E[psi]^2; for regular births from parts that are none of them negative."""
    k = np.abs(np.asarray(wavenumber, dtype=np.float64))
    if are_at_random(model):
        return model.birth_rate * square * mean_energy(model.sizes, model.pulse, k, exact=exact)
    unequal = squared_mean * energy_spread(model.sizes, model.pulse, k)
    if square > squared_mean:
        unequal = unequal + (square - squared_mean) * mean_energy(model.sizes, model.pulse, k, exact=exact)
    return model.birth_rate * unequal
