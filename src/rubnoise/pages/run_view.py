"""The data of a run in its page: every life, every tick of a stretch, extremes elsewhere, and statistics."""

from collections.abc import Callable
from math import ceil, inf, log10
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.junctions import check_numbers, gather, neighbours
from rubnoise.analysis.motion import Flights, Sticks
from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import half_life
from rubnoise.errors import Refused
from rubnoise.figures.tracks import Stretch, Track, lowest_and_highest
from rubnoise.model import Model
from rubnoise.pages.page import last_time, page
from rubnoise.record.rows import LandmarkKind, Reader, Rows, column_chunks
from rubnoise.storage.schema import GROUPS, JUNCTIONS, Dataset
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.units import KINDS, USUAL_UNITS
from rubnoise.web_page import packed

OWN: Final = ("diameter", "lateral_offset", "shear_strength")
OWN_OF_TOUCHES: Final = ("max_area", "max_overlap")
"""Columns of a touch that do not follow from its diameter, because its area follows the separation."""

_TIMES: Final = ("birth_time", "death_time")
_CHUNK: Final = 256  # rows with one base of their births
_WIDTH: Final = 4  # bytes of a value
_MARK: Final = 16  # bytes, about, that are added for a row whose end does not follow from its diameter
_MOST_WITH_TIMES: Final = 8_000_000  # bytes of lives up to which those of a two-way slider have their times, too
_SAME: Final = 1e-9  # share of a life up to which its end is where its diameter says


def bytes_of(file: Reader) -> int:
    """Return the largest number of bytes that all lives of a file take, without their times."""
    there = file.columns["junctions"]
    columns = 1 + sum(name in there for name in OWN[:2])
    if "encounter" in there:
        columns += len(OWN_OF_TOUCHES) + _MARK // _WIDTH
    return _WIDTH * columns * file.rows("junctions")


def lives(file: Reader, rows: NDArray[np.int64], *, timed: bool) -> dict[str, Any]:
    """Return rows of /junctions of a file, in order of birth, as a page holds them, ``timed`` with their times.

    Values that the page computes are left out: deaths if they follow from diameters, areas, and times at constant
    speed. Raises RunFileRefused, naming the row, if a row is not a life.
    """
    there = file.columns["junctions"]
    own = [*(name for name in OWN if name in there), *(OWN_OF_TOUCHES if "encounter" in there else ())]
    times = [name for name in _TIMES if timed and name in there and 2 * bytes_of(file) <= _MOST_WITH_TIMES]
    columns = gather(file, rows, ["birth_distance", "death_distance", "state", *own, *times])
    birth, death, state = (columns[name] for name in ("birth_distance", "death_distance", "state"))
    check_numbers("junctions", rows, {name: columns[name] for name in ("birth_distance", "death_distance", *own)})
    length = 2.0 * half_life(columns["diameter"], columns.get("lateral_offset"))
    marked = np.flatnonzero((state != 0) | (np.abs(death - birth - length) > _SAME * length))
    return {
        "units": {column.name: column.units for column in JUNCTIONS.columns if column.name in there},
        "rows": packed(rows.astype(np.uint32)) if rows.size and np.ptp(rows) >= rows.size else None,
        "first": int(rows[0]) if rows.size else 0,
        "columns": {name: _behind_bases(columns[name]) for name in ("birth_distance", *times)}
        | {name: _in_short(columns[name]) for name in own},
        "marked": {
            "row": packed(marked.astype(np.uint32)),
            "state": packed(state[marked].astype(np.uint8)),
            "death": packed(death[marked]),
        },
    }


def _behind_bases(values: Doubles) -> dict[str, Any]:
    """Return ascending values as float32 differences to the first value of each chunk."""
    bases = values[::_CHUNK]
    behind = values - np.repeat(bases, _CHUNK)[: values.size]
    return {"chunk": _CHUNK, "bases": packed(bases), "behind": packed(behind.astype(np.float32))}


def _in_short(values: Doubles) -> dict[str, Any]:
    """Return the value of all rows, if there is one, or float32 numbers."""
    if values.size and np.ptp(values) == 0.0:
        return {"value": float(values[0])}
    return {"values": packed(values.astype(np.float32))}


# Statistics.
LIVES: Final = 8.0  # length of a segment in mean lives, for the area

