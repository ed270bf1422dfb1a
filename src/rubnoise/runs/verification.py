"""Verify a result: its bytes against their hashes, its attributes, and its run, played again and compared row by row.

Scenario and seed fix every row, and every attribute except some texts about the origin, which the seal covers. So a
file is right if it is, to the last bit, what this program writes of its scenario. Of the folder of a sweep every run is
verified, and what the index says of runs is compared with their files.
"""

import json
import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf, isnan, nan
from os.path import commonprefix
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.figures import KEPT, summarise
from rubnoise.analysis.findings import attributes_of
from rubnoise.analysis.measured import Measured
from rubnoise.answer import Answer, Row, left_out
from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import RubnoiseError, RunFileRefused
from rubnoise.figure_names import DONE
from rubnoise.record.rows import Columns, JunctionState, Rows, Tee, extent_of
from rubnoise.regular_file import INDEX
from rubnoise.runs.folder import RUNS, SUFFIXES, Figures, figures_in, name_in, numbers_in, read, scenario_in, summarised
from rubnoise.runs.making import describe
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import stored
from rubnoise.scenario.sweep import name_of
from rubnoise.simulation.run import Ended, simulate
from rubnoise.storage.format import seal_of
from rubnoise.storage.index import read_index
from rubnoise.storage.inventory import expected_inventory
from rubnoise.storage.layout import environment
from rubnoise.storage.life_curve import life_tables
from rubnoise.storage.output import PART
from rubnoise.storage.reader import UNREADABLE, RunFile, open_run, refusing
from rubnoise.storage.schema import HASH, INTERVENTION
from rubnoise.streams import STREAM_VERSION

ORIGIN: Final = {"source", "scenario_toml", "software", "environment", "command", "started", "finished", HASH}
"""Attributes that the scenario does not fix: only the seal says whether they are as they were written."""

MEASURED, EXACT = 1e-9, 1e-6
"""Relative: measured figures are sums in any order, exact ones and errors come from quadratures."""

MISSING: Final = "missing"
LONGEST: Final = 160  # characters of a value that are shown
_CONSTANT: Final = 2.0**-30
"""Standard deviation over mean below which a column is constant but for rounding, and has no shape."""


