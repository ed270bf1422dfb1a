"""The file of a point of a sweep: made, found again, and read for the index.

A file with its final name is complete, so nothing else is written down: who finds the file need not make it. A run that
keeps its summary alone has its figures and curves in an archive of numpy's.
"""

import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, cast

import numpy as np

from rubnoise.analysis.run_summary import CURVES, SummarySink, curve_theory
from rubnoise.errors import OutputRefused, RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.runs.making import describe, play
from rubnoise.scenario.points import Point, name_of
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.sweep_keys import Keep
from rubnoise.simulation.extent import Engine
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import Watch
from rubnoise.storage.output import whole_file
from rubnoise.storage.reader import InUse, TooNew, open_run
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION

RUNS: Final = "runs"
"""The folder of the files, in that of the sweep."""

SUFFIXES: Final[Mapping[Keep, str]] = {"runs": ".h5", "summary": ".npz"}

Figures = Mapping[str, Any]
"""What the index of a sweep has of a run by name: figures as numbers, and of a run that keeps no more its curves.

Arrays that are no CURVES are equal for all replicates of a point; the first one has them.
"""


def file_of(folder: Path, run_id: str, keep: Keep) -> Path:
    """Return the path of the file of a run in the folder of its sweep."""
    return folder / RUNS / f"{run_id}{SUFFIXES[keep]}"


def made(point: Point, *, folder: Path, keep: Keep, command: Sequence[str], durable: bool, watch: Watch) -> Figures:
    """Make one run into its file, unless it is there, and return its figures.

    ``watch`` is called after each range of ticks, and may raise. Raises OutputInUse if another process is making the
    run, OutputRefused if the result of another run is in its place. Unless ``durable``, the caller flushes the file.
    """
    path = file_of(folder, point.run_id, keep)
    if (there := found(point, path)) is not None:
        return there
    if keep == "summary":
        summary = summarised(point.scenario, first=point.replicate == 0, watch=watch)
        with whole_file(path, force=True) as part:
            _save(part, point.scenario, summary)
        return summary
    with RunWriter(path, describe(point.scenario, path, command), force=True, durable=durable) as writer:
        return numbers_in(play(writer, point.scenario, watch=watch))


def numbers_in(figures: Figures) -> Figures:
    """Return the figures that are numbers."""
    return {name: value for name, value in figures.items() if isinstance(value, int | float)}


def summarised(scenario: Scenario, *, first: bool, watch: Watch = lambda _distance, _junctions, _live: None) -> Figures:
    """Run a scenario and return its figures and curves, with the theory of the curves for the first replicate."""
    model = scenario.model()
    sink = SummarySink(model)
    simulate(model, scenario.run.seed, sink, engine=cast(Engine, scenario.run.engine), watch=watch)
    summary = sink.finish()
    figures = {name: value for each in summary.figures for name, value in each.as_attributes().items()}
    theory = {
        f"{name}_{part}": getattr(about, part)
        for name, about in (curve_theory(model).items() if first else ())
        for part in ("place", "expected", "standard_error")
        # The histogram's errors are those of each run.
        if (name, part) != ("histogram", "standard_error")
    }
    return {**numbers_in(figures), **summary.curves, **theory}


def _save(path: Path, scenario: Scenario, summary: Figures) -> None:
    numbers = numbers_in(summary)
    arrays = {
        f"{'curve' if name in CURVES else 'point'} {name}": values
        for name, values in summary.items()
        if name not in numbers
    }
    arrays |= {"names": np.array([*numbers]), "values": np.array([*numbers.values()])}
    arrays |= {"stream_version": np.array(STREAM_VERSION), "scenario": np.array(json.dumps(scenario.resolved()))}
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


def found(point: Point, path: Path) -> Figures | None:
    """Return the figures of a run whose file is there; None without a file, or for one that a power cut has spoilt.

    The whole file is read and compared with its hashes. Raises OutputRefused for the result of another run, and
    RunFileRefused for one that this program may not judge.
    """
    if not path.exists():
        return None
    try:
        resolved, figures = read(path)
    except RunFileRefused as refusal:
        if isinstance(refusal, InUse | TooNew) or isinstance(refusal.__cause__, OSError):
            raise
        return None
    if name_in(resolved, path) != point.run_id:
        raise OutputRefused(f"{path}: is not the result of this run; move it away, and the same command makes it")
    return figures


_NOT_UNPACKED: Final = (zipfile.BadZipFile, zlib.error)


def read(path: Path) -> tuple[Mapping[str, Any], Figures | None]:
    """Return the scenario in the file of a run and its figures, None if the file is not as it was written.

    The scenario is empty if this version makes other bits of it. Raises RunFileRefused for another file.
    """
    if path.suffix == SUFFIXES["summary"]:
        return _read_summary(path)
    with open_run(path) as file:
        whole = file.provenance["finished"] and file.summary and not file.damaged()
        return scenario_in(file), numbers_in(file.summary) if whole else None


def scenario_of(path: Path) -> Mapping[str, Any]:
    """Return the scenario in the file of a run, as `read` does."""
    if path.suffix == SUFFIXES["summary"]:
        return _read_summary(path)[0]
    with open_run(path) as file:
        return scenario_in(file)


def scenario_in(file: Reader) -> Mapping[str, Any]:
    """Return the resolved scenario in a result, empty if this version makes other bits of it.

    Raises RunFileRefused if it cannot be read.
    """
    origin = file.provenance
    if origin["stream_version"] != STREAM_VERSION or "intervention" in origin:
        return {}  # with lives ended from outside it is no sample of the scenario
    try:
        return dict(json.loads(str(origin["scenario_resolved"])))
    except (ValueError, TypeError, RecursionError) as problem:
        raise RunFileRefused(f"{file.path}: the scenario in the file is not valid") from problem


def _read_summary(path: Path) -> tuple[Mapping[str, Any], Figures]:
    try:
        with np.load(path) as kept:
            same = kept["stream_version"] == STREAM_VERSION
            figures = dict(zip(kept["names"].tolist(), kept["values"].tolist(), strict=True))
            arrays = {
                name.partition(" ")[2]: kept[name] for name in kept.files if name.startswith(("curve ", "point "))
            }
            return dict(json.loads(str(kept["scenario"]))) if same else {}, figures | arrays
    except (ValueError, LookupError, TypeError, EOFError, RuntimeError, MemoryError, *_NOT_UNPACKED) as problem:
        raise RunFileRefused(f"{path}: damaged: {problem}") from None
    except OSError as problem:
        raise RunFileRefused(f"{path}: {str(problem.strerror or problem).lower()}") from problem


def name_in(resolved: Mapping[str, Any], path: Path, seed: int | None = None) -> str:
    """Return the name of a resolved scenario's run, or with another seed; empty if there is no scenario."""
    try:
        return name_of(resolved, resolved["run"]["seed"] if seed is None else seed) if resolved else ""
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as problem:
        raise RunFileRefused(f"{path}: the scenario in the file is not valid") from problem
