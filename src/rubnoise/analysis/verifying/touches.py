"""The rows of free motion checked beside its play: touches by themselves, and areas from the summits."""

from math import ceil
from typing import Final

import numpy as np

from rubnoise.analysis.reading import Ahead
from rubnoise.analysis.verifying.columns import chosen_ticks
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.reader import Rows, chunks
from rubnoise.simulation.free.scales import Scales

_ROUNDING: Final = 2.0**-42


def touch_check(model: Model, rows: Rows) -> Check:
    """Return whether touches come in order of birth, with the lives and times that follow, and ticks lie evenly."""
    notes, before, speed = Notes("identities"), 0.0, model.sliding_speed or 1.0
    for chunk in chunks(rows, "junctions"):
        birth, death = chunk["birth_distance"], chunk["death_distance"]
        in_order = birth >= np.concatenate([[before], birth[:-1]])
        notes.holds("/junctions/birth_distance", chunk.first, birth, in_order, "at or after the birth before it")
        before = birth[-1] if birth.size else before
        number = np.arange(chunk.first, chunk.first + birth.size)
        follows = {"junction": number, "life_distance": death - birth}
        follows |= {"birth_time": birth / speed, "death_time": death / speed}
        for name, values in follows.items():
            notes.equal(f"/junctions/{name}", chunk.first, chunk[name], values)
    for chunk in chunks(rows, "trace"):
        distance = np.arange(chunk.first, chunk.end, dtype=np.float64) * model.tick
        notes.equal("/trace/distance", chunk.first, chunk["distance"], distance)
    return notes.check()


def summit_check(model: Model, free: FreeSeparation, seed: int, rows: Rows) -> Check:
    """Return whether /trace has, at some ticks, the areas that the summits of the seed give at the separation in /load.

    A sum over all summits near a tick of (A_rm/N) max(h - (s - x)^2 - z, 0), which knows of no event.
    """
    notes, ahead, scales = Notes("areas"), Ahead(rows), Scales.of(model, free)
    surface, unit = scales.surface(seed), model.mean_real_contact_area / scales.live
    for tick in chosen_ticks(rows.rows("trace")).tolist():
        z = float(ahead.column("load", "separation", tick, tick + 1)[0]) / scales.height
        block, beyond = divmod(tick, surface.ticks)
        around = surface.around(block, max(ceil(-z) - surface.base + 2, 1))
        away = float(beyond) * scales.tick - around.place
        overlap = np.maximum(around.height - away * away - z, 0.0)
        found = ahead.column("trace", "real_contact_area", tick, tick + 1)
        allowed = unit * _ROUNDING * (1.0 + np.count_nonzero(overlap)) * (1.0 + abs(z))
        notes.near("/trace/real_contact_area", tick, found, np.array([unit * overlap.sum()]), np.array([allowed]))
    return notes.check()
