"""A slider that is free to leave its contact: this module plays its blocks and writes their rows.

A block is a range of ticks. In it the motion decides where summits are touched and left; each touch is a row of
/junctions. Rows are written in order of birth, so a row waits until every older touch has ended.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, pi, sqrt
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, Integers
from rubnoise.contact.distributions import Law
from rubnoise.errors import RubnoiseError
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.rows import Appender, Columns, JunctionState, Sink
from rubnoise.simulation.area import has_one_strength
from rubnoise.simulation.free.encounters import LAYERS, RoughSurface
from rubnoise.simulation.free.motion import (
    DEEPER,
    DONE,
    LOST,
    MARK,
    STATE,
    SUMMIT,
    TICK,
    TOUCH,
    Goal,
    Room,
    Surface,
    advance,
)
from rubnoise.simulation.free.step import CONTACT, ORDER, Constants, Records, Series
from rubnoise.simulation.state import State, Watch
from rubnoise.streams import Stream, uniforms

_ROOM: Final = 4096


class FreeRun:
    """A free slider as it moves, which begins at z = z' = 0; ``contacts`` are its present ones."""

    def __init__(
        self, law: Constants, surface: RoughSurface, strengths: Law | None = None, start: float = 0.0, layers: int = 1
    ) -> None:
        """Begin; strengths: of encounters (None: equal); start: x of a slider at rest; layers: drawn at least."""
        self._law, self.surface, self._strengths, self._layers, self._block = law, surface, strengths, layers, 0
        self._series = Series(np.zeros(ORDER + 1), np.zeros(ORDER + 1), np.zeros((3, 4)))
        self._state = np.zeros(1, STATE)
        self._state["x"], self._state["sliding"], self._state["fresh"] = start, -1, -1
        self.contacts = self._touched()

    def through(self, ticks: int) -> Iterator[Room]:
        """Yield the rows block by block up to a tick; raise RubnoiseError if the motion cannot continue.

        Places count from the origin of the block; touches, from contact made to contact lost, are in order of loss.
        """
        while self._block <= ticks // self.surface.ticks:
            left = ticks - self._block * self.surface.ticks
            yield self._moved(min(left + 1, self.surface.ticks), final=left < self.surface.ticks)

    def _touched(self) -> Records:
        """Return the encounters in contact at the start, with the weights that their rates give them."""
        found = self.surface.around(0, 1)
        found = found[found["height"] > found["place"] ** 2]
        contacts, place = np.zeros(found.size, CONTACT), found["place"]
        for name in ("place", "height", "number"):
            contacts[name] = found[name]
        contacts["share"], contacts["largest"] = self._shares(found["number"]), found["height"] - place * place
        contacts["weight"] = np.where(place > 0.0, 1.0, self._law.unloaded)
        if self._law.growth > 0.0:
            contacts["weight"] = 1.0 + self._law.growth * 2.0 * self._law.speed * place > 0.0
        contacts["made"] = -np.inf
        return contacts

    def _shares(self, number: Integers) -> Doubles:
        """Return the strengths of encounters over their mean, drawn from their own stream by the numbers."""
        shares, block = np.ones(number.size), number >> 24
        if self._strengths is None:
            return shares
        for each in np.unique(block):
            index = number[block == each] & (2**24 - 1)
            drawn = uniforms(self.surface.seed, Stream.STRENGTHS, int(each), int(index.max()) + 1)[index]
            shares[block == each] = self._strengths.quantile(drawn) / self._strengths.mean
        return shares

    def _pool(self, layers: int) -> Surface:
        """Return the encounters that a slider above the bottom can touch in the block, in order of entry."""
        found, bottom = self.surface.around(self._block, layers), self.surface.bottom(layers)
        pool, half = np.zeros(found.size, SUMMIT), np.sqrt(found["height"] - bottom)
        for name in ("place", "height", "number"):
            pool[name] = found[name]
        pool["entry"], pool["leave"] = found["place"] - half, found["place"] + half
        pool = pool[(pool["leave"] >= 0.0) & (pool["entry"] <= self.surface.length)]
        pool = pool[np.argsort(pool["entry"], kind="stable")]
        pool["share"] = self._shares(pool["number"])
        pool["touching"] = np.isin(pool["number"], self.contacts["number"])
        return Surface(pool, np.empty(pool.size + 1, np.int64), bottom)

    def _moved(self, ticks: int, *, final: bool) -> Room:
        """Move through the block and return its rows; draw deeper layers, and make room, where they are needed."""
        state, layers = self._state, self._layers
        end = (ticks - 1) * self.surface.tick if final else self.surface.length
        goal = Goal(end, ticks, self.surface.tick)
        out = Room(np.empty(ticks, TICK), np.empty(_ROOM, TOUCH), np.empty(_ROOM, MARK))
        touches, marks, code = [], [], DEEPER
        state["count"], state["tick"] = self.contacts.size, 0
        contacts = np.concatenate([self.contacts, np.zeros(64, CONTACT)])
        while code != DONE:
            if code == DEEPER:
                surface = self._pool(layers)
                state["next"] = state["listed"] = 0
            state["touches"] = state["marks"] = 0
            code = advance(state, self._law, contacts, surface, goal, out, self._series)
            touches.append(out.touches[: state["touches"][0]].copy())
            marks.append(out.marks[: state["marks"][0]].copy())
            self.contacts = contacts[: state["count"][0]]
            if code == LOST or (code == DEEPER and layers == LAYERS):
                raise RubnoiseError(f"the normal motion cannot go on in block {self._block}")
            if code == DEEPER:
                layers += 1
            elif state["count"][0] + 2 > contacts.size:
                contacts = np.concatenate([contacts, np.zeros_like(contacts)])
        self.contacts["place"] -= self.surface.length
        self.contacts["ago"] += 1
        state["s"] = 0.0
        self._block += 1
        return Room(out.ticks, np.concatenate(touches), np.concatenate(marks))


