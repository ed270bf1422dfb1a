"""Verify the folder of a sweep: its description, journals, index, names and every run."""

import json
import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, get_args

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.verification import ResultFile, asked_by, verify
from rubnoise.analysis.verifying.attributes import INDEX_RULES, compare_attributes, compare_structure, shown
from rubnoise.analysis.verifying.findings import Check, Difference, Notes, Verification
from rubnoise.errors import Refused, RunFileRefused, ScenarioRefused
from rubnoise.scenario.points import Case, Point, points_of
from rubnoise.scenario.reading import stored_sizes
from rubnoise.scenario.reread import sweep_as_made
from rubnoise.scenario.source import Source
from rubnoise.scenario.sweep import Sweep, loads_sweep
from rubnoise.scenario.sweep_table import Keep
from rubnoise.storage.index import POINTS, RUNS, seal_of_index
from rubnoise.storage.index_checks import check_index
from rubnoise.storage.index_file import IndexFile, name_of, open_index
from rubnoise.storage.inventory import expected_index
from rubnoise.storage.reader import open_run
from rubnoise.storage.schema import HASH
from rubnoise.sweep.folder import SweepFolder, cases_of, identity, manifest_text
from rubnoise.sweep.index import index_of
from rubnoise.sweep.journal import JournalEntry, numbered
from rubnoise.sweep.run_status import DONE, PLANNED, RecordedRuns

AS_WRITTEN: Final = "as its checksum was taken of it"
Figures = Mapping[str, Mapping[str, Any]]


def journal_check(folder: SweepFolder, files: Figures, left_out: list[LeftOut]) -> tuple[Check, frozenset[str]]:
    """Check that every line is complete, and that every run that is done has its file with the same figures.

    ``files`` are the figures of /summary in the files of runs, by name. Of several lines of a run the last one counts.
    Returns the named runs, too.
    """
    notes = Notes("journals")
    entries = list(_entries(notes, folder, left_out))
    done = {entry.run_id: (place, entry) for place, entry in entries if entry.state == "done"}
    for place, entry in done.values():
        _compare(notes, place, entry, files, folder)
    bare = sum(entry.row is None or not entry.row.file for _, entry in done.values())
    if bare:
        reason = f"{bare:,} {'run' if bare == 1 else 'runs'}, of which the sweep keeps only the summary: not made again"
        left_out.append(LeftOut(name="runs without files", reason=reason))
    unwritten = files.keys() - done.keys()
    if unwritten:
        reason = f"{len(unwritten):,} results are there that no journal calls done yet; the same sweep takes them in"
        left_out.append(LeftOut(name="journals", reason=reason))
    return notes.check(), frozenset(entry.run_id for _, entry in entries)


def _entries(notes: Notes, folder: SweepFolder, left_out: list[LeftOut]) -> Iterator[tuple[str, JournalEntry]]:
    """Yield every valid line with its place, and note the others."""
    own, cut = folder.journals(), 0
    for path in own:
        for number, entry in numbered(path):
            place = f"journal/{path.name} line {number}"
            if entry == "cut short":
                cut += 1
                continue
            notes.say(place, found="damaged" if entry == "damaged" else AS_WRITTEN, expected=AS_WRITTEN)
            if isinstance(entry, JournalEntry):
                yield place, entry
    for path in sorted((folder.root / "journal").glob("*")):
        if path not in own and not path.name.startswith("."):
            notes.say(f"journal/{path.name}", found="there", expected="no file of this name")
    if cut:
        reason = f"{cut} cut short by a kill or a power cut, as if never written"
        left_out.append(LeftOut(name="lines of journals", reason=reason))


def _compare(notes: Notes, place: str, entry: JournalEntry, files: Figures, folder: SweepFolder) -> None:
    """Compare a line "done" with the file of its run, unless the sweep keeps no files."""
    row = entry.row
    if row is None or not row.file:
        return
    notes.say(f"{place} file", found=row.file, expected=folder.relative(entry.run_id))
    if entry.run_id not in files:
        there = folder.run(entry.run_id).exists()
        found = "no result that can be read" if there else "missing"
        notes.say(row.file, found=found, expected=f"the result that {place} calls done")
        return
    figures = files[entry.run_id]
    for name in dict.fromkeys([*figures, *row.figures]):
        found, right = (json.dumps(each.get(name, "missing")) for each in (row.figures, figures))
        notes.say(f"{place} {name}", found=found, expected=f"{right} of {row.file}" if found != right else found)


MANIFEST: Final = "sweep.json"
OWN: Final = frozenset(("index.h5", "merged.h5", MANIFEST, "runs", "journal"))
"""What a sweep makes in its folder, beside locks and what is being written."""

SHOWN: Final = 10
"""How many names of one kind are listed; of others their number is."""

