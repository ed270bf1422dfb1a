"""The folder of a sweep: the file of each run, made, found again and read, whose runs are there, and for how many more.

A file with its final name is complete, so nothing else is written down: who finds the file need not make it. A run that
keeps its summary alone has its figures and curves in an archive of numpy's.
"""

import json
import os
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Final, cast

import numpy as np

from rubnoise.analysis.run_summary import SummarySink, curve_theory
from rubnoise.errors import OutputRefused, Refused, RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.runs.making import describe, play
from rubnoise.scenario.scenario import Scenario, flattened
from rubnoise.scenario.sweep import Point, Sweep, in_words, name_of, points_of, run_id
from rubnoise.scenario.sweep_keys import Keep
from rubnoise.simulation.draws import Engine
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import Watch
from rubnoise.storage.output import OutputInUse, whole_file
from rubnoise.storage.reader import InUse, TooNew, open_run
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION

RUNS: Final = "runs"
"""The folder of the files, in that of the sweep."""

SUFFIXES: Final[Mapping[Keep, str]] = {"runs": ".h5", "summary": ".npz"}

Figures = Mapping[str, Any]
"""What the index of a sweep has of a run by name: figures as numbers, and of a run that keeps no more its curves.

Arrays that are no CURVES of `analysis.run_summary` are equal for all replicates of a point; the first one has them.
"""


def file_of(folder: Path, run_id: str, keep: Keep) -> Path:
    """Return the path of the file of a run in the folder of its sweep."""
    return folder / RUNS / f"{run_id}{SUFFIXES[keep]}"


def made(point: Point, *, folder: Path, keep: Keep, command: Sequence[str], watch: Watch) -> Figures | None:
    """Make one run into its file, unless it is there, and return its figures; None if another process is making it.

    ``watch`` is called after each range of ticks, and may raise. Raises OutputRefused if the result of another run is
    in its place.
    """
    path = file_of(folder, point.run_id, keep)
    try:
        if (there := found(point, path)) is not None:
            return there
        if keep == "summary":
            summary = summarised(point.scenario, first=point.replicate == 0, watch=watch)
            with whole_file(path, force=True) as part:
                _save(part, point.scenario, summary)
            return summary
        with RunWriter(path, describe(point.scenario, path, command), force=True) as writer:
            return numbers_in(play(writer, point.scenario, watch=watch))
    except (OutputInUse, InUse):
        return None


def numbers_in(figures: Figures) -> Figures:
    """Return the figures that are numbers."""
    return {name: value for name, value in figures.items() if isinstance(value, int | float)}


def summarised(scenario: Scenario, *, first: bool, watch: Watch = lambda _distance, _junctions, _live: None) -> Figures:
    """Run a scenario and return its figures and curves, with the theory of the curves for the first replicate."""
    model = scenario.model()
    sink = SummarySink(model)
    simulate(model, scenario.run.seed, sink, engine=cast(Engine, scenario.run.engine), watch=watch)
    return {**sink.finish(), **(curve_theory(model) if first else {})}


def _save(path: Path, scenario: Scenario, summary: Figures) -> None:
    numbers = numbers_in(summary)
    kept = {name: values for name, values in summary.items() if name not in numbers}
    kept |= {"names": np.array([*numbers]), "values": np.array([*numbers.values()])}
    kept |= {"stream_version": np.array(STREAM_VERSION), "scenario": np.array(json.dumps(scenario.resolved()))}
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **kept)


def found(point: Point, path: Path) -> Figures | None:
    """Return the figures of a run whose file is there; None without a file, or for one that a power cut has spoilt.

    The whole file is read and compared with its hashes. Raises OutputRefused for the result of another run, and
    RunFileRefused for one that this program may not judge.
    """
    if not path.exists():
        return None
    try:
        resolved, figures = read(path, checked=True)
    except RunFileRefused as refusal:
        if isinstance(refusal, InUse | TooNew) or isinstance(refusal.__cause__, OSError):
            raise
        return None
    if name_in(resolved, path) != point.run_id:
        raise OutputRefused(f"{path}: is not the result of this run; move it away, and the same command makes it")
    return figures