_TOUCH: Final = np.dtype(
    [(name, np.float64) for name in ("birth", "death", "overlap", "share")] + [("number", np.int64)]
)
"""A touch: its begin and end (um; infinite outside the run), largest overlap (s_0), share, and the summit's number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scales:
    """The units of free motion: c and s_0 in um, omega_c in 1/s, W in uN.

    along: the unit of displacement along the surface, E[psi] A_rm/(m omega_c^2), in um; 1 without a slider.
    """

    length: float
    height: float
    rate: float
    load: float
    along: float

    @classmethod
    def of(cls, model: Model, free: FreeSeparation) -> Self:
        """Return the scales: c^2 = 4 A_rm/(pi N), omega_c^2 = W/(m s_0)."""
        held, along = free.held, 1.0
        length = sqrt(4.0 / pi * model.mean_real_contact_area / model.mean_junction_count)
        rate = sqrt(held.load / held.height_scale / held.mass)
        if model.slider is not None and model.strengths is not None:
            along = model.strengths.mean * model.mean_real_contact_area / (model.slider.mass * rate * rate)
        return cls(length=length, height=held.height_scale, rate=rate, load=held.load, along=along)

    def law(self, model: Model, free: FreeSeparation) -> Constants:
        """Return the constants of the motion."""
        slider, own = model.slider, (0.0, 0.0)
        if slider is not None:
            mass = slider.mass * self.rate
            own = slider.damping / mass, slider.stiffness / (mass * self.rate)
        return Constants(
            (model.sliding_speed or 0.0) / (self.length * self.rate),
            1.0 / model.mean_junction_count,
            free.held.damping / (free.held.mass * self.rate),
            1.0 if free.restitution is None else free.restitution * free.restitution,
            (free.impact_damping or 0.0) * self.height * self.rate,
            *own,
        )


class FreeMotion:
    """A free slider from the start of a run to its end, and the touches that wait for older ones."""

    def __init__(self, model: Model, free: FreeSeparation, seed: int, sink: Sink, watch: Watch | None = None) -> None:
        """Begin; ``watch``: is called after each block."""
        self._model, self._sink, self._watch = model, sink, watch
        self._scales = Scales.of(model, free)
        surface = RoughSurface.of(model.mean_junction_count, seed, model.tick / self._scales.length)
        strengths = None if has_one_strength(model) else model.strengths
        start = model.equilibrium_displacement / self._scales.along
        self._run = FreeRun(self._scales.law(model, free), surface, strengths, start)
        self._blocks = self._run.through(model.tick_count)
        self._waiting = np.empty(0, _TOUCH)
        self._landmarks = Appender(sink, "landmarks", 0)

    def next_state(self, state: State) -> State:
        """Play one block, write its rows, and return the state after it; raise RubnoiseError if it cannot go on."""
        rows = next(self._blocks)
        ticks = state.ticks + rows.ticks.size
        final = ticks > self._model.tick_count
        self._write_ticks(rows, state.ticks)
        known = self._known(self._touches(rows, state.block), final=final)
        self._write_junctions(known, state.junctions)
        self._write_landmarks(rows, self._origin(state.block))
        junctions = state.junctions + known.size
        if self._watch is not None:
            self._watch(float(ticks - 1) * self._model.tick, junctions, self._run.contacts.size)
        return State(block=state.block + 1, junctions=junctions, ticks=ticks)

    def _origin(self, block: Any) -> Any:
        """Return where blocks begin, in um."""
        return np.float64(block * self._run.surface.ticks) * self._model.tick

    def _along(self, x: Doubles, u: Doubles) -> dict[str, Doubles]:
        """Return displacement (um) and velocity (um/s) along the surface; nothing without a slider."""
        if self._model.slider is None:
            return {}
        return {"displacement": self._scales.along * x, "velocity": self._scales.along * self._scales.rate * u}

    def _write_ticks(self, rows: Room, first: int) -> None:
        model, scales, ticks = self._model, self._scales, rows.ticks
        distance = np.arange(first, first + ticks.size).astype(np.float64) * model.tick
        time, live = distance / (model.sliding_speed or 1.0), ticks["live"]
        overlap = np.maximum(ticks["overlap"], 0.0)  # rounding may make that of a new touch negative
        mean = np.full(live.size, np.nan)
        np.divide(scales.height * model.mean_junction_count * overlap, live, out=mean, where=live > 0.0)
        trace: dict[str, NDArray[Any]] = {
            "distance": distance,
            "real_contact_area": model.mean_real_contact_area * overlap,
            "junction_count": live.astype(np.uint32),
        }
        groups: dict[str, Columns] = {"trace": trace}
        groups["load"] = {
            "time": time,
            "separation": scales.height * ticks["z"],
            "velocity": scales.height * scales.rate * ticks["w"],
            "load": scales.load * np.maximum(ticks["load"], 0.0),
            "live_overlap": mean,
        }
        if model.strengths is not None:
            push = model.strengths.mean * model.mean_real_contact_area
            trace["friction_force"] = push * np.maximum(ticks["shared"], 0.0)
        if model.slider is not None:
            moved = {"time": time, "distance": distance, "friction_force": trace["friction_force"]}
            groups["slider"] = moved | self._along(ticks["x"], ticks["u"])
        for group, columns in groups.items():
            self._sink.write(group, first, columns)

    def _touches(self, rows: Room, block: int) -> NDArray[Any]:
        """Return the touches that ended in the block, and then those that have not ended."""
        ended, alive, unit = rows.touches, self._run.contacts, self._scales.length
        touches = np.empty(ended.size + alive.size, _TOUCH)
        for name, there in (("number", "number"), ("overlap", "largest"), ("share", "share")):
            touches[name] = np.concatenate([ended[there], alive[there]])
        made = np.concatenate([block - ended["ago"], block + 1 - alive["ago"]])
        touches["birth"] = self._origin(made) + unit * np.concatenate([ended["made"], alive["made"]])
        touches["death"] = np.concatenate([self._origin(block) + unit * ended["lost"], np.full(alive.size, inf)])
        return touches

    def _known(self, touches: NDArray[Any], *, final: bool) -> NDArray[Any]:
        """Return the touches whose rows can be written, in order of birth, and keep the ended ones that must wait."""
        rows = np.concatenate([self._waiting, touches])
        rows = rows[np.lexsort((rows["number"], rows["birth"]))]
        if final:
            return rows
        alive = np.isinf(rows["death"])
        known = rows["birth"] < rows["birth"][alive].min(initial=inf)
        self._waiting = rows[~known & ~alive]
        return rows[known]

    def _write_junctions(self, rows: NDArray[Any], first: int) -> None:
        """Write touches; those that reach beyond the run are cut at its begin or end."""
        model, scales = self._model, self._scales
        at_start, at_end = np.isinf(rows["birth"]), np.isinf(rows["death"])
        birth = np.where(at_start, 0.0, rows["birth"])
        death = np.where(at_end, float(model.tick_count) * model.tick, rows["death"])
        state = at_start * int(JunctionState.ALIVE_AT_START) | at_end * int(JunctionState.ALIVE_AT_END)
        overlap, speed = np.maximum(rows["overlap"], 0.0), model.sliding_speed or 1.0
        found: dict[str, NDArray[Any]] = {
            "junction": np.arange(first, first + birth.size, dtype=np.int64),
            "encounter": rows["number"],
            "birth_distance": birth,
            "death_distance": death,
            "life_distance": death - birth,
            "diameter": scales.length * np.sqrt(overlap),
            "max_area": model.mean_real_contact_area / model.mean_junction_count * overlap,
            "max_overlap": scales.height * overlap,
            "birth_time": birth / speed,
            "death_time": death / speed,
            "state": state.astype(np.uint8),
        }
        if model.strengths is not None:
            found["shear_strength"] = model.strengths.mean * rows["share"]
        self._sink.write("junctions", first, found)

    def _write_landmarks(self, rows: Room, begin: float) -> None:
        marks, scales, first = rows.marks, self._scales, self._landmarks.rows
        distance = begin + scales.length * marks["place"]
        found: dict[str, NDArray[Any]] = {
            "landmark": first + np.arange(distance.size, dtype=np.int64),
            "time": distance / (self._model.sliding_speed or 1.0),
            "distance": distance,
            "kind": marks["kind"].astype(np.uint8),
            "impact_speed": scales.height * scales.rate * marks["speed"],
        }
        self._landmarks.append(found | self._along(marks["x"], marks["u"]))