UNFINISHED: Final = (".part", ".part.journal", ".part.rows")


@dataclass(slots=True, kw_only=True)
class Results:
    """The files of runs: the figures of each by its file name, and the findings about them."""

    names: Notes
    figures: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    values: int = 0
    different: list[Difference] = field(default_factory=list)
    left_out: Counter[tuple[str, str]] = field(default_factory=Counter)

    def checks(self) -> list[Check]:
        """Check that files have the names of their runs, and that each of them is verified."""
        first = self.different[0] if self.different else None
        return [
            self.names.check(),
            Check(name="runs", values=self.values, different=len(self.different), first=first),
        ]


def verify_sweep(
    folder: str | os.PathLike[str], regenerate: int = 0, watch: Callable[[int, int], None] = lambda _done, _all: None
) -> Verification:
    """Return the verification of the folder of a sweep and of each of its runs.

    ``watch`` is called with the number of runs checked and of all runs. Raises RunFileRefused for a folder that is not
    that of a sweep, that cannot be read, or on which a sweep is at work, and Refused for ``regenerate`` if the sweep
    keeps no runs.
    """
    place = SweepFolder(Path(folder))
    try:
        return _verified(place, regenerate, watch)
    except OSError as problem:  # a folder in it may be closed to who asks, or be on a disk that fails
        reason = (problem.strerror or str(problem)).lower()
        raise RunFileRefused(f"{problem.filename or place.root}: {reason}") from problem


def _verified(place: SweepFolder, regenerate: int, watch: Callable[[int, int], None]) -> Verification:
    folder = place.root
    if not folder.is_dir() or not (place.manifest.exists() or place.index.exists()):
        raise RunFileRefused(f"{folder}: is not a sweep folder: it has neither {MANIFEST} nor index.h5")
    if place.is_at_work():
        raise RunFileRefused(f"{folder}: another process is running this sweep")
    manifest, sweep = _manifest_check(place)
    if regenerate and sweep is not None and sweep.keep == "summary":
        raise Refused(f"{folder}: the sweep keeps no runs of which blocks could be made again")
    results = _results(place, watch)
    left_out = list(_left_out(place, results))
    journals, known = journal_check(place, results.figures, left_out)
    index, of_index = index_checks(place, sweep, left_out)
    for name in results.figures:
        state = "known" if name in known | of_index else "a run that neither the index nor a journal knows"
        expected = "known" if state == "known" else "a run of this sweep"
        results.names.say(f"runs/{name}.h5", found=state, expected=expected)
    checks = [manifest, journals, *index, *results.checks()]
    return Verification(checks=tuple(checks), omitted=tuple(left_out))


def _manifest_check(folder: SweepFolder) -> tuple[Check, Sweep | None]:
    """Check that sweep.json is the description of a sweep; return that sweep, too, if it is known."""
    notes = Notes("manifest", of=MANIFEST)
    try:
        text = folder.manifest.read_text(encoding="utf-8")
        kept = json.loads(text)
        sweep = _sweep(kept, notes)
    except FileNotFoundError:
        return _one("manifest", MANIFEST, "missing", "the description of the sweep"), None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, IndexError, RecursionError) as problem:
        found = " ".join(f"unreadable ({problem})".split())
        return _one("manifest", MANIFEST, found, "the description of the sweep"), None
    notes.say("form", found="JSON", expected="JSON" if text == manifest_text(kept) else "JSON as the program writes it")
    if sweep is not None:
        right = json.loads(json.dumps(identity(sweep)))
        for key in dict.fromkeys([*right, *kept]):
            found, expected = (shown(each.get(key, "missing")) for each in (kept, right))
            notes.say(key, found=found, expected=expected)
    check = notes.check()
    return check, sweep if check.holds else None


def _sweep(kept: Mapping[str, Any], notes: Notes) -> Sweep | None:
    """Return the described sweep; None if a point does not have the name of its scenario."""
    cases = cases_of(kept)
    for number, (point, case) in enumerate(zip(kept["points"], cases, strict=True)):
        right = "the name of its scenario" if case is None else point["name"]
        notes.say(f"points {number} name", found=point["name"], expected=right)
    named = tuple(case for case in cases if case is not None)
    if len(named) < len(cases) or not cases:
        return None
    notes.say(
        "keep", found=kept["keep"], expected=kept["keep"] if kept["keep"] in get_args(Keep) else "runs or summary"
    )
    return Sweep(
        name=MANIFEST,
        text="",
        title=named[0].scenario.title,
        keys=tuple(named[0].values),
        side_by_side=(),
        cases=named,
        replicates=1,
        warnings=(),
        keep=kept["keep"],
    )


