"""Verify the folder of a sweep: every run is made again, then the index, and both are compared.

What only the index says, its texts and the reasons of failures, is left to its seal.
"""

import json
import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.answer import LeftOut
from rubnoise.errors import RunFileRefused
from rubnoise.figure_names import DONE, FAILED
from rubnoise.regular_file import INDEX
from rubnoise.runs.folder import run_files
from rubnoise.runs.index import index_of, keys_in, scenario_at
from rubnoise.runs.point_file import RUNS, SUFFIXES, Figures, name_in, numbers_in, read, scenario_in, summarised
from rubnoise.runs.verification import LONGEST, Check, Difference, Verification, verification, verify
from rubnoise.scenario.points import Point
from rubnoise.scenario.reading import stored
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.sweep import Sweep
from rubnoise.storage.index import Filled, Index, read_index
from rubnoise.storage.output import PART
from rubnoise.storage.reader import open_run

SHOWN: Final = 10
"""How many names of one kind are listed; of others their number is."""


@dataclass(slots=True, kw_only=True)
class Results:
    """The files of runs: the figures and the scenario of each by its name, and the findings about them."""

    names: Check = field(default_factory=lambda: Check("names"))
    figures: dict[str, Figures] = field(default_factory=dict)
    scenarios: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    values: int = 0
    different: list[Difference] = field(default_factory=list)
    left_out: Counter[tuple[str, str]] = field(default_factory=Counter)

    def checks(self) -> list[Check]:
        """Check that files have the names of their runs, and that each of them is verified."""
        first = self.different[0] if self.different else None
        runs = Check(name="runs", values=self.values, different=len(self.different), first=first)
        return [self.names, runs]

    def take(self, path: Path, resolved: Mapping[str, Any], figures: Figures) -> None:
        """Note what a file is of."""
        name = name_in(resolved, path)
        right = path.stem if name == path.stem else f"that of {path.stem}"
        found = name if name == path.stem else f"the result of {name or 'no run of this version'}"
        self.names.say(f"{RUNS}/{path.name}", found=found, expected=right)
        self.figures[path.stem], self.scenarios[path.stem] = figures, resolved

    def differ(self, path: Path, place: str, found: str, expected: str) -> None:
        """Note a wrong place of a file."""
        where = f"{RUNS}/{path.name}{place}"
        self.different.append(Difference(where, found[:LONGEST], expected[:LONGEST]))


def verify_sweep(
    folder: str | os.PathLike[str], regenerate: int = 0, watch: Callable[[int, int], None] = lambda _done, _all: None
) -> Verification:
    """Return the verification of the folder of a sweep and of each of its runs.

    ``watch`` is called with the number of runs checked and of all runs; ``regenerate`` is that of `verify`. Raises
    RunFileRefused for a folder that is not that of a sweep, or that cannot be read.
    """
    root = Path(folder)
    try:
        if not root.is_dir() or not ((root / INDEX).exists() or (root / RUNS).is_dir()):
            raise RunFileRefused(f"{root}: is not a sweep folder: it has neither {INDEX} nor {RUNS}")
        results = _results(root, regenerate, watch)
        left_out = list(_left_out(root, results))
        return verification((_index_check(root, results, left_out), *results.checks()), left_out)
    except OSError as problem:  # a folder in it may be closed to who asks, or be on a disk that fails
        reason = (problem.strerror or str(problem)).lower()
        raise RunFileRefused(f"{problem.filename or root}: {reason}") from problem


# The runs.
def _results(root: Path, regenerate: int, watch: Callable[[int, int], None]) -> Results:
    """Verify every file in the folder of runs."""
    results = Results()
    right = set(run_files(root))
    there = (root / RUNS).iterdir() if (root / RUNS).is_dir() else ()
    files = sorted(path for path in there if not path.name.startswith(".") and not path.name.endswith(PART))
    for number, path in enumerate(files):
        watch(number, len(files))
        if path.suffix not in SUFFIXES.values() or not path.is_file():
            results.names.say(f"{RUNS}/{path.name}", found="there", expected="no file of this name")
            continue
        if path not in right:
            results.names.say(f"{RUNS}/{path.name}", found=path.stem, expected="the result of the run that it names")
        try:
            if path.suffix == SUFFIXES["summary"]:
                _verify_summary(results, path)
            else:
                _verify_run(results, path, regenerate)
        except RunFileRefused as refusal:
            results.differ(path, "", str(refusal).removeprefix(f"{path}: "), "the result of a run")
    return results


def _verify_run(results: Results, path: Path, regenerate: int) -> None:
    with open_run(path) as run:
        results.take(path, scenario_in(run), numbers_in(run.summary))
        found = verify(run, regenerate)
    results.values += found.values
    results.left_out.update(found.left_out.items())
    for check in found.different:
        if check.first is not None:
            results.different.append(check.first.within(f"{RUNS}/{path.name}"))


def _verify_summary(results: Results, path: Path) -> None:
    """Make a run that keeps its summary alone again, and compare every figure and curve bit for bit."""
    resolved, kept = read(path)
    found = dict(kept or {})
    results.take(path, resolved, found)
    if not resolved:
        return  # which `take` has said
    scenario = stored(resolved, f"{path}: the scenario in the file")
    right = summarised(scenario, first="spectrum_place" in found)
    for name in {**found, **right}:
        one, other = (np.asarray(each.get(name, "missing")) for each in (found, right))
        results.values += other.size
        if one.dtype != other.dtype or one.shape != other.shape or one.tobytes() != other.tobytes():
            results.differ(path, f" {name}", str(one.tolist()), str(other.tolist()))


