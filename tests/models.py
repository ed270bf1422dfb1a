"""Models for the tests, from a few numbers without a scenario file, and two-way runs of them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from math import floor, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.births import (
    BirthLaw,
    ClusteredBirths,
    GammaBirths,
    JitteredBirths,
    PoissonBirths,
    RegularBirths,
)
from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.distributions import Fixed, Law, Lognormal
from rubnoise.contact.laws import Spread, law_for
from rubnoise.contact.pulses import LENS, PULSES, Pulse
from rubnoise.model import FreeSeparation, Model, Separation, Slider
from rubnoise.record.rows import MemoryRecord
from rubnoise.simulation.draws import draw_block, extent, past, start
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.two_way import TwoWayMotion
from tests.oracle.sliders import Oscillator
from tests.oracle.slow_contact import Rows

# Models for the tests, built from a few numbers without a scenario file.
BIRTHS: dict[str, Callable[..., BirthLaw]] = {
    "poisson": PoissonBirths,
    "regular": RegularBirths,
    "gamma": partial(GammaBirths, shape=4.0),
    "bunched": partial(GammaBirths, shape=0.5),
    "clustered": partial(ClusteredBirths, cluster_size=3.0, cluster_width=2.0),
    "jittered": partial(JitteredBirths, jitter=0.3),
}
PARABOLA = PULSES["parabola"]
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


RAYLEIGH = Spread(relative=sqrt(4.0 / pi - 1.0), law="weibull")


def loaded(
    *,
    ratio: float = 0.05,
    speed: float = 1000.0,
    relative_speed: float | None = None,
    height: float = 0.5,
    weight: float = 2e5,
    mass: float = 5e-3,
    **changes: Any,
) -> Model:
    """Return Fig. 5 under a load that weighs, of a hardness of 1 GPa, at a speed or at so many times c omega_c."""
    held = model(
        area=weight / 1000.0,
        spread=RAYLEIGH,
        calibration="matched",
        pulse=PARABOLA,
        speed=speed,
        **changes,
    )
    omega = sqrt(weight / height / mass)
    if relative_speed is not None:
        scale = sqrt(4.0 * held.mean_real_contact_area / (pi * held.mean_junction_count))
        held = replace(held, sliding_speed=relative_speed * scale * omega)
    separation = Separation(
        load=weight, hardness=1000.0, height_scale=height, mass=mass, damping=2.0 * ratio * mass * omega
    )
    return replace(held, hardness=1000.0, separation=separation)


def bouncing(
    *, restitution: float | None = 0.7, growth: float | None = None, ratio: float = 0.0, **changes: Any
) -> Model:
    """Return a slider that may leave its contact, at v = V/(c omega_c); growth: beta s_0 omega_c."""
    shape = {"count": 0.5, "relative_speed": 1.0, "height": 5.0, "weight": 5e4, "mass": 5e-3, "tick": 0.5}
    linear = loaded(ratio=ratio, **shape | changes)
    held = linear.separation
    assert held is not None
    rate = held.oscillator.natural_angular_frequency
    beta = None if growth is None else growth / (held.height_scale * rate)
    free = FreeSeparation(held=held, restitution=None if growth else restitution, impact_damping=beta)
    return replace(linear, separation=None, free=free)


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


# Two-way runs for the tests, from a model and a seed.
Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class CoupledRun:
    """All that a two-way run tells: its groups, the one row of /balance, and the displacement at the start in um."""

    slider: dict[str, NDArray[Any]]
    landmarks: dict[str, NDArray[Any]]
    junctions: dict[str, NDArray[Any]]
    balance: dict[str, float]
    start: float

    @property
    def duration(self) -> float:
        """Return the time of the end in s."""
        return self.balance["time"]

    def passed(self, event: str) -> tuple[NDArray[np.int64], Doubles]:
        """Return which junctions' "birth" or "death" was passed, and when first (s)."""
        times = self.junctions[f"{event}_time"]
        known = np.flatnonzero(~np.isnan(times))
        return self.junctions["junction"][known], times[known]

    def contents(self) -> list[bytes]:
        """Return everything as bytes."""
        columns = [*self.slider.values(), *self.landmarks.values(), *self.junctions.values()]
        return [column.tobytes() for column in columns] + [np.array(list(self.balance.values())).tobytes()]


