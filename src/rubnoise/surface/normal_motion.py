"""The normal motion of a slider on two Gaussian surfaces under a load, to first order, from their spectra.

At constant load the gap D follows the area A(s) at a constant gap: D less its mean is s_0 (A/A_rm - 1), with the
height scale s_0. With a mass m and a dashpot it does so through m z'' + c z' + (W/s_0) z = W (A/A_rm - 1), as in
`rubnoise.theory.load` for junctions. Source: Rice (1944) for the slope of a Gaussian field's excursion area.
"""

from dataclasses import dataclass
from math import exp, pi, sqrt
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled
from rubnoise.surface.gaussian import GaussianContact
from rubnoise.theory.load import level

_NEAR: Final = 64
_MOST_LAGS: Final = 128
_FINER: Final = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class NormalMotion:
    """Standard deviations of the gap in um and of its velocity in um/s, to first order."""

    separation_std: float
    velocity_std: float

    @property
    def velocity_level(self) -> float:
        """Level of the velocity in dB re 50 nm/s."""
        return level(self.velocity_std)


def gap_slope(contact: GaussianContact) -> float:
    """Return the root mean square of dD/ds at constant load: s_0 sqrt(-R''(0))/A_rm, exact to first order."""
    return contact.height_scale * sqrt(_slope_variance(contact)) / contact.real_contact_area


def normal_motion(contact: GaussianContact, *, load: float, speed: float, mass: float, ratio: float) -> NormalMotion:
    """Return the motion of a slider of ``mass`` in kg at a ``speed`` in um/s under a ``load`` in uN.

    The variance of the gap is int R(tau) K(tau) dtau s_0^2/A_rm^2, that of its velocity V^2 int -R''(tau) K(tau) dtau
    s_0^2/A_rm^2, with K the autocorrelation of the oscillator's response to an impulse, whose integral is 1; ``ratio``
    is its damping ratio, above 0. R is that of a run much shorter than the slider.
    """
    from scipy.interpolate import CubicSpline

    scale = contact.height_scale / contact.real_contact_area
    resonance = sqrt(load / (contact.height_scale * mass)) / speed  # in rad per um of sliding
    lags, moving = contact.curve
    fine = np.linspace(0.0, lags[-1], _FINER * lags.size)
    area = CubicSpline(lags, moving, bc_type=((1, 0.0), "not-a-knot"))(fine)
    gap = filtered_variance(fine, area, resonance, ratio)
    # What has decayed long before the slider answers is better known by R than by -R'', whose integral is 0.
    fast = resonance * contact.correlation_length < 1.0
    slope = (
        filtered_variance(fine, area, resonance, ratio, of_slope=True)
        if fast
        else filtered_variance(*_slope_curve(contact), resonance, ratio)
    )
    return NormalMotion(separation_std=scale * sqrt(max(gap, 0.0)), velocity_std=speed * scale * sqrt(max(slope, 0.0)))


def filtered_variance(
    lags: Doubles, values: Doubles, resonance: float, ratio: float, *, of_slope: bool = False
) -> float:
    """Return 2 int_0^L f(tau) K(tau) dtau of a covariance f that is straight between its lags, K as in `normal_motion`.

    K = (w/(4 zeta)) (p_2 e^(p_1 tau) - p_1 e^(p_2 tau))/(p_2 - p_1), p = -w (zeta -+ sqrt(zeta^2 - 1)); ``of_slope``
    gives the variance of the output's slope, with -K'' for K.
    """
    root = np.sqrt(complex(ratio * ratio - 1.0)) or 1e-6j  # critical damping, by its neighbour
    poles = -resonance * (ratio - root), -resonance * (ratio + root)
    slopes = np.diff(values) / np.diff(lags)

    def transform(pole: complex) -> complex:
        waves = np.exp(pole * lags)
        return complex((values[-1] * waves[-1] - values[0] - (slopes * np.diff(waves)).sum() / pole) / pole)

    first, second = map(transform, poles)
    if of_slope:
        first, second = -(poles[0] ** 2) * first, -(poles[1] ** 2) * second
    both = (poles[1] * first - poles[0] * second) / (poles[1] - poles[0])
    return float(0.5 * resonance / ratio * both.real)


