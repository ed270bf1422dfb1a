"""Models for the tests, built from a few numbers without a scenario file."""

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from math import floor
from typing import Any

from rubnoise.contact.births import (
    BirthLaw,
    ClusteredBirths,
    GammaBirths,
    JitteredBirths,
    PoissonBirths,
    RegularBirths,
)
from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.laws import Fixed, Law, Lognormal, Spread, law_for
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.model import Model, Slider
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import State

BIRTHS: dict[str, Callable[..., BirthLaw]] = {
    "poisson": PoissonBirths,
    "regular": RegularBirths,
    "gamma": partial(GammaBirths, shape=4.0),
    "bunched": partial(GammaBirths, shape=0.5),
    "clustered": partial(ClusteredBirths, cluster_size=3.0, cluster_width=2.0),
    "jittered": partial(JitteredBirths, jitter=0.3),
}
FIG5_SLIDER = Slider(mass=0.005, stiffness=300.0, damping=0.05)


UNEQUAL = Lognormal(mean=250.0, std=150.0)


def model(
    *,
    area: float = 200.0,
    count: float = 20.0,
    spread: Spread | None = None,
    calibration: Any = None,
    distance: float = 500.0,
    tick: float = 0.1,
    start: Any = "stationary",
    slider: Slider | None = FIG5_SLIDER,
    speed: float | None = 1000.0,
    strength: float | Law | None = 250.0,
    births: str = "poisson",
    pulse: Pulse = LENS,
) -> Model:
    """Return the model of Fig. 5, changed where an argument says so; the paper's calibration is for the lens alone."""
    spread = Spread(absolute=0.2) if spread is None else spread
    calibration = calibration or ("paper" if pulse is LENS else "exact")
    diameter = calibrated_diameter(calibration, area, count, spread, pulse)
    return Model(
        mean_real_contact_area=area,
        mean_junction_count=count,
        calibration=calibration,
        calibrated_diameter=diameter,
        sizes=law_for(diameter, spread),
        births=BIRTHS[births](mean_spacing=pulse.mean_life * diameter / count),
        strengths=Fixed(value=strength) if isinstance(strength, float | int) else strength,
        sliding_speed=speed,
        distance=distance,
        start=start,
        slider=slider,
        tick=tick,
        tick_count=floor(Fraction(str(distance)) / Fraction(str(tick))),
        pulse=pulse,
    )


def bare(**changes: Any) -> Model:
    """Return a contact without slider, speed or strength."""
    return model(slider=None, speed=None, strength=None, **changes)


def recorded(run: Model, seed: int = 1, **how: Any) -> MemoryRecord:
    """Return the record of a run."""
    return run_to_end(run, seed, **how)[0]


def run_to_end(run: Model, seed: int = 1, **how: Any) -> tuple[MemoryRecord, State]:
    """Return the record and the last state of a run."""
    record = MemoryRecord(extent(run, seed))
    return record, simulate(run, seed, record, **how)


def contents(record: MemoryRecord) -> dict[tuple[str, str], bytes]:
    """Return every column of a record as bytes."""
    return {
        (group, name): values.tobytes() for group, columns in record.groups.items() for name, values in columns.items()
    }
