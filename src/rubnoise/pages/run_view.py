"""The data of a run in its page: every life, every tick of a stretch, and the lowest and highest values elsewhere.

A life is eight bytes, so a page holds the lives of a million junctions, and sums their areas at the place in view. It
holds each tick between two sliding distances, and the extremes of each curve of the whole run in some thousand cells.
"""

from dataclasses import dataclass
from math import ceil, log10
from typing import Any, Final, Self

import numpy as np

from rubnoise.analysis.landmarks import Flights, Sticks
from rubnoise.analysis.selection import first_row, neighbours
from rubnoise.errors import Refused
from rubnoise.figures.tracks import Stretch, lowest_and_highest
from rubnoise.model import Model
from rubnoise.pages.lives import bytes_of, lives
from rubnoise.pages.page import last_time, page
from rubnoise.pages.statistics import exact_curves, whole_run
from rubnoise.record.reader import Reader, chunks
from rubnoise.record.rows import LandmarkKind
from rubnoise.storage.schema import GROUPS, JUNCTIONS, Dataset
from rubnoise.theory.moments import area_cumulants
from rubnoise.units import KINDS, USUAL_UNITS
from rubnoise.web_page import packed

CELLS: Final = 4096
"""Cells of a whole curve, of each of which a page has the lowest and the highest value."""

PAGE_BYTES: Final = 14_000_000
USUAL_BYTES: Final = 12_000_000
MOST_BYTES: Final = 60_000_000
"""Bytes of lives and ticks in a page, of its ticks, and of its ticks at most on request; text is a third more."""

LIVES_BYTES: Final = 12_500_000
"""Bytes up to which a page holds every life of a run; with more it holds those of its stretch."""

