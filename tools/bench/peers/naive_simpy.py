"""SimPy as its tutorial teaches it: a process a junction, and one that wakes at every tick to sum the living."""

from collections.abc import Generator
from math import acos, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import simpy

from bench.case import DAMPING, MASS, STIFFNESS, STRENGTH, Case, Draws, doubles
from bench.peers.tables import write


def lens_area(s: float, d: float) -> float:
    """Return the area (um^2) of a junction of diameter d at a distance s since its birth (um)."""
    x = min(abs(d - s), d)
    return 0.5 * (d * d * acos(x / d) - x * sqrt(d * d - x * x))


def acceleration(x: float, v: float, force: float) -> float:
    """Return x'' of the slider."""
    return (force - DAMPING * v - STIFFNESS * x) / MASS


def rk4_step(x: float, v: float, before: float, after: float, h: float) -> tuple[float, float]:
    """Return x and x' one step of h later, the force a straight line over the step."""
    middle = 0.5 * (before + after)
    a1 = acceleration(x, v, before)
    v2 = v + 0.5 * h * a1
    a2 = acceleration(x + 0.5 * h * v, v2, middle)
    v3 = v + 0.5 * h * a2
    a3 = acceleration(x + 0.5 * h * v2, v3, middle)
    v4 = v + h * a3
    a4 = acceleration(x + h * v3, v4, after)
    return x + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0, v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0


class Contact:
    """The processes of the contact and what they note."""

    def __init__(self, case: Case, draws: Draws) -> None:
        """Set the contact up at rest and empty."""
        self.case, self.draws, self.env = case, draws, simpy.Environment()
        self.live: dict[int, tuple[float, float]] = {}
        self.birth: list[float] = []
        self.diameter: list[float] = []
        self.area: list[float] = []
        self.count: list[int] = []
        self.displacement = [0.0]
        self.velocity = [0.0]

    def births(self) -> Generator[Any, Any, None]:
        """Wait for a gap, start a junction, and so on."""
        births, diameters = self.draws.rows()
        for gap, diameter in zip(np.diff(births, prepend=0.0).tolist(), diameters.tolist(), strict=True):
            yield self.env.timeout(gap)
            self.env.process(self.junction(len(self.birth), diameter))

    def junction(self, number: int, diameter: float) -> Generator[Any, Any, None]:
        """Be alive for twice the diameter."""
        self.birth.append(self.env.now)
        self.diameter.append(diameter)
        self.live[number] = (self.env.now, diameter)
        yield self.env.timeout(2.0 * diameter)
        del self.live[number]

    def sampler(self) -> Generator[Any, Any, None]:
        """At every tick sum the living and move the slider."""
        for n in range(1, self.case.tick_count + 2):
            now = self.env.now
            self.area.append(sum(lens_area(now - birth, d) for birth, d in self.live.values()))
            self.count.append(len(self.live))
            if n > 1:
                before, after = STRENGTH * self.area[-2], STRENGTH * self.area[-1]
                x, v = rk4_step(self.displacement[-1], self.velocity[-1], before, after, self.case.step)
                self.displacement.append(x)
                self.velocity.append(v)
            yield self.env.timeout(n * self.case.tick - now)


def run(case: Case, draws: Draws, path: Path) -> None:
    """Simulate births, lives, area and slider, and write them."""
    contact = Contact(case, draws)
    contact.env.process(contact.births())
    contact.env.process(contact.sampler())
    contact.env.run(until=case.distance)
    birth, diameter, area, count, displacement, velocity = map(
        doubles,
        (contact.birth, contact.diameter, contact.area, contact.count, contact.displacement, contact.velocity),
    )
    write(path, case, birth, diameter, area, count, displacement, velocity)