def _results(folder: SweepFolder, watch: Callable[[int, int], None]) -> Results:
    """Verify every file in the folder of runs."""
    results = Results(names=Notes("names"))
    runs = folder.root / "runs"
    files = sorted(path for path in runs.iterdir() if not path.name.startswith(".")) if runs.is_dir() else []
    for number, path in enumerate(files):
        watch(number, len(files))
        if path.name.endswith(UNFINISHED):
            continue
        if path.suffix != ".h5" or not path.is_file():
            results.names.say(f"runs/{path.name}", found="there", expected="no file of this name")
            continue
        try:
            with open_run(path) as run:
                _take_in(results, run, path)
        except RunFileRefused as refusal:
            reason = str(refusal).removeprefix(f"{path}: ")
            results.different.append(
                Difference(place=f"runs/{path.name}", row=None, found=reason, expected="the result of a run")
            )
    return results


def _take_in(results: Results, run: ResultFile, path: Path) -> None:
    name = name_of(run)
    right = path.stem if name == path.stem else f"that of {path.stem}"
    results.names.say(f"runs/{path.name}", found=name if name == path.stem else f"the result of {name}", expected=right)
    if not run.provenance["finished"]:
        raise RunFileRefused("unfinished")
    results.figures[path.stem] = {name: value for name, value in run.summary.items() if isinstance(value, int | float)}
    found = verify(run)
    results.values += found.values
    results.left_out.update((each.name, each.reason) for each in found.omitted)
    for check in found.different:
        if check.first is not None:
            first = check.first
            results.different.append(replace(first, place=f"runs/{path.name} {first.place}"))


def _left_out(folder: SweepFolder, results: Results) -> Iterator[LeftOut]:
    """Yield what is not compared: parts left out for runs, copies, unfinished runs and other files."""
    for (name, reason), count in sorted(results.left_out.items()):
        runs = f"{count:,} runs: " if count > 1 else "a run: "
        yield LeftOut(name=name, reason=runs + reason)
    if folder.merged.exists():
        yield LeftOut(name="merged.h5", reason="it is a copy of index and runs; `sweep --merge` writes it again")
    parts = [f"runs/{path.name}" for path in (folder.root / "runs").glob("*.h5.part")]
    yield from _some(parts, "unfinished; the same sweep resumes it", "runs/*.h5.part")
    names = [path.name for path in folder.root.iterdir()]
    strays = [name for name in names if name not in OWN and not name.startswith(".") and not name.endswith(UNFINISHED)]
    yield from _some(strays, "it is no file of the sweep", "others")


def _some(names: list[str], reason: str, of: str) -> Iterator[LeftOut]:
    """Yield the first names with a reason, and the number of further ones."""
    for name in sorted(names)[:SHOWN]:
        yield LeftOut(name=name, reason=reason)
    if len(names) > SHOWN:
        yield LeftOut(name=f"{len(names) - SHOWN:,} more of {of}", reason="the same holds for them")


def _one(name: str, place: str, found: str, expected: str) -> Check:
    first = Difference(place=place, row=None, found=found, expected=expected)
    return Check(name=name, values=1, different=1, first=first)


INDEX: Final = "index.h5"


def index_checks(
    folder: SweepFolder, sweep: Sweep | None, left_out: list[LeftOut]
) -> tuple[list[Check], frozenset[str]]:
    """Check that the index has its hashes, and that it agrees with the sweep and the journals.

    Returns the runs in it, too. Without a ``sweep`` (if sweep.json is not valid) only its hashes are checked.
    """
    try:
        with open_index(folder.index) as index:
            run_ids = frozenset(map(str, index.read(RUNS, "run_id")))
            hashes = _hash_check(index)
            if sweep is None:
                left_out.append(LeftOut(name="index", reason="sweep.json differs, and the index is made from it"))
                return [hashes], run_ids
            return [hashes, _index_check(folder, sweep, index, left_out)], run_ids
    except (RunFileRefused, KeyError) as refusal:
        missing = "missing" if not folder.index.exists() else str(refusal).removeprefix(f"{folder.index}: ")
        return [_one("index", INDEX, missing, "the index; the same sweep writes it again")], frozenset()


def _hash_check(index: IndexFile) -> Check:
    notes, damaged = Notes("index_hashes", of=INDEX), index.damaged()
    for path in index.hashes:
        state = "not what its hash was taken of" if path in damaged else "as it was written"
        notes.say(path, found=state, expected="as it was written")
    seal = seal_of_index(dict(index.attributes), {path: each or "" for path, each in index.hashes.items()})
    notes.say(f"/ {HASH}", found=index.seal or "missing", expected=seal)
    return notes.check()


