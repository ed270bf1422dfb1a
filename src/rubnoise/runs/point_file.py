"""The file of a point of a sweep: made, found again, and read for the index.

A file with its final name is complete, so nothing else is written down: who finds the file need not make it. A run that
keeps its summary alone has its figures and curves in an archive of numpy's.
"""

import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal, Self, cast

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.run_summary import SummarySink, curve_theory
from rubnoise.errors import OutputRefused, RunFileRefused
from rubnoise.model import Model
from rubnoise.runs.making import describe, play
from rubnoise.scenario.points import Point, name_of
from rubnoise.scenario.scenario import Scenario
from rubnoise.simulation.block import Watch
from rubnoise.simulation.extent import Engine
from rubnoise.simulation.run import simulate
from rubnoise.storage.output import whole_file
from rubnoise.storage.reader import InUse, TooNew, open_run
from rubnoise.storage.schema import Scalar
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION

Keep = Literal["runs", "summary"]
Arrays = Mapping[str, NDArray[Any]]
SUFFIXES: Final[Mapping[Keep, str]] = {"runs": ".h5", "summary": ".npz"}


@dataclass(frozen=True, slots=True, kw_only=True)
class RunFigures:
    """What the index of a sweep has of a run: its figures by name, and the curves of a run that keeps no more.

    ``of_point`` are arrays that are equal for all replicates of a point; the first one has them.
    """

    names: tuple[str, ...]
    values: NDArray[np.float64]
    curves: Arrays = field(default_factory=dict)
    of_point: Arrays = field(default_factory=dict)

    @classmethod
    def of(cls, figures: Mapping[str, Scalar], curves: Arrays = {}, of_point: Arrays = {}) -> Self:  # noqa: B006
        """Take the figures that are numbers."""
        numbers = {name: value for name, value in figures.items() if isinstance(value, int | float)}
        return cls(names=tuple(numbers), values=np.array([*numbers.values()]), curves=curves, of_point=of_point)

    def get(self, name: str) -> float | None:
        """Return a figure, None if the run has none of this name."""
        return float(self.values[self.names.index(name)]) if name in self.names else None

    def values_of(self, names: Sequence[str]) -> NDArray[np.float64]:
        """Return figures in the order of names; nan for one that the run does not have."""
        known = dict(zip(self.names, self.values.tolist(), strict=True))
        return np.array([known.get(name, np.nan) for name in names])


def file_of(folder: Path, run_id: str, keep: Keep) -> Path:
    """Return the path of the file of a run in the folder of its sweep."""
    return folder / "runs" / f"{run_id}{SUFFIXES[keep]}"


def made(point: Point, *, folder: Path, keep: Keep, command: Sequence[str], durable: bool, watch: Watch) -> RunFigures:
    """Make one run into its file, unless it is there, and return its figures.

    ``watch`` is called after each range of ticks, and may raise. Raises OutputInUse if another process is making the
    run, OutputRefused if the result of another run is in its place. Unless ``durable``, the caller flushes the file.
    """
    path = file_of(folder, point.run_id, keep)
    if (there := found(point, path)) is not None:
        return there
    if keep == "summary":
        with whole_file(path, force=True) as part:
            return _summed_up(point, part, watch)
    description = describe(point.scenario, path, command)
    with RunWriter(path, description, force=True, durable=durable) as writer:
        return RunFigures.of(play(writer, point.scenario, watch=watch))


def _summed_up(point: Point, path: Path, watch: Watch) -> RunFigures:
    summary = summarised(point.scenario, first=point.replicate == 0, watch=watch)
    arrays = {f"curve {name}": values for name, values in summary.curves.items()}
    arrays |= {f"point {name}": values for name, values in summary.of_point.items()}
    arrays |= {"names": np.array(summary.names), "values": summary.values, "stream_version": np.array(STREAM_VERSION)}
    arrays["scenario"] = np.array(json.dumps(point.scenario.resolved()))
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)
    return summary


def summarised(
    scenario: Scenario, *, first: bool, watch: Watch = lambda _distance, _junctions, _live: None
) -> RunFigures:
    """Run a scenario and return its figures and curves, with the theory of the curves for the first replicate."""
    model = scenario.model()
    sink = SummarySink(model)
    simulate(model, scenario.run.seed, sink, engine=cast(Engine, scenario.run.engine), watch=watch)
    summary = sink.finish()
    figures = {name: value for each in summary.figures for name, value in each.as_attributes().items()}
    return RunFigures.of(figures, summary.curves, theory_of_curves(model) if first else {})


