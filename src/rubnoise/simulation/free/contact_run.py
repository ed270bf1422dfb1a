"""A free slider from block to block: the encounters of each, its motion through them, and the rows of the block."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.contact.distributions import Law as StrengthLaw
from rubnoise.errors import RubnoiseError
from rubnoise.simulation.free.contacts import CONTACT, Law, Records, Series
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
    Output,
    Surface,
    advance,
)
from rubnoise.simulation.free.series import ORDER
from rubnoise.streams import Stream, uniforms

_ROOM: Final = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeRows:
    """The rows of a block, records as in `motion`; places count from the origin of the block.

    touches: from contact made to contact lost, in order of loss; layers: number of layers of encounters that were
    needed.
    """

    block: int
    ticks: Records
    touches: Records
    marks: Records
    layers: int


class FreeRun:
    """A free slider as it moves, which begins at z = z' = 0; ``contacts`` are its present ones."""

    def __init__(
        self, law: Law, surface: RoughSurface, strengths: StrengthLaw | None = None, start: float = 0.0, layers: int = 1
    ) -> None:
        """Begin; strengths: of encounters (None: equal); start: x of a slider at rest; layers: drawn at least."""
        self._law, self.surface, self._strengths, self._layers, self._block = law, surface, strengths, layers, 0
        self._series = Series(np.zeros(ORDER + 1), np.zeros(ORDER + 1), np.zeros((3, 4)))
        self._state = np.zeros(1, STATE)
        self._state["x"], self._state["sliding"], self._state["fresh"] = start, -1, -1
        self.contacts = self._touched()

    def through(self, ticks: int) -> Iterator[FreeRows]:
        """Yield the rows block by block up to a tick; raise RubnoiseError if the motion cannot continue."""
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

    def _moved(self, ticks: int, *, final: bool) -> FreeRows:
        """Move through the block and return its rows; draw deeper layers, and make room, where they are needed."""
        state, layers = self._state, self._layers
        end = (ticks - 1) * self.surface.tick if final else self.surface.length
        goal = Goal(end, ticks, self.surface.tick)
        out = Output(np.empty(ticks, TICK), np.empty(_ROOM, TOUCH), np.empty(_ROOM, MARK))
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
        return FreeRows(
            block=self._block - 1,
            ticks=out.ticks,
            touches=np.concatenate(touches),
            marks=np.concatenate(marks),
            layers=layers,
        )
