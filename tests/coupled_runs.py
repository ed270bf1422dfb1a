"""Two-way runs for the tests, from a model and a seed."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.simulation.coupled import layout
from rubnoise.simulation.coupled.fold import CoupledMotion, MotionRows, constants
from rubnoise.simulation.coupled.past import lived
from rubnoise.simulation.coupled.state import CoupledState
from rubnoise.simulation.draws import blocks_drawn_at_once, draw_blocks, start
from rubnoise.simulation.kernels import Scratch
from rubnoise.simulation.state import LiveRows
from tests.oracle.oscillator import Oscillator
from tests.oracle.slow_contact import Rows

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
    for place, value in (changed or {}).items():
        numbers[place] = value
    before = start(model, seed)
    state = CoupledState.start(model, numbers, before.live)
    if displacement is not None:
        state.numbers[layout.DISPLACEMENT] = displacement
    begin = float(state.numbers[layout.DISPLACEMENT])
    told: list[MotionRows] = []
    block, place, junctions = before.block, before.next_birth, before.junctions
    earlier = earlier or partial(lived, model, seed)
    motion = CoupledMotion(model, numbers, state, Scratch(0), earlier, cells)
    while not motion.finished:
        born, known, reached = LiveRows.none(), np.inf, 0.0 if block == 0 else place
        if place <= model.distance:
            births = draw_blocks(model, seed, block, place, blocks or blocks_drawn_at_once(model, block))
            count = len(births)
            born = LiveRows(
                junction=np.arange(junctions, junctions + count, dtype=np.int64),
                birth=births.birth,
                diameter=births.diameter,
                strength=births.strength,
                departure=np.full(count, np.inf),
            )
            block, place, junctions = block + births.blocks, births.next_birth, junctions + count
            known = place if place <= model.distance else np.inf
        shares = np.arange(1, pieces) / pieces
        borders = (reached + shares * (min(known, model.distance) - reached)).tolist()
        for border in [*borders, known]:
            told.extend(motion.through(born, border))
        if resumed:
            motion = CoupledMotion(model, numbers, CoupledState.unpack(motion.state.pack()), Scratch(0), earlier, cells)
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
    motion = CoupledMotion(
        model, numbers, replace(state, covered=-np.inf), Scratch(0), lambda _begin, _end: LiveRows.none()
    )
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
