"""Exact theory of two Gaussian surfaces that slide on each other: areas, junctions, lives and the noise of the area.

Contact is where z(x, y; s) = h1(x + s, y) + h2(x, y) exceeds the gap D = u sigma: an excursion set of one Gaussian
field in (x, y, s). h1 is the track, h2 the slider. Sources: Rice (1944), Adler, The Geometry of Random Fields (1981,
chapter 4.6, for the mean Euler characteristics), Nayak (1971, doi:10.1115/1.3451608).
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import exp, inf, log, pi, sqrt
from typing import Final

import numpy as np
from scipy import ndimage
from scipy.special import ndtr, ndtri, owens_t

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled
from rubnoise.surface.waves import Waves

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
