"""A two-way slider in a run: this module moves it through the contact, tick range by tick range, and writes its rows.

A row of /junctions says when the slider first passed the birth and the death. So a row waits until both times are
known, and all later rows wait behind it. Junctions behind the slider are kept as far as it may run back.
"""

from math import ceil, floor, inf
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import RubnoiseError
from rubnoise.model import Model
from rubnoise.record.rows import Appender, Sink
from rubnoise.simulation.area import ForceCells, force_cells
from rubnoise.simulation.cell_moments import AFTER, ROOT_CELLS
from rubnoise.simulation.draws import past
from rubnoise.simulation.observer import Notifier
from rubnoise.simulation.pushing import (
    BACK,
    INTEGRALS,
    MARK,
    ORDER,
    REACHED,
    REVERSED,
    ROW,
    STATE,
    DrivenSlider,
    StepOutput,
    Stop,
    advance,
    columns_of,
)
from rubnoise.simulation.state import LiveRows, junction_columns
from rubnoise.simulation.ticks import coupled_spacing

CELLS: Final = 131_072  # cells whose force is known at a time: it takes some 8 MB
_BEHIND: Final = 1024  # cells behind the slider among them, so that a short reversal stays within

_ROWS, _MARKS = 65_536, 4096

_DEFLECTIONS: Final = 20.0  # how far the slider may run back, at least, over the displacement at which it is in balance


