"""The normal motion of a slider on two Gaussian surfaces under a load, to first order, from their spectra.

At constant load the gap D less its mean is s_0 (A/A_rm - 1); with a mass and a dashpot as in `theory.coupling`.
Source: Rice (1944) for the slope of a Gaussian field's excursion area.
"""

from dataclasses import dataclass
from functools import cached_property
from math import exp, pi, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.surface.gaussian import GaussianContact
from rubnoise.theory.coupling import level


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
    return contact.height_scale * sqrt(_Slopes(contact).variance) / contact.real_contact_area


def normal_motion(contact: GaussianContact, *, load: float, speed: float, mass: float, ratio: float) -> NormalMotion:
    """Return the motion of a slider of ``mass`` in kg at a ``speed`` in um/s under a ``load`` in uN.

    Var D = int R(tau) K(tau) dtau s_0^2/A_rm^2, of the velocity V^2 times the same of -R'', K the autocorrelation of
    the oscillator's response to an impulse, of damping ``ratio`` above 0; R is that of a run much shorter than the
    slider.
    """
    from scipy.interpolate import CubicSpline

    scale = contact.height_scale / contact.real_contact_area
    resonance = sqrt(load / (contact.height_scale * mass)) / speed  # in rad per um of sliding
    lags, moving = contact.curve
    fine = np.linspace(0.0, lags[-1], 8 * lags.size)
    area = CubicSpline(lags, moving, bc_type=((1, 0.0), "not-a-knot"))(fine)
    gap = filtered_variance(fine, area, resonance, ratio)
    # What has decayed long before the slider answers is better known by R than by -R'', whose integral is 0.
    if resonance * contact.correlation_length < 1.0:
        slope = filtered_variance(fine, area, resonance, ratio, of_slope=True)
    else:
        slope = filtered_variance(*_Slopes(contact).curve(), resonance, ratio)
    return NormalMotion(separation_std=scale * sqrt(max(gap, 0.0)), velocity_std=speed * scale * sqrt(max(slope, 0.0)))


def filtered_variance(
    lags: Doubles, values: Doubles, resonance: float, ratio: float, *, of_slope: bool = False
) -> float:
    """Return 2 int_0^L f(tau) K(tau) dtau of a covariance f that is straight between its lags, or with -K'' for K.

    K = (w/(4 zeta)) (p_2 e^(p_1 tau) - p_1 e^(p_2 tau))/(p_2 - p_1), p = -w (zeta -+ sqrt(zeta^2 - 1)).
    """
    root = np.sqrt(complex(ratio * ratio - 1.0)) or 1e-6j  # critical damping, by its neighbour
    poles = -resonance * np.array([ratio - root, ratio + root])
    waves = np.exp(poles[:, None] * lags)
    bends = (np.diff(waves) * (np.diff(values) / np.diff(lags))).sum(1) / poles
    transforms = (values[-1] * waves[:, -1] - values[0] - bends) / poles
    if of_slope:
        transforms *= -(poles**2)
    both = (poles[1] * transforms[0] - poles[0] * transforms[1]) / (poles[1] - poles[0])
    return float(0.5 * resonance / ratio * both.real)


class _Slopes:
    """The slope of the area: -R''(tau) = A0 int int phi2'(u, u; rho) C_1x C_2x dx dy, C_ix = d(C_i/sigma^2)/dx."""

    def __init__(self, contact: GaussianContact) -> None:
        self.contact = contact
        along = contact.correlations[0].shape[0]
        waves = 2j * pi * np.fft.fftfreq(along, contact.slider.spacing[0])[:, None]
        self.gradients = [np.fft.ifft(np.fft.fft(each, axis=0) * waves, axis=0).real for each in contact.correlations]
        self.chances = [own * part for own, part in zip(self.gradients, contact.chance, strict=True)]

    def summed(self, shift: int) -> float:
        """Return the sum of phi2' C_1x C_2x over all lags but rho = 1, less chance, at a lag in points."""
        u, (track, slider) = self.contact.level, self.contact.correlations
        above = np.maximum(1.0 + np.roll(track, -shift, axis=0) + slider, 1e-9)
        left = np.maximum((2.0 - above) * above, 1e-12)
        density = np.exp(-u * u / above) / (2.0 * pi * np.sqrt(left)) * ((u / above) ** 2 + (above - 1.0) / left)
        slopes, chance = (np.roll(one, -shift, axis=0) * other for one, other in (self.gradients, self.chances))
        return float((density * slopes - u * u * exp(-u * u) / (2.0 * pi) * chance).sum())

    @cached_property
    def variance(self) -> float:
        """-R''(0) in um^2, exact: what is singular at lag 0 has a known integral, the rest is smooth enough for a sum.

        That part is e^(-u^2/2)/(2 pi) a_1 a_2 x^2/(a x^2 + b y^2)^1.5 exp(-(a x^2 + b y^2)/2), slopes over sigma.
        """
        contact = self.contact
        _, slopes, others = (contact.moments / contact.roughness**2).T
        a, b = slopes.sum(), others.sum()
        grid = zip(contact.slider.power.shape, contact.slider.spacing, strict=True)
        x, y = np.ix_(*(np.fft.fftfreq(n, 1.0 / n) * step for n, step in grid))
        square = a * x * x + b * y * y
        square[0, 0] = 1.0  # where x = 0, so that nothing is counted
        factor = exp(-0.5 * contact.level**2) / (2.0 * pi) * slopes.prod()
        near = factor * x * x / square**1.5 * np.exp(-0.5 * square)
        of_near = contact.nominal_area * factor * pi * sqrt(0.5 * pi) / (a * sqrt(a * b))
        return float(contact.cell * (self.summed(0) - near.sum()) + of_near)

    def curve(self) -> tuple[Doubles, Doubles]:
        """Return lags in um and -R''(lag) in um^2, at 0 and where the sum over the map is smooth."""
        shifts = self.contact.shifts(2, 64, 128)
        values = [self.contact.cell * self.summed(int(each)) for each in shifts]
        return np.append(0, shifts) * self.contact.slider.spacing[0], np.array([self.variance, *values])
