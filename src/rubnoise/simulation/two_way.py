"""A two-way slider in a run: this module moves it through the contact, tick range by tick range, and writes its rows.

A row of /junctions says when the slider first passed the birth and the death. So a row waits until both times are
known, and all later rows wait behind it. Waiting rows are carried from block to block.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws.discrete import largest_of
from rubnoise.errors import RubnoiseError
from rubnoise.model import Model
from rubnoise.record.sink import Appender, Sink
from rubnoise.simulation.block import junction_columns
from rubnoise.simulation.coupled.fold import CoupledMotion, MotionRows, constants
from rubnoise.simulation.coupled.state import CoupledState
from rubnoise.simulation.draws import backward, blocks_drawn_at_once, draw_blocks, start
from rubnoise.simulation.observer import Notifier
from rubnoise.simulation.state import LiveRows, State
from rubnoise.streams import Stream, uniforms


def lived(model: Model, seed: int, begin: float, end: float) -> LiveRows:
    """Return all junctions that live between two distances (um), in order of birth.

    Junctions of the past have the numbers -1, -2, ...
    """
    first = start(model, seed)
    found = [_between(first.live, begin, end)]
    block, place, number = first.block, first.next_birth, first.junctions
    while place < end and place <= model.distance:
        births = draw_blocks(model, seed, block, place, blocks_drawn_at_once(model, block))
        found.append(_between(births.rows(number), begin, end))
        block, place, number = block + births.blocks, births.next_birth, number + len(births)
    if begin < 0.0 and model.start == "stationary":
        found.append(_between(past(model, seed, begin), begin, end))
    together = found[0]
    for rows in found[1:]:
        together = together.then(rows)
    return together.at(np.argsort(together.birth, kind="stable"))


def past(model: Model, seed: int, begin: float) -> LiveRows:
    """Return the junctions that had died before s = 0, latest first, back to ``begin`` (um): all that live after it.

    A slider needs them if it runs back beyond the carried junctions. They have their own streams. Of Poisson births,
    only lives that ended before the start are kept, which are independent of those alive at the start. Regular births
    continue backward at their spacing, with the diameters that the start has drawn for them. Gamma and scattered births
    have one past, from which the start also takes its live junctions. A contact that starts empty has no past.
    """
    longest = 2.0 * largest_of(model.sizes)
    birth, diameter = backward(model, seed, begin - longest)
    dead = np.flatnonzero(birth + 2.0 * diameter <= 0.0)
    if model.strengths is None:
        strength = np.ones(birth.size)
    else:
        strength = model.strengths.draw(uniforms(seed, Stream.PAST_STRENGTHS, 0, birth.size))
    latest = dead[::-1]
    return LiveRows(
        junction=-1 - latest.astype(np.int64),
        birth=birth[latest],
        diameter=diameter[latest],
        strength=strength[latest],
        departure=np.full(dead.size, np.inf),
    )


def _between(rows: LiveRows, begin: float, end: float) -> LiveRows:
    return rows.at(np.flatnonzero((rows.birth < end) & (rows.birth + 2.0 * rows.diameter > begin)))


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoWayState:
    """What a block of a two-way run passes to the next.

    slider, landmarks, written: rows of /slider, /landmarks and /junctions so far; waiting: the junctions whose rows are
    not written yet; times (2, rows): when the slider first passed their births and deaths (s), nan before that.
    """

    motion: CoupledState
    slider: int = 0
    landmarks: int = 0
    written: int = 0
    waiting: LiveRows = field(default_factory=LiveRows.none)
    times: Doubles = field(default_factory=lambda: np.empty((2, 0)))


class TwoWayMotion:
    """A two-way slider that moves through a block, and the rows of /junctions that wait for it."""

    def __init__(
        self,
        model: Model,
        seed: int,
        sink: Sink,
        state: State,
        notifier: Notifier | None = None,
    ) -> None:
        """Continue from a state."""
        self._model, self._sink, self._notifier = model, sink, notifier
        numbers = constants(model, model.slider.tolerance if model.slider is not None else 0.0)
        begun: TwoWayState | None = state.motion
        past = begun or TwoWayState(motion=CoupledState.start(model, numbers, start(model, seed).live))
        self._written, self._waiting, self._times = past.written, past.waiting, past.times
        if begun is None:
            self._write_junctions(LiveRows.none(), self._times)
        self._constants = numbers
        self._motion = CoupledMotion(model, numbers, past.motion, partial(lived, model, seed))
        self._slider = Appender(sink, "slider", past.slider)
        self._landmarks = Appender(sink, "landmarks", past.landmarks)

    def through(self, rows: LiveRows, known: float) -> None:
        """Move the slider until it needs the field beyond ``known`` (um), and write its rows.

        ``rows`` must include every birth before ``known``. Raises RubnoiseError if no step keeps the tolerance.
        """
        first = self._written + len(self._waiting)
        born = rows.at(np.flatnonzero(rows.junction >= first))
        born = replace(born, departure=np.full(len(born), np.inf))
        self._waiting = self._waiting.then(born)
        self._times = np.concatenate([self._times, np.full((2, len(born)), np.nan)], axis=1)
        before = self._motion.finished
        for moved in self._moved(born, known):
            self._write(moved)
        if self._motion.finished and not before:
            self._sink.write("balance", 0, self._balance())
        self._write_known()
        if self._notifier is not None:
            self._notifier.reach(inf if self._motion.finished else self._motion.state.distance(self._constants))

    @property
    def state(self) -> TwoWayState:
        """The state from which the next block continues."""
        return TwoWayState(
            slider=self._slider.rows,
            landmarks=self._landmarks.rows,
            written=self._written,
            waiting=self._waiting,
            times=self._times,
            motion=self._motion.state,
        )

    def _moved(self, born: LiveRows, known: float) -> Iterator[MotionRows]:
        try:
            yield from self._motion.through(born, known)
        except ArithmeticError as problem:
            raise RubnoiseError(f"{problem}; a larger slider.tolerance may do") from problem

    def _write(self, moved: MotionRows) -> None:
        self._slider.append(moved.slider)
        count = moved.landmarks["time"].size
        number = np.arange(self._landmarks.rows, self._landmarks.rows + count, dtype=np.int64)
        self._landmarks.append({"landmark": number, **moved.landmarks})
        for times, (junction, time) in zip(self._times, (moved.births, moved.deaths), strict=True):
            times[junction - self._written] = time
        if self._notifier is not None:
            self._notifier.landmarks(moved.landmarks)

    def _balance(self) -> dict[str, Doubles]:
        """Return the row of /balance: the motion at the end of the run, and the integrals over the whole run."""
        state, constants = self._motion.state, self._constants
        row = {
            "time": state.time(constants),
            "distance": state.distance(constants),
            "displacement": state.displacement,
            "velocity": state.velocity(constants),
            **state.integrals,
        }
        return {name: np.array([value]) for name, value in row.items()}

    def _write_known(self) -> None:
        """Write the waiting rows up to the first one with unknown times; write all of them if the run is over."""
        waiting, (birth, death) = self._waiting, self._times
        beyond = waiting.natural_death > self._model.distance
        known = ~np.isnan(death) | (beyond & (np.signbit(waiting.birth) | ~np.isnan(birth)))
        count = len(waiting) if self._motion.finished or known.all() else int(np.argmin(known))
        if count:
            self._write_junctions(waiting.part(0, count), self._times[:, :count])
            self._waiting, self._times = waiting.at(np.arange(count, len(waiting))), self._times[:, count:].copy()
            self._written += count

    def _write_junctions(self, rows: LiveRows, times: Doubles) -> None:
        columns = junction_columns(self._model, rows)
        self._sink.write("junctions", self._written, columns | {"birth_time": times[0], "death_time": times[1]})
