"""Verify the folder of a sweep: every run is made again, and what the index says of runs is compared with their files.

What only the index says, its texts and the reasons of failures, is left to its hash.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
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
    root, figures, incomplete = Path(folder), dict[str, Figures](), Counter[tuple[str, str]]()
    index, names, runs = checks = Check("index"), Check("names"), Check("runs")
    try:
        if not root.is_dir() or not ((root / INDEX).exists() or (root / RUNS).is_dir()):
            raise RunFileRefused(f"{root}: is not a sweep folder: it has neither {INDEX} nor {RUNS}")
        files = sorted(_seen(root / RUNS))
        for number, path in enumerate(files):
            watch(number, len(files))
            place = f"{RUNS}/{path.name}"
            if path.suffix not in SUFFIXES.values():
                names.differ(f"{place} is no file of a run")
                continue
            try:
                resolved, figures[path.stem], found = _verified(path, regenerate=regenerate)
                name = name_in(resolved, path) or "no run of this version"
            except RunFileRefused as refusal:
                runs.differ(f"{place} {str(refusal).removeprefix(f'{path}: ')[:LONGEST]}")
                continue
            names.say(place, found=f"the result of {name}", expected=f"the result of {path.stem}")
            runs.values += found.values
            incomplete.update(found.left_out.items())
            for check in found.different:
                runs.differ(f"{place} {check.first}")
        omitted = [*_left_out(root, incomplete), *_compare_index(index, root, figures)]
        return verification(checks, omitted)
    except OSError as problem:  # a folder in it may be closed to who asks, or be on a disk that fails
        reason = (problem.strerror or str(problem)).lower()
        raise RunFileRefused(f"{problem.filename or root}: {reason}") from problem


def _verified(path: Path, *, regenerate: bool) -> tuple[Mapping[str, Any], Figures, Verification]:
    """Return the scenario and the figures in the file of a run, and its verification.

    A run that keeps its summary alone is made again, and every figure and curve is compared bit for bit.
    """
    if path.suffix == SUFFIXES["runs"]:
        with open_run(path) as run:
            return scenario_in(run), numbers_in(run.summary), verify(run, regenerate=regenerate)
    (resolved, kept), check = read(path), Check("summary")
    found, right = dict(kept or {}), dict[str, Any]()
    if resolved:
        scenario = stored(resolved, f"{path}: the scenario in the file")
        right |= summarised(scenario, first="spectrum_place" in found)
    for name in {**found, **right} if right else ():
        one, other = (np.asarray(each.get(name, "missing")) for each in (found, right))
        check.values += other.size
        if one.dtype != other.dtype or one.shape != other.shape or one.tobytes() != other.tobytes():
            here, there = (str(each.tolist())[:LONGEST] for each in (one, other))
            check.differ(f"{name} is {here}, should be {there}")
    return resolved, found, verification([check])


def _seen(folder: Path) -> list[Path]:
    """Return what is in a folder, but parts and what is hidden."""
    there = folder.iterdir() if folder.is_dir() else ()
    return [path for path in there if not path.name.startswith(".") and not path.name.endswith(PART)]


def _left_out(root: Path, incomplete: Counter[tuple[str, str]]) -> Iterator[Row]:
    """Yield what is not compared: parts left out for runs, unfinished runs and other files."""
    for (name, reason), count in sorted(incomplete.items()):
        yield left_out(name, f"{count:,} runs: {reason}" if count > 1 else f"a run: {reason}")
    for part in sorted((root / RUNS).glob(f"*{PART}")):
        yield left_out(f"{RUNS}/{part.name}", "unfinished; the same sweep makes it")
    for path in sorted(_seen(root)):
        if path.name not in {INDEX, RUNS}:
            yield left_out(path.name, "it is no file of the sweep")


def _compare_index(check: Check, root: Path, kept: Mapping[str, Figures]) -> Iterator[Row]:
    """Compare the runs and the figures in the index with those that the files have; yield what cannot be compared."""
    try:
        index = read_index(root / INDEX)
    except RunFileRefused as refusal:
        missing = "missing" if not (root / INDEX).exists() else str(refusal).removeprefix(f"{root / INDEX}: ")
        check.say(INDEX, found=missing, expected="the index; the same sweep writes it again")
        return
    names, points, seeds, states = (index.runs[name].values.tolist() for name in ("run_id", "point", "seed", "state"))
    if any(state != DONE and name in kept for name, state in zip(names, states, strict=True)):
        yield left_out("index", "it is older than some runs; the same sweep renews it")
    with refusing(root / INDEX):
        scenarios = [index.scenario(point).resolved() for point in range(len(index.values))]
    for name, point, seed in zip(names, points, seeds, strict=True):
        check.say(
            f"{INDEX} /runs/point and /runs/seed of {name}: run", found=name_of(scenarios[point], seed), expected=name
        )
    files = any(index.runs["file"].values) or not kept
    for name, figures in figures_in(index, "runs" if files else "summary"):
        check.say(f"{INDEX} {RUNS}/{name}", found=DONE if name in kept else "missing", expected=DONE)
        right = kept.get(name, figures)
        for figure in {**figures, **right}:
            found, expected = (str(np.asarray(each.get(figure, nan)).tolist()) for each in (figures, right))
            check.say(f"{INDEX} /runs/{figure} of {name}", found=found, expected=expected)
    if others := len(kept.keys() - set(names)):
        yield left_out(f"{others:,} of {RUNS}", "the index lacks them")
