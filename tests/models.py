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
from rubnoise.contact.laws import Fixed, Law, Lognormal, Spread, law_for
from rubnoise.contact.pulses import LENS, PULSES, Pulse
from rubnoise.model import FreeSeparation, Model, Separation, Slider
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation.coupled import layout
from rubnoise.simulation.coupled.fold import CoupledMotion, MotionRows, constants
from rubnoise.simulation.coupled.state import CoupledState
from rubnoise.simulation.draws import blocks_drawn_at_once, draw_blocks, start
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.two_way import lived
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
    """All that a two-way run tells, its last state, its constants, and the displacement at the start in um."""

    slider: dict[str, NDArray[Any]]
    landmarks: dict[str, NDArray[Any]]
    births: tuple[NDArray[np.int64], Doubles]
    deaths: tuple[NDArray[np.int64], Doubles]
    state: CoupledState
    constants: Doubles
    start: float

    @property
    def duration(self) -> float:
        """Return the time of the end in s."""
        return self.state.time(self.constants)

    @property
    def velocity(self) -> float:
        """Return x' at the end in um/s."""
        return float(self.constants[layout.DRIVE] - self.state.numbers[layout.RELATIVE])

    def contents(self) -> list[bytes]:
        """Return everything as bytes; first passages in order of junctions."""
        passed = [(j[np.argsort(j)], t[np.argsort(j)]) for j, t in (self.births, self.deaths)]
        sums = np.array(list(self.state.integrals.values()))
        columns = [*self.slider.values(), *self.landmarks.values(), *passed[0], *passed[1], sums]
        return [np.ascontiguousarray(column).tobytes() for column in columns]


def coupled(
    model: Model,
    seed: int = 1,
    *,
    tolerance: float = 1e-9,
    displacement: float | None = None,
    blocks: int | None = None,
    pieces: int = 1,
    resumed: bool = False,
    cells: int = 131_072,
    earlier: Any = None,
    changed: dict[int, float] | None = None,
) -> CoupledRun:
    """Run a model two-way coupled from end to end.

    displacement: the start's, in um, in place of the model's; blocks: played together; pieces: in which a block is made
    known; resumed: whether the state is written down and read between blocks; cells: of a range; changed: constants.
    """
    numbers = constants(model, tolerance)
    for index, value in (changed or {}).items():
        numbers[index] = value
    before = start(model, seed)
    state = CoupledState.start(model, numbers, before.live)
    if displacement is not None:
        state.numbers[layout.DISPLACEMENT] = displacement
    begin = float(state.numbers[layout.DISPLACEMENT])
    told: list[MotionRows] = []
    block, place, junctions = before.block, before.next_birth, before.junctions
    earlier = earlier or partial(lived, model, seed)
    motion = CoupledMotion(model, numbers, state, earlier, cells)
    while not motion.finished:
        born, known, reached = LiveRows.none(), np.inf, 0.0 if block == 0 else place
        if place <= model.distance:
            births = draw_blocks(model, seed, block, place, blocks or blocks_drawn_at_once(model, block))
            born = births.rows(junctions)
            block, place, junctions = block + births.blocks, births.next_birth, junctions + len(births)
            known = place if place <= model.distance else np.inf
        shares = np.arange(1, pieces) / pieces
        borders = (reached + shares * (min(known, model.distance) - reached)).tolist()
        for border in [*borders, known]:
            told.extend(motion.through(born, border))
        if resumed:
            motion = CoupledMotion(model, numbers, motion.state, earlier, cells)
            motion.finished = known == np.inf
    return _told(told, motion.state, numbers, begin)


def among(
    model: Model, junctions: LiveRows, *, displacement: float, tolerance: float = 1e-9, most: int = 0
) -> CoupledRun:
    """Run a slider among given junctions, born before s = 0 and the only ones there ever are.

    most: landmarks after which the run may stop, if there are so many.
    """
    numbers = constants(model, tolerance)
    state = CoupledState.start(model, numbers, junctions)
    state.numbers[layout.DISPLACEMENT] = displacement
    motion = CoupledMotion(model, numbers, replace(state, covered=-np.inf), lambda _begin, _end: LiveRows.none())
    told: list[MotionRows] = []
    places = np.linspace(0.0, model.distance, 51)[1:-1].tolist()
    for known in [*places, np.inf]:
        told.extend(motion.through(LiveRows.none(), known))
        if most and sum(some.landmarks["time"].size for some in told) >= most:
            break
    return _told(told, motion.state, numbers, displacement)


def _told(told: list[MotionRows], state: CoupledState, numbers: Doubles, begin: float) -> CoupledRun:
    assert [some.first_row for some in told] == np.cumsum([0] + [some.slider["time"].size for some in told])[
        :-1
    ].tolist()
    return CoupledRun(
        slider={name: np.concatenate([some.slider[name] for some in told]) for name in told[0].slider},
        landmarks={name: np.concatenate([some.landmarks[name] for some in told]) for name in told[0].landmarks},
        births=_together([some.births for some in told]),
        deaths=_together([some.deaths for some in told]),
        state=state,
        constants=numbers,
        start=begin,
    )


def _together(passed: list[tuple[NDArray[np.int64], Doubles]]) -> tuple[NDArray[np.int64], Doubles]:
    junctions, times = zip(*passed, strict=True)
    return np.concatenate(junctions), np.concatenate(times)


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
