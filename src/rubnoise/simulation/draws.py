"""What a seed decides: who is alive at the start, and the births of every block."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.deviates import exponential
from rubnoise.model import Model
from rubnoise.simulation.state import LiveRows, State
from rubnoise.streams import Stream, generator, uniforms

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockBirths:
    """The births of one block within the run: distances (um), diameters (um), strengths (MPa; ones without a law).

    gaps (um) lead from each birth to the next; next_birth (um) opens the next block, and may lie beyond the run.
    """

    birth: Doubles
    gaps: Doubles
    diameter: Doubles
    strength: Doubles
    next_birth: float

    def __len__(self) -> int:
        """Return the number of births."""
        return self.birth.size


def births_per_block(model: Model) -> int:
    """Return B = max(1000, ceil(10 N_jm)): a block is some lives long, however dense the contact."""
    return max(1000, ceil(10.0 * model.mean_junction_count))


def first_birth(model: Model, seed: int) -> float:
    """Return the distance in um of the first birth after the start."""
    return float(model.births.first_gap(uniforms(seed, Stream.FIRST_BIRTH, 0, 1))[0])


def birth_distances(model: Model, seed: int, block: int, begin: float) -> tuple[Doubles, Doubles]:
    """Return the B + 1 birth distances from a block's first birth on, and the B gaps between them (um).

    Each is the one before plus its gap, as an event clock adds: never the block's begin plus a sum of gaps.
    """
    gaps = model.births.gaps(uniforms(seed, Stream.GAPS, block, births_per_block(model)))
    return np.add.accumulate(np.concatenate([[begin], gaps])), gaps


def draw_block(model: Model, seed: int, block: int, begin: float) -> BlockBirths:
    """Return the births of a block that lie within the run."""
    birth, gaps = birth_distances(model, seed, block, begin)
    count = min(int(np.searchsorted(birth, model.distance, side="right")), gaps.size)
    return BlockBirths(
        birth=birth[:count],
        gaps=gaps[:count],
        diameter=model.sizes.draw(uniforms(seed, Stream.DIAMETERS, block, count)),
        strength=_strengths(model, uniforms(seed, Stream.STRENGTHS, block, count)),
        next_birth=float(birth[count]),
    )


def count_births(model: Model, seed: int) -> int:
    """Return how many junctions are born within the run: from the gaps alone, a block at a time."""
    return sum(_births_by_block(model, seed))


def _births_by_block(model: Model, seed: int) -> Iterator[int]:
    block, begin = 0, first_birth(model, seed)
    while begin <= model.distance:
        birth, gaps = birth_distances(model, seed, block, begin)
        yield min(int(np.searchsorted(birth, model.distance, side="right")), gaps.size)
        block, begin = block + 1, float(birth[-1])


def start(model: Model, seed: int) -> State:
    """Return the state before the first block.

    A stationary contact has Poisson(lam E[2d]) junctions, their diameters of density proportional to d f(d), their ages
    uniform on [0, 2d]; an empty one has none.
    """
    live = _stationary_rows(model, seed) if model.start == "stationary" else LiveRows.none()
    return State(
        block=0,
        begin=0.0,
        next_birth=first_birth(model, seed),
        junctions=len(live),
        ticks=0,
        events=0,
        live=live,
        displacement=model.equilibrium_displacement,
        velocity=0.0,
    )


def _stationary_rows(model: Model, seed: int) -> LiveRows:
    count = _poisson(seed, 2.0 * model.birth_rate * model.sizes.moment(1))
    diameter = model.sizes.draw_length_biased(generator(seed, Stream.START_DIAMETERS), count)
    birth = -(2.0 * diameter) * uniforms(seed, Stream.START_AGES, 0, count)
    order = np.argsort(birth, kind="stable")
    return LiveRows(
        junction=np.arange(count, dtype=np.int64),
        birth=birth[order],
        diameter=diameter[order],
        # Block -1 cannot be: the start has the strengths of the highest block number instead.
        strength=_strengths(model, uniforms(seed, Stream.STRENGTHS, 2**63, count)),
        departure=np.full(count, np.inf),
    )


def _poisson(seed: int, mean: float) -> int:
    """Return a Poisson count: how many unit exponentials fit into the mean, in correctly rounded operations only."""
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
