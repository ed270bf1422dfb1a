"""Exact theory of two Gaussian surfaces that slide: areas, junctions, lives, noise, and normal motion under a load."""

from dataclasses import dataclass, field
from functools import cached_property
from math import exp, inf, log, pi, sqrt
from typing import Final

import numpy as np
from scipy import ndimage
from scipy.special import ndtr, ndtri, owens_t

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled
from rubnoise.surface.height_map import Waves
from rubnoise.theory.coupling import level

_CELLS: Final = 1 << 17  # of the table of the inner integral
_RING: Final = 0.8  # where the ring of waves begins that a change of the cut-off changes, over the cut-off frequency


@dataclass(frozen=True)
class GaussianContact:
    """The sliding contact of a slider on an endless track, both Gaussian, with a share of the area in contact.

    ``nominal_area`` A0 in um^2 and ``slider_length`` in um are those of the slider.
    """

    track: Waves = field(repr=False)
    slider: Waves = field(repr=False)
    share: float
    nominal_area: float
    slider_length: float

    @cached_property
    def level(self) -> float:
        """U = D/sigma with Q(u) = A_rm/A0, Q the upper tail of the normal distribution."""
        return float(-ndtri(self.share))

    @cached_property
    def moments(self) -> Doubles:
        """Variance in um^2 and mean square slopes along and across, in rows of track and slider."""
        return np.stack((self.track.moments(), self.slider.moments()))

    @cached_property
    def roughness(self) -> float:
        """Sigma in um: sigma^2 = sigma_1^2 + sigma_2^2."""
        return sqrt(self.moments[:, 0].sum())

    @property
    def height_scale(self) -> float:
        """s_0 = -A/(dA/dD) = sigma Q(u)/phi(u) in um: how fast the area falls with the gap."""
        density = exp(-0.5 * self.level**2) / sqrt(2.0 * pi)
        return self.roughness * self.share / density

    @property
    def real_contact_area(self) -> float:
        """A_rm = A0 Q(u) in um^2."""
        return self.nominal_area * float(ndtr(-self.level))

    @cached_property
    def junction_count(self) -> float:
        """N_jm = A0 (2 pi)^-1.5 sqrt((a1 + a2)(b1 + b2))/sigma^2 u exp(-u^2/2), the mean Euler characteristic."""
        return self._count(self.moments.sum(0))

    def _count(self, moments: Doubles) -> float:
        (variance, along, across), u = moments.tolist(), self.level
        return self.nominal_area * (2.0 * pi) ** -1.5 * sqrt(along * across) / variance * u * exp(-0.5 * u * u)

    @cached_property
    def birth_rate(self) -> float:
        """Lam = A0 (2 pi)^-2 sqrt(a1 a2 (b1 + b2))/sigma^3 (u^2 - 1) exp(-u^2/2) births per um; a life is one blob."""
        u = self.level
        slopes = sqrt(self.moments[:, 1].prod() * self.moments[:, 2].sum())
        return self.nominal_area * (2.0 * pi) ** -2 * slopes / self.roughness**3 * (u * u - 1.0) * exp(-0.5 * u * u)

    @property
    def mean_life(self) -> float:
        """N_jm/lam in um of sliding; inf if one surface is flat along the sliding."""
        return self.junction_count / self.birth_rate if self.birth_rate > 0.0 else inf

    def count_at(self, cutoff: float) -> float:
        """Return N_jm at the same share of the area without waves shorter than ``cutoff`` in um."""
        return self._count(self.track.moments(cutoff) + self.slider.moments(cutoff))

    def count_slope(self, cutoff: float) -> float:
        """Return dN_jm/d ln(cutoff) at one share of the area, from the mean power in a ring at the cut-off (um)."""
        ends = [self.track.moments(each) + self.slider.moments(each) for each in (cutoff, cutoff / _RING)]
        variance, along, across = (ends[0] - ends[1]) / -log(_RING) / self.moments.sum(0)
        return self.junction_count * float(variance - 0.5 * (along + across))

    @cached_property
    def correlations(self) -> tuple[Doubles, Doubles]:
        """Both autocorrelations over sigma^2, of track and slider, at the lags of the slider's grid."""
        variance = self.roughness**2
        return self._at_slider_lags(self.track.correlation()) / variance, self.slider.correlation() / variance

    @property
    def cell(self) -> float:
        """A0 times the area between four of these lags in um^4: what a sum over lags is multiplied by."""
        return self.nominal_area * self.slider.spacing[0] * self.slider.spacing[1]

    def _at_slider_lags(self, values: Doubles) -> Doubles:
        """Return a map over the track's lags at those of the slider: interpolated, and 0 beyond half of the track."""
        shape, spacing, own = self.slider.power.shape, self.slider.spacing, self.track.spacing
        if values.shape == shape and np.allclose(own, spacing, rtol=1e-6):
            return values
        lags = [np.fft.fftfreq(n, 1.0 / n) * step / there for n, step, there in zip(shape, spacing, own, strict=True)]
        inside = [np.abs(lag) <= n // 2 for lag, n in zip(lags, values.shape, strict=True)]
        places = np.meshgrid(*lags, indexing="ij")
        return ndimage.map_coordinates(values, places, order=3, mode="grid-wrap") * np.outer(*inside)

    @cached_property
    def chance(self) -> tuple[Doubles, Doubles]:
        """Weights over the lags that leave of track and slider what is chance of one map; 0 of exact spectra.

        The power of a wave on one map scatters as much as its mean: products of what is left at lags longer than a
        quarter of the sides raise R, and as much near 0.
        """
        along, across = np.ix_(*(np.abs(np.fft.fftfreq(n)) for n in self.slider.power.shape))
        far = (np.hypot(along, across) > 0.25).astype(np.float64)
        if self.track.scatter is None or self.slider.scatter is None:
            return 0.0 * far, 0.0 * far
        scatters = self._at_slider_lags(self.track.scatter), self.slider.scatter
        track, slider = (far * sqrt(each.sum() / ((each * far).sum() or inf)) for each in scatters)
        return track, slider

    @cached_property
    def _integral(self) -> Doubles:
        """Table of g = int_0^rho phi2(u, u; r) dr at even steps of v = sqrt((1 - rho)/2) from 0 to 1.

        g = Q(u) (1 - Q(u)) - 2 T(u, v/sqrt(1 - v^2)), T of Owen (1956); in v there is no root at rho = 1.
        """
        v = np.linspace(0.0, 1.0, _CELLS + 1)
        ratio = v / np.sqrt(np.maximum(1.0 - v * v, 1e-300))
        table = ndtr(self.level) * ndtr(-self.level) - 2.0 * owens_t(self.level, ratio)
        table[1:-1] -= np.diff(table, 2) / 12.0  # by which straight lines between its values lie above it in the mean
        return np.asarray(table)

    @cached_property
    def _parts(self) -> tuple[Doubles, Doubles]:
        """Of track and slider: the correlation, and its part that is chance."""
        track, slider = (np.stack((own, own * part)) for own, part in zip(self.correlations, self.chance, strict=True))
        return track, slider

    def _covariance(self, track: Doubles, slider: Doubles, shift: int = 0) -> float:
        second = 0.5 * self.level**2 * exp(-(self.level**2)) / (2.0 * pi)
        return self.cell * _sum_over_lags(track, slider, shift, self._integral, second)

    def ensemble_covariance(self, shift: int) -> float:
        """Return A0 int int [int_0^rho phi2 dr] dx dy at a lag of ``shift`` points, in um^4, less chance."""
        return self._covariance(*self._parts, shift)

    @cached_property
    def ensemble_variance(self) -> float:
        """R(0) in um^4: over all sliders and all tracks."""
        return self.ensemble_covariance(0)

    @cached_property
    def frozen_variances(self) -> tuple[float, float]:
        """(J_1, J_2) in um^4: J_i = A0 int int int_0^(C_i/sigma^2) phi2 dr dx dy, of the track and of the slider.

        J_2 is frozen for ever; J_1 changes when the slider moves by its length.
        """
        track, slider = self._parts
        return self._covariance(track, np.zeros_like(slider)), self._covariance(np.zeros_like(track), slider)

    @property
    def frozen_share(self) -> float:
        """J_2/R(0): the share of the variance that sliding never shows, since the slider carries its own asperities."""
        return self.frozen_variances[1] / self.ensemble_variance

    @property
    def relative_std(self) -> float:
        """Standard deviation over mean of the area in one run much longer than the slider: sqrt(R(0) - J_2)/A_rm."""
        return sqrt(max(self.ensemble_variance - self.frozen_variances[1], 0.0)) / self.real_contact_area

    @property
    def relative_std_short(self) -> float:
        """The same in one run much shorter than the slider: sqrt(R(0) - J_1 - J_2)/A_rm."""
        return sqrt(max(self.ensemble_variance - sum(self.frozen_variances), 0.0)) / self.real_contact_area

    def shifts(self, first: int, near: int, most: int) -> Integers:
        """Return at most ``most`` lags in points, up to half of the map: all up to ``near``, then ever fewer."""
        points = self.slider.power.shape[0] // 2
        far = np.geomspace(near, max(points, near + 1), most - near).astype(np.int64)
        shifts = np.unique(np.concatenate((np.arange(first, near), far)))
        return shifts[shifts <= points]

    @cached_property
    def curve(self) -> tuple[Doubles, Doubles]:
        """Lags in um up to half of the slider's map, and R(lag) - J_1 - J_2 in um^4, the covariance in a short run."""
        shifts = self.shifts(0, 64, 192)
        moving = np.array([self.ensemble_covariance(int(each)) for each in shifts]) - sum(self.frozen_variances)
        return np.asarray(shifts * self.slider.spacing[0], dtype=np.float64), moving

    def autocovariance(self, lag: Doubles) -> Doubles:
        """Return R(tau) - J_2 in um^4, of a long run: `curve` + J_1 max(0, 1 - tau/L_x), L_x the slider's length."""
        track = self.frozen_variances[0] * np.maximum(0.0, 1.0 - np.abs(lag) / self.slider_length)
        return np.interp(np.abs(lag), *self.curve) + track

    def spectrum(self, wavenumber: Doubles) -> Doubles:
        """Return S(k) in um^5 of a short run: int R exp(-i k tau) dtau, two-sided, k in rad/um.

        R is `curve` under Parzen's window, which ends at twice the first lag without correlation: no power is negative.
        """
        from scipy.interpolate import CubicSpline

        lags, moving = self.curve
        zero = int(np.argmax(moving <= 0.0)) if (moving <= 0.0).any() else lags.size - 1
        lag = np.arange(0.0, min(2.0 * lags[zero], lags[-1]), self.slider.spacing[0])
        x = lag / lag[-1]
        window = np.where(x < 0.5, 1.0 - 6.0 * x * x * (1.0 - x), 2.0 * (1.0 - x) ** 3)
        even = CubicSpline(lags, moving)(lag) * window * self.slider.spacing[0]
        k = np.asarray(wavenumber, dtype=np.float64)[..., None]
        return np.asarray(2.0 * (even * np.cos(k * lag)).sum(-1) - even[0])

    @cached_property
    def correlation_length(self) -> float:
        """The lag in um at which the covariance in a short run has fallen to one half; nan beyond half of the map."""
        return half_width(*self.curve)

    @property
    def load_std(self) -> float:
        """Std D in um at constant load, to first order, of a short run: s_0 sqrt(R(0) - J_1 - J_2)/A_rm."""
        return self.height_scale * self.relative_std_short


def half_width(lags: Doubles, values: Doubles) -> float:
    """Return the first lag at which a curve is half of its first value, by a spline; nan if there is none."""
    from scipy.interpolate import CubicSpline

    roots = CubicSpline(lags, values).solve(0.5 * float(values[0]), extrapolate=False)
    return float(roots.min()) if roots.size else float("nan")


@compiled
def _sum_over_lags(track: Doubles, slider: Doubles, shift: int, table: Doubles, second: float) -> float:
    """Return the sum over (x, y) of g(C1(x + shift, y) + C2(x, y)) less ``second`` times the square of its chance."""
    _, along, across = slider.shape
    cells = table.size - 1
    total = 0.0
    for i in range(along):
        moved = (i + shift) % along
        row = 0.0
        for j in range(across):
            square = 0.5 * (1.0 - track[0, moved, j] - slider[0, i, j])
            place = cells * np.sqrt(min(max(square, 0.0), 1.0))
            cell = min(int(place), cells - 1)
            chance = track[1, moved, j] + slider[1, i, j]
            row += table[cell] + (place - cell) * (table[cell + 1] - table[cell]) - second * chance * chance
        total += row
    return total


# Normal motion under a load.
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
