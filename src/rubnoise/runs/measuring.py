"""Runs that leave no file: each is measured as its rows come, in this process."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, TypeVar, cast

from rubnoise.model import Model
from rubnoise.record.sink import Extent, Sink
from rubnoise.scenario.points import Point
from rubnoise.simulation.extent import Engine, extent
from rubnoise.simulation.run import simulate

Kept = TypeVar("Kept", bound=Sink)
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement(Generic[Kept, Result]):
    """A measurement of a run: ``sink`` takes its rows as they come, ``read`` returns the result at the end.

    Nothing else is kept of a run.
    """

    sink: Callable[[Extent], Kept]
    read: Callable[[Model, Kept], Result]


def run_points(points: Iterable[Point], measure: Measurement[Kept, Result]) -> Iterator[tuple[Point, Result]]:
    """Run points in their order, and yield each with its result as soon as it is known."""
    for point in points:
        yield point, measured(point, measure)


def measured(point: Point, measure: Measurement[Kept, Result]) -> Result:
    """Run one point and return its result, which does not depend on the process or the time."""
    model = point.scenario.model()
    sink = measure.sink(extent(model, point.seed))
    simulate(model, point.seed, sink, engine=cast(Engine, point.scenario.run.engine))
    return measure.read(model, sink)
