"""The folder of a sweep: the file of each run, made, found again and read, and the index, made from the figures of all.

A file with its final name is complete, so nothing else is written down: who finds the file need not make it. A run that
keeps its summary alone has its figures and curves in an archive of numpy's. Figures in an index that is not stale are
taken from there.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.run_summary import CURVES, SummarySink
from rubnoise.errors import OutputRefused, RunFileRefused, in_few
from rubnoise.figure_names import DONE, FAILED, FIGURE_NAMES, PLANNED
from rubnoise.record.rows import Reader
from rubnoise.regular_file import INDEX, open_stream
from rubnoise.runs.making import describe, play
from rubnoise.scenario.document import SECTIONS, Keep
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.reading import stored
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.sweep import Case, Point, Sweep, run_id
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import Watch
from rubnoise.storage.index import Filled, Index, read_index
from rubnoise.storage.layout import now, package_version
from rubnoise.storage.objects import naming_damage
from rubnoise.storage.output import OutputInUse, whole_file
from rubnoise.storage.reader import InUse, TooNew, open_run, refusing
from rubnoise.storage.schema import INTERVENTION, Dataset
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION
from rubnoise.units import RATIO, Quantity

RUNS: Final = "runs"  # the folder of the files, in that of the sweep
SUFFIXES: Final[Mapping[Keep, str]] = {"runs": ".h5", "summary": ".npz"}

Figures = Mapping[str, Any]
"""What the index of a sweep has of a run by name: figures as numbers, and of a run that keeps no more its curves.

Arrays that are no CURVES are equal for all replicates of a point; the first one has them.
"""


def file_of(folder: Path, run_id: str, keep: Keep) -> Path:
    """Return the path of the file of a run in the folder of its sweep."""
    return folder / RUNS / f"{run_id}{SUFFIXES[keep]}"


def made(
    point: Point, *, folder: Path, keep: Keep, command: Sequence[str], watch: Watch = lambda *_: None
) -> Figures | None:
    """Make one run into its file, if it is not there, and return its figures; None if another process makes it.

    Raises OutputRefused if the result of another run is in its place.
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


def summarised(scenario: Scenario, *, first: bool, watch: Watch = lambda *_: None) -> Figures:
    """Run a scenario and return its figures and curves, with the theory of the curves for the first replicate."""
    model = scenario.model()
    sink = SummarySink(model)
    simulate(model, scenario.run.seed, sink, engine=scenario.run.engine, watch=watch)
    return {**sink.finish(), **(sink.theory() if first else {})}


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
        scenario, figures = read(path, checked=True)
    except RunFileRefused as refusal:
        if isinstance(refusal, InUse | TooNew) or isinstance(refusal.__cause__, OSError):
            raise
        return None
    if name_in(scenario) != point.run_id:
        raise OutputRefused(f"{path}: is not the result of this run; move it away, and the same command makes it")
    return figures


def read(path: Path, *, checked: bool = False) -> tuple[Scenario | None, Figures]:
    """Return the scenario in the file of a run, None if this version makes other bits of it, and its figures.

    Raises RunFileRefused for another file, and for one that is ``checked`` and not as it was written.
    """
    if path.suffix == SUFFIXES["summary"]:
        return _read_summary(path)
    with open_run(path) as file:
        if checked and (not file.summary or file.damaged()):
            raise RunFileRefused(f"{path}: is not as it was written")
        return scenario_in(file), numbers_in(file.summary)


def scenario_in(file: Reader) -> Scenario | None:
    """Return the scenario in a result, None if this version makes other bits of it; raises RunFileRefused."""
    origin = file.provenance
    if origin["stream_version"] != STREAM_VERSION or INTERVENTION in origin:
        return None  # with lives ended from outside it is no sample of the scenario
    return stored(origin["scenario_resolved"], f"{file.path}: the scenario in the file")