_PERIODS: Final = 16.0  # length of a segment in periods of what swings, for its velocity
_TICKS: Final = (6, 14)  # powers of two between which a segment has ticks
_SPREADS, _POINTS = 5.0, 200  # how far the density of the area is drawn, in standard deviations, and at how many areas
_BARS: Final = 60  # of a histogram

PLANE_CELLS: Final = (96, 72)  # cells of the phase plane across and up

QUANTITIES: Final = {"area": "area", "velocity": "velocity", "normal": "normal-velocity", "load": "load"}
"""What has statistics, by its name in a page, as it is called in pictures."""


def statistics(stretch: Stretch) -> dict[str, Any]:
    """Return what a page says of area, velocities and load over a whole run, beside what theory expects.

    Of each, None if the run does not have it: the step in um or s; the ticks of a segment, their number, and the
    two-sided density in um^4 per rad/um, um^2/s^2 per rad/s or uN^2 per rad/s with its expectation, None if theory has
    none; ``ends`` and ``counts`` of bars. Zeros of area and load of a slider that leaves the contact are among
    ``rows``, and not drawn. Beside them is the exact density of the area in 1/um^2. The phase plane has its ticks in
    each cell of displacement (across) and velocity (up), row by row from below.
    """
    whole, model = stretch.whole(), stretch.model
    return {
        "density": _known(lambda: _density(model)) if stretch.has_theory else None,
        "phase": _phase(stretch.file) if "slider" in stretch.file.columns else None,
        **{name: _of_quantity(whole, drawn) for name, drawn in QUANTITIES.items()},
    }