def _index_check(folder: SweepFolder, sweep: Sweep, index: IndexFile, left_out: list[LeftOut]) -> Check:
    """Compare an index with one made again from the sweep and the journals, unless these have newer entries."""
    try:
        check_index(index)
    except RunFileRefused as refusal:
        reason = str(refusal).removeprefix(f"{index.path}: ")
        return _one("index", INDEX, reason, "an index as the program writes it")
    notes, attributes = Notes("index", of=INDEX), index.attributes
    sides = {name: json.loads(attributes[name]) for name in ("grid", "side_by_side")}
    notes.say("swept keys", found=[*sides["grid"], *sides["side_by_side"]], expected=[*sweep.keys])
    cases = _cases(notes, sweep, index)
    if not notes.check().holds:
        return notes.check()
    stored = replace(sweep, text=attributes["scenario_toml"], side_by_side=tuple(sides["side_by_side"]), cases=cases)
    numbers = index.read(RUNS, "point")
    counts = np.bincount(numbers[(numbers >= 0) & (numbers < len(cases))], minlength=len(cases)).tolist()
    points = tuple(point for case, count in zip(cases, counts, strict=True) for point in points_of([case], count))
    known = RecordedRuns.of(folder, points, counts=lambda _entry: True)
    before = zip(known.states, map(str, index.read(RUNS, "state")), strict=True)
    # The journals may call runs done, or failed at all, that an index does not.
    since = any(now != then and (now == DONE or then == PLANNED) for now, then in before)
    if len(cases) < len(sweep.cases) or since:
        reason = "it is older than sweep.json or the journals; the same sweep renews it"
        left_out.append(LeftOut(name="index", reason=reason))
        return notes.check()
    right, values = expected_index(index_of(folder, stored, points, known, attributes["command"]))
    found = index.inventory()
    compare_structure(notes, found, right)
    compare_attributes(notes, INDEX_RULES, found, right)
    for path, column in values.items():
        group, _, name = path[1:].partition("/")
        if any(each.name == name for each in index.columns(group)):
            _compare_rows(notes, path, index.raw(group, name), column)
    _compare_text(notes, stored, points, attributes, left_out)
    return notes.check()


def _cases(notes: Notes, sweep: Sweep, index: IndexFile) -> tuple[Case, ...]:
    """Return the points of an index in the form of sweep.json, in the order of the index."""
    by_values = {json.dumps(dict(case.values)): case for case in sweep.cases}
    cases = []
    for row, text in enumerate(map(str, index.read(POINTS, "values"))):
        known = by_values.get(text)
        notes.say(f"/points/values row {row}", found=text, expected=text if known else "a point of sweep.json")
        cases += [known] if known else []
    return tuple(cases)


def _compare_rows(notes: Notes, path: str, found: NDArray[Any], right: NDArray[Any]) -> None:
    """Compare a column of any type bit for bit, and note the first row that differs."""
    if found.shape != right.shape or found.dtype != right.dtype:
        return  # its structure differs, which is reported already
    bits = [np.ascontiguousarray(each).view(np.uint8).reshape(len(each), -1) for each in (found, right)]
    wrong = np.flatnonzero((bits[0] != bits[1]).any(axis=1))
    row = int(wrong[0]) if wrong.size else 0
    place = f"{path} row {row}" if wrong.size else path
    one, other = (shown(str(each[row].tolist())) if wrong.size else "right" for each in (found, right))
    notes.say(place, found=one, expected=other)


def _compare_text(
    notes: Notes, sweep: Sweep, points: tuple[Point, ...], attributes: Mapping[str, str], left_out: list[LeftOut]
) -> None:
    """Compare the stored text of the sweep's file with the sweep that was made of it."""
    asked = asked_by(attributes["command"])
    kept = stored_sizes(*(case.scenario.resolved() for case in sweep.cases))
    try:
        again = loads_sweep(sweep.text, "scenario_toml", asked.overrides if asked else (), kept)
    except ScenarioRefused as refusal:
        if "extends" in Source("scenario_toml", sweep.text).data:
            reason = "it extends a file that is not kept, and is not compared"
            left_out.append(LeftOut(name="index scenario_toml", reason=reason))
        else:
            notes.say("/ scenario_toml", found=str(refusal).partition("\n")[0], expected="the file of the sweep")
        return
    again = sweep_as_made(again, sweep.cases[0].scenario.resolved())
    there, here = (json.loads(json.dumps(identity(each))) for each in (again, sweep))
    wrong = [key for key in here if there[key] != here[key]]
    wrong += ["side_by_side"] if again.side_by_side != sweep.side_by_side else []
    if again.precision is None and len(points) != len(sweep.cases) * again.replicates:
        wrong.append("replicates")
    if wrong and asked is None:
        reason = f"the program that carried it out changed its {', '.join(wrong)}"
        left_out.append(LeftOut(name="index scenario_toml", reason=reason))
    else:
        found = f"another {', '.join(wrong)}" if wrong else "the sweep"
        notes.say("/ scenario_toml", found=found, expected="the sweep")
