"""Scans from files of 42 instruments and formats by SurfaceTopography, and from its objects; or from text.

A text is a list of points with their places, which is put on a grid, or a matrix of heights.
"""

import os
import re
import warnings
from collections import Counter
from collections.abc import Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass
from io import StringIO
from itertools import dropwhile
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import Refused, needing
from rubnoise.regular_file import open_stream
from rubnoise.storage.measured import head_of
from rubnoise.storage.objects import naming_damage
from rubnoise.storage.text_table import ENCODINGS, begin_of
from rubnoise.units import LENGTH, QuantityError, is_unit, read_quantity, spelled

MOST_MISSING: Final = 0.1  # share of missing points that are filled
MOST_BYTES: Final = 1 << 30  # of a file that is read


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """What is said beside a file: ``unit`` of lengths without one, ``height_unit``, ``size`` in um, and ``channel``."""

    unit: str | None = None
    height_unit: str | None = None
    size: tuple[float, float] | None = None
    channel: str | None = None


Scan = dict[str, Any]
"""The fields of a HeightMap: heights and spacings in um, and the history that says how they were read."""


def read_scan(path: Path, told: Told) -> Scan:
    """Return the map of a file; raises Refused for one without size or unit, with few points, or of another kind."""
    for keyword in ("unit", "height_unit"):
        length_scale(getattr(told, keyword) or "um", f"{keyword}=")  # also if the file names its own
    quiet = redirect_stderr(StringIO())  # where readers print
    with naming_damage(f"{path}: is no surface that can be read", "", Refused), np.errstate(all="ignore"), quiet:
        return _read(_library(), path, told)


def _read(library: Any, path: Path, told: Told) -> Scan:
    """Return the map of a file: of text by its lines, of others by the reader that knows them or fits the ending."""
    with open_stream(path) as stream:
        held = os.fstat(stream.fileno()).st_size
    if held > MOST_BYTES:
        raise Refused(f"{path}: has {held:,} bytes; up to {MOST_BYTES:,} are read")
    fitting = [each for each in library.IO.readers if path.suffix.lower()[1:] in (each.file_extensions() or ())]
    others = [each for each in fitting if each.format() not in ("xyz", "asc")]
    text, history = text_of(path) if others != fitting or not fitting else (None, ())
    if text is None:
        try:
            return _of_channel(library.open_topography(str(path)), path.name, told, history)
        except library.IO.CannotDetectFileFormat:
            for reader in others:  # one that fits its ending says why
                library.open_topography(str(path), format=reader.format())
        raise Refused(f"{path}: no reader of SurfaceTopography knows its format")
    head, values, clean = table_of(text, path.name)
    if (found := points_of(head, values)) is None:
        return _of_channel(library.open_topography(StringIO(clean), "asc"), path.name, told, history)
    points, *units = found
    heights, steps = gridded(points, path.name)
    made = library.Topography(np.ma.masked_invalid(heights), np.multiply(heights.shape, steps))
    return from_topography(made, path.name, told, history, units)


def _of_channel(reader: Any, name: str, told: Told, history: tuple[str, ...]) -> Scan:
    """Return the wanted channel of a file, which is named if there are more."""
    channels = {each.channel_id: each for each in reader.channels}
    chosen = told.channel or reader.default_channel.channel_id
    heights = [each for each, channel in channels.items() if channel.is_height_channel]
    if chosen not in heights:
        raise Refused(f"{name}: channel=: {chosen} names no heights in it; these do: {', '.join(heights)}")
    if len(channels) > 1:
        history = (*history, f"channel {chosen} of {', '.join(channels)}")
    if channels[chosen].physical_sizes is None and told.size is None:
        raise Refused(f'{name}: does not say how large it is; say it: size="128 um x 128 um"')
    given = {"physical_sizes": told.size} if channels[chosen].physical_sizes is None else {}
    return from_topography(channels[chosen].topography(**given), name, told, history, ["um" if given else "", ""])


