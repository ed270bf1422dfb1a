"""Where the blocks of a run begin: from its rows alone, and as /blocks has it."""

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.reading import Ahead, Chunk, chunks
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.analysis.verifying.lives import born_before
from rubnoise.arrays import Doubles, Integers
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.record.rows import Phase


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTable:
    """Where every block begins: its first birth (um), the rows born and the ticks finished before it.

    The first birth of a run without any is infinite here: it lies beyond the run, and no row says where.
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
    """Return whether /blocks says of every block where it begins, and how the slider moved then."""
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
