"""Verify the folder of a sweep: every run is made again, then the index, and both are compared."""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.verification import asked_by, verify
from rubnoise.analysis.verifying.attributes import command_form, moment_form, shown, source_form
from rubnoise.analysis.verifying.findings import Check, Difference, Notes, Verification
from rubnoise.errors import RunFileRefused, ScenarioRefused
from rubnoise.runs.folder import INDEX, run_files
from rubnoise.runs.folder import RUNS as FOLDER
from rubnoise.runs.index import DONE, FAILED, figures_in, index_of
from rubnoise.runs.point_file import SUFFIXES, Keep, RunFigures, read_summary, resolved_in, run_in, summarised
from rubnoise.scenario.points import points_of
from rubnoise.scenario.reading import stored, stored_sizes
from rubnoise.scenario.sweep import Sweep, loads_sweep
from rubnoise.scenario.text import read_toml
from rubnoise.storage.index import (
    POINTS,
    RUNS,
    SUMMARIES,
    IndexFile,
    index_bytes,
    index_of_bytes,
    open_index,
    seal_of_index,
)
from rubnoise.storage.index_checks import check_index
from rubnoise.storage.reader import open_run

SHOWN: Final = 10
"""How many names of one kind are listed; of others their number is."""

UNFINISHED: Final = ".part"
Watch = Callable[[int, int], None]


@dataclass(slots=True, kw_only=True)
class Results:
    """The files of runs: the figures and the scenario of each by its name, and the findings about them."""

    names: Notes = field(default_factory=lambda: Notes("names"))
    figures: dict[str, RunFigures] = field(default_factory=dict)
    scenarios: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    values: int = 0
    different: list[Difference] = field(default_factory=list)
    left_out: Counter[tuple[str, str]] = field(default_factory=Counter)

    def checks(self) -> list[Check]:
        """Check that files have the names of their runs, and that each of them is verified."""
        first = self.different[0] if self.different else None
        runs = Check(name="runs", values=self.values, different=len(self.different), first=first)
        return [self.names.check(), runs]

    def take(self, path: Path, resolved: Mapping[str, Any], figures: RunFigures) -> None:
        """Note what a file is of."""
        name = run_in(resolved, path)
        right = path.stem if name == path.stem else f"that of {path.stem}"
        found = name if name == path.stem else f"the result of {name or 'no run of this version'}"
        self.names.say(f"{FOLDER}/{path.name}", found=found, expected=right)
        self.figures[path.stem], self.scenarios[path.stem] = figures, resolved

    def differ(self, path: Path, place: str, found: str, expected: str) -> None:
        """Note a wrong place of a file."""
        where = f"{FOLDER}/{path.name}{place}"
        self.different.append(Difference(place=where, row=None, found=found, expected=expected))


def verify_sweep(
    folder: str | os.PathLike[str], regenerate: int = 0, watch: Watch = lambda _done, _all: None
) -> Verification:
    """Return the verification of the folder of a sweep and of each of its runs.

    ``watch`` is called with the number of runs checked and of all runs; ``regenerate`` is that of `verify`. Raises
    RunFileRefused for a folder that is not that of a sweep, or that cannot be read.
    """
    root = Path(folder)
    try:
        if not root.is_dir() or not ((root / INDEX).exists() or (root / FOLDER).is_dir()):
            raise RunFileRefused(f"{root}: is not a sweep folder: it has neither {INDEX} nor {FOLDER}")
        results = _results(root, regenerate, watch)
        left_out = list(_left_out(root, results))
        index, known = _index_checks(root, results, left_out)
        if known is not None:
            beside = [f"{FOLDER}/{name}" for name in results.figures if name not in known]
            left_out += _some(beside, "it is no run that the index names", "runs")
        return Verification(checks=(*index, *results.checks()), omitted=tuple(left_out))
    except OSError as problem:  # a folder in it may be closed to who asks, or be on a disk that fails
        reason = (problem.strerror or str(problem)).lower()
        raise RunFileRefused(f"{problem.filename or root}: {reason}") from problem


# The runs.
def _results(root: Path, regenerate: int, watch: Watch) -> Results:
    """Verify every file in the folder of runs."""
    results = Results()
    right = set(run_files(root))
    there = (root / FOLDER).iterdir() if (root / FOLDER).is_dir() else ()
    files = sorted(path for path in there if not path.name.startswith(".") and not path.name.endswith(UNFINISHED))
    for number, path in enumerate(files):
        watch(number, len(files))
        if path.suffix not in SUFFIXES.values() or not path.is_file():
            results.names.say(f"{FOLDER}/{path.name}", found="there", expected="no file of this name")
            continue
        if path not in right:
            results.names.say(f"{FOLDER}/{path.name}", found=path.stem, expected="the result of the run that it names")
        try:
            (_verify_summary if path.suffix == SUFFIXES["summary"] else _verify_run)(results, path, regenerate)
        except RunFileRefused as refusal:
            results.differ(path, "", str(refusal).removeprefix(f"{path}: "), "the result of a run")
    return results


