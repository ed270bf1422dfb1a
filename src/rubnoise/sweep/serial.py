"""The points of a sweep run one after another, each in memory and only as far as somebody measures it."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar, cast

from rubnoise.model import Model
from rubnoise.record.sink import Extent, Sink
from rubnoise.scenario.points import Point
from rubnoise.simulation.run import Engine, extent, simulate
from rubnoise.sweep.engine import Course, Here

Kept = TypeVar("Kept", bound=Sink)
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure(Generic[Kept, Result]):
    """What a run is measured by: ``sink`` keeps its rows as they come, ``read`` says in the end what they were.

    The result is all that is left of a run. Give functions of a module, which other processes can be told of.
    """

    sink: Callable[[Extent], Kept]
    read: Callable[[Model, Kept], Result]


def run_points(points: Iterable[Point], measure: Measure[Kept, Result]) -> Iterator[tuple[Point, Result]]:
    """Run points in their order, and yield each with its result as soon as it is there."""
    for outcome in Course(points, partial(measured, measure=measure), Here()).outcomes():
        if outcome.problem is not None:
            raise outcome.problem
        yield outcome.point, cast(Result, outcome.result)


def measured(point: Point, measure: Measure[Kept, Result]) -> Result:
    """Run one point and return its result, which is the same wherever and whenever it is run."""
    model = point.scenario.model()
    sink = measure.sink(extent(model, point.seed))
    simulate(model, point.seed, sink, engine=cast(Engine, point.scenario.run.engine))
    return measure.read(model, sink)