def from_topography(
    topography: Any, name: str, told: Told, history: tuple[str, ...] = (), units: Sequence[str] = ("", "")
) -> Scan:
    """Return an object of SurfaceTopography as a map, with other ``units`` of its size and its heights, or Refused."""
    if topography.dim != 2 or not topography.is_uniform:
        raise Refused(f"{name}: is a profile or has uneven points; a map of heights over an even grid is needed")
    if (points := int(np.prod(topography.nb_grid_pts))) > MOST_VALUES:
        raise Refused(f"{name}: has {points:,} points; up to {MOST_VALUES:,} are read")
    own = getattr(topography, "unit", None)
    named = units[0] or own or topography.info.get("raw_metadata", {}).get("xunit")  # a text may name that of its size
    scale = length_scale(named or told.unit, name)
    up = length_scale(told.height_unit or units[1] or own or told.unit, name, "height_unit")
    along, across = (float(step) * scale for step in topography.pixel_size)
    heights, done = _filled(topography, name)
    scaled, about = np.ascontiguousarray(heights * up), {"name": name, "history": (*history, *done)}
    return {"heights": scaled, "spacing": (along, across), "periodic": bool(topography.is_periodic), **about}


def length_scale(unit: Any, name: str, keyword: str = "unit") -> float:
    """Return the size of a unit of length in um; raises Refused for another unit, and for none."""
    if not unit:
        what = "lengths" if keyword == "unit" else "heights"
        raise Refused(f'{name}: names no unit of its {what}; say it: {keyword}="um"')
    try:
        return float(read_quantity("1 " + str(unit).replace("\u00c5", "angstrom"), LENGTH))
    except QuantityError as problem:
        raise Refused(f"{name}: {unit}: {problem}; right form: um, nm, mm, m") from problem


def _filled(topography: Any, name: str) -> tuple[Doubles, tuple[str, ...]]:
    """Return heights whose missing points are filled by a harmonic function of their neighbours, and words for that."""
    heights = np.ma.masked_invalid(topography.heights())
    missing = int(np.ma.getmaskarray(heights).sum())
    if missing == 0:
        return np.asarray(heights.data, dtype=np.float64), ()
    if (share := missing / heights.size) > MOST_MISSING:
        many = f"{100.0 * share:.3g} % of its points are missing; up to {100.0 * MOST_MISSING:g} % are filled"
        raise Refused(f"{name}: {many}; cut out a part that was measured")
    filled = topography.interpolate_undefined_data_with_harmonic_function().heights()
    return np.asarray(filled, dtype=np.float64), (f"{missing:,} missing points filled from their neighbours",)


def write_scan(path: Path, heights: Doubles, size: tuple[float, float], *, periodic: bool) -> None:
    """Write a map in um as netCDF, which SurfaceTopography reads again with its unit and its period."""
    _library().Topography(heights, size, unit="um", periodic=periodic).to_netcdf(str(path))