def _verify_run(results: Results, path: Path, regenerate: int) -> None:
    with open_run(path) as run:
        results.take(path, resolved_in(run.provenance, path), RunFigures.of(run.summary))
        if not run.provenance["finished"]:
            raise RunFileRefused("unfinished")
        found = verify(run, regenerate)
    results.values += found.values
    results.left_out.update((each.name, each.reason) for each in found.omitted)
    for check in found.different:
        if check.first is not None:
            results.different.append(replace(check.first, place=f"{FOLDER}/{path.name} {check.first.place}"))


def _verify_summary(results: Results, path: Path, _regenerate: int) -> None:
    """Make a run that keeps its summary alone again, and compare every figure and curve bit for bit."""
    resolved, kept = read_summary(path)
    results.take(path, resolved, kept)
    again = summarised(stored(resolved, f"{path}: the scenario in the file"), first=bool(kept.of_point))
    if kept.names != again.names:
        results.differ(path, " names", ", ".join(kept.names), ", ".join(again.names))
    pairs = {"values": (kept.values, again.values)}
    for one, other in ((kept.curves, again.curves), (kept.of_point, again.of_point)):
        pairs |= {name: (one.get(name, _NOTHING), other.get(name, _NOTHING)) for name in {**one, **other}}
    for name, (found, right) in pairs.items():
        results.values += right.size
        if found.dtype != right.dtype or found.shape != right.shape or found.tobytes() != right.tobytes():
            results.differ(path, f" {name}", shown(str(found.tolist())), shown(str(right.tolist())))


_NOTHING: Final = np.empty(0)


def _left_out(root: Path, results: Results) -> Iterator[LeftOut]:
    """Yield what is not compared: parts left out for runs, unfinished runs and other files."""
    for (name, reason), count in sorted(results.left_out.items()):
        runs = f"{count:,} runs: " if count > 1 else "a run: "
        yield LeftOut(name=name, reason=runs + reason)
    parts = [f"{FOLDER}/{path.name}" for path in (root / FOLDER).glob("*.part")]
    yield from _some(parts, "unfinished; the same sweep makes it", f"{FOLDER}/*.part")
    names = [path.name for path in root.iterdir() if path.name not in {INDEX, FOLDER}]
    strays = [name for name in names if not name.startswith(".") and not name.endswith(UNFINISHED)]
    yield from _some(strays, "it is no file of the sweep", "others")


def _some(names: Sequence[str], reason: str, of: str) -> Iterator[LeftOut]:
    """Yield the first names with a reason, and the number of further ones."""
    for name in sorted(names)[:SHOWN]:
        yield LeftOut(name=name, reason=reason)
    if len(names) > SHOWN:
        yield LeftOut(name=f"{len(names) - SHOWN:,} more of {of}", reason="the same holds for them")


# The index.
def _index_checks(root: Path, results: Results, left_out: list[LeftOut]) -> tuple[list[Check], set[str] | None]:
    """Check that the index has its hashes, and that it is what the runs make it; return the runs in it, too."""
    notes = Notes("index", of=INDEX)
    try:
        with open_index(root / INDEX) as index:
            hashes = _hash_check(index)
            check_index(index)
            known = set(map(str, index.read(RUNS, "run_id")))
            _compare_index(notes, index, results, left_out)
            return [hashes, notes.check()], known
    except RunFileRefused as refusal:
        missing = "missing" if not (root / INDEX).exists() else str(refusal).removeprefix(f"{root / INDEX}: ")
        first = Difference(place=INDEX, row=None, found=missing, expected="the index; the same sweep writes it again")
        return [Check(name="index", values=1, different=1, first=first)], None


def _hash_check(index: IndexFile) -> Check:
    notes, damaged = Notes("index_hashes", of=INDEX), index.damaged()
    for path in index.hashes:
        state = "not what its hash was taken of" if path in damaged else "as it was written"
        notes.say(path, found=state, expected="as it was written")
    seal = seal_of_index(dict(index.attributes), {path: each or "" for path, each in index.hashes.items()})
    notes.say("/ xxh3_128", found=index.seal or "missing", expected=seal)
    return notes.check()


