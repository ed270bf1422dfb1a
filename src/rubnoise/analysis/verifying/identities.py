"""The rows of a file whose run cannot be played again, compared with what follows from a few of their own columns."""

import numpy as np

from rubnoise.analysis.reading import chunks
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.record.rows import JunctionState, junction_columns, junction_states, natural_death
from rubnoise.simulation.kernels import peak_areas

OF_MOTION = ("birth_time", "death_time")
"""Columns of /junctions that only its motion decides where a slider is coupled two ways."""


def identity_check(model: Model, rows: Rows) -> Check:
    """Return whether deaths, areas, times and states follow from birth, diameter and offset, and ticks lie evenly.

    A life that was ended early has the death that it had.
    """
    notes, before = Notes("identities"), -np.inf
    for chunk in chunks(rows, "junctions"):
        birth, diameter, offset = chunk["birth_distance"], chunk["diameter"], chunk.get("lateral_offset")
        in_order = birth >= np.concatenate([[before], birth[:-1]])
        notes.holds("/junctions/birth_distance", chunk.first, birth, in_order, "at or after the birth before it")
        before = birth[-1] if birth.size else before
        with np.errstate(invalid="ignore", over="ignore"):
            natural = natural_death(birth, diameter, offset)
            early = (chunk["state"] & JunctionState.ENDED_EARLY) != 0
            departure = np.where(early, chunk["death_distance"], np.inf)
            expected = junction_columns(
                first_row=chunk.first,
                birth=birth,
                diameter=diameter,
                strength=chunk.get("shear_strength"),
                natural=natural,
                departure=departure,
                state=junction_states(natural, departure, np.signbit(birth), model.distance),
                speed=model.sliding_speed,
                offset=offset,
                peak=None if offset is None else peak_areas(diameter, offset),
            )
        for name, values in expected.items():
            if not (model.is_two_way and name in OF_MOTION):
                notes.equal(f"/junctions/{name}", chunk.first, chunk[name], values)
    for chunk in chunks(rows, "trace"):
        distance = np.arange(chunk.first, chunk.end, dtype=np.float64) * model.tick
        notes.equal("/trace/distance", chunk.first, chunk["distance"], distance)
    return notes.check()