def _library() -> Any:
    with needing("surface", "a scan"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it tells that it found no MPI, which no scan needs
        import SurfaceTopography
    return SurfaceTopography


MOST_VALUES: Final = 1 << 26  # points of a map that is read
_NEAR: Final = 0.1  # of a step: how far a point may lie off the grid
_MISSED: Final = re.compile(r"(?<!\w)(?:nan|bad|inf(?:inite)?)(?!\w)", re.IGNORECASE)
_ROW: Final = re.compile(r"(?=.*(?:\d|nan))[\s\d.,;+-]*(?:(?:[eEdD](?=[+-]?\d)|nan)[\s\d.,;+-]*)*")


def text_of(path: Path) -> tuple[str | None, tuple[str, ...]]:
    """Return a text in UTF-8, UTF-16 or Windows-1252, with a note on the last two; None for other files."""
    encoding, lines = begin_of(path)
    text = "\n".join(line for _, line in lines)
    return (None, ()) if "\0" in text else (text, ENCODINGS[encoding])


def table_of(text: str, name: str) -> tuple[str, Doubles, str]:
    """Return the lines above a table, its numbers by row, and all lines with spaces between numbers, or Refused."""
    lines = _MISSED.sub("nan", text.replace("\u2212", "-")).splitlines()
    numbers = [at for at, line in enumerate(lines) if _ROW.fullmatch(line)]
    if not numbers:
        raise Refused(f"{name}: has no rows of numbers")
    seen = "\n".join(lines[at] for at in numbers[:100])
    spaced = re.search(r"\d[ \t]+[+-]?\d", seen) is not None and re.search(r",\s", seen) is None
    decimal = ";" in seen or (spaced and "." not in seen)  # what a comma is; else it parts numbers
    marks = str.maketrans({";": " ", ",": "." if decimal else " ", "D": "e", "d": "e"})
    for at in numbers:
        lines[at] = lines[at].translate(marks)
    lengths = {at: len(lines[at].split()) for at in numbers}
    usual = Counter(lengths.values()).most_common(1)[0][0]
    # What stands above the table, such as a date, is no row of it.
    rows = list(dropwhile(lambda at: lengths[at] != usual, numbers))
    if uneven := [f"line {at + 1}: has {lengths[at]} numbers" for at in rows if lengths[at] != usual]:
        raise Refused(f"{name}: {uneven[0]}, other rows {usual}; write nan for a point that was missed")
    try:
        values = np.loadtxt((lines[at] for at in rows), ndmin=2)
    except ValueError as problem:
        cell = str(problem).split("'")[1]
        line = next(at for at in rows if cell in lines[at].split()) + 1
        raise Refused(f"{name}: line {line}: {cell} is no number; right form: 1.5") from None
    head = [f"# {line}" if at in lengths else line for at, line in enumerate(lines[: rows[0]])]
    return "\n".join(head), values, "\n".join([*head, *lines[rows[0] :]])


def points_of(head: str, values: Doubles) -> tuple[Doubles, str, str] | None:
    """Return x, y, z in columns with the units of places and heights; None without three columns or such names."""
    width = values.shape[1]
    lines = [line.strip("#% \t").replace('"', "") for line in reversed(head.splitlines())]
    cells = [each for line in lines for each in (re.split(r"[;,\t]|\s{2,}", line), line.split()) if len(each) == width]
    if len(cells) > 1 and all(is_unit(spelled(unit.strip("[] "))) for unit in cells[0]):
        cells[0] = [f"{name} [{unit.strip('[] ')}]" for name, unit in zip(cells[1], cells[0], strict=True)]
    heads = [head_of(cell) for cell in cells[0]] if cells else []
    names = [each.name.lower() for each in heads]
    named = {"x", "y", "z"} <= set(names)
    if not (width == 3 or named):
        return None
    columns = [names.index(each) for each in "xyz"] if named else [0, 1, 2]
    said = dict(re.findall(r"(Lateral|Value) units?\s*[:=]\s*(\S+)", head))
    along, _, up = (heads[column].unit for column in columns) if heads else ("", "", "")
    return values[:, columns], along or said.get("Lateral", ""), up or said.get("Value", "")


def gridded(points: Doubles, name: str) -> tuple[Doubles, tuple[float, float]]:
    """Return heights on the even grid of their places, nan where there is no point, and its spacings."""
    (along, step), (across, other) = (_on_axis(points[:, axis], name, "xy"[axis]) for axis in (0, 1))
    shape = int(along.max()) + 1, int(across.max()) + 1
    if shape[0] * shape[1] > MOST_VALUES:
        raise Refused(f"{name}: its points need a grid of {shape[0]:,} x {shape[1]:,}; up to {MOST_VALUES:,} are read")
    taken, heights = np.zeros(shape, dtype=bool), np.full(shape, np.nan)
    taken[along, across], heights[along, across] = True, points[:, 2]
    if taken.sum() < len(points):
        raise Refused(f"{name}: has two points at one place; leave out one of them")
    return heights, (step, other)


def _on_axis(values: Doubles, name: str, axis: str) -> tuple[Integers, float]:
    """Return the numbers of even steps at which values lie, a tenth of a step beside at most, and the step."""
    ordered = np.sort(values)
    gaps, span = np.diff(ordered), float(ordered[-1] - ordered[0])
    if not (0.0 < span < np.inf):
        raise Refused(f"{name}: {axis} is not a place of each point; a list needs x, y and z, that of a map")
    apart = ordered[np.append(True, gaps > _NEAR * gaps.max())]
    step = span / round(span / float(np.median(np.diff(apart))))
    places = (values - ordered[0]) / step
    off = np.abs(places - np.rint(places))
    if (worst := int(off.argmax())) and off[worst] > _NEAR:
        raise Refused(f"{name}: {axis} = {values[worst]:g} lies on no even grid, whose step would be {step:.4g}")
    return np.rint(places).astype(np.int64), step
