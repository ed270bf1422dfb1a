"""The random draws of a run: the junctions alive at the start, and the births of every block."""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil
from typing import cast

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import BirthLaw, GammaBirths, GapLaw, RegularBirths, ScatteredBirths
from rubnoise.contact.deviates import exponential
from rubnoise.contact.laws import Fixed
from rubnoise.contact.laws.discrete import largest_of
from rubnoise.contact.off_centre import half_life
from rubnoise.model import Model
from rubnoise.simulation.state import LiveRows, State
from rubnoise.streams import Stream, generator, uniforms

_MOST_KEPT = 24
"""Largest number of draws kept: a few megabytes, enough for all births of a run of half a million junctions."""

_PAIRS = 1024
"""Points of a square that are drawn at a time."""

_DRAWN_AT_ONCE = 24_576
"""Births drawn at once: enough to make arrays worth their overhead, few enough for the processor's cache."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockBirths:
    """The births of some blocks within the run: distances (um), diameters (um), strengths (MPa; ones without a law).

    blocks: their number; next_birth (um): the first birth of the block after them, which may lie beyond the run.
    offset: distance of each pass from the centre line (um), with a sign; None if all pass through both centres.
    """

    birth: Doubles
    diameter: Doubles
    strength: Doubles
    blocks: int
    next_birth: float
    offset: Doubles | None = None

    def __len__(self) -> int:
        """Return the number of births."""
        return self.birth.size

    def rows(self, first: int) -> LiveRows:
        """Return the junctions with their row numbers from ``first`` on; none has left."""
        return LiveRows(
            junction=np.arange(first, first + len(self), dtype=np.int64),
            birth=self.birth,
            diameter=self.diameter,
            strength=self.strength,
            departure=np.full(len(self), np.inf),
            offset=self.offset,
        )


def births_per_block(model: Model) -> int:
    """Return B = max(1000, ceil(10 N_jm)): a block is at least ten mean lives long, however dense the contact."""
    return max(1000, ceil(10.0 * model.mean_junction_count))


def first_birth(model: Model, seed: int) -> float:
    """Return the distance in um of the first birth after the start."""
    births = model.births
    if isinstance(births, ScatteredBirths):
        return float(births.following(seed, 0.0, 1)[0])
    return _around(births, seed)[1]


def _around(births: BirthLaw, seed: int) -> tuple[float, float]:
    """Return how far before the start the past gaps begin, and how far after it the first birth is (um)."""
    return cast("GapLaw", births).around(uniforms(seed, Stream.FIRST_BIRTH, 0, 2))


def birth_distances(model: Model, seed: int, block: int, begin: float, blocks: int = 1) -> Doubles:
    """Return the births of some blocks, then the first birth of the block after them (um).

    Each birth is the one before plus its gap, as an event clock adds: never ``begin`` plus a sum of gaps. Regular
    births lie at whole multiples of their spacing from the first birth of the run; ``begin`` is not used for them.
    Scattered births are drawn about their centres and sorted.
    """
    return _birth_distances(model, seed, block, begin, blocks, births_per_block(model))


@lru_cache(maxsize=_MOST_KEPT)
def _birth_distances(model: Model, seed: int, block: int, begin: float, blocks: int, count: int) -> Doubles:
    """Return them for ``count`` births a block; they are kept, because a run counts its births before it plays them."""
    if isinstance(model.births, ScatteredBirths):
        births = model.births.following(seed, begin, blocks * count + 1)
    elif isinstance(model.births, RegularBirths):
        births = model.births.places(first_birth(model, seed), block * count + np.arange(blocks * count + 1))
    else:
        gaps = _drawn(model, seed, Stream.GAPS, block, blocks)
        births = np.add.accumulate(np.concatenate([[begin], gaps]))
    births.flags.writeable = False
    return births


def blocks_drawn_at_once(model: Model, block: int) -> int:
    """Return how many blocks to draw at once, beginning with this one: those to the end of its group."""
    group = _blocks_at_once(model)
    return group - block % group


def births_drawn_at_once(model: Model) -> int:
    """Return how many births are drawn and played at a time, if several small blocks are played at once."""
    return _blocks_at_once(model) * births_per_block(model)


def _drawn(model: Model, seed: int, stream: Stream, block: int, blocks: int) -> Doubles:
    """Return the values that a stream draws for all births of these blocks; small blocks are drawn in groups."""
    group, births = _blocks_at_once(model), births_per_block(model)
    if group == 1:
        return _made(model, stream, _uniforms(model, seed, stream, block, 1))
    before = block % group
    drawn = _drawn_at_once(model, seed, stream, block - before, group)
    return drawn[before * births : (before + blocks) * births]


def _blocks_at_once(model: Model) -> int:
    """Return how many blocks form a group that is drawn at once, at most all blocks of the run."""
    births = births_per_block(model)
    return max(min(_DRAWN_AT_ONCE // births, ceil(model.distance * model.birth_rate / births)), 1)


@lru_cache(maxsize=4)
def _drawn_at_once(model: Model, seed: int, stream: Stream, block: int, blocks: int) -> Doubles:
    made = _made(model, stream, _uniforms(model, seed, stream, block, blocks))
    made.flags.writeable = False
    return made


def _uniforms(model: Model, seed: int, stream: Stream, block: int, blocks: int) -> Doubles:
    """Return a stream's uniforms for all births of these blocks; zeros if the law ignores them."""
    births = births_per_block(model)
    if stream is Stream.OFFSETS:
        return uniforms(seed, stream, block, births, blocks)
    law = {Stream.DIAMETERS: model.sizes, Stream.STRENGTHS: model.strengths}.get(stream, model.births)
    if law is None or isinstance(law, Fixed):
        return np.zeros(blocks * births)
    return uniforms(seed, stream, block, births, blocks)


