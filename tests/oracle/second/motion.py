"""The slider of a run compared with its force: its motion from each tick to the next, by formulas of its own."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil, log2
from typing import Final

import numpy as np

from rubnoise.analysis.reading import Ahead
from rubnoise.arrays import CHUNK_ROWS, Doubles
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Rows, chunks
from rubnoise.runs.verification import Check
from rubnoise.theory.sizes import panels
from tests.oracle.second.contact import Window
from tests.oracle.second.notes import Notes
from tests.oracle.second.sums import force_moments

_NODES = 20
_HALVINGS = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class CellMotion:
    """What becomes of displacement and velocity over a cell: free (2, 2) of them, gains (2, 3) of the force's moments.

    ``fastest`` is the modulus of the faster exponent of the free motion in 1/s.
    """

    free: Doubles
    gains: Doubles
    fastest: float

    def through(self, moments: Doubles, displacement: Doubles, velocity: Doubles) -> tuple[Doubles, Doubles]:
        """Return displacement (um) and velocity (um/s) where ticks end that begin with those given.

        moments (3, ticks, cells) of the force in each cell of each tick, in uN um.
        """
        for cell in range(moments.shape[2]):
            pushed = self.gains @ moments[:, :, cell]
            displacement, velocity = (
                self.free[row, 0] * displacement + self.free[row, 1] * velocity + pushed[row] for row in (0, 1)
            )
        return displacement, velocity


_SMALL = 1e-2  # of r t, below which a series is closer than a difference of exponentials


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeDecay:
    """m x'' + c x' + k x = 0 with a = c/(2m) and r^2 = a^2 - k/m: ``rate`` a and ``square_root`` r^2 in s^-1, s^-2."""

    rate: float
    square_root: float
    natural: float

    @property
    def fastest(self) -> float:
        """The modulus of the faster exponent in 1/s: the natural frequency when it rings, up to 2a when it creeps."""
        return self.natural if self.square_root <= 0.0 else self.rate + float(np.sqrt(self.square_root))

    def __call__(self, time: Doubles) -> tuple[Doubles, Doubles]:
        """Return exp(-a t) cosh(r t) and exp(-a t) sinh(r t)/r at times in s.

        x(t) = (even + a odd) x(0) + odd x'(0); the impulse response is odd / m.
        """
        if self.square_root < 0.0:
            turns = float(np.sqrt(-self.square_root))
            decay, angle = np.exp(-self.rate * time), turns * time
            even, divided = decay * np.cos(angle), decay * np.sin(angle) / turns
        else:
            root = float(np.sqrt(self.square_root))
            slow, fast = np.exp(-(self.natural**2) / (self.rate + root) * time), np.exp(-(self.rate + root) * time)
            even, divided = 0.5 * (slow + fast), 0.5 * (slow - fast) / (root or 1.0)
        turned = self.square_root * np.square(time)
        series = time * np.exp(-self.rate * time) * (1.0 + turned / 6.0 * (1.0 + turned / 20.0))
        return even, np.where(np.abs(turned) < _SMALL**2, series, divided)


def free_motion(slider: Slider) -> FreeDecay:
    """Return the free motion of a slider; its square root is taken as a product, which keeps its digits near 0."""
    rate, natural = slider.damping / (2.0 * slider.mass), slider.natural_angular_frequency
    return FreeDecay(rate=rate, square_root=(rate - natural) * (rate + natural), natural=natural)


def cell_motion(slider: Slider, speed: float, width: float) -> CellMotion:
    """Return the motion over a cell of a width in um at a sliding speed in um/s.

    x(h) = (even + a odd) x + odd x' and its derivative, and the i-th gain is (2i + 1)/(m V) int_0^1 g(h (1 - y))
    P_i(2y - 1) dy with g = odd for x and its derivative for x'.
    """
    free, duration = free_motion(slider), width / speed
    even, odd = (float(value[0]) for value in free(np.array([duration])))
    moved = [
        [even + free.rate * odd, odd],
        [-(free.natural**2) * odd, even - free.rate * odd],
    ]
    # Finer and finer towards the end of the cell, where the answer of an over-damped slider is steep.
    steps = max(_HALVINGS, ceil(log2(max(free.fastest * duration, 1.0))) + _HALVINGS)
    edges = np.concatenate([[0.0], 2.0 ** np.arange(-steps, 1.0)])
    rest, weights = panels(edges, _NODES)
    even_then, odd_then = free(duration * rest)
    answers = np.stack([odd_then, even_then - free.rate * odd_then])
    place = 1.0 - 2.0 * rest
    shapes = np.stack([np.ones_like(place), 3.0 * place, 5.0 * (1.5 * place * place - 0.5)])
    gains = np.einsum("an,in,n->ai", answers, shapes, weights) / (slider.mass * speed)
    return CellMotion(free=np.array(moved), gains=gains, fastest=free.fastest)


