"""A run of a free slider as a fold: block by block from one state to the next, with the rows of each block."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.contact.laws import Law
from rubnoise.errors import RubnoiseError
from rubnoise.simulation.free import contacts as held
from rubnoise.simulation.free import motion
from rubnoise.simulation.free.encounters import LAYERS, Encounters, RoughSurface
from rubnoise.streams import Stream, uniforms

_ROOM: Final = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeContact:
    """The parameters of a free motion, in the units c, s_0, 1/omega_c, W.

    live: N, mean number of live junctions at z = 0; speed: v; damping_ratio: of the dashpot beside the contact, 0 for
    none; restitution: e, or else impact_damping: beta s_0 omega_c; tick: in c. slider: drag over mass, spring over mass
    and start displacement of a slider along the surface, which starts at rest and is driven by (1/N) sum of strengths
    times overlaps; without a slider, the spring is 0.
    """

    live: float
    speed: float
    tick: float
    damping_ratio: float = 0.0
    restitution: float | None = None
    impact_damping: float | None = None
    slider: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def constants(self) -> Doubles:
        """Return the constants of a run, at the places in `contacts`."""
        found = np.zeros(held.CONSTANTS)
        free = self.restitution is None
        found[held.LAW] = held.IMPACT_DAMPING if free else held.RESTITUTION
        found[held.SPEED], found[held.PER_LIVE] = self.speed, 1.0 / self.live
        found[held.DRAG] = 2.0 * self.damping_ratio
        found[held.UNLOADED] = (self.restitution or 0.0) * (self.restitution or 0.0)
        found[held.GROWTH] = self.impact_damping or 0.0
        found[held.OWN_DRAG], found[held.OWN_SPRING], _ = self.slider
        found[held.TICK] = self.tick
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeState:
    """The state of a free slider at the start of a block: numbers and encounters in contact, as in `contacts`."""

    block: int
    sliding: int
    fresh: int
    numbers: Doubles
    contacts: Doubles


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeRows:
    """The rows of a block, with columns as in `motion`; places count from the origin of the block.

    ticks (8, n): the motion at each tick; touches (6, n): from contact made to contact lost, in order of loss; marks
    (5, n): where the last contact was lost and the first was made; steps: number of steps; layers: number of layers of
    encounters that were needed.
    """

    block: int
    ticks: Doubles
    touches: Doubles
    marks: Doubles
    steps: int
    layers: int


class FreeRun:
    """A moving free slider; ``state`` is its present state."""

    def __init__(
        self,
        contact: FreeContact,
        seed: int,
        state: FreeState | None = None,
        strengths: Law | None = None,
        layers: int = 1,
    ) -> None:
        """Begin at z = z' = 0, or continue from ``state``; strengths: of encounters (None: equal); layers: at least."""
        self.surface = RoughSurface.of(contact.live, seed, contact.tick)
        self._contact, self._strengths, self._layers = contact, strengths, layers
        self._constants = contact.constants()
        self.state = self._start() if state is None else state

    def through(self, ticks: int) -> Iterator[FreeRows]:
        """Yield the rows block by block up to a tick; raise RubnoiseError if the motion cannot continue."""
        last = ticks // self.surface.ticks
        while self.state.block <= last:
            left = ticks - self.state.block * self.surface.ticks
            yield self._block(min(left + 1, self.surface.ticks), final=self.state.block == last)

    def _start(self) -> FreeState:
        around = self._around(0, 1)
        overlap = around.height - around.place * around.place
        inside = np.flatnonzero(overlap > 0.0)
        contacts = np.zeros((held.COLUMNS, inside.size))
        contacts[held.PLACE], contacts[held.HEIGHT] = around.place[inside], around.height[inside]
        contacts[held.NUMBER] = around.number[inside]
        contacts[held.SHARE] = self._shares(around.number[inside])
        contacts[held.WEIGHT] = 1.0
        if self._contact.restitution is not None:
            unloaded = float(self._constants[held.UNLOADED])
            contacts[held.WEIGHT] = np.where(around.place[inside] > 0.0, 1.0, unloaded)
        else:
            rate = 2.0 * self._contact.speed * around.place[inside]
            contacts[held.WEIGHT] = 1.0 * (1.0 + self._constants[held.GROWTH] * rate > 0.0)
        contacts[held.MADE] = -np.inf
        contacts[held.LARGEST] = overlap[inside]
        numbers = np.zeros(held.NUMBERS)
        numbers[held.X] = self._contact.slider[2]
        return FreeState(block=0, sliding=-1, fresh=-1, numbers=numbers, contacts=contacts)

    def _around(self, block: int, layers: int) -> Encounters:
        return self.surface.around(block, layers)

    def _shares(self, number: Integers) -> Doubles:
        """Return the strengths of encounters over their mean, drawn from their own stream by the numbers."""
        if self._strengths is None or not number.size:
            return np.ones(number.size)
        drawn = [
            uniforms(self.surface.seed, Stream.STRENGTHS, int(block), int(index.max()) + 1)[index]
            for block in np.unique(number >> 24)
            for index in (number[number >> 24 == block] & (2**24 - 1),)
        ]
        order = np.argsort(number >> 24, kind="stable")
        shares = np.empty(number.size)
        shares[order] = self._strengths.quantile(np.concatenate(drawn)) / self._strengths.mean
        return shares

    def _pool(self, layers: int) -> tuple[Doubles, Doubles]:
        """Return the pool of the block, and the numbers of its encounters."""
        around, bottom = self._around(self.state.block, layers), self.surface.bottom(layers)
        half = np.sqrt(around.height - bottom)
        near = np.flatnonzero((around.place + half >= 0.0) & (around.place - half <= self.surface.length))
        order = near[np.argsort((around.place - half)[near], kind="stable")]
        pool = np.empty((motion.POOL, order.size))
        pool[motion.POOL_PLACE], pool[motion.POOL_HEIGHT] = around.place[order], around.height[order]
        pool[motion.POOL_SHARE] = self._shares(around.number[order])
        pool[motion.POOL_NUMBER] = around.number[order]
        pool[motion.ENTRY], pool[motion.LEAVE] = (around.place - half)[order], (around.place + half)[order]
        return pool, around.number[order].astype(float)

    def _block(self, ticks: int, *, final: bool) -> FreeRows:
        state, constants, layers = self.state, self._constants, self._layers
        numbers, whole = state.numbers.copy(), np.zeros(motion.WHOLE, np.int64)
        count = state.contacts.shape[1]
        whole[motion.COUNT], whole[motion.SLIDING], whole[motion.FRESH] = count, state.sliding, state.fresh
        contacts = np.zeros((held.COLUMNS, count + 64))
        contacts[:, :count] = state.contacts
        end = float(ticks - 1) * self._contact.tick if final else self.surface.length
        rows = np.empty((motion.TICK_COLUMNS, ticks))
        out = (rows, np.empty((motion.TOUCH_COLUMNS, _ROOM)), np.empty((motion.MARK_COLUMNS, _ROOM)))
        touches, marks, work = (
            [np.empty((motion.TOUCH_COLUMNS, 0))],
            [np.empty((motion.MARK_COLUMNS, 0))],
            np.zeros(motion.WORK),
        )
        pool, number = self._pool(layers)
        code = motion.DEEPER
        while True:
            if code == motion.DEEPER:
                touching = np.isin(number, contacts[held.NUMBER, : whole[motion.COUNT]]).astype(np.uint8)
                listed = np.empty(number.size + 1, np.int64)
                whole[motion.NEXT] = whole[motion.LISTED] = 0
            code = motion.advance(
                numbers,
                whole,
                constants,
                contacts,
                pool,
                touching,
                listed,
                self.surface.bottom(layers),
                end,
                ticks,
                out,
                work,
            )
            touches.append(out[1][:, : whole[motion.TOUCHES]].copy())
            marks.append(out[2][:, : whole[motion.MARKS]].copy())
            whole[motion.TOUCHES] = whole[motion.MARKS] = 0
            if code == motion.DONE:
                break
            if code == motion.LOST or layers == LAYERS:
                raise RubnoiseError(f"the normal motion cannot go on in block {state.block}")
            if code == motion.DEEPER:
                layers += 1
                pool, number = self._pool(layers)
            elif whole[motion.COUNT] + 2 > contacts.shape[1]:
                contacts = np.concatenate([contacts, np.zeros_like(contacts)], axis=1)
        kept = contacts[:, : whole[motion.COUNT]].copy()
        kept[held.PLACE] -= self.surface.length
        kept[held.MADE] -= self.surface.length
        numbers[held.S] = 0.0
        self.state = replace(
            state,
            block=state.block + 1,
            sliding=int(whole[motion.SLIDING]),
            fresh=int(whole[motion.FRESH]),
            numbers=numbers,
            contacts=kept,
        )
        return FreeRows(
            block=state.block,
            ticks=rows,
            touches=np.concatenate(touches, axis=1),
            marks=np.concatenate(marks, axis=1),
            steps=int(whole[motion.STEPS]),
            layers=layers,
        )
