"""Maps of heights, on one grid, and their waves: cut-off wavelengths, power, autocorrelation, self-affine maps."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from math import inf
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy import fft, ndimage

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.streams import Stream, philox

FEWEST_POINTS: Final = 16  # a side, below which a map has no spectrum
LONGEST, STEEPEST = 1e6, 10.0  # side in um and rms slope of a scan


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeightMap:
    """Heights h in um over a grid whose first index runs along the sliding, spacings in um.

    ``periodic``: the map repeats itself at its edges. ``history``: the changes so far, in words.
    """

    heights: Doubles = field(repr=False)
    spacing: tuple[float, float]
    periodic: bool = False
    name: str = "surface"
    history: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Raises Refused for invalid maps: too few points, a spacing of 0, a height that is not a number."""
        if self.heights.ndim != 2 or min(self.heights.shape) < FEWEST_POINTS:
            shape, fewest = " x ".join(map(str, self.heights.shape)), f"{FEWEST_POINTS} x {FEWEST_POINTS}"
            raise Refused(f"{self.name}: has {shape} points; a map of {fewest} or more is needed")
        if not all(0.0 < step < np.inf for step in self.spacing):
            raise Refused(f"{self.name}: its points are {self.spacing} um apart; two lengths above 0 are needed")
        if not np.isfinite(self.heights).all():
            raise Refused(f"{self.name}: has heights that are no numbers; fill or leave out its missing points")

    @property
    def size(self) -> tuple[float, float]:
        """Length along and width across the sliding, in um."""
        along, across = self.heights.shape
        return along * self.spacing[0], across * self.spacing[1]

    @property
    def area(self) -> float:
        """Nominal area A0 in um^2."""
        return self.size[0] * self.size[1]

    @property
    def digest(self) -> str:
        """The first half of the SHA-256 of shape, spacings and heights, which identifies the surface."""
        content = np.ascontiguousarray(self.heights, dtype="<f8")
        head = repr((content.shape, tuple(map(float, self.spacing)))).encode()
        return sha256(head + content.tobytes()).hexdigest()[:32]

    def changed(self, heights: Doubles, done: str) -> Self:
        """Return the map with other heights, and with the change in its history."""
        return replace(self, heights=heights, history=(*self.history, done))

    def turned(self) -> Self:
        """Return the map turned by 180 degrees about its normal, as a partner for a surface that slides on itself."""
        return replace(self, heights=self.heights[::-1, ::-1], name=f"{self.name} turned by 180 degrees")

    def transposed(self) -> Self:
        """Return the map with its second index along the sliding."""
        done = (*self.history, "turned to slide along its second index")
        return replace(self, heights=self.heights.T.copy(), spacing=self.spacing[::-1], history=done)

    def on_grid_of(self, other: "HeightMap") -> Doubles:
        """Return heights at the points of another map, over the part that both cover from the first corner on."""
        if self.heights.shape == other.heights.shape and np.allclose(self.spacing, other.spacing, rtol=1e-6):
            return self.heights
        grids = zip(self.heights.shape, other.heights.shape, np.divide(other.spacing, self.spacing), strict=True)
        points = [np.arange(min(there, int((here - 1) / step) + 1)) * step for here, there, step in grids]
        return ndimage.map_coordinates(self.heights, np.meshgrid(*points, indexing="ij"), order=3, mode="mirror")


def check_sense(surface: HeightMap) -> None:
    """Raises Refused for a map longer or steeper than a measured one can be: its units or some heights are wrong."""
    if (longest := max(surface.size)) > LONGEST:
        metres = f"{1e-6 * longest:.4g} m long, and no scan is longer than {1e-6 * LONGEST:g} m"
        raise Refused(f'{surface.name}: is {metres}: give the unit of its lengths; right form: unit="um"')
    rises = [np.sqrt(np.square(np.diff(surface.heights, axis=axis)).mean()) for axis in (0, 1)]
    if (slope := float(max(np.divide(rises, surface.spacing)))) > STEEPEST:
        steep = f"has an rms slope of {slope:.3g}, and no surface has more than {STEEPEST:g}"
        remedy = 'give the unit of its heights, height_unit="um", or leave out values that stand for missing points'
        raise Refused(f"{surface.name}: {steep}: {remedy}")


