"""Traces whose junctions are known, made in memory, and those of files."""

import os

import numpy as np

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.distributions import Law
from rubnoise.contact.laws import LAWS
from rubnoise.inference.signal import Signal
from rubnoise.model import Model
from rubnoise.record.rows import MemoryRecord
from rubnoise.simulation.draws import extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.foreign import opened
from rubnoise.storage.measured import Asked, Source, measured

PER_LIFE = 64
WHOLE = Asked()


def read_measured(trace: str | os.PathLike[str], asked: Asked = WHOLE) -> Source:
    """Return a column of a file and its places, cut and checked."""
    return measured(opened(trace, asked.column), asked)


def contact(
    law: str, spread: float, count: float, lives: int, *, mean: float = 5.5, strengths: Law | None = None
) -> Model:
    """Return a contact with junctions of this mean diameter, 64 ticks a mean life."""
    sizes = LAWS[law].make(mean, spread * mean, {})
    tick = 2.0 * sizes.mean / PER_LIFE
    return Model(
        mean_real_contact_area=1.0,
        mean_junction_count=float(count),
        calibration="exact",
        calibrated_diameter=mean,
        sizes=sizes,
        births=PoissonBirths(mean_spacing=2.0 * sizes.mean / count),
        strengths=strengths or LAWS["fixed"].make(250.0, 0.0, {}),
        sliding_speed=1000.0,
        distance=tick * (lives * PER_LIFE - 1),
        start="stationary",
        slider=None,
        tick=tick,
        tick_count=lives * PER_LIFE - 1,
    )


def signal(model: Model, seed: int, *, noise: float = 0.05) -> Signal:
    """Return the friction force of a run in uN, with white noise of a part of its spread."""
    record = MemoryRecord(extent(model, seed))
    simulate(model, seed, record, engine="batch")
    values = np.array(record["trace"]["friction_force"])
    values += noise * values.std() * np.random.default_rng([seed, 1]).standard_normal(values.size)
    return Signal(values=values, tick=model.tick, unit="uN", scale=1.0)