def _made(model: Model, stream: Stream, uniform: Doubles) -> Doubles:
    """Return a gap (um), diameter (um), strength (MPa) or offset divided by d for each uniform."""
    if stream is Stream.OFFSETS:
        return _both_ways(uniform)
    if stream is Stream.GAPS:
        return cast("GapLaw", model.births).gaps(uniform)
    return model.sizes.draw(uniform) if stream is Stream.DIAMETERS else _strengths(model, uniform)


def draw_blocks(model: Model, seed: int, block: int, begin: float, blocks: int = 1) -> BlockBirths:
    """Return those births of a block, or of several that are drawn at once, that lie within the run."""
    births = births_per_block(model)
    birth = birth_distances(model, seed, block, begin, blocks)
    first = birth[: blocks * births : births]
    blocks = max(int(np.searchsorted(first, model.distance, side="right")), 1)
    count = min(int(np.searchsorted(birth, model.distance, side="right")), blocks * births)
    return BlockBirths(
        birth=birth[:count],
        diameter=_drawn(model, seed, Stream.DIAMETERS, block, blocks)[:count],
        strength=_drawn(model, seed, Stream.STRENGTHS, block, blocks)[:count],
        blocks=blocks,
        next_birth=float(birth[count]),
        offset=_offsets(model, seed, block, blocks, count),
    )


def _offsets(model: Model, seed: int, block: int, blocks: int, count: int) -> Doubles | None:
    """Return the first ``count`` lateral offsets (um), uniform on (-d, d); None if all passes are centred."""
    if model.pulse.offset == "none":
        return None
    diameter = _drawn(model, seed, Stream.DIAMETERS, block, blocks)
    return (diameter * _drawn(model, seed, Stream.OFFSETS, block, blocks))[:count]


def _both_ways(uniform: Doubles) -> Doubles:
    """Map uniforms to numbers uniform on (-1, 1): odd multiples of 2^-53, never 0, -1 or 1."""
    return (2.0 * uniform - 1.0) + 2.0**-53


def count_births(model: Model, seed: int) -> int:
    """Return the number of births within the run, counted from the gaps alone."""
    block, begin, count = 0, first_birth(model, seed), 0
    while begin <= model.distance:
        blocks = blocks_drawn_at_once(model, block)
        birth = birth_distances(model, seed, block, begin, blocks)
        count += int(np.searchsorted(birth[:-1], model.distance, side="right"))
        block, begin = block + blocks, float(birth[-1])
    return count


def start(model: Model, seed: int) -> State:
    """Return the state before the first block: a stationary contact has live junctions, an empty one has none."""
    live = _stationary_rows(model, seed) if model.start == "stationary" else LiveRows.none()
    return State(next_birth=first_birth(model, seed), junctions=len(live), live=live)


