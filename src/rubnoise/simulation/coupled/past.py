"""The junctions that lie behind a two-way slider: drawn again where it runs back further than they are carried.

Before the start a stationary contact has a past, in streams of its own: for Poisson births those are thinned to lives
that ended before the start, which are independent of those alive there; regular births go on backward at their spacing,
with the diameters that the start has drawn for them. Gamma and scattered births have one past, of which the start takes
those alive. An empty contact has none.
"""

from math import ceil

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws.discrete import largest_of
from rubnoise.model import Model
from rubnoise.simulation.draws import backward, blocks_drawn_at_once, draw_blocks, first_birth, start
from rubnoise.simulation.state import LiveRows
from rubnoise.streams import Stream, generator, uniforms


def lived(model: Model, seed: int, begin: float, end: float) -> LiveRows:
    """Return all junctions that live between two distances in um, in order of birth.

    Those of the past count down from -1.
    """
    first = start(model, seed)
    found = [_between(first.live, begin, end)]
    block, place, number = first.block, first.next_birth, first.junctions
    while place < end and place <= model.distance:
        births = draw_blocks(model, seed, block, place, blocks_drawn_at_once(model, block))
        count = len(births)
        rows = LiveRows(
            junction=np.arange(number, number + count, dtype=np.int64),
            birth=births.birth,
            diameter=births.diameter,
            strength=births.strength,
            departure=np.full(count, np.inf),
        )
        found.append(_between(rows, begin, end))
        block, place, number = block + births.blocks, births.next_birth, number + count
    if begin < 0.0 and model.start == "stationary":
        found.append(_between(past(model, seed, begin), begin, end))
    together = found[0]
    for rows in found[1:]:
        together = together.then(rows)
    return together.at(np.argsort(together.birth, kind="stable"))


def past(model: Model, seed: int, begin: float) -> LiveRows:
    """Return the junctions that were born and had died before s = 0, back to all that live beyond ``begin`` (um)."""
    longest = 2.0 * largest_of(model.sizes)
    draw = _regular if isinstance(model.births, RegularBirths) else backward
    birth, diameter = draw(model, seed, begin - longest)
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


def _regular(model: Model, seed: int, begin: float) -> tuple[Doubles, Doubles]:
    """Return births (um), latest first, beyond ``begin``, with the diameters from which the start took those alive."""
    births = model.births
    if not isinstance(births, RegularBirths):
        raise TypeError("births at one spacing are wanted")
    count = ceil(-begin / births.mean_spacing) + 1
    number = np.arange(1, count + 1)
    birth = births.places(first_birth(model, seed), -number)
    return birth, model.sizes.draw(generator(seed, Stream.START_DIAMETERS).random(count))


def _between(rows: LiveRows, begin: float, end: float) -> LiveRows:
    return rows.at(np.flatnonzero((rows.birth < end) & (rows.birth + 2.0 * rows.diameter > begin)))
