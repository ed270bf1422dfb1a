"""The runs that claims rest on: every point of a sweep, and the numbers found in it with their scatter."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rubnoise.analysis.replicates import PooledEstimate, estimate
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.scenario.shipped import shipped
from rubnoise.scenario.sweep import expand, load_sweep
from rubnoise.sweep.execution import Measurement, run_points

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
        """Return the one point of a mean real contact area (um^2), mean junction count, pulse shape, written spread.

        Speeds are in um/s, damping is in N s/m. Of a sweep over both couplings it is the point of one.
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


def gather(name: str, read: Read, report: Report) -> Evidence:
    """Run every point of a sweep that comes with rubnoise, in memory, and measure each run."""
    found: dict[int, list[dict[str, float]]] = {}
    cases: dict[int, tuple[Model, Mapping[str, Any]]] = {}
    measure = Measurement(sink=MemoryRecord, read=read)
    points = expand(load_sweep(shipped(name)))
    for number, (point, numbers) in enumerate(run_points(points, measure), 1):
        report(f"{name}: run {number} of {len(points)}")
        case = number - 1 - point.replicate
        cases.setdefault(case, (point.scenario.model(), point.values))
        found.setdefault(case, []).append(numbers)
    return Evidence(
        tuple(
            Found(model=model, values=values, numbers=_together(found[case])) for case, (model, values) in cases.items()
        )
    )


def _together(runs: list[dict[str, float]]) -> dict[str, PooledEstimate]:
    return {name: estimate([run[name] for run in runs]) for name in runs[0]}
