"""The runs behind claims: every point of a sweep, and its numbers with their scatter."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import nan
from typing import Any

from rubnoise.analysis.replicates import PooledEstimate, estimate, ratio
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.runs.measuring import Measurement, run_points
from rubnoise.scenario.points import Point
from rubnoise.scenario.shipped import shipped
from rubnoise.scenario.sweep import expand, load_sweep

Read = Callable[[Model, MemoryRecord], dict[str, float]]
"""Finds named numbers in the record of one run."""

Report = Callable[[str], None]
"""Called with a text on each run before it begins."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """One point of a sweep: its model, its swept values as written, and each number with its replicates' scatter."""

    model: Model
    values: Mapping[str, Any]
    numbers: dict[str, PooledEstimate]


@dataclass(frozen=True, slots=True)
class Evidence:
    """All points of a sweep."""

    points: tuple[Found, ...]

    def at(
        self,
        *,
        area: float | None = None,
        count: float | None = None,
        shape: str | None = None,
        spread: str | None = None,
        speed: float | None = None,
        damping: float | None = None,
        coupling: str = "one-way",
    ) -> Found:
        """Return the point with a mean real contact area (um^2), mean junction count, pulse shape, written spread.

        Speeds are in um/s, damping is in N s/m; ``coupling`` chooses the point in a sweep over both couplings.
        """
        wanted = [
            point
            for point in self.points
            if area in (None, point.model.mean_real_contact_area)
            and count in (None, point.model.mean_junction_count)
            and shape in (None, point.model.pulse.shape)
            and spread in (None, point.values.get("diameter.spread"))
            and speed in (None, point.model.sliding_speed)
            and (
                point.model.slider is None
                or (point.model.slider.coupling == coupling and damping in (None, point.model.slider.damping))
            )
        ]
        [found] = wanted
        return found


def quotient(
    name: str, one: Found, other: Found, number: str, exact: Callable[[Model], float] | None = None
) -> ClaimedNumber:
    """Return a number of one point over that of another; without ``exact`` theory has none."""
    return ClaimedNumber(
        name=name,
        simulated=ratio(one.numbers[number], other.numbers[number]),
        exact=nan if exact is None else exact(one.model) / exact(other.model),
    )


def gather(name: str, read: Read, report: Report) -> Evidence:
    """Run every point of a sweep that comes with rubnoise, in memory, and measure each run."""
    cases: dict[int, tuple[Point, list[dict[str, float]]]] = {}
    measure = Measurement(sink=MemoryRecord, read=read)
    points = expand(load_sweep(shipped(name)))
    for number, (point, numbers) in enumerate(run_points(points, measure)):
        report(f"{name}: run {number + 1} of {len(points)}")
        cases.setdefault(number - point.replicate, (point, []))[1].append(numbers)
    return Evidence(
        tuple(
            Found(
                model=point.scenario.model(),
                values=point.values,
                numbers={each: estimate([run[each] for run in runs]) for each in runs[0]},
            )
            for point, runs in cases.values()
        )
    )
