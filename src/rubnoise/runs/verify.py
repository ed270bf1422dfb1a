"""Verify the folder of a sweep: every run is made again, and what the index says of runs is compared with their files.

What only the index says, its texts and the reasons of failures, is left to its seal.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from typing import Any, Final

import numpy as np

from rubnoise.answer import Row, left_out
from rubnoise.errors import RunFileRefused
from rubnoise.figure_names import DONE
from rubnoise.regular_file import INDEX
from rubnoise.runs.folder import RUNS, SUFFIXES, Figures, name_in, numbers_in, read, run_files, scenario_in, summarised
from rubnoise.runs.index import figures_in, scenario_at
from rubnoise.runs.verification import LONGEST, Check, Difference, Verification, verification, verify
from rubnoise.scenario.reading import stored
from rubnoise.scenario.sweep import name_of
from rubnoise.scenario.sweep_keys import Keep
from rubnoise.storage.index import read_index
from rubnoise.storage.output import PART
from rubnoise.storage.reader import open_run

SHOWN: Final = 10
"""How many names of one kind are listed; of others their number is."""


@dataclass(slots=True, kw_only=True)
class Results:
    """The files of runs: the figures of each by its name, and the checks of their names and of what is in them."""

    names: Check = field(default_factory=lambda: Check("names"))
    runs: Check = field(default_factory=lambda: Check("runs"))
    figures: dict[str, Figures] = field(default_factory=dict)
    left_out: Counter[tuple[str, str]] = field(default_factory=Counter)

    def take(self, path: Path, resolved: Mapping[str, Any], figures: Figures) -> None:
        """Note what a file is of."""
        name = name_in(resolved, path)
        right = path.stem if name == path.stem else f"that of {path.stem}"
        found = name if name == path.stem else f"the result of {name or 'no run of this version'}"
        self.names.say(f"{RUNS}/{path.name}", found=found, expected=right)
        self.figures[path.stem] = figures


def verify_sweep(
    folder: str | os.PathLike[str],
    *,
    regenerate: bool = False,
    watch: Callable[[int, int], None] = lambda _done, _all: None,
) -> Verification:
    """Return the verification of the folder of a sweep and of each of its runs.

    ``watch`` is called with the number of runs checked and of all runs; ``regenerate`` is that of `verify`. Raises
    RunFileRefused for a folder that is not that of a sweep, or that cannot be read.
    """
    root = Path(folder)
    try:
        if not root.is_dir() or not ((root / INDEX).exists() or (root / RUNS).is_dir()):
            raise RunFileRefused(f"{root}: is not a sweep folder: it has neither {INDEX} nor {RUNS}")
        results = _results(root, watch, regenerate=regenerate)
        omitted = list(_left_out(root, results))
        return verification((_index_check(root, results, omitted), results.names, results.runs), omitted)
    except OSError as problem:  # a folder in it may be closed to who asks, or be on a disk that fails
        reason = (problem.strerror or str(problem)).lower()
        raise RunFileRefused(f"{problem.filename or root}: {reason}") from problem


def _results(root: Path, watch: Callable[[int, int], None], *, regenerate: bool) -> Results:
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
                _verify_run(results, path, regenerate=regenerate)
        except RunFileRefused as refusal:
            reason = str(refusal).removeprefix(f"{path}: ")[:LONGEST]
            results.runs.differ(Difference(f"{RUNS}/{path.name}", reason, "the result of a run"))
    return results


def _verify_run(results: Results, path: Path, *, regenerate: bool) -> None:
    with open_run(path) as run:
        results.take(path, scenario_in(run), numbers_in(run.summary))
        found = verify(run, regenerate=regenerate)
    results.runs.values += found.values
    results.left_out.update(found.left_out.items())
    for check in found.different:
        if check.first is not None:
            results.runs.differ(check.first.within(f"{RUNS}/{path.name}"))


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
        results.runs.values += other.size
        if one.dtype != other.dtype or one.shape != other.shape or one.tobytes() != other.tobytes():
            here, there = (str(each.tolist())[:LONGEST] for each in (one, other))
            results.runs.differ(Difference(f"{RUNS}/{path.name} {name}", here, there))


def _left_out(root: Path, results: Results) -> Iterator[Row]:
    """Yield what is not compared: parts left out for runs, unfinished runs and other files."""
    for (name, reason), count in sorted(results.left_out.items()):
        runs = f"{count:,} runs: " if count > 1 else "a run: "
        yield left_out(name, runs + reason)
    parts = [f"{RUNS}/{path.name}" for path in (root / RUNS).glob(f"*{PART}")]
    yield from _some(parts, "unfinished; the same sweep makes it", f"{RUNS}/*{PART}")
    names = [path.name for path in root.iterdir() if path.name not in {INDEX, RUNS}]
    strays = [name for name in names if not name.startswith(".") and not name.endswith(PART)]
    yield from _some(strays, "it is no file of the sweep", "others")


def _some(names: Sequence[str], reason: str, of: str) -> Iterator[Row]:
    """Yield the first names with a reason, and the number of further ones."""
    for name in sorted(names)[:SHOWN]:
        yield left_out(name, reason)
    if len(names) > SHOWN:
        yield left_out(f"{len(names) - SHOWN:,} more of {of}", "the same holds for them")


def _index_check(root: Path, results: Results, omitted: list[Row]) -> Check:
    """Check that the index is as it was written, and that it has the figures and the runs that the files have."""
    notes = Check("index")
    try:
        index = read_index(root / INDEX)
    except RunFileRefused as refusal:
        missing = "missing" if not (root / INDEX).exists() else str(refusal).removeprefix(f"{root / INDEX}: ")
        notes.say(INDEX, found=missing, expected="the index; the same sweep writes it again")
        return notes
    names, points, seeds, states = (index.runs[name].values.tolist() for name in ("run_id", "point", "seed", "state"))
    if any(state != DONE and name in results.figures for name, state in zip(names, states, strict=True)):
        omitted.append(left_out("index", "it is older than some runs; the same sweep renews it"))
    scenarios = [
        scenario_at(index, point, root / INDEX).resolved() for point in range(len(index.points["values"].values))
    ]
    for name, point, seed in zip(names, points, seeds, strict=True):
        notes.say(f"/runs/point and /runs/seed of {name}: run", found=name_of(scenarios[point], seed), expected=name)
    keep: Keep = "runs" if any(index.runs["file"].values) or not results.figures else "summary"
    for name, figures in figures_in(index, keep):
        notes.say(f"{RUNS}/{name}", found=DONE if name in results.figures else "missing", expected=DONE)
        kept = results.figures.get(name, figures)
        for figure in {**figures, **kept}:
            found, right = (np.asarray(each.get(figure, nan)).tolist() for each in (figures, kept))
            notes.say(f"/runs/{figure} of {name}", found=str(found), expected=str(right))
    omitted += _some([f"{RUNS}/{name}" for name in results.figures if name not in names], "the index lacks it", "runs")
    notes.first = notes.first.within(INDEX) if notes.first else None
    return notes