def read(path: Path, *, checked: bool = False) -> tuple[Mapping[str, Any], Figures | None]:
    """Return the scenario in the file of a run and its figures, None if it is ``checked`` and not as it was written.

    The scenario is empty if this version makes other bits of it. Raises RunFileRefused for another file.
    """
    if path.suffix == SUFFIXES["summary"]:
        return _read_summary(path)
    with open_run(path) as file:
        spoilt = checked and (not file.summary or file.damaged())
        return scenario_in(file), None if spoilt else numbers_in(file.summary)


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
        with np.load(path) as file:
            kept = dict(file)
        version, scenario, names, values = (
            kept.pop(name) for name in ("stream_version", "scenario", "names", "values")
        )
        figures = dict(zip(names.tolist(), values.tolist(), strict=True))
        return dict(json.loads(str(scenario))) if version == STREAM_VERSION else {}, figures | kept
    except OSError as problem:
        raise RunFileRefused(f"{path}: {str(problem.strerror or problem).lower()}") from problem
    except Exception as problem:  # noqa: BLE001  (what a damaged archive raises, which may be any error)
        raise RunFileRefused(f"{path}: damaged: {problem}") from None


def name_in(resolved: Mapping[str, Any], path: Path, seed: int | None = None) -> str:
    """Return the name of a resolved scenario's run, or with another seed; empty if there is no scenario."""
    try:
        return name_of(resolved, resolved["run"]["seed"] if seed is None else seed) if resolved else ""
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError) as problem:
        raise RunFileRefused(f"{path}: the scenario in the file is not valid") from problem


_SHARD: Final = re.compile(r"([1-9][0-9]{0,5})/([1-9][0-9]{0,5})")
_RUN: Final = re.compile(r"[0-9a-f]{16}(?:\.h5|\.npz)")
_FREE: Final = ("title", "run.engine", "run.seed", "output.tick")
"""Keys that the names of points do not depend on, and the tick, whose default follows from the others."""


def check_folder(root: Path) -> None:
    """Raise OutputRefused if a path is no folder for a sweep: it cannot be written, or holds other files."""
    # A path that may not be looked at counts as missing here: it is the folder above that is closed.
    above = next(place for place in (root, *root.absolute().parents) if os.path.lexists(place))
    if not above.is_dir():
        raise OutputRefused(f"{above}: is no folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise OutputRefused(f"{above}: the folder is not writable")
    if above != root:
        return
    if not os.access(root, os.R_OK):
        raise OutputRefused(f"{root}: the folder is not readable")
    if not (root / RUNS).is_dir() and any(not entry.name.startswith(".") for entry in root.iterdir()):
        raise OutputRefused(f"{root}: is not a sweep folder, and not empty; name another folder")


def check_strangers(root: Path, sweep: Sweep, known: Collection[str]) -> None:
    """Raise OutputRefused if a folder holds the run of a scenario that the sweep lacks; ``known`` are its runs.

    Further replicates of its points are no strangers, damaged files are of no sweep.
    """
    cases, seed = {run_id(case.scenario): case for case in sweep.cases}, sweep.cases[0].scenario.run.seed
    there = sorted((root / RUNS).iterdir()) if (root / RUNS).is_dir() else []
    others = [path for path in there if _RUN.fullmatch(path.name) and path.stem not in known]
    replicates: dict[str, set[str]] = {}
    for path in others:
        with suppress(RunFileRefused):
            resolved, _ = read(path)
            name, reason = name_in(resolved, path, seed), ""
            if name not in cases:
                reason = _difference(resolved, sweep)
            elif name not in replicates:
                more = points_of([cases[name]], len(others) + len(known))
                replicates[name] = {point.run_id for point in more}
            if reason or path.stem not in replicates[name]:
                said = f"{path.stem}: {reason or 'its seed is of another run.seed'}"
                remedy = "force=True leaves them beside the runs of this one"
                raise OutputRefused(f"{root}: holds the runs of another scenario; {said}; {remedy}")


def _difference(resolved: Mapping[str, Any], sweep: Sweep) -> str:
    """Return in what a run differs from all points of a sweep, which differ among themselves in the swept keys."""
    if not resolved:
        return "this version makes other bits of its scenario"
    there = flattened(resolved)
    here = flattened(json.loads(json.dumps(sweep.cases[0].scenario.resolved())))
    for key in sorted((here.keys() | there.keys()) - {*_FREE, *sweep.keys}):
        one, other = there.get(key, "not given"), here.get(key, "not given")
        if one != other:
            return f"{key} is {one} there, and {other} here"
    return f"it is of a point that this sweep lacks: {in_words({key: there.get(key) for key in sweep.keys})}"


def in_shard(shard: str, whole: Iterable[str]) -> set[str]:
    """Return the names in one of several parts of a whole, such as "2/8", whatever their order; raises Refused."""
    found = _SHARD.fullmatch(shard)
    if found is None or int(found[1]) > int(found[2]):
        raise Refused(f'shard=: "{shard[:20]}" is no part of a whole; right form: shard="2/8", from 1/8 to 8/8')
    return set(sorted(whole)[int(found[1]) - 1 :: int(found[2])])
