"""The waves of a surface: cut-off wavelengths, its power and autocorrelation, and self-affine surfaces from a seed."""

from dataclasses import dataclass, field
from math import inf
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.streams import Stream, philox
from rubnoise.surface.height_map import FEWEST_POINTS, HeightMap

MOST_POINTS: Final = 8192  # a side of a synthetic map: it takes half a GB, and its transform twice as much


def band_limited(surface: HeightMap, cutoff: float, longest: float | None = None) -> HeightMap:
    """Return a map without waves shorter than ``cutoff`` and longer than ``longest`` (both in um) and without mean.

    The limit is sharp. A map that is not periodic is continued by its mirror image at each edge (a cosine transform).
    Raises Refused for a cut-off below two points or above half of the scan, and for limits without waves between.
    """
    points, half = 2.0 * max(surface.spacing), 0.5 * min(surface.size)
    if not points * (1.0 - 1e-9) <= cutoff <= half:
        outside = f"{cutoff:.6g} um is not between two points, {points:.4g} um, and half the scan, {half:.4g} um"
        raise Refused(f"{surface.name}: cutoff=: {outside}")
    if longest is not None and not cutoff < longest:
        raise Refused(f"longest=: {longest:.6g} um leaves no waves; it has to be above the cut-off, {cutoff:.6g} um")
    if surface.periodic:
        kept = _kept(*frequencies(surface.heights.shape, surface.spacing), cutoff, longest)
        heights = fft.ifft2(fft.fft2(surface.heights) * kept).real
    else:
        sides = zip(surface.heights.shape, surface.size, strict=True)
        along, across = np.ix_(*(0.5 * np.arange(n) / side for n, side in sides))
        heights = fft.idctn(fft.dctn(surface.heights) * _kept(along, across, cutoff, longest))
    if not np.ptp(heights) > 1e-12 * np.ptp(surface.heights):
        raise Refused(f"{surface.name}: no waves are left between the cut-off and the longest wave")
    limit = "" if longest is None else f", and longer than {longest:.6g} um"
    return surface.changed(heights, f"waves shorter than {cutoff:.6g} um removed{limit}")


def frequencies(shape: tuple[int, ...], spacing: tuple[float, float]) -> tuple[Doubles, Doubles]:
    """Return the frequencies of a discrete transform in cycles per um: a column along the sliding, a row across."""
    along, across = np.ix_(*(fft.fftfreq(n, step) for n, step in zip(shape, spacing, strict=True)))
    return along, across


def _kept(along: Doubles, across: Doubles, cutoff: float, longest: float | None = None) -> NDArray[np.bool_]:
    frequency = np.hypot(along, across)
    lowest = (1.0 - 1e-9) / (longest or inf)
    return (frequency > 0.0) & (frequency >= lowest) & (frequency <= (1.0 + 1e-9) / cutoff)


@dataclass(frozen=True, eq=False)
class Waves:
    """The power of a surface by wave, ``power`` S in um^2 on the grid of the discrete transform, its sum the variance.

    ``scatter``: how the chance of one map spreads over the lags of its autocorrelation, 1 at lag 0; None of an exact
    spectrum. Source: Nayak (1971, doi:10.1115/1.3451608).
    """

    power: Doubles = field(repr=False)
    spacing: tuple[float, float]
    scatter: Doubles | None = field(default=None, repr=False)

    @classmethod
    def of(cls, surface: HeightMap) -> Self:
        """Return the power of a map; one that is not periodic is tapered by Hann's window, its variance kept."""
        heights = surface.heights - surface.heights.mean()
        variance, scatter = float(np.square(heights).mean()), np.ones_like(heights)
        if not surface.periodic:
            along, across = np.ix_(*(np.square(np.sin(np.pi * (np.arange(n) + 0.5) / n)) for n in heights.shape))
            weight = along * across
            heights = (heights - (heights * weight).sum() / weight.sum()) * weight
            spread = fft.ifft2(np.square(np.abs(fft.fft2(np.square(weight))))).real
            scatter = spread / spread[0, 0]
        power = np.square(np.abs(fft.fft2(heights)))
        power[0, 0] = 0.0
        return cls(power * (variance / (power.sum() or 1.0)), surface.spacing, scatter)

    def moments(self, cutoff: float | None = None) -> Doubles:
        """Return variance and mean square slopes along and across, S (2 pi f)^2 summed, of waves down to ``cutoff``."""
        along, across = frequencies(self.power.shape, self.spacing)
        power = self.power if cutoff is None else self.power * _kept(along, across, cutoff)
        slopes = [(power * np.square(2.0 * np.pi * each)).sum() for each in (along, across)]
        return np.array([power.sum(), *slopes])

    def correlation(self) -> Doubles:
        """Return C(x, y) = sum S cos(2 pi (f_x x + f_y y)) in um^2 at the points of the grid, lags wrapped round."""
        return fft.ifft2(self.power).real * self.power.size


def self_affine(
    *, points: int, spacing: float, roughness: float, hurst: float, rolloff: float, cutoff: float, seed: int
) -> HeightMap:
    """Return a periodic Gaussian surface of points x points, with equal bits for equal arguments.

    Its power is q^(-2 - 2 H) for frequencies q from 1/rolloff to 1/cutoff, constant below and 0 above (um); its rms
    height is exactly ``roughness`` in um. Source: Jacobs, Junge, Pastewka (2017, doi:10.1088/2051-672X/aa51f8).
    """
    _check(points, spacing, hurst, rolloff, cutoff)
    along, across = np.ix_(fft.fftfreq(points, spacing), fft.rfftfreq(points, spacing))
    frequency = np.maximum(np.hypot(along, across), 1.0 / rolloff)
    amplitude = np.where(_kept(along, across, cutoff), frequency ** (-1.0 - hurst), 0.0)
    noise = np.random.Generator(philox(seed, Stream.SURFACE)).standard_normal((points, points))
    heights = fft.irfft2(fft.rfft2(noise) * amplitude, s=(points, points))
    heights -= heights.mean()
    heights *= roughness / np.sqrt(np.square(heights).mean())
    words = f"self-affine, H = {hurst:g}, waves from {cutoff:g} um to {rolloff:g} um, seed {seed}"
    name, grid = f"synthetic surface {seed}", (spacing, spacing)
    return HeightMap(heights=heights, spacing=grid, periodic=True, name=name, history=(words,))


def _check(points: int, spacing: float, hurst: float, rolloff: float, cutoff: float) -> None:
    if not FEWEST_POINTS <= points <= MOST_POINTS:
        raise Refused(f"points=: {points} is not between {FEWEST_POINTS} and {MOST_POINTS:,}")
    if not 0.0 < hurst <= 1.0:
        raise Refused(f"hurst=: {hurst:g} is not above 0 and at most 1")
    if not 2.0 * spacing <= cutoff <= rolloff <= points * spacing:
        raise Refused(
            f"cutoff=: {cutoff:g} um and rolloff=: {rolloff:g} um have to lie, in this order, between two points,"
            f" {2.0 * spacing:g} um, and the side of the map, {points * spacing:g} um"
        )