def name_in(scenario: Scenario | None) -> str:
    """Return the name of the run of a scenario in a file."""
    return "no run of this version" if scenario is None else run_id(scenario)


def _read_summary(path: Path) -> tuple[Scenario | None, Figures]:
    with refusing(path), open_stream(path) as stream, naming_damage(), np.load(stream) as file:
        kept = dict(file)
        version, scenario, names, values = map(kept.pop, ("stream_version", "scenario", "names", "values"))
        figures = dict(zip(names.tolist(), values.tolist(), strict=True))
    known = stored(str(scenario), f"{path}: the scenario in the file") if version == STREAM_VERSION else None
    return known, figures | kept


# The index.
ABOUT: Final = {
    "run": "row number of the run",
    "run_id": "name of the run",
    "point": "number of the point",
    "replicate": "number of the replicate",
    "seed": "seed of the random streams",
    "file": "result of the run, seen from this folder",
    "state": "planned, done or failed",
    "reason": "why it failed",
}
"""The columns of runs that are neither swept keys nor figures, and what they mean."""


def index_of(
    sweep: Sweep, points: Sequence[Point], found: Mapping[str, Figures], failed: Mapping[str, str], command: str
) -> Index:
    """Return the index of a sweep: runs that were ``found``, that ``failed`` for a reason, and that are planned."""
    places = {tuple(case.values.values()): number for number, case in enumerate(sweep.cases)}
    numbers, rows = [places[tuple(point.values.values())] for point in points], list[tuple[Any, ...]]()
    for row, (point, number) in enumerate(zip(points, numbers, strict=True)):
        name = point.run_id
        state = DONE if name in found else FAILED if name in failed else PLANNED
        file = file_of(Path(), name, "runs").as_posix() if state == DONE and sweep.keep == "runs" else ""
        reason = in_few(failed[name]) if state == FAILED else ""
        rows.append((row, name, number, point.replicate, point.seed, file, state, reason))
    about = [_column(*each, values) for each, values in zip(ABOUT.items(), zip(*rows, strict=True), strict=True)]
    keys = [_swept(key, [case.scenario for case in sweep.cases]) for key in sweep.keys]
    of_points = [
        _column("point", "number of the point", range(len(sweep.cases))),
        _column("values", "swept values as written, as JSON", [*map(_values_of, sweep.cases)]),
        *keys,
    ]
    swept, runs = [replace(key, values=key.values[numbers]) for key in keys], [found.get(row[1], {}) for row in rows]
    of_runs = [*about[:4], *swept, *about[4:], *figure_columns(runs)]
    return Index(
        texts=_texts(sweep, points[0].scenario, command),
        points={column.about.name: column for column in of_points},
        runs={column.about.name: column for column in of_runs},
        summaries=_summaries(runs, numbers, len(sweep.cases)),
    )


def _values_of(case: Case) -> str:
    """Return the swept values of a point as written, with the sizes of a swept file, which may go, as JSON."""
    found = dict(case.values)
    if not found.keys().isdisjoint(("diameter.file", "diameter.column")):
        sizes = case.scenario.resolved()["diameter"]
        found |= {f"diameter.{name}": sizes[name] for name in ("values", "hash")}
    return json.dumps(found)


def _texts(sweep: Sweep, first: Scenario, command: str) -> dict[str, str]:
    resolved = first.resolved()
    if "tick" not in first.given.get("output", {}):
        del resolved["output"]["tick"]  # its default follows the size of the junctions of each point
    return {
        "title": sweep.title,
        "source": f"rubnoise {package_version('rubnoise')}",
        "written": now(),
        "command": command,
        "scenario_toml": sweep.text,
        "scenario_resolved": json.dumps(resolved, ensure_ascii=False),
        "grid": json.dumps([key for key in sweep.keys if key not in sweep.side_by_side]),
        "side_by_side": json.dumps(list(sweep.side_by_side)),
    }