CURVES: Final = {
    "trace": ("real_contact_area", "junction_count", "friction_force"),
    "slider": ("displacement", "velocity"),
    "load": ("separation", "velocity", "load"),
}
STYLES: Final = ("uPlot.min.css", "view.css")
SCRIPTS: Final = (
    *("rows", "plot", "where", "life", "sums", "window", "charts", "lives", "table"),
    *("phase", "largest", "welch", "statistics", "view"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunView:
    """A stretch of a run that is shown with all its rows; ``name`` is the file's name in the page."""

    stretch: Stretch
    name: str

    @classmethod
    def of(cls, stretch: Stretch, name: str) -> Self:
        """Return the view of a chosen stretch, otherwise of as much of the beginning as a page usually holds.

        Raises Refused for a chosen stretch of more rows than a page can hold.
        """
        needed = _tick_bytes(stretch)
        if stretch.chosen and needed > MOST_BYTES:
            width = (stretch.stop - stretch.start) * MOST_BYTES / needed
            raise Refused(
                f"{stretch.start:g} to {stretch.stop:g} um hold {needed / 1e6:,.0f} MB of ticks, and a page holds"
                f" {MOST_BYTES / 1e6:g} MB at most; --from and --to choose a shorter stretch, of about {width:.2g} um"
            )
        room = min(USUAL_BYTES, PAGE_BYTES - min(bytes_of(stretch.file), LIVES_BYTES))
        if not stretch.chosen and needed > room:
            stretch = stretch.narrowed((stretch.stop - stretch.start) * room / needed)
        return cls(stretch=stretch, name=name)

    def page(self) -> str:
        """Return the text of the page."""
        data = self._data()
        return page("view.html", title=data["title"], styles=STYLES, scripts=SCRIPTS, data=data)

    def _data(self) -> dict[str, Any]:
        model, file = self.stretch.model, self.stretch.file
        exact = area_cumulants(model)
        groups = [name for name in CURVES if name in file.columns]
        curves = exact_curves(file, model)
        return {
            "title": str(file.attributes["title"]) or self.name,
            "name": self.name,
            "start": self.stretch.start,
            "stop": self.stretch.stop,
            "distance": model.distance,
            "tick": model.tick,
            "speed": model.sliding_speed,
            "twoWay": model.is_two_way and "slider" in file.columns,
            "pulse": model.pulse.name,
            "loaded": "load" in file.columns,
            "area": {"mean": exact.mean, "std": exact.std} if self.stretch.has_theory else None,
            "count": {"mean": model.mean_junction_count} if self.stretch.has_theory else None,
            "weight": model.load if model.held is not None else None,
            "meanLife": model.mean_life_distance,
            "states": {name: bit for column in JUNCTIONS.columns for bit, name in column.flags},
            "units": _units(),
            "junctionRows": file.rows("junctions"),
            "junctions": self._lives(),
            "extremes": extremes(file, model),
            "exact": curves,
            "whole": whole_run(file, curves, leaves=model.free is not None),
            "groups": {name: self._rows(name) for name in groups},
            "landmarks": self._landmarks() if model.is_two_way and "landmarks" in file.columns else None,
            "flights": None if model.free is None else self._flights(),
            "levels": {name: _levels(file, name, CURVES[name]) for name in groups},
        }

    def _lives(self) -> dict[str, Any]:
        """Return every life of the run; if there are too many, those of the stretch and all lives at the same time."""
        file, start, stop = self.stretch.file, self.stretch.start, self.stretch.stop
        if bytes_of(file) <= LIVES_BYTES:
            rows, (start, stop) = np.arange(file.rows("junctions")), (0.0, self.stretch.model.distance)
        else:
            shown = neighbours(file, -1, start, stop, touches=True)
            rows = neighbours(file, -1, float(shown.birth.min()), float(shown.death.max()), touches=True).rows
        return {"start": start, "stop": stop, **lives(file, rows, timed=self.stretch.model.is_two_way)}

    def _rows(self, group: str) -> dict[str, Any]:
        first, last = self.stretch.rows(group)
        file = self.stretch.file
        columns = {
            column.name: {
                "units": column.units,
                "means": column.long_name,
                **packed(file.column(group, column.name, first, last)),
            }
            for column in _shown(file, group)
        }
        return {"first": first, "columns": columns}

    def _landmarks(self) -> dict[str, Any]:
        """Return times in s at which sticks of the stretch begin and end, and time and displacement of reversals."""
        file, (first, last) = self.stretch.file, self.stretch.rows("slider")
        times = file.column("slider", "time", first, last)
        begin, end = (float(times[0]), float(times[-1])) if times.size else (0.0, 0.0)
        found = Sticks.of(file, begin, end)
        rows = [first_row(file, "landmarks", "time", each) for each in (begin, end)]
        kind, time, place = (file.column("landmarks", name, *rows) for name in ("kind", "time", "displacement"))
        turns = kind == LandmarkKind.REVERSAL
        return {
            "begin": packed(found.begin),
            "end": packed(found.end),
            "reversals": {"time": packed(time[turns]), "displacement": packed(place[turns])},
        }

    def _flights(self) -> dict[str, Any]:
        """Return distances in um of flights and impacts, and the speed in um/s of the overlap at each impact."""
        file, speed = self.stretch.file, self.stretch.model.sliding_speed or 1.0
        found = Flights.of(file, 0.0, last_time(file, "load"), MOST_FLIGHTS)
        return {
            "begin": packed(speed * found.begin),
            "end": packed(speed * found.end),
            "place": packed(speed * found.impacts),
            "impact": packed(found.speeds),
        }


MOST_FLIGHTS: Final = 200_000
"""Landmarks of a run that go into a page: 3 MB; of more the first."""


LEFT_OUT: Final = {"trace": ("distance",), "slider": ("friction_force",), "load": ("time", "live_overlap")}
"""Columns that a page does without: it computes places and times of ticks, and takes the one-way force from /trace."""


def _shown(file: Reader, group: str) -> list[Dataset]:
    """Return the columns of a group that a page has."""
    about = next(each for each in GROUPS if each.name == group)
    there = set(file.columns[group]) - set(LEFT_OUT[group])
    return [column for column in about.columns if column.name in there]


def _tick_bytes(stretch: Stretch) -> float:
    """Return about how many bytes the ticks of a stretch take, as if a two-way slider moved evenly."""
    file, share = stretch.file, (stretch.stop - stretch.start) / stretch.model.distance
    return share * sum(
        file.rows(group) * np.dtype(column.dtype).itemsize
        for group in CURVES
        if group in file.columns
        for column in _shown(file, group)
    )


def _units() -> dict[str, dict[str, int]]:
    """Return for each unit of a column other usual units, as powers of ten of it."""
    wanted = {column.units for column in JUNCTIONS.columns} - {"1"}
    found = {}
    for kind in (kind for kind in KINDS if kind.unit in wanted):
        alike = {text: unit.size for text, unit in USUAL_UNITS.items() if unit.dimension == kind.dimension}
        found[kind.unit] = {text: round(log10(size / alike[kind.unit])) for text, size in alike.items()}
    return found


def _levels(file: Any, group: str, names: tuple[str, ...]) -> dict[str, Any]:
    """Return the lowest and highest values of columns in cells of equally many rows; memory holds a chunk at a time."""
    rows = file.rows(group)
    step = max(1, ceil(rows / CELLS))
    kept = [name for name in (*names, "distance") if name in file.columns[group]]
    found: dict[str, Any] = {"step": step, "rows": rows}
    for name in kept:
        low, high = lowest_and_highest(file.column(group, name), step)
        found[name] = {"low": packed(low), "high": packed(high)}
    return found


FORCES: Final = ("friction_force", "real_contact_area")
"""What is largest: the force on the contact, or the area of one whose strength is not known."""


def extremes(file: Reader, model: Model) -> dict[str, Any]:
    """Return the extremes of a whole run; among equal ones the first.

    ``junction``: the row of the largest diameter; ``force``: the column of /trace, its value, and the distance in um of
    that tick; ``stick``, of a slider that sticks: begin and end in s, and the distance in um at which it stands;
    ``impact``, of one that leaves the surface: time in s, distance in um and speed in um/s.
    """
    name = next(each for each in FORCES if each in file.columns["trace"])
    row, value = _largest(file, "trace", name)
    sticks = "landmarks" in file.columns and model.free is None
    return {
        "junction": _largest(file, "junctions", "diameter")[0] if file.rows("junctions") else None,
        "force": {"name": name, "distance": row * model.tick, "value": value},
        "stick": _longest_stick(file) if sticks else None,
        "impact": None if model.free is None else _hardest_impact(file, model),
    }


def _largest(file: Reader, group: str, name: str) -> tuple[int, float]:
    best, where = -np.inf, 0
    for chunk in chunks(file, group):
        row = int(np.argmax(chunk[name]))
        if chunk[name][row] > best:
            best, where = float(chunk[name][row]), chunk.first + row
    return where, best


def _hardest_impact(file: Reader, model: Model) -> dict[str, float] | None:
    found = Flights.of(file, 0.0, last_time(file, "load"))
    if not found.speeds.size:
        return None
    hardest = int(np.argmax(found.speeds))
    time = float(found.impacts[hardest])
    return {"time": time, "distance": time * (model.sliding_speed or 1.0), "speed": float(found.speeds[hardest])}


def _longest_stick(file: Reader) -> dict[str, float] | None:
    rows, last = file.rows("slider"), last_time(file, "slider")
    sticks = Sticks.of(file, 0.0, last)
    if not sticks.begin.size:
        return None
    longest = int(np.argmax(sticks.end - sticks.begin))
    begin, end = float(sticks.begin[longest]), float(sticks.end[longest])
    row = min(round(0.5 * (begin + end) * (rows - 1) / last), rows - 1)
    return {"begin": begin, "end": end, "distance": float(file.column("slider", "distance", row, row + 1)[0])}