def _of_quantity(whole: Stretch, name: str) -> dict[str, Any] | None:
    try:
        track = Track.of(whole, name)
    except Refused:
        return None
    per_unit, column = track.quantity.scale**-2, (track.group, track.quantity.column)
    length = (LIVES if track.swings is None else _PERIODS) / track.natural if track.natural else inf
    ticks = 1 << int(np.clip(np.rint(np.log2(max(length / track.step, 1.0))), *_TICKS))
    spectrum, values = welch(column_chunks(whole.file, *column), ticks, track.step), whole.file.column(*column)
    shown, ends = values if whole.has_theory or name == "normal-velocity" else values[values > 0.0], _ends(values)
    return {
        "step": track.step,
        "ticks": ticks,
        "expected": _known(lambda: per_unit * track.expected(ticks, ticks // 2)) if track.has_theory else None,
        "density": packed(spectrum.density),
        "segments": spectrum.segments,
        "ends": ends,
        "counts": packed(np.histogram(shown, _BARS, ends)[0].astype(np.uint32)),
        "rows": values.size,
    }


def _density(model: Model) -> Doubles:
    exact = area_cumulants(model)
    highest = exact.mean + _SPREADS * exact.std
    area = np.linspace(max(exact.mean - _SPREADS * exact.std, highest / _POINTS), highest, _POINTS)
    return np.stack([area, distribution(model).density(area)])


def _known(curve: Callable[[], Doubles]) -> dict[str, str] | None:
    try:
        return packed(curve().ravel())
    except Refused:
        return None


def _ends(values: NDArray[Any]) -> tuple[float, float]:
    """Return the lowest and the highest value, which are never equal."""
    low, high = float(values.min()), float(values.max())
    return (low, high) if low < high else (low - 0.5, low + 0.5)


def _phase(file: Rows) -> dict[str, Any]:
    x, v = (file.column("slider", name) for name in ("displacement", "velocity"))
    place, velocity = _ends(x), _ends(v)
    counts = np.histogram2d(x, v, PLANE_CELLS, (place, velocity))[0]
    return {
        "across": PLANE_CELLS[0],
        "place": place,
        "velocity": velocity,
        "counts": packed(counts.T.astype(np.uint32)),
    }


# The page.
CURVES: Final = {
    "trace": ("real_contact_area", "junction_count", "friction_force"),
    "slider": ("displacement", "velocity"),
    "load": ("separation", "velocity", "load"),
}
LEFT_OUT: Final = {"trace": ("distance",), "slider": ("friction_force",), "load": ("time", "live_overlap")}
"""Columns that a page does without: it computes places and times of ticks, and takes the one-way force from /trace."""

PAGE_BYTES: Final = 14_000_000
USUAL_BYTES: Final = 12_000_000
MOST_BYTES: Final = 60_000_000
"""Bytes of lives and ticks in a page, of its ticks, and of its ticks at most on request; text is a third more."""

LIVES_BYTES: Final = 12_500_000
"""Bytes up to which a page holds every life of a run; with more it holds those of its stretch."""

CELLS: Final = 4096  # of a whole curve, of each of which a page has the lowest and the highest value
_MOST_FLIGHTS: Final = 200_000  # landmarks of a run that go into a page: 3 MB; of more the first
_STYLES: Final = ("uPlot.min.css", "view.css")
_SCRIPTS: Final = (
    *("rows", "plot", "where", "life", "sums", "window", "charts", "lives", "table"),
    *("phase", "largest", "welch", "statistics", "view"),
)


def held_by_a_page(stretch: Stretch) -> Stretch:
    """Return a chosen stretch itself, otherwise as much of the beginning as a page usually holds.

    Raises Refused for a chosen stretch of more rows than a page can hold.
    """
    file, share = stretch.file, (stretch.stop - stretch.start) / stretch.model.distance
    shown = {group: _shown(file, group) for group in CURVES if group in file.columns}
    rows = {group: file.rows(group) * sum(np.dtype(each.dtype).itemsize for each in shown[group]) for group in shown}
    needed = share * sum(rows.values())  # as if a two-way slider moved evenly
    if stretch.chosen and needed > MOST_BYTES:
        width = (stretch.stop - stretch.start) * MOST_BYTES / needed
        raise Refused(
            f"{stretch.start:g} to {stretch.stop:g} um hold {needed / 1e6:,.0f} MB of ticks, and a page holds"
            f" {MOST_BYTES / 1e6:g} MB at most; --from and --to choose a shorter stretch, of about {width:.2g} um"
        )
    room = min(USUAL_BYTES, PAGE_BYTES - min(bytes_of(file), LIVES_BYTES))
    return stretch.narrowed((stretch.stop - stretch.start) * room / needed) if needed > room else stretch


def run_page(stretch: Stretch) -> str:
    """Return the text of the page of a run, with all rows of a stretch that a page can hold."""
    model, file = stretch.model, stretch.file
    exact = area_cumulants(model)
    groups = [name for name in CURVES if name in file.columns]
    title = str(file.attributes["title"]) or str(file.path)
    data = {
        "title": title,
        "start": stretch.start,
        "stop": stretch.stop,
        "distance": model.distance,
        "tick": model.tick,
        "speed": model.sliding_speed,
        "twoWay": model.is_two_way,
        "pulse": model.pulse.name,
        "loaded": "load" in file.columns,
        "area": {"mean": exact.mean, "std": exact.std} if stretch.has_theory else None,
        "count": {"mean": model.mean_junction_count} if stretch.has_theory else None,
        "weight": model.load if model.held is not None else None,
        "meanLife": model.mean_life_distance,
        "states": {name: bit for column in JUNCTIONS.columns for bit, name in column.codes},
        "units": _units(),
        "junctionRows": file.rows("junctions"),
        "junctions": _lives(stretch),
        "extremes": extremes(file, model),
        "statistics": statistics(stretch),
        "groups": {name: _rows(stretch, name) for name in groups},
        "landmarks": _landmarks(stretch) if model.is_two_way else None,
        "flights": None if model.free is None else _flights(file, model),
        "levels": {name: _levels(file, name) for name in groups},
    }
    return page("view.html", title=title, styles=_STYLES, scripts=_SCRIPTS, data=data)


def _lives(stretch: Stretch) -> dict[str, Any]:
    """Return every life of the run; if there are too many, those of the stretch and all lives at the same time."""
    file, start, stop = stretch.file, stretch.start, stretch.stop
    if bytes_of(file) <= LIVES_BYTES:
        rows, (start, stop) = np.arange(file.rows("junctions")), (0.0, stretch.model.distance)
    else:
        shown = neighbours(file, start, stop, touches=True)
        rows = neighbours(file, float(shown.birth.min()), float(shown.death.max()), touches=True).rows
    return {"start": start, "stop": stop, **lives(file, rows, timed=stretch.model.is_two_way)}


def _rows(stretch: Stretch, group: str) -> dict[str, Any]:
    first, last = stretch.rows(group)
    columns = {
        column.name: {"units": column.units, "means": column.long_name}
        | packed(stretch.file.column(group, column.name, first, last))
        for column in _shown(stretch.file, group)
    }
    return {"first": first, "columns": columns}


def _landmarks(stretch: Stretch) -> dict[str, Any]:
    """Return times in s at which sticks of the stretch begin and end, and time and displacement of reversals."""
    file, (first, last) = stretch.file, stretch.rows("slider")
    times = file.column("slider", "time", first, last)
    begin, end = (float(times[0]), float(times[-1])) if times.size else (0.0, 0.0)
    found = Sticks.of(file, begin, end)
    turns = found.rows["kind"] == LandmarkKind.REVERSAL
    return {
        "begin": packed(found.begin),
        "end": packed(found.end),
        "reversals": {name: packed(found.rows[name][turns]) for name in ("time", "displacement")},
    }


def _flights(file: Reader, model: Model) -> dict[str, Any]:
    """Return distances in um of flights and impacts, and the speed in um/s of the overlap at each impact."""
    speed, found = model.sliding_speed or 1.0, Flights.of(file, 0.0, last_time(file, "load"), _MOST_FLIGHTS)
    return {
        "begin": packed(speed * found.begin),
        "end": packed(speed * found.end),
        "place": packed(speed * found.impacts),
        "impact": packed(found.speeds),
    }


def _shown(file: Reader, group: str) -> list[Dataset]:
    """Return the columns of a group that a page has."""
    about = next(each for each in GROUPS if each.name == group)
    there = set(file.columns[group]) - set(LEFT_OUT[group])
    return [column for column in about.columns if column.name in there]


def _units() -> dict[str, dict[str, int]]:
    """Return for each unit of a column other usual units, as powers of ten of it."""
    wanted = {column.units for column in JUNCTIONS.columns} - {"1"}
    found = {}
    for kind in (kind for kind in KINDS if kind.unit in wanted):
        alike = {text: unit.size for text, unit in USUAL_UNITS.items() if unit.dimension == kind.dimension}
        found[kind.unit] = {text: round(log10(size / alike[kind.unit])) for text, size in alike.items()}
    return found


def _levels(file: Reader, group: str) -> dict[str, Any]:
    """Return the lowest and highest values of columns in cells of equally many rows."""
    step = max(1, ceil(file.rows(group) / CELLS))
    found: dict[str, Any] = {"step": step, "rows": file.rows(group)}
    for name in [name for name in (*CURVES[group], "distance") if name in file.columns[group]]:
        low, high = lowest_and_highest(file.column(group, name), step)
        found[name] = {"low": packed(low), "high": packed(high)}
    return found


def extremes(file: Reader, model: Model) -> dict[str, Any]:
    """Return the extremes of a whole run; among equal ones the first.

    ``junction``: the row of the largest diameter; ``force``: the column of /trace, its value, and the distance in um of
    that tick; the area of a contact whose strength is not known takes its place; ``stick``, of a slider that sticks:
    begin and end in s, and the distance in um at which it stands; ``impact``, of one that leaves the surface: time in
    s, distance in um and speed in um/s.
    """
    name = "friction_force" if "friction_force" in file.columns["trace"] else "real_contact_area"
    forces, diameters = file.column("trace", name), file.column("junctions", "diameter")
    row = int(np.argmax(forces))
    return {
        "junction": int(np.argmax(diameters)) if diameters.size else None,
        "force": {"name": name, "distance": row * model.tick, "value": float(forces[row])},
        "stick": _longest_stick(file) if model.is_two_way else None,
        "impact": _hardest_impact(file, model.sliding_speed or 1.0) if model.free is not None else None,
    }


def _longest_stick(file: Reader) -> dict[str, float] | None:
    last = last_time(file, "slider")
    sticks = Sticks.of(file, 0.0, last)
    if not sticks.begin.size:
        return None
    longest = int(np.argmax(sticks.end - sticks.begin))
    begin, end = float(sticks.begin[longest]), float(sticks.end[longest])
    at = round(0.5 * (begin + end) * (file.rows("slider") - 1) / last)
    return {"begin": begin, "end": end, "distance": float(file.column("slider", "distance", at, at + 1)[0])}


def _hardest_impact(file: Reader, sliding_speed: float) -> dict[str, float] | None:
    flights = Flights.of(file, 0.0, last_time(file, "load"))
    if not flights.speeds.size:
        return None
    hardest = int(np.argmax(flights.speeds))
    time, speed = float(flights.impacts[hardest]), float(flights.speeds[hardest])
    return {"time": time, "distance": time * sliding_speed, "speed": speed}
