"""Read scans from files of 42 instruments and formats by SurfaceTopography, or take its objects."""

import os
import warnings
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import ExtraMissing, Refused
from rubnoise.surface.height_map import HeightMap
from rubnoise.units import LENGTH, QuantityError, parse_unit

MOST_MISSING: Final = 0.1  # share of missing points that are filled
MOST_BYTES: Final = 1 << 30  # of a file that is read
MOST_VALUES: Final = 1 << 26  # points of a map that is read


def read_surface(path: str | os.PathLike[str], unit: str | None = None) -> HeightMap:
    """Return the first map of a file in um, missing points filled by a harmonic function of their neighbours.

    The first index is the sliding direction; ``unit`` is that of all lengths if the file names none. Raises Refused if
    the file is not a surface, for a profile, a map without a unit, and one with too many missing points.
    """
    name = os.fspath(path)
    if not Path(name).is_file():
        raise Refused(f"{name}: {'is not a regular file' if Path(name).exists() else 'no such file'}")
    if (size := Path(name).stat().st_size) > MOST_BYTES:
        raise Refused(f"{name}: has {size:,} bytes; up to {MOST_BYTES:,} are read")
    library = _library()
    try:
        with np.errstate(all="ignore"):
            opened = library.open_topography(name).topography()
            return from_topography(opened, Path(name).name, unit)
    except Refused:
        raise
    except Exception as problem:  # a reader may raise anything about a damaged file
        reason = " ".join(str(problem).split())
        if "tried" in reason:
            reason = "no reader of SurfaceTopography knows its format"
        raise Refused(f"{name}: is no surface that can be read: {reason[:200]}") from problem


def from_topography(topography: Any, name: str = "surface", unit: str | None = None) -> HeightMap:
    """Return a topography of SurfaceTopography as a map in um; raises Refused as `read_surface` does."""
    if topography.dim != 2 or not topography.is_uniform:
        raise Refused(f"{name}: is a profile or has uneven points; a map of heights over an even grid is needed")
    if topography.pixel_size is None:
        raise Refused(f"{name}: does not say how far its points are apart; save it with its lengths")
    if unit is not None:
        length_scale(unit, "unit=")  # also if the file names its own
    named = getattr(topography, "unit", None) or unit
    if named is None:
        raise Refused(f'{name}: names no unit of its lengths; say it: unit="um" (--unit um)')
    scale = length_scale(str(named), name)
    if (points := int(np.prod(topography.nb_grid_pts))) > MOST_VALUES:
        raise Refused(f"{name}: has {points:,} points; up to {MOST_VALUES:,} are read")
    along, across = (float(step) * scale for step in topography.pixel_size)
    heights, done = _filled(topography, name)
    periodic, scaled = bool(topography.is_periodic), np.ascontiguousarray(heights * scale)
    return HeightMap(heights=scaled, spacing=(along, across), periodic=periodic, name=name, history=done)


def length_scale(unit: str, name: str) -> float:
    """Return the size of a unit of length in um; raises Refused for another unit."""
    try:
        size = parse_unit(unit.replace("\u00c5", "angstrom"))
    except QuantityError as problem:
        raise Refused(f"{name}: {unit}: {problem}; a unit of length is needed, such as um") from problem
    if size.dimension != LENGTH.dimension:
        raise Refused(f"{name}: {unit} is no unit of length; right form: um, nm, mm, m")
    return float(size.size)


def _filled(topography: Any, name: str) -> tuple[Doubles, tuple[str, ...]]:
    """Return heights without missing points, and how they were filled."""
    heights = np.ma.masked_invalid(topography.heights())
    missing = int(np.ma.getmaskarray(heights).sum())
    if missing == 0:
        return np.asarray(heights.data, dtype=np.float64), ()
    if (share := missing / heights.size) > MOST_MISSING:
        raise Refused(
            f"{name}: {100.0 * share:.3g} % of its points are missing; up to {100.0 * MOST_MISSING:g} % are filled;"
            " cut out a part that was measured"
        )
    filled = topography.interpolate_undefined_data_with_harmonic_function().heights()
    return np.asarray(filled, dtype=np.float64), (f"{missing:,} missing points filled from their neighbours",)


def to_file(surface: HeightMap, path: Path) -> None:
    """Write a map as netCDF, which SurfaceTopography reads again with its unit and its period."""
    made = _library().Topography(surface.heights, surface.size, unit="um", periodic=surface.periodic)
    made.to_netcdf(str(path))


def _library() -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it tells that it found no MPI, which no scan needs
            import SurfaceTopography
    except ImportError as problem:
        raise ExtraMissing(
            'scans are read by SurfaceTopography, which is not installed: python3 -m pip install "rubnoise[surface]"'
        ) from problem
    return SurfaceTopography
