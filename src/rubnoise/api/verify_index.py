"""The index of a sweep compared with its own hashes, and with an index made again from sweep.json and the journals."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.verifying.attributes import (
    command_form,
    compare_attributes,
    compare_structure,
    digits_form,
    moment_form,
    shown,
    source_form,
)
from rubnoise.analysis.verifying.findings import Check, Difference, Notes
from rubnoise.analysis.verifying.origin import asked_by
from rubnoise.errors import RunFileRefused, ScenarioRefused
from rubnoise.scenario.points import Case, Point, points_of
from rubnoise.scenario.source import Source
from rubnoise.scenario.sweep import Sweep, loads_sweep
from rubnoise.storage.index import POINTS, RUNS, seal_of_index
from rubnoise.storage.index_checks import check_index
from rubnoise.storage.index_file import IndexFile, open_index
from rubnoise.storage.inventory import expected_index
from rubnoise.storage.reader import Unseen
from rubnoise.storage.schema import HASH
from rubnoise.sweep.folder import SweepFolder, identity
from rubnoise.sweep.index import index_of
from rubnoise.sweep.run_status import DONE, PLANNED, RecordedRuns

INDEX: Final = "index.h5"

RULES: Final = {
    ("/", "source"): source_form,
    ("/", "written"): moment_form,
    ("/", "command"): command_form,
    ("/", HASH): digits_form,
}
"""What sweep.json and the journals do not hold to the last character."""


@dataclass(frozen=True, slots=True, kw_only=True)
class IndexFound:
    """What came of an index: its checks, and the runs that it knows."""

    checks: tuple[Check, ...]
    run_ids: frozenset[str] = frozenset()


def index_checks(folder: SweepFolder, sweep: Sweep | None, left_out: list[LeftOut]) -> IndexFound:
    """Return whether the index has its hashes, and whether it is that of the sweep and of what the journals hold.

    Without a ``sweep``, which sweep.json does not hold, its hashes are all that can be asked.
    """
    try:
        with open_index(folder.index) as index:
            run_ids = frozenset(map(str, index.read(RUNS, "run_id")))
            hashes = _hash_check(index)
            if sweep is None:
                left_out.append(LeftOut(name="index", reason="sweep.json differs, and the index is made from it"))
                return IndexFound(checks=(hashes,), run_ids=run_ids)
            return IndexFound(checks=(hashes, _index_check(folder, sweep, index, left_out)), run_ids=run_ids)
    except Unseen:
        raise  # it could not be read, which is not its fault
    except (RunFileRefused, KeyError) as refusal:
        missing = "missing" if not folder.index.exists() else str(refusal).removeprefix(f"{folder.index}: ")
        first = Difference(place=INDEX, row=None, found=missing, expected="the index; the same sweep writes it again")
        return IndexFound(checks=(Check(name="index", values=1, different=1, first=first),))


def _hash_check(index: IndexFile) -> Check:
    notes, damaged = Notes("index_hashes", of=INDEX), index.damaged()
    for path in index.hashes:
        state = "not what its hash was taken of" if path in damaged else "as it was written"
        notes.say(path, found=state, expected="as it was written")
    seal = seal_of_index(dict(index.attributes), {path: each or "" for path, each in index.hashes.items()})
    notes.say(f"/ {HASH}", found=index.seal or "missing", expected=seal)
    return notes.check()


def _index_check(folder: SweepFolder, sweep: Sweep, index: IndexFile, left_out: list[LeftOut]) -> Check:
    """Compare an index with one that is made again from the sweep and the journals, unless they know more by now."""
    try:
        check_index(index)
    except RunFileRefused as refusal:
        reason = str(refusal).removeprefix(f"{index.path}: ")
        first = Difference(place=INDEX, row=None, found=reason, expected="an index as the program writes it")
        return Check(name="index", values=1, different=1, first=first)
    notes, attributes = Notes("index", of=INDEX), index.attributes
    sides = {name: _list(attributes[name]) for name in ("grid", "side_by_side")}
    notes.say("swept keys", found=[*sides["grid"], *sides["side_by_side"]], expected=[*sweep.keys])
    cases = _cases(notes, sweep, index)
    if not notes.check().holds:
        return notes.check()
    stored = replace(sweep, text=attributes["scenario_toml"], side_by_side=tuple(sides["side_by_side"]), cases=cases)
    points = _points(cases, index)
    known = RecordedRuns.of(folder, points, counts=lambda _entry: True)
    if len(cases) < len(sweep.cases) or _since(index, known):
        reason = "it is older than sweep.json or the journals; the same sweep renews it"
        left_out.append(LeftOut(name="index", reason=reason))
        return notes.check()
    right, values = expected_index(index_of(folder, stored, points, known, attributes["command"]))
    found = index.inventory()
    compare_structure(notes, found, right)
    compare_attributes(notes, RULES, found, right)
    for path, column in values.items():
        group, _, name = path[1:].partition("/")
        if any(each.name == name for each in index.columns(group)):
            _compare_rows(notes, path, index.raw(group, name), column)
    _compare_text(notes, stored, points, attributes, left_out)
    return notes.check()


def _list(text: str) -> list[str]:
    """Return the keys that an attribute lists; none where it lists none."""
    try:
        names = json.loads(text)
    except (ValueError, RecursionError):
        return []
    return [str(key) for key in names] if isinstance(names, list) else []


def _cases(notes: Notes, sweep: Sweep, index: IndexFile) -> tuple[Case, ...]:
    """Return the points of an index as sweep.json has them, in the order of the index."""
    by_values = {json.dumps(dict(case.values)): case for case in sweep.cases}
    cases = []
    for row, text in enumerate(map(str, index.read(POINTS, "values"))):
        known = by_values.get(text)
        notes.say(f"/points/values row {row}", found=text, expected=text if known else "a point of sweep.json")
        cases += [known] if known else []
    return tuple(cases)


def _points(cases: tuple[Case, ...], index: IndexFile) -> tuple[Point, ...]:
    """Return the runs that an index should have, for as many replicates of each point as it has."""
    numbers = index.read(RUNS, "point")
    counts = np.bincount(numbers[(numbers >= 0) & (numbers < len(cases))], minlength=len(cases))
    return tuple(point for case, count in zip(cases, counts, strict=True) for point in points_of([case], int(count)))


def _since(index: IndexFile, known: RecordedRuns) -> bool:
    """Whether the journals call runs done, or failed at all, that an index does not."""
    before = map(str, index.read(RUNS, "state"))
    return any(now != then and (now == DONE or then == PLANNED) for now, then in zip(known.states, before, strict=True))


def _compare_rows(notes: Notes, path: str, found: NDArray[Any], right: NDArray[Any]) -> None:
    """Compare a column of any kind bit for bit, and name the first row that differs."""
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
    """Compare the file of the sweep, as read, with the sweep that it was made into."""
    asked = asked_by(attributes["command"])
    try:
        again = loads_sweep(sweep.text, "scenario_toml", asked.overrides if asked else ())
    except ScenarioRefused as refusal:
        if "extends" in Source("scenario_toml", sweep.text).data:
            reason = "it extends a file that is not kept, and is not compared"
            left_out.append(LeftOut(name="index scenario_toml", reason=reason))
        else:
            notes.say("/ scenario_toml", found=str(refusal).partition("\n")[0], expected="the file of the sweep")
        return
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