def coupled(
    model: Model,
    seed: int = 1,
    *,
    cells: int = 50,
    displacement: float | None = None,
    pieces: int = 1,
) -> CoupledRun:
    """Run a model two-way coupled from end to end.

    displacement: the start's, in um, in place of the model's; pieces: in which a block is made known.
    """
    run = _two_way(model, cells)
    state, record = start(run, seed), MemoryRecord(extent(run, seed))
    motion = _motion(run, seed, record, state.live, displacement)
    begin = float(motion.state["displacement"][0])
    block, place, junctions = state.block, state.next_birth, state.junctions
    reached = 0.0
    while reached < run.distance:
        born, place = draw_block(run, seed, block, place, junctions)
        block, junctions = block + 1, junctions + len(born)
        known = min(place, run.distance)
        for share in np.arange(1, pieces + 1) / pieces:
            motion.through(born, reached + share * (known - reached) if share < 1.0 else known)
        reached = known
    return _told(record, begin)


def among(model: Model, junctions: LiveRows, *, displacement: float, cells: int = 50, most: int = 0) -> CoupledRun:
    """Run a slider among given junctions, born before s = 0 or later, and the only ones there ever are.

    most: landmarks after which the run may stop, if there are so many.
    """
    run = replace(_two_way(model, cells), start="empty")
    record = MemoryRecord({"junctions": len(junctions), "slider": None, "landmarks": None, "balance": 1})
    motion = _motion(run, 1, record, junctions, displacement)
    for known in [*np.linspace(0.0, model.distance, 51)[1:-1].tolist(), model.distance]:
        motion.through(LiveRows.none(), known)
        if most and record.groups["landmarks"]["time"].size >= most:
            break
    return _told(record, displacement)


def _two_way(model: Model, cells: int) -> Model:
    assert model.slider is not None
    return replace(model, slider=replace(model.slider, coupling="two-way", cells=cells))


def _motion(run: Model, seed: int, record: MemoryRecord, live: LiveRows, displacement: float | None) -> TwoWayMotion:
    motion = TwoWayMotion(run, seed, record, live)
    if displacement is not None:
        motion.state["displacement"] = displacement
    return motion


def _told(record: MemoryRecord, begin: float) -> CoupledRun:
    groups = {name: dict(record.groups.get(name, {})) for name in ("slider", "landmarks", "junctions", "balance")}
    return CoupledRun(
        slider=groups["slider"],
        landmarks=groups["landmarks"],
        junctions=groups["junctions"],
        balance={name: float(values[0]) for name, values in groups["balance"].items()},
        start=begin,
    )


def lived(model: Model, seed: int, begin: float, end: float) -> LiveRows:
    """Return all junctions that live between two distances (um), in order of birth; those of the past have -1, ..."""
    first = start(model, seed)
    found, block, place, number = first.live, first.block, first.next_birth, first.junctions
    if begin < 0.0:
        behind = past(model, seed, begin)
        found = behind.at(np.flatnonzero(behind.natural_death <= 0.0)).then(found)
    while place < end and place <= model.distance:
        born, place = draw_block(model, seed, block, place, number)
        block, number = block + 1, number + len(born)
        found = found.then(born)
    lives = np.flatnonzero((found.birth < end) & (found.birth + 2.0 * found.diameter > begin))
    return found.at(lives[np.argsort(found.birth[lives], kind="stable")])


def field_of(model: Model, seed: int, begin: float = 0.0) -> Rows:
    """Return the junctions that live from a distance (um) to the end of a run, as references take them."""
    found = lived(model, seed, begin, model.distance)
    return Rows(
        birth=found.birth, diameter=found.diameter, strength=found.strength, death=found.birth + 2.0 * found.diameter
    )


def oscillator_of(model: Model) -> Oscillator:
    """Return a model's slider as references take it."""
    slider = model.slider
    assert slider is not None
    return Oscillator(mass=slider.mass, stiffness=slider.stiffness, damping=slider.damping)
