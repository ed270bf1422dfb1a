"""The sources of the figures of the paper: scenario files, and their runs and sweeps."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

from rubnoise.api.running import simulate
from rubnoise.figures.stretch import Stretch
from rubnoise.record.sink import Sink
from rubnoise.runs.measuring import Measurement, run_points
from rubnoise.scenario import Scenario, load
from rubnoise.scenario.points import Point
from rubnoise.scenario.shipped import shipped
from rubnoise.scenario.sweep import expand, load_sweep

FOLDER: Final = "paper"

Kept = TypeVar("Kept", bound=Sink)
Result = TypeVar("Result")
Watch = Callable[[int, int], None]
"""Called with the number of runs done and the number of all runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sources:
    """The scenario files of the figures: the shipped ones, or those of a folder."""

    folder: Path | None = None
    watch: Watch | None = None

    def path(self, name: str) -> Path:
        """Return the path of a scenario file; raises Refused if a shipped file is missing."""
        return shipped(f"{FOLDER}/{name}") if self.folder is None else self.folder / name

    def scenario(self, name: str, changes: Sequence[str] = ()) -> Scenario:
        """Return a scenario; raises ScenarioRefused."""
        return load(self.path(name), changes)

    def stretch(self, name: str, stop: float | None = None) -> Stretch:
        """Run a scenario, and return its run from the start to a distance in um, or all; raises as a picture does."""
        return Stretch.of(simulate(self.scenario(name)).reader(), 0.0, stop)

    def points(self, name: str) -> tuple[Point, ...]:
        """Return the points of a sweep; raises ScenarioRefused."""
        return expand(load_sweep(self.path(name)))

    def results(self, name: str, measure: Measurement[Kept, Result]) -> Iterator[tuple[Point, Result]]:
        """Run a sweep, and yield its points with their results."""
        points = self.points(name)
        for done, result in enumerate(run_points(points, measure), 1):
            yield result
            if self.watch is not None:
                self.watch(done, len(points))
