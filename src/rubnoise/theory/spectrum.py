"""The spectral density of real contact area: shot noise of pulses of one shape and many sizes."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.contact.sizes import SizeLaw
from rubnoise.model import Model
from rubnoise.theory.quadrature import cut_size_rule, size_range
from rubnoise.theory.transform import STEP_END, PulseTransform, transform_of

Doubles = NDArray[np.float64]

_LARGEST_PHASE = 480.0  # k (d_high - d_low) up to which the swing of the spectrum is followed through the sizes
_PANEL_PHASE = 20.0
_FIRST_PHASES = (5.0, 10.0)
_NODES = 24
_AT_ONCE = 256


def spectral_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return the two-sided spectral density S(k) of real contact area in um^4 per rad/um, for any shape of k in rad/um.

    S(k) = lam E[|A^(k)|^2], with R(tau) = (1/2 pi) int S(k) exp(i k tau) dk and lam the birth rate; A^(k) is
    pi d H_1(k d) / k^2 for the lens and (pi/4) d^3 (sin(k d/2) / (k d/2))^2 for the triangle. S(0) is finite.
    Source: Carson's theorem (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    return _by_size(model, wavenumber, exact=True)


def mean_spectral_density(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return S(k) with the swing of its tail averaged over one period, in um^4 per rad/um; k in rad/um.

    The same as S(k) below k d = 32, and at every k whose sizes are spread enough to damp the swing; for integrals over
    panels of k wider than a swing. Source: as `spectral_density`, with the transform of `PulseTransform.mean_square`.
    """
    return _by_size(model, wavenumber, exact=False)


def density_at_zero(model: Model) -> float:
    """Return S(0) = lam c_1^2 m_6 in um^4 per rad/um, from the exact sixth moment of the size law."""
    return model.birth_rate * model.pulse.life_integral(1) ** 2 * model.sizes.moment(6)


def largest_swinging_wavenumber(law: SizeLaw) -> float:
    """Return the wavenumber in rad/um beyond which sizes are averaged over the swing; inf for one size.

    At k (d_high - d_low) = 480 a normal law of standard deviation sigma has k sigma > 25, and its spread leaves a
    factor exp(-320) of the swing; a gamma law with sigma = mean/10 has k sigma = 11. A law so wide that it has phases
    below 160 beside larger ones is smooth enough for the step of `PulseTransform.mean_square`.
    """
    low, high = size_range(law)
    return np.inf if low == high else _LARGEST_PHASE / (high - low)


def _by_size(model: Model, wavenumber: ArrayLike, *, exact: bool) -> Doubles:
    wavenumbers = np.abs(np.asarray(wavenumber, dtype=np.float64))
    swinging = wavenumbers <= largest_swinging_wavenumber(model.sizes)
    result = np.empty_like(wavenumbers)
    transform = transform_of(model.pulse)
    square = transform.square if exact else transform.mean_square
    result[swinging] = _in_chunks(lambda k: _resolved(model.sizes, k, square), wavenumbers[swinging])
    result[~swinging] = _in_chunks(lambda k: _damped(model.sizes, k, transform), wavenumbers[~swinging])
    return model.birth_rate * result


def _in_chunks(function: Callable[[Doubles], Doubles], wavenumbers: Doubles) -> Doubles:
    """Apply a function to few wavenumbers at a time, in order of size, so that memory and nodes stay few."""
    order = np.argsort(wavenumbers)
    result = np.empty_like(wavenumbers)
    for first in range(0, order.size, _AT_ONCE):
        rows = order[first : first + _AT_ONCE]
        result[rows] = function(wavenumbers[rows])
    return result


def _resolved(law: SizeLaw, wavenumbers: Doubles, square: Callable[[Doubles], Doubles]) -> Doubles:
    """Return E[|A^(k)|^2] with diameters close enough to follow the swing."""
    (low, high), fastest = size_range(law), float(wavenumbers.max())
    phases = np.append(_FIRST_PHASES, np.arange(_PANEL_PHASE, fastest * (high - low), _PANEL_PHASE))
    cuts = low + phases / max(fastest, 1.0 / high)
    diameters, probabilities = cut_size_rule(law, cuts, _NODES)
    return square(np.multiply.outer(wavenumbers, diameters)) @ (probabilities * diameters**6)


def _damped(law: SizeLaw, wavenumbers: Doubles, transform: PulseTransform) -> Doubles:
    """Return E[|A^(k)|^2] where the swing averages out: small diameters resolved, the rest by their mean over a swing.

    Small diameters matter where a spread as large as the mean leaves the density an edge at d = 0.
    """
    phases = np.append(_FIRST_PHASES, np.arange(_PANEL_PHASE, STEP_END + 1.0, _PANEL_PHASE))
    cuts = phases / wavenumbers[:, None]
    diameters, probabilities = cut_size_rule(law, cuts, _NODES)
    return np.sum(transform.mean_square(wavenumbers[:, None] * diameters) * probabilities * diameters**6, axis=-1)