_MOST_FITTED: Final = 20_000  # points by which a sphere or a cylinder is fitted
FORMS: Final[Mapping[str, str]] = {
    "none": "no form removed",
    "tilt": "a plane removed",
    "polynomial": "a polynomial of second degree removed",
    "cylinder": "a cylinder removed",
    "sphere": "a sphere removed",
}
"""Forms that can be removed, and what is then said of the map."""


def without_form(surface: HeightMap, form: str) -> HeightMap:
    """Return a map without its form (see `FORMS`) by least squares; a periodic map has none and stays as it is.

    A sphere or cylinder is z = z0 -+ (R - sqrt(R^2 - r^2)), r the distance from centre or axis, after its paraboloid.
    """
    if form == "none" or surface.periodic:
        return surface
    fitted = _polynomial(surface.heights, degree=1 if form == "tilt" else 2)
    if form in ("cylinder", "sphere"):
        fitted = _curved(surface, fitted, form)
    return surface.changed(surface.heights - fitted, FORMS[form])


def _polynomial(heights: Doubles, degree: int) -> Doubles:
    along, across = np.ix_(*(np.linspace(-1.0, 1.0, n) for n in heights.shape))
    terms = np.stack([(along**i * across**j).ravel() for i in range(degree + 1) for j in range(degree + 1 - i)])
    weights = np.linalg.solve(terms @ terms.T, terms @ heights.ravel())
    return (weights @ terms).reshape(heights.shape)


def _curved(surface: HeightMap, start: Doubles, form: str) -> Doubles:
    """Return the sphere or the cylinder of least squares, found from the curvature of a polynomial of second degree."""
    from scipy.optimize import least_squares

    scale, unit = max(surface.size), float(np.ptp(start)) or 1.0
    steps = [step / scale for step in surface.spacing]
    places = [(np.arange(n) - 0.5 * (n - 1)) * step for n, step in zip(start.shape, steps, strict=True)]
    fewer = [slice(None, None, max(1, int(each.size / np.sqrt(_MOST_FITTED)))) for each in places]
    x, y = places[0][:, None], places[1][None, :]
    wanted = surface.heights[tuple(fewer)] / unit
    # The largest curvature of the polynomial and its direction are a start for both.
    second = [
        [np.gradient(slope, step, axis=i).mean() for i, step in enumerate(steps)]
        for slope in np.gradient(start / unit, *steps)
    ]
    bends, axes = np.linalg.eigh(second)
    bend, (along, across) = max(zip(bends.tolist(), axes.T, strict=True), key=lambda each: abs(each[0]))
    found = least_squares(
        lambda p: (_shape(p, x[fewer[0]], y[:, fewer[1]], unit / scale, form) - wanted).ravel(),
        [float(wanted.mean()), bend, 0.0, 0.0, np.arctan2(across, along), 0.0],
        x_scale=[1.0, abs(bend) or 1.0, 1.0, 1.0, 1.0, 1.0],
    )
    return unit * _shape(found.x, x, y, unit / scale, form)


def _shape(p: Doubles, x: Doubles, y: Doubles, slope: float, form: str) -> Doubles:
    """Return heights in units of ``slope``: of level, curvature, place of the centre, angle and lean of the axis."""
    level, bend, x0, y0, angle, lean = p
    a, b = (x - x0) * np.cos(angle) + (y - y0) * np.sin(angle), (y - y0) * np.cos(angle) - (x - x0) * np.sin(angle)
    square = a * a + (b * b if form == "sphere" else 0.0)
    root = np.sqrt(np.maximum(1.0 - (bend * slope) ** 2 * square, 0.0))
    return level + bend * square / (1.0 + root) + (lean * b if form == "cylinder" else 0.0)


# Waves.
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