class TwoWayMotion:
    """A two-way slider from the start of a run to its end, and the rows of /junctions that wait for it.

    ``state`` is the one record of `pushing.STATE`, as it moves.
    """

    def __init__(self, model: Model, seed: int, sink: Sink, live: LiveRows, notifier: Notifier | None = None) -> None:
        """Begin at rest among the junctions alive at the start."""
        slider, speed = model.slider, model.sliding_speed
        if slider is None or speed is None:
            raise ValueError("a slider moves where there is a sliding speed")
        self._model, self._sink, self._notifier = model, sink, notifier
        self._drive = DrivenSlider(slider.mass, slider.stiffness, slider.damping, speed, model.tick / speed)
        self._width = coupled_spacing(model)
        self.state = np.zeros(1, STATE)
        self.state["displacement"], self.state["relative"] = model.equilibrium_displacement, speed
        self._largest = max(abs(model.equilibrium_displacement), model.balanced_displacement)
        self._covered = -inf
        rows = live
        if model.start == "stationary":
            self._covered = -self.reach
            behind = past(model, seed, self._covered)
            rows = behind.at(np.flatnonzero(behind.natural_death <= 0.0)).then(live)
        self._rows, self._times = rows, np.full((2, len(rows)), np.nan)
        self._drawn, self._written = len(live), 0
        self._marks, self._work = np.empty(_MARKS, MARK), np.zeros((4, ORDER + 1))
        self._slider, self._landmarks = Appender(sink, "slider", 0), Appender(sink, "landmarks", 0)
        self._finished = False
        self._write_junctions(LiveRows.none(), self._times[:, :0])

    @property
    def reach(self) -> float:
        """How far the slider may run back from the farthest distance so far (um).

        Forward, x' <= V: so x hardly grows beyond G/k + V/omega_0. Back, it loses energy and runs at most
        sqrt(x^2 + (V/omega_0)^2) + |x|. Twice this is kept, and at least twenty times the displacement in balance.
        """
        swing = self._drive.speed * (self._drive.mass / self._drive.stiffness) ** 0.5
        return 4.0 * self._largest + 4.0 * swing + _DEFLECTIONS * self._model.balanced_displacement

    @property
    def distance(self) -> float:
        """How far it has slid, s in um."""
        return float(self.state["cell"][0] + self.state["y"][0]) * self._width

    def through(self, rows: LiveRows, known: float) -> None:
        """Move the slider until it needs the force beyond ``known`` (um), and write its rows.

        ``rows`` must include every birth before ``known`` that no earlier call had. Raises RubnoiseError if the slider
        runs back beyond the junctions that are kept.
        """
        if self._finished:
            return
        born = rows.at(np.flatnonzero(rows.junction >= self._drawn))
        self._drawn += len(born)
        self._rows = self._rows.then(born)
        self._times = np.concatenate([self._times, np.full((2, len(born)), np.nan)], axis=1)
        final = known >= self._model.distance
        place = self._model.distance if final else known
        cell = floor(place / self._width)
        stop = Stop(cell, place / self._width - cell) if final else Stop(cell - AFTER, 0.0)
        while not self._is_at(stop):
            self._move(stop)
        self._finished = final
        if final:
            values = {name: self.state[name][0] for name in ("time", "displacement", *INTEGRALS)}
            values |= {"distance": self.distance, "velocity": self._drive.speed - self.state["relative"][0]}
            self._sink.write("balance", 0, {name: np.array([value]) for name, value in values.items()})
        self._write_known()
        if self._notifier is not None:
            self._notifier.reach(inf if final else self.distance)

    def _is_at(self, stop: Stop) -> bool:
        cell, y = int(self.state["cell"][0]), float(self.state["y"][0])
        return int(self.state["phase"][0]) != REVERSED and (cell, y) >= (stop.cell, stop.y)

    def _move(self, stop: Stop) -> None:
        """Move to the stop, or as far as the force is known about the slider."""
        cell, back = int(self.state["cell"][0]), int(self.state["phase"][0]) == REVERSED
        begin = cell - (CELLS // 2 if back else _BEHIND)
        if self._covered > -inf:
            begin = max(begin, ceil(self._covered / self._width))
        end = begin + CELLS
        if end <= stop.cell:
            stop = Stop(end, 0.0)
        cells = self._force(begin, min(end, stop.cell + 1))
        self._largest = max(self._largest, float(cells.cubics[:, 0].max(initial=0.0)) / self._drive.stiffness)
        code = self._advance(cells, stop)
        if code == BACK and begin * self._width <= self._covered + self._width:
            raise RubnoiseError(
                f"at {self.state['time'][0]:g} s the slider runs back beyond {self.distance:g} um, more than"
                f" {self.reach:g} um: junctions there are no longer kept"
            )

    def _force(self, begin: int, end: int) -> ForceCells:
        rows = self._rows
        first, last = (begin - ROOT_CELLS) * self._width, (end + AFTER) * self._width
        near = (rows.birth < last) & (rows.birth + 2.0 * rows.diameter > first)
        return force_cells(self._model.pulse.shape, rows.at(np.flatnonzero(near)), begin, end, self._width)

    def _advance(self, cells: ForceCells, stop: Stop) -> int:
        """Move within cells, write the rows, and return why the motion stopped."""
        index, places = self._ahead(stop)
        code, times = -1, np.full(places.size, np.nan)
        while code not in (REACHED, BACK):
            first = int(self.state["row"][0])
            table = np.empty(_ROWS, ROW)
            met = int(self.state["met"][0])
            code = advance(
                self.state, self._drive, cells, stop, StepOutput(first, table, self._marks, places, times), self._work
            )
            columns = columns_of(table, int(self.state["row"][0]) - first)
            number = np.arange(first, int(self.state["row"][0]))
            self._slider.append({"time": number * self._model.tick / self._drive.speed, **columns})
            self._times.ravel()[index[met : int(self.state["met"][0])]] = times[met : int(self.state["met"][0])]
            self._write_marks()
        self.state["met"] = 0
        return code

    def _ahead(self, stop: Stop) -> tuple[Integers, Doubles]:
        """Return births and deaths that are not met yet, as indices of both rows of times, and their places (um)."""
        rows = self._rows
        places = np.concatenate([rows.birth, rows.birth + 2.0 * rows.diameter])
        unmet = np.isnan(self._times.ravel()) & ~np.signbit(places) & (places <= (stop.cell + 1) * self._width)
        index = np.flatnonzero(unmet)
        index = index[np.argsort(places[index], kind="stable")]
        return index, places[index]

    def _write_marks(self) -> None:
        count = int(self.state["mark"][0])
        number = np.arange(self._landmarks.rows, self._landmarks.rows + count, dtype=np.int64)
        columns = {"landmark": number, **columns_of(self._marks, count)}
        self._landmarks.append(columns)
        self.state["mark"] = 0
        if self._notifier is not None:
            self._notifier.landmarks(columns)

    def _write_known(self) -> None:
        """Write the waiting rows up to the first one with unknown times, and drop those far behind."""
        rows, times = self._rows, self._times
        waiting = int(np.count_nonzero(rows.junction < self._written))
        missing = np.isnan(times) & np.array([~np.signbit(rows.birth), rows.natural_death <= self._model.distance])
        unknown = missing.any(axis=0)[waiting:]
        count = unknown.size if self._finished or not unknown.any() else int(np.argmax(unknown))
        self._write_junctions(rows.at(slice(waiting, waiting + count)), times[:, waiting : waiting + count])
        self._written += count
        border = self.distance - self.reach
        old = (rows.junction < self._written) & (rows.natural_death < border)
        if old.any():
            kept = np.flatnonzero(~old)
            self._rows, self._times = rows.at(kept), times[:, kept]
            self._covered = max(self._covered, float(rows.natural_death[old].max()))

    def _write_junctions(self, rows: LiveRows, times: Doubles) -> None:
        columns = junction_columns(self._model, rows)
        self._sink.write("junctions", self._written, columns | {"birth_time": times[0], "death_time": times[1]})
