"""A slider that is free to leave its contact: this module plays its blocks and writes their rows.

A block is a range of ticks. In it the motion decides where summits are touched and left; each touch is a row of
/junctions. Rows are written in order of birth, so a row waits until every older touch has ended.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.rows import JunctionState
from rubnoise.record.sink import Appender, Sink
from rubnoise.simulation.block import RunSetup
from rubnoise.simulation.free import contacts as held
from rubnoise.simulation.free import motion as columns
from rubnoise.simulation.free.fold import FreeContact, FreeRows, FreeRun, FreeState
from rubnoise.simulation.free.scales import Scales
from rubnoise.simulation.state import State

_NUMBER, _BIRTH, _DEATH, _OVERLAP, _SHARE = range(5)
_ROWS: Final = 5
"""Rows of a touch: its summit, begin and end (um; infinite outside the run), largest overlap (s_0), and share."""

PlayTouches = Callable[[float, float, Doubles, Doubles], None]
"""Plays the touches of a block; called with its begin and end and those of each touch (um)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Past:
    """What a block continues from: landmarks so far, touches that wait for older ones, the motion (None at first)."""

    landmarks: int = 0
    waiting: Doubles = field(default_factory=lambda: np.empty((_ROWS, 0)))
    motion: FreeState | None = None


def next_free_state(run: RunSetup, free: FreeSeparation, state: State, play: PlayTouches | None = None) -> State:
    """Play one block, write its rows, and return the state from which to continue.

    ``play``: plays the touches as events, if given. Raises RubnoiseError if the motion cannot continue.
    """
    block = _Block(run.model, free, run.seed, run.sink, state)
    after = block.played(play)
    if run.watch is not None:
        run.watch(float(after.ticks - 1) * run.model.tick, after.junctions, block.in_contact)
    return after