def _column(name: str, meaning: str, values: Sequence[Any], units: str = "1") -> Filled:
    """Return texts, whole numbers, or numbers in a unit."""
    array = np.array(values)
    about = Dataset(name, "" if array.dtype.kind == "U" else units, "", meaning, dtype=array.dtype.str)
    return Filled(about=about, values=array)


def _swept(key: str, scenarios: Sequence[Scenario]) -> Filled:
    """Return the values of a key as numbers in its working unit, or as texts if they are not numbers of one kind."""
    section, name = key.split(".")
    values = [getattr(getattr(scenario, section), name) for scenario in scenarios]
    meaning = keys_of(SECTIONS[section])[name].about
    units = {(value.kind.unit if isinstance(value, Quantity) and value.kind != RATIO else "1") for value in values}
    if len(units) == 1 and all(isinstance(value, int | float) for value in values):
        return _column(key, meaning, [float(value) for value in values], units.pop())
    return _column(key, meaning, [value.as_text() if isinstance(value, Quantity) else str(value) for value in values])


def figure_columns(runs: Sequence[Figures]) -> Iterator[Filled]:
    """Yield a column for each figure that a run has."""
    for name in dict.fromkeys(name for run in runs for name, value in run.items() if not isinstance(value, np.ndarray)):
        # the name of a column begins with that of a figure of /summary
        unit = next((known.unit for figure, known in FIGURE_NAMES.items() if name.startswith(figure)), "") or "1"
        yield _column(name, name.replace("_", " "), [float(run.get(name, np.nan)) for run in runs], unit)


def _summaries(runs: Sequence[Figures], numbers: Sequence[int], points: int) -> dict[str, NDArray[Any]]:
    """Return curves, a row for each run, and what the runs of a point share, a row for each point; else nan."""
    found: dict[str, NDArray[Any]] = {}
    for row, (number, run) in enumerate(zip(numbers, runs, strict=True)):
        for name, values in run.items():
            if isinstance(values, np.ndarray):
                of_run = name in CURVES
                if name not in found:
                    found[name] = np.full((len(runs) if of_run else points, values.size), np.nan)
                found[name][row if of_run else number] = values
    return found


def known_runs(root: Path, sweep: Sweep) -> tuple[dict[str, Figures], dict[str, str], int]:
    """Return what a sound index knows: runs whose files are older, failures, replicates of points; else nothing."""
    found: dict[str, Figures] = {}
    try:
        written = (root / INDEX).stat().st_mtime_ns
        index = read_index(root / INDEX)
    except (OSError, RunFileRefused):
        return {}, {}, 0
    for name, figures in figures_in(index, sweep.keep):
        with suppress(OSError):
            about = file_of(root, name, sweep.keep).stat()
            if max(about.st_mtime_ns, about.st_ctime_ns) <= written:
                found[name] = figures
    columns = [index.runs[name].values.tolist() for name in ("run_id", "state", "reason")]
    failed = {name: reason for name, state, reason in zip(*columns, strict=True) if state == FAILED}
    return found, failed, 1 + int(index.runs["replicate"].values.max(initial=-1))


def figures_in(index: Index, keep: Keep) -> Iterator[tuple[str, Figures]]:
    """Yield the names of runs that an index calls done, with their figures, and curves of runs that keep no more."""
    names = [name for name in index.runs if name not in {*ABOUT, *index.keys}]
    figures = np.array([index.runs[name].values for name in names]).T.tolist()
    columns = [index.runs[name].values.tolist() for name in ("run_id", "point", "replicate", "file", "state")]
    for row, (run_name, point, replicate, file, state) in enumerate(zip(*columns, strict=True)):
        if state == DONE and bool(file) == (keep == "runs"):
            of_run = {name: values[row] for name, values in index.summaries.items() if name in CURVES}
            of_point = {name: values[point] for name, values in index.summaries.items() if name not in CURVES}
            arrays = of_run if replicate else of_run | of_point
            yield run_name, dict(zip(names, figures[row], strict=True)) | arrays
