"""Exponents of speed and of height under a load that weighs.

n is the slope of the normal velocity over the speed at a fixed height, m over the height at a fixed speed, each from
two runs; no run serves twice. A slope has to be within four standard errors of theory, and m of (1 + n)/2.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import hypot, log, sqrt
from typing import Final

from parts import table

from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from rubnoise.theory.load import load_motion
from rubnoise.theory.sampling import load_errors
from studies.study import Study
from tests.models import loaded

RATIO: Final = 0.3
HEIGHT: Final = 0.5
"""Damping ratio, and the height scale in um at which the speed changes."""

SPEEDS: Final = (0.1, 0.3, 1.0, 3.0, 10.0)
"""v = V/(c omega_c). It goes as V sqrt(s_0): where V changes by a factor, s_0 changes by its square."""

DISTANCE: Final = 40_000.0
TICK: Final = 0.05
"""In um, at v up to 1; both grow with v."""

SEED: Final = 371
ALLOWED: Final = 4.0


@dataclass(frozen=True, kw_only=True)
class Slope:
    """A slope of ln std of the normal velocity, from two runs and by theory."""

    exact: float
    found: float
    error: float


@dataclass(frozen=True, kw_only=True)
class Row:
    """Both slopes between two relative speeds."""

    begin: float
    end: float
    speed: Slope
    height: Slope

    @property
    def miss(self) -> tuple[float, float]:
        """What m is above (1 + n)/2 in the runs, and its standard error."""
        return self.height.found - 0.5 * (1.0 + self.speed.found), hypot(self.height.error, 0.5 * self.speed.error)


def measured(model: Model, seed: int) -> tuple[float, float, float]:
    """Return ln std of the normal velocity, its standard error, both of one run, and by theory."""
    tally = Tally.of(model)
    simulate(model, seed, tally, engine="batch")
    std = tally.moments["normal_velocity"].std
    exact = load_motion(model).velocity_std
    return log(std), load_errors(model, model.distance).velocity_std / exact, log(exact)


def slope(models: tuple[Model, Model], step: float, seed: int) -> Slope:
    """Return the slope between two models that are ``step`` apart in the logarithm."""
    (low, a, low_exact), (high, b, high_exact) = (measured(model, seed + n) for n, model in enumerate(models))
    return Slope(exact=(high_exact - low_exact) / step, found=(high - low) / step, error=hypot(a, b) / step)


def contacts(begin: float, end: float) -> tuple[tuple[Model, Model], tuple[Model, Model]]:
    """Return contacts at two relative speeds: by another speed at the height HEIGHT, by another height at one speed."""

    def contact(v: float, height: float) -> Model:
        longer = max(1.0, v)
        return loaded(distance=DISTANCE * longer, tick=TICK * longer, height=height, ratio=RATIO, relative_speed=v)

    middle = sqrt(begin * end)
    low, high = (contact(v, HEIGHT * (v / middle) ** 2) for v in (begin, end))
    return (contact(begin, HEIGHT), contact(end, HEIGHT)), (low, high)


def row(begin: float, end: float, seed: int) -> Row:
    """Return both slopes between two relative speeds, each from runs of its own."""
    speeds, heights = contacts(begin, end)
    step = log(end / begin)
    return Row(begin=begin, end=end, speed=slope(speeds, step, seed), height=slope(heights, 2.0 * step, seed + 2))


def made() -> Iterator[Row]:
    """Yield a row for each step of the speed."""
    return (row(begin, end, SEED + 4 * n) for n, (begin, end) in enumerate(pairwise(SPEEDS)))


def faults(rows: Sequence[Row]) -> list[str]:
    """Return what runs and theory, or runs and the identity, disagree in."""
    scores = [
        (name, each, z)
        for each in rows
        for name, z in (
            ("n", (each.speed.found - each.speed.exact) / each.speed.error),
            ("m", (each.height.found - each.height.exact) / each.height.error),
            ("m - (1 + n)/2", each.miss[0] / each.miss[1]),
        )
    ]
    return [f"{name} from {each.begin:g} to {each.end:g}: z = {z:.2f}" for name, each, z in scores if abs(z) > ALLOWED]


def tables(rows: Sequence[Row]) -> dict[str, str]:
    """Return the table of the page."""
    head = ("V/(c omega_c)", "n, runs", "n, theory", "m, runs", "m, theory", "m - (1 + n)/2, runs")
    cells = (
        (
            f"{each.begin:g} to {each.end:g}",
            *_told(each.speed),
            *_told(each.height),
            f"{each.miss[0]:+.3f} ± {each.miss[1]:.3f}",
        )
        for each in rows
    )
    return {"load": table(head, cells)}


def _told(each: Slope) -> tuple[str, str]:
    return f"{each.found:.3f} ± {each.error:.3f}", f"{each.exact:.3f}"


STUDY: Final = Study(
    about=__doc__,
    page="load.md",
    data="load.json",
    row=Row,
    facts={"damping_ratio": RATIO, "junctions": 20, "seed": SEED},
    make=made,
    faults=faults,
    tables=tables,
)