class _Block:
    """One block of a free run, from its state to its rows."""

    def __init__(self, model: Model, free: FreeSeparation, seed: int, sink: Sink, state: State) -> None:
        self._model, self._free, self._sink, self._state = model, free, sink, state
        self._scales = Scales.of(model, free)
        self._past = _Past() if state.motion is None else state.motion
        equal = model.strengths is None or isinstance(model.strengths, Fixed)
        contact = _contact(model, free, self._scales)
        self._run = FreeRun(contact, seed, self._past.motion, None if equal else model.strengths)
        self._length = self._run.surface.ticks
        self._push = 0.0 if model.strengths is None else model.strengths.mean * model.mean_real_contact_area

    def played(self, play: PlayTouches | None) -> State:
        """Play the block and return the state after it."""
        state, model = self._state, self._model
        rows = next(self._run.through(model.tick_count))
        self._write_ticks(rows)
        touches, final = self._touches(rows), state.ticks + rows.ticks.shape[1] > model.tick_count
        if play is not None:
            self._among_events(play, touches, final=final)
        known, waiting = self._known(touches, final=final)
        self._write_junctions(known)
        landmarks = self._write_landmarks(rows)
        past = _Past(landmarks=landmarks, waiting=waiting, motion=self._run.state)
        return State(
            block=state.block + 1,
            next_birth=self._origin(state.block + 1),
            junctions=state.junctions + known.shape[1],
            ticks=state.ticks + rows.ticks.shape[1],
            motion=past,
        )

    @property
    def in_contact(self) -> int:
        """Number of summits in contact now."""
        return self._run.state.contacts.shape[1]

    def _origin(self, block: int) -> float:
        return float(block * self._length) * self._model.tick

    def _along(self, x: Any, u: Any) -> tuple[Any, Any]:
        """Return displacement (um) and velocity (um/s) of the slider along the surface."""
        if self._model.slider is None:
            return 0.0, 0.0
        unit = _along_unit(self._model, self._scales)
        return unit * x, unit * self._scales.rate * u

    def _write_ticks(self, rows: FreeRows) -> None:
        model, scales, first, ticks = self._model, self._scales, self._state.ticks, rows.ticks
        distance = np.arange(first, first + ticks.shape[1]).astype(np.float64) * model.tick
        live = ticks[columns.TICK_LIVE]
        overlap = np.maximum(ticks[columns.TICK_OVERLAP], 0.0)  # rounding may make that of a new touch negative
        trace: dict[str, NDArray[Any]] = {
            "distance": distance,
            "real_contact_area": model.mean_real_contact_area * overlap,
            "junction_count": live.astype(np.uint32),
        }
        force = self._push * np.maximum(ticks[columns.TICK_SHARED], 0.0)
        if model.strengths is not None:
            trace["friction_force"] = force
        self._sink.write("trace", first, trace)
        mean = np.full(live.size, np.nan)
        np.divide(scales.height * scales.live * overlap, live, out=mean, where=live > 0.0)
        time = distance / (model.sliding_speed or 1.0)
        load = {
            "time": time,
            "separation": scales.height * ticks[columns.TICK_Z],
            "velocity": scales.height * scales.rate * ticks[columns.TICK_W],
            "load": scales.load * np.maximum(ticks[columns.TICK_LOAD], 0.0),
            "live_overlap": mean,
        }
        self._sink.write("load", first, load)
        if model.slider is not None:
            x, v = self._along(ticks[columns.TICK_X], ticks[columns.TICK_U])
            moved = {"time": time, "distance": distance, "friction_force": force, "displacement": x, "velocity": v}
            self._sink.write("slider", first, moved)

    def _touches(self, rows: FreeRows) -> Doubles:
        """Return the touches that ended in the block, and then those that have not ended."""
        scales, ended, alive = self._scales, rows.touches, self._run.state.contacts
        here, there = self._origin(self._state.block), self._origin(self._state.block + 1)
        birth = [here + scales.length * ended[columns.TOUCH_MADE], there + scales.length * alive[held.MADE]]
        death = [here + scales.length * ended[columns.TOUCH_LOST], np.full(alive.shape[1], inf)]
        pairs = ((columns.TOUCH_NUMBER, held.NUMBER), (columns.TOUCH_LARGEST, held.LARGEST))
        number, overlap = ([ended[mine], alive[other]] for mine, other in pairs)
        share = [ended[columns.TOUCH_SHARE], alive[held.SHARE]]
        return np.array([np.concatenate(each) for each in (number, birth, death, overlap, share)])

    def _among_events(self, play: PlayTouches, touches: Doubles, *, final: bool) -> None:
        begin = self._origin(self._state.block)
        end = self._model.distance if final else self._origin(self._state.block + 1)
        made, lost = (np.clip(touches[each], begin, end) for each in (_BIRTH, _DEATH))
        order = np.lexsort((touches[_NUMBER], made))
        play(begin, end, made[order], lost[order])

    def _known(self, touches: Doubles, *, final: bool) -> tuple[Doubles, Doubles]:
        """Return the touches whose rows can be written, in order of birth, and the ended ones that must wait."""
        rows = np.concatenate([self._past.waiting, touches], axis=1)
        rows = rows[:, np.lexsort((rows[_NUMBER], rows[_BIRTH]))]
        if final:
            return rows, rows[:, :0]
        alive = np.isinf(rows[_DEATH])
        oldest = rows[_BIRTH, alive].min(initial=inf)
        known = rows[_BIRTH] < oldest
        return rows[:, known], rows[:, ~known & ~alive]

    def _write_junctions(self, rows: Doubles) -> None:
        """Write touches; those that reach beyond the run are cut at its begin or end."""
        model, scales, first = self._model, self._scales, self._state.junctions
        end = float(model.tick_count) * model.tick
        at_start, at_end = np.isinf(rows[_BIRTH]), np.isinf(rows[_DEATH])
        birth, death = np.where(at_start, 0.0, rows[_BIRTH]), np.where(at_end, end, rows[_DEATH])
        state = at_start * int(JunctionState.ALIVE_AT_START) | at_end * int(JunctionState.ALIVE_AT_END)
        overlap, speed = np.maximum(rows[_OVERLAP], 0.0), model.sliding_speed or 1.0
        found: dict[str, NDArray[Any]] = {
            "junction": np.arange(first, first + birth.size, dtype=np.int64),
            "encounter": rows[_NUMBER].astype(np.int64),
            "birth_distance": birth,
            "death_distance": death,
            "life_distance": death - birth,
            "diameter": scales.length * np.sqrt(overlap),
            "max_area": model.mean_real_contact_area / scales.live * overlap,
            "max_overlap": scales.height * overlap,
            "birth_time": birth / speed,
            "death_time": death / speed,
            "state": state.astype(np.uint8),
        }
        if model.strengths is not None:
            found["shear_strength"] = model.strengths.mean * rows[_SHARE]
        self._sink.write("junctions", first, found)

    def _write_landmarks(self, rows: FreeRows) -> int:
        marks, scales = rows.marks, self._scales
        appender = Appender(self._sink, "landmarks", self._past.landmarks)
        distance = self._origin(self._state.block) + scales.length * marks[columns.MARK_PLACE]
        found: dict[str, NDArray[Any]] = {
            "landmark": appender.rows + np.arange(distance.size, dtype=np.int64),
            "time": distance / (self._model.sliding_speed or 1.0),
            "distance": distance,
            "kind": marks[columns.MARK_KIND].astype(np.uint8),
            "impact_speed": scales.height * scales.rate * marks[columns.MARK_SPEED],
        }
        if self._model.slider is not None:
            x, v = self._along(marks[columns.MARK_X], marks[columns.MARK_U])
            found |= {"displacement": x, "velocity": v}
        appender.append(found)
        return appender.rows


def _along_unit(model: Model, scales: Scales) -> float:
    """Return the unit of displacement along the surface in um: E[psi] A_rm/(m omega_c^2)."""
    if model.slider is None or model.strengths is None:
        return 1.0
    return model.strengths.mean * model.mean_real_contact_area / (model.slider.mass * scales.rate * scales.rate)


def _contact(model: Model, free: FreeSeparation, scales: Scales) -> FreeContact:
    slider = (0.0, 0.0, 0.0)
    if model.slider is not None:
        mass = model.slider.mass * scales.rate
        spring = model.slider.stiffness / (mass * scales.rate)
        slider = model.slider.damping / mass, spring, model.equilibrium_displacement / _along_unit(model, scales)
    growth = free.impact_damping
    return FreeContact(
        live=scales.live,
        speed=scales.speed,
        tick=scales.tick,
        damping_ratio=0.5 * free.held.damping / (free.held.mass * scales.rate),
        restitution=free.restitution,
        impact_damping=None if growth is None else growth * scales.height * scales.rate,
        slider=slider,
    )
