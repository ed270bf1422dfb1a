"""Where the blocks of a run begin, and some of them made again from the seed and compared bit for bit."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.reading import Ahead, Chunk, chunks
from rubnoise.analysis.verifying.findings import Check, LeftOut, Notes
from rubnoise.analysis.verifying.lives import born_before, ended_early
from rubnoise.analysis.verifying.origin import CONSTANTS, stored_constants
from rubnoise.arrays import Doubles, Integers
from rubnoise.model import Model
from rubnoise.record.reader import Reader, Rows
from rubnoise.record.rows import Phase
from rubnoise.record.sink import Columns
from rubnoise.simulation.draws import start
from rubnoise.simulation.run import extent, simulate, slider_constants
from rubnoise.simulation.state import LiveRows, State


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTable:
    """Where every block begins: its first birth (um), the rows born and the ticks finished before it.

    The first birth of a run without any is infinite here: it lies beyond the run, and no row tells where.
    """

    birth: Doubles
    first_junction: Integers
    first_tick: Integers

    def __len__(self) -> int:
        """Return the number of blocks."""
        return self.birth.size


def block_table(model: Model, rows: Rows) -> BlockTable:
    """Return the blocks of a run: each has max(1000, ceil(10 N_jm)) births, the last one what is left of them.

    A block ends where the next one's first birth happens, and has the ticks before that; the last has all the others.
    """
    size, start, total = max(1000, ceil(10.0 * model.mean_junction_count)), born_before(rows), rows.rows("junctions")
    first_junction = start + size * np.arange(max(ceil((total - start) / size), 1), dtype=np.int64)
    birth = np.full(first_junction.size, np.inf)
    ahead = Ahead(rows)
    for block, row in enumerate(first_junction.tolist()):
        if row < total:
            birth[block] = ahead.column("junctions", "birth_distance", row, row + 1)[0]
    first_tick = np.minimum(_ticks_before(birth, model.tick), model.tick_count + 1)
    first_tick[0] = 0
    return BlockTable(birth=birth, first_junction=first_junction, first_tick=first_tick.astype(np.int64))


def slider_before(model: Model, rows: Rows, tick: int) -> tuple[float, float]:
    """Return displacement (um) and velocity (um/s) at the tick before one, or those of the start."""
    if tick == 0 or "slider" not in rows.columns:
        return model.equilibrium_displacement, 0.0
    displacement, velocity = (rows.column("slider", name, tick - 1, tick)[0] for name in ("displacement", "velocity"))
    return float(displacement), float(velocity)


def block_check(model: Model, rows: Rows) -> Check:
    """Return whether /blocks tells of every block where it begins, and how the slider moved then."""
    notes, table, ahead = Notes("blocks"), block_table(model, rows), Ahead(rows)
    notes.say("/blocks rows", found=rows.rows("blocks"), expected=len(table))
    if rows.rows("blocks") == len(table):
        for chunk in chunks(rows, "blocks"):
            _check_chunk(notes, chunk, model, ahead, table)
    return notes.check()


def _check_chunk(notes: Notes, chunk: Chunk, model: Model, rows: Rows, table: BlockTable) -> None:
    part = slice(chunk.first, chunk.end)
    expected: dict[str, NDArray[Any]] = {
        "block": np.arange(chunk.first, chunk.end),
        "first_junction": table.first_junction[part],
        "first_tick": table.first_tick[part],
    }
    if model.is_two_way:
        expected |= _two_way_before(model, rows, table, part)
    elif "displacement" in chunk:
        moved = [slider_before(model, rows, tick) for tick in table.first_tick[part].tolist()]
        expected["displacement"], expected["velocity"] = np.array(moved).T
    for name, values in expected.items():
        notes.equal(f"/blocks/{name}", chunk.first, chunk[name], values)
    birth, known = chunk["birth_distance"], np.isfinite(table.birth[part])
    notes.equal("/blocks/birth_distance", chunk.first, birth, np.where(known, table.birth[part], birth))
    notes.holds("/blocks/birth_distance", chunk.first, birth, known | (birth > model.distance), "beyond the run")


def _two_way_before(model: Model, rows: Rows, table: BlockTable, part: slice) -> dict[str, NDArray[Any]]:
    """Return the last row of /slider before each block is reached: where its first birth is passed, or at the start."""
    names, total = ("time", "distance", "phase", "displacement", "velocity"), rows.rows("slider")
    chosen = []
    for block, junction in enumerate(table.first_junction[part].tolist(), start=part.start):
        if block == 0:
            chosen.append((0.0, 0.0, int(Phase.SLIP), model.equilibrium_displacement, 0.0))
            continue
        passed = rows.column("junctions", "birth_time", junction, junction + 1)[0]
        low, high = 0, total
        while low < high:
            middle = (low + high) // 2
            if rows.column("slider", "time", middle, middle + 1)[0] <= passed:
                low = middle + 1
            else:
                high = middle
        row = max(low - 1, 0)
        chosen.append(tuple(rows.column("slider", name, row, row + 1)[0] for name in names))
    return {name: np.array(values) for name, values in zip(names, zip(*chosen, strict=True), strict=True)}


def _ticks_before(place: Doubles, tick: float) -> Doubles:
    """Return how many ticks i * tick lie before places in um; division alone may be off by one."""
    count = np.ceil(place / tick)
    for step in (1.0, 1.0, -1.0):
        wrong = count * tick < place if step > 0.0 else (count - 1.0) * tick >= place
        count = np.where(np.isfinite(count) & wrong, np.maximum(count + step, 0.0), count)
    return count


UNTOUCHED: Final = ("junction", "birth_distance", "diameter", "max_area", "shear_strength", "birth_time")
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
    return notes.check(), _told(touched)


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
    """Return rows of a file as those of a state in which nobody has left yet."""
    birth = chunk["birth_distance"]
    return LiveRows(
        junction=np.arange(chunk.first, chunk.end),
        birth=birth,
        diameter=chunk["diameter"],
        strength=chunk["shear_strength"] if "shear_strength" in chunk else np.ones(birth.size),
        departure=np.full(birth.size, np.inf),
    )


def _check_constants(notes: Notes, model: Model, run: Reader) -> None:
    """Compare the constants of the slider's step, computed anew, with those of the file."""
    constants, told = slider_constants(model), stored_constants(run)
    for name, value in constants.named().items() if constants else ():
        notes.say(f"{CONSTANTS} {name}", found=told.get(name), expected=value)


def _told(touched: list[int]) -> list[LeftOut]:
    if not touched:
        return []
    which = ", ".join(map(str, touched))
    reason = f"interrupts ended lives in block {which}: only births, sizes and strengths could be compared there"
    return [LeftOut(name="regenerated", reason=reason)]
