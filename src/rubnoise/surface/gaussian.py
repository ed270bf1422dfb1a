"""Exact theory of two Gaussian surfaces that slide on each other: areas, junctions, lives and the noise of the area.

Contact is where z(x, y; s) = h1(x + s, y) + h2(x, y) exceeds the gap D = u sigma: an excursion set of one Gaussian
field in (x, y, s). h1 is the track, h2 the slider. Sources: Rice (1944), Adler, The Geometry of Random Fields (1981,
chapter 4.6, for the mean Euler characteristics), Nayak (1971, doi:10.1115/1.3451608).
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import exp, inf, pi, sqrt
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.special import ndtr, ndtri

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled
from rubnoise.surface.waves import Waves

_CELLS: Final = 8192
"""Of the table of the inner integral; its error, of fourth order, is below 1e-11 of the value at rho = 1."""

_NODES: Final = 6
_FIRST: Final = 64
_MOST_LAGS: Final = 192


@dataclass(frozen=True)
class GaussianContact:
    """The sliding contact of a slider on a track, both Gaussian, at a share of the nominal area in contact.

    ``nominal_area`` A0 in um^2 and ``slider_length`` in um are those of the slider; the track is always fresh.
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
    def roughness(self) -> float:
        """Sigma in um: sigma^2 = sigma_1^2 + sigma_2^2."""
        return sqrt(self.track.variance + self.slider.variance)

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
        return self._count(self.track.variance + self.slider.variance, *self._slopes)

    @property
    def _slopes(self) -> tuple[float, float]:
        (a1, b1), (a2, b2) = self.track.slopes, self.slider.slopes
        return a1 + a2, b1 + b2

    def _count(self, variance: float, along: float, across: float) -> float:
        u = self.level
        return self.nominal_area * (2.0 * pi) ** -1.5 * sqrt(along * across) / variance * u * exp(-0.5 * u * u)

    @cached_property
    def birth_rate(self) -> float:
        """Lam = A0 (2 pi)^-2 sqrt(a1 a2 (b1 + b2))/sigma^3 (u^2 - 1) exp(-u^2/2) births per um; a life is one blob."""
        u = self.level
        slopes = sqrt(self.track.slopes[0] * self.slider.slopes[0] * self._slopes[1])
        return self.nominal_area * (2.0 * pi) ** -2 * slopes / self.roughness**3 * (u * u - 1.0) * exp(-0.5 * u * u)

    @property
    def mean_life(self) -> float:
        """N_jm/lam in um of sliding; inf if one surface is flat along the sliding."""
        return self.junction_count / self.birth_rate if self.birth_rate > 0.0 else inf

    def count_slope(self, cutoff: float) -> float:
        """Return dN_jm/d ln(cutoff) at one share of the area, from the power of the waves at the cut-off (in um).

        Of self-affine surfaces with Hurst exponent H far from their longest waves it is -2 (1 - H) N_jm.
        """
        along, across = self._slopes
        variance = self.roughness**2
        edges = [each.at_edge(cutoff) for each in (self.track, self.slider)]
        d_variance, d_along, d_across = (-sum(edge[i] for edge in edges) for i in range(3))
        return self.junction_count * (0.5 * d_along / along + 0.5 * d_across / across - d_variance / variance)

    @cached_property
    def correlations(self) -> tuple[Doubles, Doubles, tuple[float, float]]:
        """Both autocorrelations over sigma^2 at the lags of one grid, and its spacings: the slider's grid."""
        variance = self.roughness**2
        track = self._at_slider_lags(self.track.correlation())
        return track / variance, self.slider.correlation() / variance, self.slider.spacing

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
    def _integral(self) -> Doubles:
        return _inner_integral(self.level)

    @cached_property
    def _chance(self) -> tuple[float, float, Doubles]:
        """The part of a map's chance in the sum of rho^2 over all lags: of the track, of the slider, of both by shift.

        The power of a wave on one map scatters as much as its mean. Its autocorrelation does not decay to 0, and
        the squares of the rest raise R. Far lags show how much, and it is the same near 0. Both maps share it if one
        surface slides on itself.
        """
        track, slider, _ = self.correlations
        (shares, beyond), none = self._far, np.zeros(slider.shape[0])
        if not any(shares):
            return 0.0, 0.0, none
        far = [np.where(beyond, track, 0.0), np.where(beyond, slider, 0.0)]
        sums = [share * float(np.square(own).sum()) for share, own in zip(shares, far, strict=True)]
        return sums[0], sums[1], self._common(*far)

    @cached_property
    def _far(self) -> tuple[tuple[float, float], NDArray[np.bool_]]:
        """Chance at all lags over that at far lags, of track and slider, 0 of exact spectra; and which lags are far."""
        shape = self.slider.power.shape
        # Which lags, wrapped round, are longer than a quarter of the sides.
        along, across = (np.minimum(np.arange(n), n - np.arange(n)) / n for n in shape)
        beyond = np.hypot(along[:, None], across[None, :]) > 0.25
        if self.track.scatter is None or self.slider.scatter is None:
            return (0.0, 0.0), beyond
        scatters = (self._at_slider_lags(self.track.scatter), self.slider.scatter)
        return (
            float(scatters[0].sum() / scatters[0][beyond].sum()),
            float(scatters[1].sum() / scatters[1][beyond].sum()),
        ), beyond

    def _common(self, track: Doubles, slider: Doubles) -> Doubles:
        """Return by shift the sum of the product of two maps' far lags, as much as all lags have."""
        common = np.fft.ifft((np.fft.fft(track, axis=0) * np.fft.fft(slider, axis=0).conj()).sum(1)).real
        shares, _ = self._far
        return np.asarray(common * sqrt(shares[0] * shares[1]))

    @cached_property
    def gradients(self) -> tuple[Doubles, Doubles]:
        """dC/dx over sigma^2 in 1/um of both surfaces at the lags of `correlations`, by their waves."""
        track, slider, spacing = self.correlations
        waves = 2j * pi * np.fft.fftfreq(slider.shape[0], spacing[0])[:, None]
        one, other = (np.fft.ifft(np.fft.fft(each, axis=0) * waves, axis=0).real for each in (track, slider))
        return np.ascontiguousarray(one), np.ascontiguousarray(other)

    @cached_property
    def chance_of_slopes(self) -> Doubles:
        """By shift, the chance in the sum of phi2' C_1x C_2x over all lags: phi2'(u, u; 0) times that of far lags."""
        (shares, beyond), gradients = self._far, self.gradients
        if not any(shares):
            return np.zeros(beyond.shape[0])
        second = self.level**2 * exp(-(self.level**2)) / (2.0 * pi)
        return second * self._common(*(np.where(beyond, each, 0.0) for each in gradients))

    def _summed(self, shift: int, which: tuple[bool, bool] = (True, True)) -> float:
        """Return A0 int int [int_0^rho phi2 dr] dx dy at a lag of ``shift`` points, in um^4, on an endless track.

        ``which`` of both autocorrelations count. The part of a single map's chance is subtracted, to second order.
        """
        track, slider, spacing = self.correlations
        maps = [own if counts else np.zeros_like(own) for own, counts in zip((track, slider), which, strict=True)]
        of_track, of_slider, of_both = self._chance
        chance = which[0] * of_track + which[1] * of_slider + 2.0 * all(which) * float(of_both[shift % of_both.size])
        second = 0.5 * self.level**2 * exp(-(self.level**2)) / (2.0 * pi)
        summed = _sum_over_lags(maps[0], maps[1], shift, self._integral) - second * chance
        return self.nominal_area * spacing[0] * spacing[1] * summed

    @cached_property
    def ensemble_variance(self) -> float:
        """R(0) in um^4: over all sliders and all tracks."""
        return self._summed(0)

    @cached_property
    def frozen_variances(self) -> tuple[float, float]:
        """(J_1, J_2) in um^4: J_i = A0 int int int_0^(C_i/sigma^2) phi2 dr dx dy, of the track and of the slider.

        J_2 is frozen for ever: the mean differs from slider to slider. J_1 is that of the track below the slider, which
        changes when the slider moves by its length.
        """
        return self._summed(0, (True, False)), self._summed(0, (False, True))

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

    @cached_property
    def curve(self) -> tuple[Doubles, Doubles]:
        """Lags in um up to half of the slider's map, and R(lag) - J_1 - J_2 in um^4, the covariance in a short run."""
        points, spacing = self.correlations[1].shape[0] // 2, self.correlations[2][0]
        far = np.geomspace(_FIRST, max(points, _FIRST + 1), _MOST_LAGS - _FIRST)
        shifts = np.unique(np.concatenate((np.arange(_FIRST), far.astype(np.int64))))
        shifts = shifts[shifts <= points]
        frozen = sum(self.frozen_variances)
        return shifts * spacing, np.array([self._summed(int(each)) for each in shifts]) - frozen

    def autocovariance(self, lag: Doubles) -> Doubles:
        """Return R(tau) - J_2 in um^4 of a slider of its length on a fresh track, the covariance in a long run.

        R(tau) = `curve` + J_1 max(0, 1 - tau/L_x) + J_2, L_x the slider's length; lags in um up to half of the map.
        """
        lags, moving = self.curve
        track = self.frozen_variances[0]
        return np.interp(np.abs(lag), lags, moving) + track * np.maximum(0.0, 1.0 - np.abs(lag) / self.slider_length)

    def spectrum(self, wavenumber: Doubles) -> Doubles:
        """Return S(k) in um^5 of a short run: int R exp(-i k tau) dtau, two-sided, k in rad/um.

        R is `curve` under Parzen's window, which ends at twice the first lag without correlation: no power is negative.
        """
        from scipy.interpolate import CubicSpline

        lags, moving = self.curve
        zero = int(np.argmax(moving <= 0.0)) if (moving <= 0.0).any() else lags.size - 1
        lag = np.arange(0.0, min(2.0 * lags[zero], lags[-1]), self.correlations[2][0])
        x = lag / lag[-1]
        window = np.where(x < 0.5, 1.0 - 6.0 * x * x * (1.0 - x), 2.0 * (1.0 - x) ** 3)
        even = CubicSpline(lags, moving)(lag) * window * self.correlations[2][0]
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

    def with_cutoff(self, cutoff: float) -> Self:
        """Return the contact without waves shorter than ``cutoff`` in um, at the same share of the area."""
        track, slider = (each.below(cutoff) for each in (self.track, self.slider))
        return type(self)(track, slider, self.share, self.nominal_area, self.slider_length)