def _slope_curve(contact: GaussianContact) -> tuple[Doubles, Doubles]:
    """Return lags in um and -R''(lag) in um^2: exact at 0, and at others where the sum over the map is smooth."""
    (track, slider), points = contact.gradients, contact.correlations[1].shape[0] // 2
    far = np.geomspace(_NEAR, max(points, _NEAR + 1), _MOST_LAGS - _NEAR)
    shifts = np.unique(np.concatenate((np.arange(2, _NEAR), far.astype(np.int64))))
    shifts = shifts[shifts <= points]
    maps, spacing, chance = contact.correlations, contact.correlations[2], contact.chance_of_slopes
    area = contact.nominal_area * spacing[0] * spacing[1]
    sums = [
        area * (_sum_of_slopes(maps[0], maps[1], track, slider, int(each), contact.level) - chance[each])
        for each in shifts
    ]
    return np.concatenate(([0], shifts)) * spacing[0], np.array([_slope_variance(contact), *sums])


def _slope_variance(contact: GaussianContact) -> float:
    """Return -R''(0) = A0 int int phi2'(u, u; rho) C_1x C_2x dx dy in um^2, C_ix = d(C_i/sigma^2)/dx.

    Near lag 0 the integrand is e^(-u^2/2)/(2 pi) a_1 a_2 x^2/(a x^2 + b y^2)^1.5, slopes over sigma. That part, times
    exp(-(a x^2 + b y^2)/2), has the integral below; the rest is smooth enough for a sum over the points. The product of
    the maps' chance at far lags, where phi2' is constant, is subtracted.
    """
    track, slider, spacing = contact.correlations
    u = contact.level
    (a1, b1), (a2, b2) = (np.array(each.slopes) / contact.roughness**2 for each in (contact.track, contact.slider))
    x, y = (np.fft.fftfreq(n, 1.0 / n) * step for n, step in zip(slider.shape, spacing, strict=True))
    square = (a1 + a2) * np.square(x)[:, None] + (b1 + b2) * np.square(y)[None, :]
    square[0, 0] = 1.0  # where x = 0, so that nothing is counted
    factor = exp(-0.5 * u * u) / (2.0 * pi) * a1 * a2
    near = factor * np.square(x)[:, None] / square**1.5 * np.exp(-0.5 * square)
    of_near = factor * pi * sqrt(0.5 * pi) / ((a1 + a2) * sqrt((a1 + a2) * (b1 + b2)))
    summed = _sum_of_slopes(track, slider, *contact.gradients, 0, u) - near.sum() - contact.chance_of_slopes[0]
    return float(contact.nominal_area * (summed * spacing[0] * spacing[1] + of_near))


@compiled
def _sum_of_slopes(
    track: Doubles, slider: Doubles, by_track: Doubles, by_slider: Doubles, shift: int, u: float
) -> float:
    """Return the sum of phi2'(u, u; rho) C_1x(x + shift) C_2x(x) over all points but those at rho = 1."""
    along, across = slider.shape
    total = 0.0
    for i in range(along):
        moved = (i + shift) % along
        row = 0.0
        for j in range(across):
            rho = track[moved, j] + slider[i, j]
            left = 1.0 - rho * rho
            if left > 1e-12:
                chance = np.exp(-u * u / (1.0 + rho)) / (2.0 * np.pi * np.sqrt(left))
                row += (
                    chance * (u * u / ((1.0 + rho) * (1.0 + rho)) + rho / left) * by_track[moved, j] * by_slider[i, j]
                )
        total += row
    return total