SHARE: Final = 5e-10
"""Of the largest displacement or velocity: what a tick may be away from where the one before it leads."""

STILL: Final = 2.0**-44
"""Of the fastest rate times the largest displacement: velocities that are rounding alone, where the force is steady."""

PLACES: Final = 2.0
"""Roundings of a place: a force F that comes or goes so much earlier moves the velocity by F/(m V) times that."""

LONG: Final = 8.0
"""Mean lives of the longest lives: those born so long before the run have places as far out as its own."""


def motion_check(model: Model, rows: Rows, cells: int) -> Check:
    """Return whether every tick of a one-way slider follows from the one before it and the force between them.

    ``cells`` is into how many equal parts a tick is divided, in each of which the force is known by three moments.
    """
    notes, ahead = Notes("motion"), Ahead(rows)
    for name, begin in (("displacement", model.equilibrium_displacement), ("velocity", 0.0)):
        notes.equal(f"/slider/{name}", 0, rows.column("slider", name, 0, 1), begin)
    motion, largest = _motion(model, cells), {name: _largest(rows, name) for name in ("displacement", "velocity")}
    for first, end, moments in _moments(model, rows, cells):
        before = (ahead.column("slider", name, first - 1, end - 1) for name in largest)
        with np.errstate(invalid="ignore", over="ignore"):
            led = motion.through(moments, *before)
            allowed = _allowed(model, motion, largest, np.arange(first, end, dtype=np.float64) * model.tick)
        for name, expected, limit in zip(largest, led, allowed, strict=True):
            notes.near(f"/slider/{name}", first, ahead.column("slider", name, first, end), expected, limit)
    return notes


def _allowed(
    model: Model, motion: CellMotion, largest: dict[str, float], distance: Doubles
) -> tuple[float, float | Doubles]:
    """Return what displacement (um) and velocity (um/s) may be away at ticks from where those before them lead."""
    if model.slider is None or model.sliding_speed is None:
        return 0.0, 0.0
    moved, fast = largest["displacement"], largest["velocity"]
    pushed = model.slider.natural_angular_frequency**2 * moved / model.sliding_speed
    place = np.spacing(distance + LONG * model.mean_life_distance)
    return SHARE * moved, SHARE * fast + STILL * motion.fastest * moved + PLACES * place * pushed


def _motion(model: Model, cells: int) -> CellMotion:
    if model.slider is None or model.sliding_speed is None:
        raise ValueError("a model without a slider has no motion")
    return cell_motion(model.slider, model.sliding_speed, model.tick / cells)


def _moments(model: Model, rows: Rows, cells: int) -> Iterator[tuple[int, int, Doubles]]:
    """Yield first and last ticks with the moments (3, ticks, cells) of the force in the cells that end with them."""
    window, total, size = Window(rows), rows.rows("slider"), max(CHUNK_ROWS // cells, 1)
    width = model.tick / cells
    for first in range(1, total, size):
        end = min(first + size, total)
        edges = np.arange((first - 1) * cells, (end - 1) * cells + 1).astype(np.float64) * width
        moments = np.zeros((3, edges.size - 1))
        for each in window.until(float(edges[-1])):
            shapes: tuple[Doubles, ...] = (each.birth, each.diameter, each.death, each.strength)
            if model.pulse.offset != "none":
                shapes = (*shapes, each.offset)
            moments += force_moments(model.pulse, edges, width, shapes)
        yield first, end, moments.reshape(3, end - first, cells)


def _largest(rows: Rows, name: str) -> float:
    """Return the largest modulus of a column's finite numbers."""
    found = 0.0
    for chunk in chunks(rows, "slider"):
        finite = chunk[name][np.isfinite(chunk[name])]
        found = max(found, float(np.abs(finite).max(initial=0.0)))
    return found