def _stationary_rows(model: Model, seed: int) -> LiveRows:
    has_past = isinstance(model.births, RegularBirths | GammaBirths | ScatteredBirths)
    birth, diameter, offset = _alive_of_past(model, seed) if has_past else _alive_at_random(model, seed)
    return LiveRows(
        junction=np.arange(birth.size, dtype=np.int64),
        birth=birth,
        diameter=diameter,
        # There is no block -1, so the strengths at the start have the highest block number.
        strength=_strengths(model, uniforms(seed, Stream.STRENGTHS, 2**63, birth.size)),
        departure=np.full(birth.size, np.inf),
        offset=offset,
    )


def _alive_at_random(model: Model, seed: int) -> tuple[Doubles, Doubles, Doubles | None]:
    """Return births, diameters and offsets (um) of the junctions alive at the start, if births are Poisson.

    Their number is Poisson(lam E[life]), their diameters have a density proportional to d f(d), and their ages are
    uniform over the life. Where passes miss the centre line, the centre of one asperity is uniform in the disc of
    radius d about the other. Its coordinate across the motion is the offset, so that long lives are found more often.
    """
    count = _poisson(seed, model.mean_live_junctions)
    diameter = model.sizes.draw_length_biased(generator(seed, Stream.START_DIAMETERS), count)
    offset = None if model.pulse.offset == "none" else diameter * _across_a_disc(seed, count)
    birth = -(2.0 * half_life(diameter, offset)) * uniforms(seed, Stream.START_AGES, 0, count)
    order = np.argsort(birth, kind="stable")
    return birth[order], diameter[order], None if offset is None else offset[order]


def _across_a_disc(seed: int, count: int) -> Doubles:
    """Return one coordinate of points uniform in the unit disc: the points of a square that lie within the disc."""
    source, found, size = generator(seed, Stream.START_OFFSETS), [np.empty(0)], 0
    while size < count:
        x, y = _both_ways(source.random((2, _PAIRS)))
        found.append(x[x * x + y * y < 1.0])
        size += found[-1].size
    return np.concatenate(found)[:count]


def _alive_of_past(model: Model, seed: int) -> tuple[Doubles, Doubles, None]:
    """Return births and diameters (um) of the junctions that are born before the start and die after it."""
    birth, diameter = backward(model, seed, -2.0 * largest_of(model.sizes))
    alive = birth + 2.0 * diameter > 0.0
    return birth[alive][::-1], diameter[alive][::-1], None


def backward(model: Model, seed: int, begin: float) -> tuple[Doubles, Doubles]:
    """Return births (um) before the start, latest first, back to ``begin`` or beyond, and a diameter (um) for each.

    Regular births continue at their spacing. Read backward, the gaps of a renewal process have the same law, except the
    gap around the start, which is longer.
    """
    births, count = model.births, births_per_block(model)
    if isinstance(births, RegularBirths):
        number = np.arange(1, ceil(-begin / births.mean_spacing) + 2)
        source = generator(seed, Stream.START_DIAMETERS)
        return births.places(first_birth(model, seed), -number), model.sizes.draw(source.random(number.size))
    if isinstance(births, ScatteredBirths):
        places = [births.between(seed, begin, float(np.nextafter(0.0, -1.0)))[::-1]]
    else:
        place, block = -_around(births, seed)[0], 0
        places = [np.array([place] if place else [])]
        while place >= begin:
            gaps = cast("GapLaw", births).gaps(uniforms(seed, Stream.PAST_GAPS, block, count))
            places.append(np.subtract.accumulate(np.concatenate([[place], gaps]))[1:])
            place, block = float(places[-1][-1]), block + 1
    birth = np.concatenate(places)
    blocks = ceil(birth.size / count)
    uniform = uniforms(seed, Stream.PAST_DIAMETERS, 0, count, blocks) if blocks else np.empty(0)
    return birth, model.sizes.draw(uniform[: birth.size])


def _poisson(seed: int, mean: float) -> int:
    """Return a Poisson count: how many unit exponentials fit into the mean. All operations are correctly rounded."""
    source = generator(seed, Stream.START_COUNT)
    count, total = 0, 0.0
    while True:
        sums = np.add.accumulate(np.concatenate([[total], exponential(source.random(1024))]))[1:]
        within = int(np.searchsorted(sums, mean, side="right"))
        count, total = count + within, float(sums[-1])
        if within < sums.size:
            return count


def _strengths(model: Model, uniform: Doubles) -> Doubles:
    return np.ones_like(uniform) if model.strengths is None else model.strengths.draw(uniform)