def theory_of_curves(model: Model) -> dict[str, NDArray[Any]]:
    """Return the places of the curves in a model's summaries and their expected values: `spectrum_place` and so on.

    They are equal for all runs of a point; nan if theory has none.
    """
    return {
        f"{name}_{part}": getattr(theory, part)
        for name, theory in curve_theory(model).items()
        for part in ("place", "expected", "standard_error")
        # The histogram's errors are those of each run.
        if (name, part) != ("histogram", "standard_error")
    }


def found(point: Point, path: Path) -> RunFigures | None:
    """Return the figures of a run whose file is there; None without a file, or for one that a power cut has spoilt.

    The whole file is read and compared with its hashes. Raises OutputRefused for the result of another run, and
    RunFileRefused for one that this program may not judge.
    """
    if not path.exists():
        return None
    try:
        name, figures = read(path)
    except RunFileRefused as refusal:
        if isinstance(refusal, InUse | TooNew) or isinstance(refusal.__cause__, OSError):
            raise
        return None
    if name != point.run_id:
        raise OutputRefused(f"{path}: is not the result of this run; move it away, and the same command makes it")
    return figures


def read(path: Path) -> tuple[str, RunFigures | None]:
    """Return the name of the run in a file and its figures, None if the file is not as it was written.

    The name is empty if this version makes other bits of the same scenario. Raises RunFileRefused for another file.
    """
    if path.suffix == SUFFIXES["summary"]:
        resolved, figures = read_summary(path)
        return run_in(resolved, path), figures
    with open_run(path) as file:
        origin = file.provenance
        # With lives ended from outside it is no sample of the scenario.
        other = origin["stream_version"] != STREAM_VERSION or "intervention" in origin
        name = "" if other else run_in(resolved_in(origin, path), path)
        whole = origin["finished"] and file.summary and not file.damaged()
        return name, RunFigures.of(file.summary) if whole else None


def read_summary(path: Path) -> tuple[Mapping[str, Any], RunFigures]:
    """Return the resolved scenario of a run that keeps its summary alone, and what it keeps; raises RunFileRefused."""
    try:
        with np.load(path) as kept:
            resolved = json.loads(str(kept["scenario"]))
            if kept["stream_version"] != STREAM_VERSION:
                resolved = {}
            curves, of_point = (
                {name.removeprefix(kind): kept[name] for name in kept.files if name.startswith(kind)}
                for kind in ("curve ", "point ")
            )
            names = tuple(map(str, kept["names"]))
            return resolved, RunFigures(names=names, values=kept["values"], curves=curves, of_point=of_point)
    except (ValueError, LookupError, TypeError, EOFError, zipfile.BadZipFile) as problem:
        raise RunFileRefused(f"{path}: damaged: {problem}") from None
    except OSError as problem:
        raise RunFileRefused(f"{path}: {str(problem.strerror or problem).lower()}") from problem


def resolved_in(provenance: Mapping[str, Scalar], path: Path) -> Mapping[str, Any]:
    """Return the resolved scenario in a result; raises RunFileRefused if it cannot be read."""
    try:
        return dict(json.loads(str(provenance["scenario_resolved"])))
    except (ValueError, TypeError, RecursionError) as problem:
        raise RunFileRefused(f"{path}: the scenario in the file is not valid") from problem


def run_in(resolved: Mapping[str, Any], path: Path, seed: int | None = None) -> str:
    """Return the name of a resolved scenario's run, or with another seed; empty if there is no scenario."""
    try:
        return name_of(resolved, resolved["run"]["seed"] if seed is None else seed) if resolved else ""
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as problem:
        raise RunFileRefused(f"{path}: the scenario in the file is not valid") from problem


def check_run(provenance: Mapping[str, Scalar], path: Path, run_id: str) -> None:
    """Raise RunFileRefused if a file is the result of another run."""
    if (name := run_in(resolved_in(provenance, path), path)) != run_id:
        raise RunFileRefused(f"{path}: is the result of another run, {name}")