def half_width(lags: Doubles, values: Doubles) -> float:
    """Return the first lag at which a curve is half of its first value, by a spline; nan if there is none."""
    from scipy.interpolate import CubicSpline

    roots = CubicSpline(lags, values).solve(0.5 * float(values[0]), extrapolate=False)
    return float(roots.min()) if roots.size else float("nan")


def _inner_integral(level: float) -> Doubles:
    """Return g = int_0^rho phi2(u, u; r) dr with its slope, at even steps of v = sqrt((1 - rho)/2) from 0 to 1.

    phi2 = exp(-u^2/(1 + r))/(2 pi sqrt(1 - r^2)); with r = sin t it is int exp(-u^2/(1 + sin t)) dt/(2 pi), by Gauss's
    rule on each step of t. In v the integral has no root at rho = 1.
    """
    v = np.linspace(0.0, 1.0, _CELLS + 1)
    t = 0.5 * pi - 2.0 * np.arcsin(v)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    middle, half = 0.5 * (t[:-1] + t[1:]), 0.5 * (t[1:] - t[:-1])
    pieces = (weights * half[:, None] * _density(level, middle[:, None] + half[:, None] * nodes)).sum(1)
    whole = np.concatenate(([0.0], np.cumsum(pieces)))
    i = int(np.searchsorted(-t, 0.0)) - 1  # rho = 0 lies in this step
    at_zero = whole[i] - 0.5 * t[i] * float(weights @ _density(level, 0.5 * t[i] * (1.0 - nodes)))
    slope = -2.0 * _density(level, t) / np.sqrt(np.maximum(1.0 - v * v, 1e-12))
    return np.stack((whole - at_zero, slope / _CELLS), axis=1)


def _density(level: float, t: Doubles) -> Doubles:
    below = 1.0 + np.sin(t)
    return np.exp(-(level * level) / np.maximum(below, 1e-300)) / (2.0 * pi)


@compiled
def _sum_over_lags(track: Doubles, slider: Doubles, shift: int, integral: Doubles) -> float:
    """Return the sum over (x, y) of g(C1(x + shift, y) + C2(x, y)), correlations over sigma^2, by cubics."""
    along, across = slider.shape
    cells = integral.shape[0] - 1
    total = 0.0
    for i in range(along):
        moved = (i + shift) % along
        row = 0.0
        for j in range(across):
            square = 0.5 * (1.0 - track[moved, j] - slider[i, j])
            place = cells * np.sqrt(min(max(square, 0.0), 1.0))
            cell = min(int(place), cells - 1)
            x = place - cell
            y = 1.0 - x
            row += y * y * ((1.0 + 2.0 * x) * integral[cell, 0] + x * integral[cell, 1]) + x * x * (
                (3.0 - 2.0 * x) * integral[cell + 1, 0] - y * integral[cell + 1, 1]
            )
        total += row
    return total