def _left_out(root: Path, results: Results) -> Iterator[LeftOut]:
    """Yield what is not compared: parts left out for runs, unfinished runs and other files."""
    for (name, reason), count in sorted(results.left_out.items()):
        runs = f"{count:,} runs: " if count > 1 else "a run: "
        yield LeftOut(name=name, reason=runs + reason)
    parts = [f"{RUNS}/{path.name}" for path in (root / RUNS).glob(f"*{PART}")]
    yield from _some(parts, "unfinished; the same sweep makes it", f"{RUNS}/*{PART}")
    names = [path.name for path in root.iterdir() if path.name not in {INDEX, RUNS}]
    strays = [name for name in names if not name.startswith(".") and not name.endswith(PART)]
    yield from _some(strays, "it is no file of the sweep", "others")


def _some(names: Sequence[str], reason: str, of: str) -> Iterator[LeftOut]:
    """Yield the first names with a reason, and the number of further ones."""
    for name in sorted(names)[:SHOWN]:
        yield LeftOut(name=name, reason=reason)
    if len(names) > SHOWN:
        yield LeftOut(name=f"{len(names) - SHOWN:,} more of {of}", reason="the same holds for them")


# The index.
def _index_check(root: Path, results: Results, left_out: list[LeftOut]) -> Check:
    """Check that the index is as it was written, and that it is what the runs make it."""
    notes = Check("index")
    try:
        index = read_index(root / INDEX)
    except RunFileRefused as refusal:
        missing = "missing" if not (root / INDEX).exists() else str(refusal).removeprefix(f"{root / INDEX}: ")
        notes.say(INDEX, found=missing, expected="the index; the same sweep writes it again")
        return notes
    rows = [index.runs[name].values.tolist() for name in ("run_id", "point", "state")]
    states = dict(zip(rows[0], rows[2], strict=True))
    if any(state != DONE and name in results.figures for name, state in states.items()):
        left_out.append(LeftOut(name="index", reason="it is older than some runs; the same sweep renews it"))
    else:
        of_points: dict[int, str] = {}
        for name, point, state in zip(*rows, strict=True):
            is_missing = state == DONE and name not in results.figures
            notes.say(f"{RUNS}/{name}", found="missing" if is_missing else state, expected=state)
            if name in results.figures:
                scenario = name_in(results.scenarios[name], root, 0)
                same = of_points.setdefault(point, scenario) == scenario
                notes.say(f"/runs/point of {name}", found=point if same else "that of others", expected=point)
        _compare(notes, index, _made_again(index, root, results))
    beside = [f"{RUNS}/{name}" for name in results.figures if name not in states]
    left_out += _some(beside, "it is no run that the index names", "runs")
    notes.first = notes.first.within(INDEX) if notes.first else None
    return notes


def _made_again(index: Index, root: Path, results: Results) -> Index:
    """Return the index as the scenarios and figures in the files make it; failures are known from the index alone."""
    names = ("run_id", "point", "replicate", "seed", "file", "state", "reason")
    rows = list(zip(*(index.runs[name].values.tolist() for name in names), strict=True))
    values = [json.loads(text) for text in index.points["values"].values.tolist()]
    scenarios: dict[int, Scenario] = {}
    points, failed = [], {}
    for run_id, point, replicate, seed, _, state, reason in rows:
        resolved = results.scenarios.get(run_id)
        if point not in scenarios:
            scenarios[point] = stored(resolved) if resolved else scenario_at(index, point, root / INDEX)
        points.append(
            Point(
                values=values[point],
                replicate=replicate,
                run_id=run_id,
                seed=resolved["run"]["seed"] if resolved else seed,
                scenario=scenarios[point],
            )
        )
        if state == FAILED:
            failed[run_id] = reason
    sweep = Sweep(
        name=INDEX,
        text=index.texts["scenario_toml"],
        title=index.texts["title"],
        keys=keys_in(index),
        side_by_side=tuple(json.loads(index.texts["side_by_side"])),
        cases=(),
        replicates=1,
        warnings=(),
        keep="runs" if any(row[4] for row in rows) or not results.figures else "summary",
    )
    return index_of(sweep, points, results.figures, failed, index.texts["command"])


def _compare(notes: Check, index: Index, right: Index) -> None:
    columns = [_columns(each) for each in (index, right)]
    notes.say("/ columns", found=", ".join(columns[0]), expected=", ".join(columns[1]))
    for path in (path for path in columns[0] if path in columns[1]):
        one, other = (each[path] for each in columns)
        for part in ("units", "long_name"):
            notes.say(f"{path} {part}", found=getattr(one.about, part), expected=getattr(other.about, part))
        _compare_rows(notes, path, one.values, other.values)
    for name in {**index.summaries, **right.summaries}:
        arrays = (each.summaries.get(name, np.empty(0)) for each in (index, right))
        _compare_rows(notes, f"/summaries/{name}", *arrays)


def _columns(index: Index) -> dict[str, Filled]:
    """Return the columns of points and of runs by their paths."""
    groups = (("points", index.points), ("runs", index.runs))
    return {f"/{group}/{name}": column for group, columns in groups for name, column in columns.items()}


def _compare_rows(notes: Check, path: str, found: NDArray[Any], right: NDArray[Any]) -> None:
    """Compare a column of any type bit for bit, and note the first row that differs."""
    if found.shape != right.shape or found.dtype != right.dtype:
        notes.say(path, found=f"{found.shape} {found.dtype}", expected=f"{right.shape} {right.dtype}")
        return
    bits = [np.ascontiguousarray(each).view(np.uint8).reshape(len(each), -1) for each in (found, right)]
    row = int(np.argmax((bits[0] != bits[1]).any(axis=1))) if len(found) else 0
    one, other = (str(each[row : row + 1].tolist()) for each in (found, right))
    same = np.array_equal(bits[0], bits[1])
    notes.say(f"{path} row {row}", found=other if same else one, expected=other)
