"""Self-affine Gaussian surfaces from a seed, for tests and teaching."""

from math import isfinite
from typing import Final

import numpy as np
from scipy import fft

from rubnoise.errors import Refused
from rubnoise.streams import Stream, generator
from rubnoise.surface.height_map import FEWEST_POINTS, HeightMap

MOST_POINTS: Final = 8192
"""Points a side at most: a map of these takes half a GB, and its transform twice as much."""


def self_affine(
    *, points: int, spacing: float, roughness: float, hurst: float, rolloff: float, cutoff: float, seed: int
) -> HeightMap:
    """Return a periodic Gaussian surface of points x points, with equal bits for equal arguments.

    Its power is q^(-2 - 2 H) for frequencies q from 1/rolloff to 1/cutoff, constant below and 0 above (lengths in
    um), and its rms height is exactly ``roughness`` in um. White noise of a seed is filtered in frequency.
    Source: Jacobs, Junge, Pastewka, Quantitative characterization of surface topography using spectral analysis (2017,
    doi:10.1088/2051-672X/aa51f8).
    """
    _check(points, spacing, roughness, hurst, rolloff, cutoff)
    frequency = np.hypot(fft.fftfreq(points, spacing)[:, None], fft.rfftfreq(points, spacing)[None, :])
    kept = (frequency > 0.0) & (frequency <= (1.0 + 1e-9) / cutoff)
    amplitude = np.where(kept, np.maximum(frequency, 1.0 / rolloff) ** (-1.0 - hurst), 0.0)
    noise = generator(seed, Stream.SURFACE).standard_normal((points, points))
    heights = fft.irfft2(fft.rfft2(noise) * amplitude, s=(points, points))
    heights -= heights.mean()
    heights *= roughness / np.sqrt(np.square(heights).mean())
    words = f"self-affine, H = {hurst:g}, waves from {cutoff:g} um to {rolloff:g} um, seed {seed}"
    return HeightMap(
        heights=heights, spacing=(spacing, spacing), periodic=True, name=f"synthetic surface {seed}", history=(words,)
    )


def _check(points: int, spacing: float, roughness: float, hurst: float, rolloff: float, cutoff: float) -> None:
    """Raises Refused for an impossible surface."""
    if not FEWEST_POINTS <= points <= MOST_POINTS:
        raise Refused(f"points=: {points} is not between {FEWEST_POINTS} and {MOST_POINTS:,}")
    for name, value in (("spacing", spacing), ("roughness", roughness)):
        if not (isfinite(value) and value > 0.0):
            raise Refused(f"{name}=: {value:g} um is not a length above 0")
    if not 0.0 < hurst <= 1.0:
        raise Refused(f"hurst=: {hurst:g} is not above 0 and at most 1")
    if not 2.0 * spacing <= cutoff <= rolloff <= points * spacing:
        raise Refused(
            f"cutoff=: {cutoff:g} um and rolloff=: {rolloff:g} um have to lie, in this order, between two points,"
            f" {2.0 * spacing:g} um, and the side of the map, {points * spacing:g} um"
        )
