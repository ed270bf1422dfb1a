"""Some blocks of a run made again from its seed, and compared with what the file has of them, bit for bit.

Of all checks this one alone runs the simulation; it is loaded only where blocks are made again.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

import numpy as np

from rubnoise.analysis.reading import Chunk, chunks
from rubnoise.analysis.verifying.blocks import BlockTable, block_table, slider_before
from rubnoise.analysis.verifying.findings import Check, LeftOut, Notes
from rubnoise.analysis.verifying.lives import ended_early
from rubnoise.analysis.verifying.origin import CONSTANTS, stored_constants
from rubnoise.model import Model
from rubnoise.record.reader import Reader, Rows
from rubnoise.record.sink import Columns
from rubnoise.simulation.draws import start
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate, slider_constants
from rubnoise.simulation.state import LiveRows, State

UNTOUCHED: Final = (
    "junction",
    "birth_distance",
    "diameter",
    "lateral_offset",
    "max_area",
    "shear_strength",
    "birth_time",
)
"""Columns of /junctions that an interrupt leaves as they are."""


class _BlockIsOver(Exception):  # noqa: N818  (nothing is wrong)
    """Raised where the block that was asked for has been played."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Compared:
    """A sink that keeps nothing: it notes where rows are not those of a file.

    ``touched``: interrupts have changed the block in the file, and only what they leave as it is can be compared.
    """

    rows: Rows
    notes: Notes
    touched: bool

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Compare rows of a group (see Sink)."""
        if group not in self.rows.columns or (self.touched and group != "junctions"):
            return
        for name, values in columns.items():
            if self.touched and name not in UNTOUCHED:
                continue
            found = self.rows.column(group, name, first_row, first_row + values.size)
            if found.size == values.size:
                self.notes.equal(f"/{group}/{name}", first_row, found, values)
            else:
                self.notes.say(f"/{group}/{name} rows", found=first_row + found.size, expected=first_row + values.size)


def regeneration_check(model: Model, run: Reader, seed: int, count: int) -> tuple[Check, list[LeftOut]]:
    """Return whether ``count`` blocks, spread evenly from the first to the last, come out again bit for bit.

    Each goes on from the rows of the junctions that were alive before it and from the slider's last tick. Blocks in
    which an interrupt ended a life are compared by their births and sizes alone. A two-way motion depends on all that
    it has come through, to the bit: of such a run it is the first ``count`` blocks.
    """
    if model.is_two_way:
        return _from_the_start(model, run, seed, count)
    notes, table = Notes("regenerated"), block_table(model, run)
    expected = extent(model, seed)
    notes.say("/junctions rows", found=run.rows("junctions"), expected=expected.junctions)
    _check_constants(notes, model, run)
    touched = []
    for state, changed in _starts(model, run, seed, table, chosen_blocks(len(table), count)):
        sink = Compared(rows=run, notes=notes, touched=changed)
        _play(model, seed, sink, state)
        touched += [state.block] if changed else []
    return notes.check(), _left_out(touched)


def _from_the_start(model: Model, run: Reader, seed: int, count: int) -> tuple[Check, list[LeftOut]]:
    notes, blocks, expected = Notes("regenerated"), run.rows("blocks"), extent(model, seed)
    notes.say("/junctions rows", found=run.rows("junctions"), expected=expected.junctions)
    notes.say("/blocks rows", found=blocks, expected=expected.blocks)

    def leave(state: State) -> None:
        if state.block >= count:
            raise _BlockIsOver

    with suppress(_BlockIsOver):
        sink = Compared(rows=run, notes=notes, touched=False)
        last = simulate(model, seed, sink, engine="batch", commit=leave, alone=True)
        notes.say("/slider rows", found=run.rows("slider"), expected=last.slider_rows)
    if count >= blocks:
        return notes.check(), []
    reason = f"the first {count:,} of {blocks:,} blocks were made again: a two-way motion can be from its start alone"
    return notes.check(), [LeftOut(name="regenerated", reason=reason)]


def chosen_blocks(blocks: int, count: int) -> list[int]:
    """Return so many numbers of blocks, or all there are, spread evenly from the first to the last."""
    return np.unique(np.rint(np.linspace(0, blocks - 1, min(count, blocks)))).astype(int).tolist()


def _play(model: Model, seed: int, sink: Compared, state: State) -> None:
    """Play the block that a state begins, and no other."""

    def leave(_state: State) -> None:
        raise _BlockIsOver

    try:
        simulate(model, seed, sink, engine="events", state=state, commit=leave, alone=True)
    except _BlockIsOver:
        return


def _starts(model: Model, run: Reader, seed: int, table: BlockTable, blocks: list[int]) -> Iterator[tuple[State, bool]]:
    """Yield the state before each block, from the rows of the file, and whether interrupts have changed the block."""
    live, touched = _alive_before(model, run, table, blocks)
    for block in blocks:
        if block == 0:
            yield start(model, seed), touched[block]
            continue
        tick, birth = int(table.first_tick[block]), float(table.birth[block])
        displacement, velocity = slider_before(model, run, tick)
        yield (
            State(
                block=block,
                begin=birth,
                next_birth=birth,
                junctions=int(table.first_junction[block]),
                ticks=tick,
                events=0,
                live=live[block],
                slider_rows=tick if "slider" in run.columns else 0,
                displacement=displacement,
                velocity=velocity,
            ),
            touched[block],
        )


def _alive_before(
    model: Model, run: Reader, table: BlockTable, blocks: list[int]
) -> tuple[dict[int, LiveRows], dict[int, bool]]:
    """Return who lived on beyond the last tick before each block, and whether an interrupt ended a life since.

    All rows are read once, whatever the number of blocks.
    """
    live = {block: LiveRows.none() for block in blocks}
    touched = dict.fromkeys(blocks, False)
    limits = (table.first_tick - 1) * model.tick
    ends = np.append(table.first_junction[1:], run.rows("junctions"))
    for chunk in chunks(run, "junctions"):
        row, early, death = np.arange(chunk.first, chunk.end), ended_early(chunk), chunk["death_distance"]
        rows = _as_live(chunk)
        reached = (table.first_junction < chunk.end) | (limits < death.max(initial=-np.inf))
        for block in (block for block in blocks if reached[block] and ends[block] > chunk.first):
            before = row < table.first_junction[block]
            carried = before & (death > limits[block])
            live[block] = live[block].then(rows.at(np.flatnonzero(carried)))
            within = carried | (~before & (row < ends[block]))
            touched[block] = touched[block] or bool(np.any(early & within))
    return live, touched


def _as_live(chunk: Chunk) -> LiveRows:
    """Return rows of a file as those of a state in which no junction has left yet."""
    birth = chunk["birth_distance"]
    return LiveRows(
        junction=np.arange(chunk.first, chunk.end),
        birth=birth,
        diameter=chunk["diameter"],
        strength=chunk["shear_strength"] if "shear_strength" in chunk else np.ones(birth.size),
        departure=np.full(birth.size, np.inf),
        offset=chunk.get("lateral_offset"),
    )


def _check_constants(notes: Notes, model: Model, run: Reader) -> None:
    """Compare the constants of the slider's step, computed anew, with those of the file."""
    constants, from_file = slider_constants(model), stored_constants(run)
    for name, value in constants.named().items() if constants else ():
        notes.say(f"{CONSTANTS} {name}", found=from_file.get(name), expected=value)


def _left_out(touched: list[int]) -> list[LeftOut]:
    if not touched:
        return []
    which = ", ".join(map(str, touched))
    reason = f"interrupts ended lives in block {which}: only births, sizes and strengths could be compared there"
    return [LeftOut(name="regenerated", reason=reason)]