def _compare_index(notes: Notes, index: IndexFile, results: Results, left_out: list[LeftOut]) -> None:
    """Compare an index with the files of the runs, and with one made from them and from the sweep in its text."""
    states = dict(zip(index.read(RUNS, "run_id").tolist(), index.read(RUNS, "state").tolist(), strict=True))
    if any(state != DONE and name in results.figures for name, state in states.items()):
        left_out.append(LeftOut(name="index", reason="it is older than some runs; the same sweep renews it"))
        return
    sweep = _sweep_in(notes, index, results, left_out)
    keep: Keep = "runs" if any(index.read(RUNS, "file")) or DONE not in states.values() else "summary"
    for name, figures in figures_in(index, keep):
        there = results.figures.get(name)
        right = figures if there is None else replace(figures, values=there.values_of(figures.names))
        place = f"{FOLDER}/{name}{SUFFIXES[keep]}"
        notes.say(place, found="missing" if there is None else DONE, expected=DONE)
        same = figures.values.tobytes() == right.values.tobytes()
        notes.say(f"/{RUNS} figures of {name}", found="others" if not same else "those", expected="those")
    if sweep is not None:
        _compare_with(notes, index, _made_again(index, replace(sweep, keep=keep), results))


def _sweep_in(notes: Notes, index: IndexFile, results: Results, left_out: list[LeftOut]) -> Sweep | None:
    """Return the sweep in the text of an index; None if the text alone does not say it."""
    text, asked = index.attributes["scenario_toml"], asked_by(index.attributes["command"])
    try:
        kept = stored_sizes(*results.scenarios.values())
        sweep = loads_sweep(text, "scenario_toml", asked.overrides if asked else (), kept)
        points = points_of(sweep.cases, sweep.replicates)
    except ScenarioRefused as refusal:
        if "extends" in read_toml("scenario_toml", text).data:
            reason = "it extends a file that is not kept, and is not compared"
            left_out.append(LeftOut(name="index scenario_toml", reason=reason))
        else:
            notes.say("/ scenario_toml", found=str(refusal).partition("\n")[0], expected="the file of the sweep")
        return None
    known = set(index.read(RUNS, "run_id").tolist())
    if asked is None and not {point.run_id for point in points} & known:
        reason = "the program that carried it out changed its scenario"
        left_out.append(LeftOut(name="index scenario_toml", reason=reason))
        return None
    return sweep


def _made_again(index: IndexFile, sweep: Sweep, results: Results) -> IndexFile:
    """Return the index as the files of the runs make it; failures are known from the index alone."""
    numbers = index.read(RUNS, "point")
    counts = np.bincount(numbers, minlength=len(sweep.cases)).tolist()
    points = [point for case, count in zip(sweep.cases, counts, strict=False) for point in points_of([case], count)]
    rows = zip(*(index.read(RUNS, name).tolist() for name in ("run_id", "state", "reason")), strict=True)
    failed = {name: reason for name, state, reason in rows if state == FAILED}
    made = index_of(sweep, points, results.figures, failed, index.attributes["command"])
    return index_of_bytes(index_bytes(made), index.path)


def _compare_with(notes: Notes, index: IndexFile, right: IndexFile) -> None:
    for name in ("title", "scenario_toml", "scenario_resolved", "grid", "side_by_side"):
        found, expected = (shown(each.attributes[name]) for each in (index, right))
        notes.say(f"/ {name}", found=found, expected=expected)
    for name, form in (("command", command_form), ("written", moment_form), ("source", source_form)):
        notes.say(
            f"/ {name}", found=index.attributes[name], expected=form(index.attributes[name]) or index.attributes[name]
        )
    notes.say("/", found=", ".join(index.others) or "nothing more", expected="nothing more")
    for group in (POINTS, RUNS, SUMMARIES):
        one, other = ({about.name: about for about in each.columns(group)} for each in (index, right))
        notes.say(f"/{group} columns", found=", ".join(sorted(one)), expected=", ".join(sorted(other)))
        for name in one.keys() & other.keys():
            path = f"/{group}/{name}"
            for part in ("dtype", "units", "long_name"):
                notes.say(f"{path} {part}", found=getattr(one[name], part), expected=getattr(other[name], part))
            _compare_rows(notes, path, index.raw(group, name), right.raw(group, name))


def _compare_rows(notes: Notes, path: str, found: NDArray[Any], right: NDArray[Any]) -> None:
    """Compare a column of any type bit for bit, and note the first row that differs."""
    if found.shape != right.shape or found.dtype != right.dtype:
        notes.say(path, found=f"{found.shape} {found.dtype}", expected=f"{right.shape} {right.dtype}")
        return
    bits = [np.ascontiguousarray(each).view(np.uint8).reshape(len(each), -1) for each in (found, right)]
    wrong = np.flatnonzero((bits[0] != bits[1]).any(axis=1))
    row = int(wrong[0]) if wrong.size else 0
    place = f"{path} row {row}" if wrong.size else path
    one, other = (shown(str(each[row].tolist())) if wrong.size else "right" for each in (found, right))
    notes.say(place, found=one, expected=other)