@dataclass(slots=True)
class Check:
    """One check, which every correct file passes: how many values it compared, how many differ, and the first."""

    name: str
    values: int = 0
    different: int = 0
    first: str = ""

    @property
    def holds(self) -> bool:
        """Whether no value differs."""
        return self.different == 0

    def equal(self, place: str, first_row: int, found: NDArray[Any], expected: NDArray[Any]) -> None:
        """Compare rows of a column bit for bit: -0 differs from 0, and nan equals nan."""
        bits, right = f"u{found.dtype.itemsize}", np.ascontiguousarray(expected, found.dtype)
        wrong = np.flatnonzero(np.ascontiguousarray(found).view(bits) != right.view(bits))
        self.values += found.size
        if wrong.size:
            one, other = (repr(each[wrong[0]].item()) for each in (found, right))
            self.differ(f"{place} row {first_row + int(wrong[0])} is {one}, should be {other}", wrong.size)

    def say(self, place: str, *, found: object, expected: object) -> None:
        """Compare one value; long texts are shown from a little before the place where they differ."""
        self.values += 1
        if found is not expected and found != expected:  # nan, which a figure may be, equals itself
            one, other = str(found), str(expected)
            begin = max(len(commonprefix([one, other])) - LONGEST // 2, 0)  # noqa: RUF071  (of any text)
            self.differ(f"{place} is {one[begin:][:LONGEST]}, should be {other[begin:][:LONGEST]}")

    def compare(self, found: Mapping[str, object], expected: Mapping[str, object], *, where: str = "") -> None:
        """Compare values by name, of which neither side may lack one; ``where`` stands before the names."""
        for name in {**expected, **found}:
            one, other = (each.get(name, MISSING) for each in (found, expected))
            self.say(f"{where}{name}", found=one, expected=other)

    def differ(self, said: str, count: int = 1) -> None:
        """Count differences, and keep what is said of the first one."""
        self.different += count
        self.first = self.first or said


@dataclass(frozen=True, kw_only=True, repr=False)
class Verification(Answer):
    """A result checked against its own hashes, rows and scenario, one row per check, in the order of ``checks``.

    ``passed`` is true if every value is right; ``left_out`` names the checks that could not be made, with the reason;
    ``remark`` says what may explain a difference.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     answer = run.verify()
    >>> answer.passed, answer.rows[0].name, answer.checks[0].different
    (True, 'hashes', 0)
    """

    checks: Sequence[Check] = ()
    remark: str = ""

    @property
    def different(self) -> list[Check]:
        """The checks with differences."""
        return [check for check in self.checks if not check.holds]

    @property
    def values(self) -> int:
        """Number of values of all checks together."""
        return sum(check.values for check in self.checks)


def _verification(checks: Sequence[Check], *omitted: Row, remark: str = "") -> Verification:
    """Return the answer of finished checks, of what was left out, and of what may explain a difference."""
    rows, notes = list[Row](), (remark,) if remark else ()
    for check in checks:
        note = "" if check.holds else f"{check.different:,} different; the first: {check.first}"
        rows.append(Row(part="checks", name=check.name, value=check.values, note=note, fails=not check.holds))
    found = Verification(rows=(*rows, *omitted), notes=notes, checks=checks, remark=remark)
    return replace(found, judged=f"{len(checks)} checks of {found.values:,} values")


def verify(run: RunFile) -> Verification:
    """Return the verification of a result file; memory does not grow with the run.

    Checks that depend on something found different are left out.
    """
    hashes, structure, attributes = checks = [Check("hashes"), Check("structure"), Check("attributes")]
    if lost := _check_hashes(hashes, run):
        return _verification(checks[:1], left_out("everything else", f"{lost[0]} cannot be read"))
    try:
        scenario = stored(run.provenance["scenario_resolved"])
    except RunFileRefused as refusal:
        structure.differ(f"/provenance scenario_resolved {refusal}")
        return _verification(checks[:2], left_out("everything else", "there is no scenario"))
    _check_description(structure, attributes, scenario, run)
    if not structure.holds:
        return _verification(checks, left_out("everything else", "groups and columns are not those of the scenario"))
    if (version := run.provenance["stream_version"]) != STREAM_VERSION:
        drawn = f"this rubnoise draws version {STREAM_VERSION}, and {run.attributes['source']} wrote the file"
        others = f"has random streams of version {version}, which can't be drawn again: {drawn}"
        return _verification(checks, *(left_out(name, others) for name in ("replay", "summary")))
    return _played(checks, scenario, run)


def _check_hashes(check: Check, run: RunFile) -> list[str]:
    """Compare columns and attributes with their hashes; return the columns that cannot be read."""
    check.values += sum(run.rows(group) * len(names) for group, names in run.columns.items())
    damaged = run.damaged()
    check.compare(damaged, dict.fromkeys(damaged, "as it was written"))
    right = seal_of(run.attributes, run.summary, run.provenance)
    check.say(f"/provenance {HASH}", found=run.seal or MISSING, expected=right)
    return [place for place, found in damaged.items() if found == UNREADABLE]


def _check_description(structure: Check, attributes: Check, scenario: Scenario, run: RunFile) -> None:
    """Compare objects, attributes and types with those of a file that is composed from the scenario."""
    model = scenario.model()
    rows = {group: run.rows(group) for group in run.columns}
    known = extent_of(model, rows["junctions"])
    extent = {group: rows.get(group, 0) if count is None else count for group, count in known.items()}
    right = describe(scenario, run.path, (), str(run.provenance.get(INTERVENTION, "")), extent)
    right = right if scenario.title else replace(right, title=str(run.attributes["title"]))
    found, expected = run.inventory(), expected_inventory(right)
    for path, name in {**expected, **found}:
        one, other = (each.get((path, name), MISSING) for each in (found, expected))
        if not name:
            structure.say(path, found=one, expected=other)
        elif (path, "") in found.keys() & expected.keys() and not _is_free(path, name, one, other):
            values = [words.rpartition(", ")[0] or words for words in (one, other)]
            if values[0] != values[1]:  # types show where they alone differ
                one, other = values
            attributes.say(f"{path} {name}", found=one, expected=other)


def _is_free(path: str, name: str, found: str, expected: str) -> bool:
    """Whether no scenario says what an attribute should be: one of the origin, or a figure, one of the rows."""
    return expected == MISSING if path == "/summary" else name in ORIGIN and MISSING not in (found, expected)


class _BeyondFile(Exception):  # noqa: N818  (the file is wrong, not the program)
    """Raised at the first row that a file does not have."""


class _Compared:
    """A sink that compares the rows of a run with those of a file, in one check for each group."""

    def __init__(self, rows: Rows) -> None:
        self._rows = rows
        self.checks = {group: Check(group) for group in rows.columns}
        self.written = dict.fromkeys(self.checks, 0)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Compare rows of a group (see Sink)."""
        total, end = self._rows.rows(group), first_row + next(iter(columns.values())).size
        for name, values in columns.items():
            found = self._rows.column(group, name, first_row, min(end, total))
            self.checks[group].equal(f"/{group}/{name}", first_row, found, values[: found.size])
        self.written[group] = end
        if end > total:
            self.count(group, "more")
            raise _BeyondFile

    def count(self, group: str, expected: object) -> None:
        """Compare the number of rows."""
        self.checks[group].say(f"/{group} rows", found=self._rows.rows(group), expected=expected)


def _played(checks: list[Check], scenario: Scenario, run: RunFile) -> Verification:
    """Return the verification of a run that is played again, up to the first row that its file does not have.

    If an intervention ended lives, births come from the seed and these ends from the file.
    """
    model = scenario.model()
    compared, seen = _Compared(run), Measured(model)
    for group, columns in () if model.free else life_tables(model.pulse).items():
        compared.write(group, 0, columns)
    ended = ended_of(run) if INTERVENTION in run.provenance and not model.is_two_way else None
    try:
        scenario.check_size()
        with suppress(_BeyondFile):
            simulate(model, scenario.run.seed, Tee((compared, seen)), engine="batch", ended=ended)
            for group, written in compared.written.items():
                compared.count(group, written)
    except (RubnoiseError, ArithmeticError) as problem:
        compared.count("slider" if model.slider else "trace", str(problem).partition("\n")[0])
    checks, remark = [*checks, *compared.checks.values()], ""
    if all(check.holds for check in compared.checks.values()):
        return _verification([*checks, _summary_check(seen, run.summary)])
    if (there := str(run.provenance["environment"])) != (here := json.dumps(environment())):
        remark = f"the run was made on {there} and played again on {here}"
    return _verification(checks, left_out("summary", "rows of the columns that it sums up differ"), remark=remark)


def ended_of(rows: Rows) -> Ended:
    """Return a function for the places (um) at which a file ended junctions early, never before run and life begin."""

    def ended(number: Integers) -> Doubles:
        if not number.size:
            return np.empty(0)
        first, end = int(number[0]), int(number[-1]) + 1
        names = ("state", "birth_distance", "death_distance")
        state, birth, death = (rows.column("junctions", name, first, end) for name in names)
        begin, found = np.fmax(birth, 0.0), np.full(end - first, np.inf)
        early = (state & JunctionState.ENDED_EARLY) != 0
        found[: death.size] = np.where(early, np.where(death > begin, death, begin), np.inf)
        return found[number - first]

    return ended


def _summary_check(seen: Measured, kept: Mapping[str, object]) -> Check:
    """Compare the summary with every figure of the rows, and of the theory of the scenario."""
    check, right = Check("summary"), dict[str, object]()
    for figure in summarise(seen):
        for name, value in attributes_of([figure]).items():
            allowed = _allowed(figure, seen) if name == figure.name else EXACT * abs(value)
            found = kept.get(name)
            near = isinstance(found, float) and (abs(found - value) <= allowed or (isnan(found) and isnan(value)))
            right[name] = found if near else value
    check.compare(kept, right, where="/summary ")
    return check


def _allowed(figure: Row, measured: Measured) -> float:
    """Return the allowed deviation of a measured figure; the shape of a column that is constant to rounding is free."""
    if (kept := KEPT.get(figure.name)) is None:
        return MEASURED * abs(figure.value)
    seen = measured.moments[kept.column_in(measured.model)]
    if figure.name.endswith(("_skewness", "_kurtosis")):
        return MEASURED * max(abs(figure.value), 1.0) if seen.std > _CONSTANT * abs(seen.mean) else inf
    return MEASURED * (abs(figure.value) + (seen.std + 1e-3 * abs(seen.mean)) / kept.over(measured.model))


# The folder of a sweep.
def verify_sweep(
    folder: str | os.PathLike[str],
    *,
    watch: Callable[[int, int], None] = lambda _done, _all: None,
) -> Verification:
    """Return the verification of the folder of a sweep and of each of its runs.

    ``watch`` is called with the number of runs checked and of all. Raises RunFileRefused for what is no such folder.
    """
    root, figures, incomplete = Path(folder), dict[str, Figures](), Counter[tuple[str, str]]()
    index, names, runs = checks = Check("index"), Check("names"), Check("runs")
    with refusing(root):  # a folder in it may be closed to who asks, or be on a disk that fails
        if not root.is_dir() or not ((root / INDEX).exists() or (root / RUNS).is_dir()):
            raise RunFileRefused(f"is not a sweep folder: it has neither {INDEX} nor {RUNS}")
        files = _seen(root / RUNS)
        for number, path in enumerate(files):
            watch(number, len(files))
            place = f"{RUNS}/{path.name}"
            if path.suffix not in SUFFIXES.values():
                names.differ(f"{place} is no file of a run")
                continue
            try:
                scenario, figures[path.stem], found = _verified(path)
            except RunFileRefused as refusal:
                runs.differ(f"{place} {str(refusal).removeprefix(f'{path}: ')[:LONGEST]}")
                continue
            names.say(place, found=f"the result of {name_in(scenario)}", expected=f"the result of {path.stem}")
            runs.values += found.values
            incomplete.update(found.left_out.items())
            for check in found.different:
                runs.differ(f"{place} {check.first}")
        return _verification(checks, *_left_out(root, incomplete), *_compare_index(index, root, figures))


def _verified(path: Path) -> tuple[Scenario | None, Figures, Verification]:
    """Return scenario and figures in the file of a run, and its verification; a summary alone is made again."""
    if path.suffix == SUFFIXES["runs"]:
        with open_run(path) as run:
            return scenario_in(run), numbers_in(run.summary), verify(run)
    (scenario, found), check = read(path), Check("summary")
    if scenario is not None:
        check.compare(_told(found), _told(summarised(scenario, first="spectrum_place" in found)))
    return scenario, found, _verification([check])


def _told(figures: Figures) -> dict[str, str]:
    """Return figures and curves as texts, which are equal where their bits are."""
    return {name: str(np.asarray(value).tolist()) for name, value in figures.items()}


def _seen(folder: Path) -> list[Path]:
    """Return what is in a folder, but parts and what is hidden."""
    there = sorted(folder.iterdir()) if folder.is_dir() else ()
    return [path for path in there if not path.name.startswith(".") and not path.name.endswith(PART)]


def _left_out(root: Path, incomplete: Counter[tuple[str, str]]) -> Iterator[Row]:
    """Yield what is not compared: parts left out for runs, unfinished runs and other files."""
    for (name, reason), count in sorted(incomplete.items()):
        yield left_out(name, f"{count:,} runs: {reason}" if count > 1 else f"a run: {reason}")
    for part in sorted((root / RUNS).glob(f"*{PART}")):
        yield left_out(f"{RUNS}/{part.name}", "unfinished; the same sweep makes it")
    others = (path.name for path in _seen(root) if path.name not in {INDEX, RUNS})
    yield from (left_out(name, "it is no file of the sweep") for name in others)


def _compare_index(check: Check, root: Path, kept: Mapping[str, Figures]) -> Iterator[Row]:
    """Compare the runs and the figures in the index with those that the files have; yield what cannot be compared."""
    try:
        index = read_index(root / INDEX)
    except RunFileRefused as refusal:
        missing = MISSING if not (root / INDEX).exists() else str(refusal).removeprefix(f"{root / INDEX}: ")
        check.say(INDEX, found=missing, expected="the index; the same sweep writes it again")
        return
    names, points, seeds, states = (index.runs[name].values.tolist() for name in ("run_id", "point", "seed", "state"))
    if any(state != DONE and name in kept for name, state in zip(names, states, strict=True)):
        yield left_out("index", "it is older than some runs; the same sweep renews it")
    with refusing(root / INDEX):
        scenarios = [index.scenario(point).resolved() for point in range(len(index.values))]
    for name, point, seed in zip(names, points, seeds, strict=True):
        place = f"{INDEX} /runs/point and /runs/seed of {name}: run"
        check.say(place, found=name_of(scenarios[point], seed), expected=name)
    files = any(index.runs["file"].values) or not kept
    for name, figures in figures_in(index, "runs" if files else "summary"):
        check.say(f"{INDEX} {RUNS}/{name}", found=DONE if name in kept else MISSING, expected=DONE)
        right = kept.get(name, figures)
        lacking = dict.fromkeys([*figures, *right], nan)  # as an index has what a run lacks
        one, other = (_told({**lacking, **each}) for each in (figures, right))
        check.compare(one, other, where=f"{INDEX} /runs of {name}: ")
    if others := len(kept.keys() - set(names)):
        yield left_out(f"{others:,} of {RUNS}", "the index lacks them")
