"""Verify the folder of a sweep: every run is made again, and what the index says of runs is compared with their files.

What only the index says, its texts and the reasons of failures, is left to its seal.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from rubnoise.answer import Row, left_out
from rubnoise.errors import RunFileRefused
from rubnoise.figure_names import DONE
from rubnoise.regular_file import INDEX
from rubnoise.runs.folder import RUNS, SUFFIXES, Figures, name_in, numbers_in, read, scenario_in, summarised
from rubnoise.runs.index import figures_in
from rubnoise.runs.verification import LONGEST, Check, Verification, verification, verify
from rubnoise.scenario.reading import stored
from rubnoise.scenario.sweep import name_of
from rubnoise.storage.index import read_index
from rubnoise.storage.output import PART
from rubnoise.storage.reader import open_run, refusing


@dataclass(slots=True, kw_only=True)
class _Results:
    """The files of runs: the figures of each by its name, and the checks of their names and of what is in them."""

    regenerate: bool
    names: Check = field(default_factory=lambda: Check("names"))
    runs: Check = field(default_factory=lambda: Check("runs"))
    figures: dict[str, Figures] = field(default_factory=dict)
    left_out: Counter[tuple[str, str]] = field(default_factory=Counter)

    def take(self, path: Path) -> None:
        """Verify a file in the folder of runs."""
        place = f"{RUNS}/{path.name}"
        try:
            if path.suffix == SUFFIXES["runs"]:
                self._take_run(path, place)
            elif path.suffix == SUFFIXES["summary"]:
                self._take_summary(path, place)
            else:
                self.names.differ(f"{place} is no file of a run")
        except RunFileRefused as refusal:
            self.runs.differ(f"{place} {str(refusal).removeprefix(f'{path}: ')[:LONGEST]}")

    def _note(self, path: Path, resolved: Mapping[str, Any], figures: Figures) -> None:
        """Note what a file is of."""
        found = f"the result of {name_in(resolved, path) or 'no run of this version'}"
        self.names.say(f"{RUNS}/{path.name}", found=found, expected=f"the result of {path.stem}")
        self.figures[path.stem] = figures

    def _take_run(self, path: Path, place: str) -> None:
        with open_run(path) as run:
            self._note(path, scenario_in(run), numbers_in(run.summary))
            found = verify(run, regenerate=self.regenerate)
        self.runs.values += found.values
        self.left_out.update(found.left_out.items())
        for check in found.different:
            self.runs.differ(f"{place} {check.first}")

    def _take_summary(self, path: Path, place: str) -> None:
        """Make a run that keeps its summary alone again, and compare every figure and curve bit for bit."""
        resolved, kept = read(path)
        found = dict(kept or {})
        self._note(path, resolved, found)
        if not resolved:
            return
        right = summarised(stored(resolved, f"{path}: the scenario in the file"), first="spectrum_place" in found)
        for name in {**found, **right}:
            one, other = (np.asarray(each.get(name, "missing")) for each in (found, right))
            self.runs.values += other.size
            if one.dtype != other.dtype or one.shape != other.shape or one.tobytes() != other.tobytes():
                here, there = (str(each.tolist())[:LONGEST] for each in (one, other))
                self.runs.differ(f"{place} {name} is {here}, should be {there}")


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
    root, results = Path(folder), _Results(regenerate=regenerate)
    try:
        if not root.is_dir() or not ((root / INDEX).exists() or (root / RUNS).is_dir()):
            raise RunFileRefused(f"{root}: is not a sweep folder: it has neither {INDEX} nor {RUNS}")
        files = sorted(_seen(root / RUNS))
        for number, path in enumerate(files):
            watch(number, len(files))
            results.take(path)
        omitted = list(_left_out(root, results))
        return verification((_index_check(root, results, omitted), results.names, results.runs), omitted)
    except OSError as problem:  # a folder in it may be closed to who asks, or be on a disk that fails
        reason = (problem.strerror or str(problem)).lower()
        raise RunFileRefused(f"{problem.filename or root}: {reason}") from problem


def _seen(folder: Path) -> list[Path]:
    """Return what is in a folder, but parts and what is hidden."""
    there = folder.iterdir() if folder.is_dir() else ()
    return [path for path in there if not path.name.startswith(".") and not path.name.endswith(PART)]


def _left_out(root: Path, results: _Results) -> Iterator[Row]:
    """Yield what is not compared: parts left out for runs, unfinished runs and other files."""
    for (name, reason), count in sorted(results.left_out.items()):
        yield left_out(name, f"{count:,} runs: {reason}" if count > 1 else f"a run: {reason}")
    for part in sorted((root / RUNS).glob(f"*{PART}")):
        yield left_out(f"{RUNS}/{part.name}", "unfinished; the same sweep makes it")
    for path in sorted(_seen(root)):
        if path.name not in {INDEX, RUNS}:
            yield left_out(path.name, "it is no file of the sweep")


def _index_check(root: Path, results: _Results, omitted: list[Row]) -> Check:
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
    with refusing(root / INDEX):
        scenarios = [index.scenario(point).resolved() for point in range(len(index.values))]
    for name, point, seed in zip(names, points, seeds, strict=True):
        place = f"{INDEX} /runs/point and /runs/seed of {name}: run"
        notes.say(place, found=name_of(scenarios[point], seed), expected=name)
    files = any(index.runs["file"].values) or not results.figures
    for name, figures in figures_in(index, "runs" if files else "summary"):
        notes.say(f"{INDEX} {RUNS}/{name}", found=DONE if name in results.figures else "missing", expected=DONE)
        kept = results.figures.get(name, figures)
        for figure in {**figures, **kept}:
            found, right = (str(np.asarray(each.get(figure, nan)).tolist()) for each in (figures, kept))
            notes.say(f"{INDEX} /runs/{figure} of {name}", found=found, expected=right)
    if others := len(results.figures.keys() - set(names)):
        omitted.append(left_out(f"{others:,} of {RUNS}", "the index lacks them"))
    return notes
