"""The runs that claims rest on: every point of a sweep, and the numbers found in it with their scatter."""

from collections.abc import Callable
from dataclasses import dataclass

from rubnoise.claims.claim import Estimate, estimate
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.scenario.shipped import shipped
from rubnoise.scenario.sweep import expand, load_sweep
from rubnoise.sweep.serial import Measure, run_points

Read = Callable[[Model, MemoryRecord], dict[str, float]]
"""Finds named numbers in the record of one run."""

Tell = Callable[[str], None]
"""Is told what is being run, before it is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """One point of a sweep: its model, and each number with the scatter of the point's replicates."""

    model: Model
    numbers: dict[str, Estimate]


@dataclass(frozen=True, slots=True)
class Evidence:
    """All points of a sweep."""

    points: tuple[Found, ...]

    def at(self, *, area: float | None = None, count: float | None = None, shape: str | None = None) -> Found:
        """Return the one point of a mean real contact area (um^2), a mean junction count, a pulse shape."""
        wanted = [
            point
            for point in self.points
            if area in (None, point.model.mean_real_contact_area)
            and count in (None, point.model.mean_junction_count)
            and shape in (None, point.model.pulse.shape)
        ]
        [found] = wanted
        return found


def gather(name: str, read: Read, tell: Tell) -> Evidence:
    """Run every point of a sweep that comes with rubnoise, in memory, and measure each run."""
    found: dict[int, list[dict[str, float]]] = {}
    models: dict[int, Model] = {}
    measure = Measure(sink=MemoryRecord, read=read)
    points = expand(load_sweep(shipped(name)))
    for number, (point, numbers) in enumerate(run_points(points, measure), 1):
        tell(f"{name}: run {number} of {len(points)}")
        case = number - 1 - point.replicate
        models.setdefault(case, point.scenario.model())
        found.setdefault(case, []).append(numbers)
    return Evidence(tuple(Found(model=models[case], numbers=_together(runs)) for case, runs in found.items()))


def _together(runs: list[dict[str, float]]) -> dict[str, Estimate]:
    return {name: estimate([run[name] for run in runs]) for name in runs[0]}
