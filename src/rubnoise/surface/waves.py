"""The waves of a surface: cut-off wavelengths, its spectrum along and across the sliding, and its autocorrelation."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.surface.height_map import HeightMap

RING: Final = 0.8
"""Where the ring of waves begins whose power says what a change of the cut-off changes, over the cut-off frequency."""


def check_wavelengths(surface: HeightMap, cutoff: float, longest: float | None) -> None:
    """Raises Refused for a cut-off below two points or above half of the scan, and for limits without waves between."""
    points, half = 2.0 * max(surface.spacing), 0.5 * min(surface.size)
    if not points * (1.0 - 1e-9) <= cutoff <= half:
        raise Refused(
            f"{surface.name}: cutoff=: {cutoff:.6g} um is not between two points, {points:.4g} um, and half the scan,"
            f" {half:.4g} um"
        )
    if longest is not None and not cutoff < longest:
        raise Refused(f"longest=: {longest:.6g} um leaves no waves; it has to be above the cut-off, {cutoff:.6g} um")


def band_limited(surface: HeightMap, cutoff: float, longest: float | None = None) -> HeightMap:
    """Return a map without waves shorter than ``cutoff`` and longer than ``longest`` (both in um) and without mean.

    The limit in frequency is sharp, so a second call changes nothing. A periodic map is transformed as it is; another
    one is continued by its mirror image at each edge, without a jump (a cosine transform).
    """
    check_wavelengths(surface, cutoff, longest)
    sides = surface.heights.shape
    if surface.periodic:
        along, across = (fft.fftfreq(n, step) for n, step in zip(sides, surface.spacing, strict=True))
        waves = fft.fft2(surface.heights)
    else:
        along, across = (0.5 * np.arange(n) / (n * step) for n, step in zip(sides, surface.spacing, strict=True))
        waves = fft.dctn(surface.heights, norm="ortho")
    waves *= _kept(along, across, cutoff, longest)
    heights = fft.ifft2(waves).real if surface.periodic else fft.idctn(waves, norm="ortho")
    if not np.ptp(heights) > 1e-12 * np.ptp(surface.heights):
        raise Refused(f"{surface.name}: no waves are left between the cut-off and the longest wave")
    limit = "" if longest is None else f", and longer than {longest:.6g} um"
    return surface.changed(heights, f"waves shorter than {cutoff:.6g} um removed{limit}")


def _kept(along: Doubles, across: Doubles, cutoff: float, longest: float | None) -> NDArray[np.bool_]:
    frequency = np.hypot(along[:, None], across[None, :])
    kept = (frequency <= (1.0 + 1e-9) / cutoff) & (frequency > 0.0)
    return kept if longest is None else kept & (frequency >= (1.0 - 1e-9) / longest)


@dataclass(frozen=True, eq=False)
class Waves:
    """The power of a surface by wave: ``power`` S in um^2 on the grid of the discrete transform, its sum the variance.

    Frequencies f are in cycles per um, first index along the sliding. Source: Nayak, Random process model of rough
    surfaces (1971, doi:10.1115/1.3451608).
    """

    power: Doubles = field(repr=False)
    spacing: tuple[float, float]
    scatter: Doubles | None = field(default=None, repr=False)
    """How the chance of one map spreads over the lags of its autocorrelation, 1 at lag 0; None of an exact spectrum."""

    @classmethod
    def of(cls, surface: HeightMap) -> Self:
        """Return the power of a map; one that is not periodic is tapered by Hann's window, its variance kept."""
        heights = surface.heights - surface.heights.mean()
        variance = float(np.square(heights).mean())
        if not surface.periodic:
            along, across = (np.square(np.sin(np.pi * (np.arange(n) + 0.5) / n)) for n in heights.shape)
            weight = along[:, None] * across[None, :]
            heights = (heights - (heights * weight).sum() / weight.sum()) * weight
            spread = fft.ifft2(np.square(np.abs(fft.fft2(np.square(weight))))).real
            scatter = spread / spread[0, 0]
        else:
            scatter = np.ones_like(heights)
        power = np.square(np.abs(fft.fft2(heights)))
        power[0, 0] = 0.0
        return cls(power * (variance / (power.sum() or 1.0)), surface.spacing, scatter)

    @cached_property
    def variance(self) -> float:
        """Mean square of the heights, sigma^2 = sum S in um^2."""
        return float(self.power.sum())

    @cached_property
    def slopes(self) -> tuple[float, float]:
        """Mean square slopes along and across the sliding: a = sum S (2 pi f_x)^2, b = sum S (2 pi f_y)^2."""
        along, across = self._frequencies
        return (
            float((self.power.sum(1) * np.square(2.0 * np.pi * along)).sum()),
            float((self.power.sum(0) * np.square(2.0 * np.pi * across)).sum()),
        )

    @property
    def _frequencies(self) -> tuple[Doubles, Doubles]:
        along, across = (fft.fftfreq(n, step) for n, step in zip(self.power.shape, self.spacing, strict=True))
        return along, across

    def correlation(self) -> Doubles:
        """Return C(x, y) = sum S cos(2 pi (f_x x + f_y y)) in um^2 at the points of the grid, lags wrapped round."""
        return fft.ifft2(self.power).real * self.power.size

    def below(self, cutoff: float) -> Self:
        """Return the waves without those shorter than ``cutoff`` in um."""
        along, across = self._frequencies
        return type(self)(self.power * _kept(along, across, cutoff, None), self.spacing, self.scatter)

    def at_edge(self, cutoff: float) -> tuple[float, float, float]:
        """Return the loss of variance and of both mean square slopes as ln(cutoff) rises by 1, in um^2, 1 and 1.

        -d(sum S)/d ln(cutoff), from the mean power of the waves in a ring at the cut-off, for a spectrum that continues
        beyond it.
        """
        along, across = self._frequencies
        frequency = np.hypot(along[:, None], across[None, :])
        ring = (frequency > RING / cutoff) & (frequency <= (1.0 + 1e-9) / cutoff)
        edge = type(self)(np.where(ring, self.power, 0.0), self.spacing)
        width = -float(np.log(RING))
        return edge.variance / width, edge.slopes[0] / width, edge.slopes[1] / width
