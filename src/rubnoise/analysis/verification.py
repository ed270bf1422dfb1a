"""Verify a result file: hashes, structure, origin, and its run played again and compared row by row."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from shlex import split
from typing import Any, Final, Protocol

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.verifying.attributes import attribute_checks, clock_notes
from rubnoise.analysis.verifying.columns import (
    area_check,
    curve_check,
    hash_check,
    identity_check,
    summary_check,
    summit_check,
    unreadable,
)
from rubnoise.analysis.verifying.findings import Check, Difference, Notes, Verification
from rubnoise.analysis.verifying.replay import replay_checks
from rubnoise.errors import Refused, RunFileRefused, ScenarioRefused
from rubnoise.model import Model
from rubnoise.record.reader import HashedReader, Reader, chunks
from rubnoise.record.tally import TALLIED, Tally
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import stored
from rubnoise.scenario.reread import Reread, reread
from rubnoise.scenario.scenario import flattened
from rubnoise.storage.inventory import Inventory
from rubnoise.storage.layout import features_of, stored_groups
from rubnoise.storage.provenance import environment
from rubnoise.streams import STREAM_VERSION


def layout_check(model: Model, run: HashedReader) -> Check:
    """Return whether a file has the groups, columns and ticks that a run of its scenario has."""
    notes, features = Notes("layout"), features_of(model)
    for group in stored_groups(features):
        expected = tuple(column.name for column in group.columns)
        notes.say(f"/{group.name}", found=tuple(run.columns.get(group.name, ())), expected=expected)
    notes.say("/trace rows", found=run.rows("trace"), expected=model.tick_count + 1)
    if model.slider_rows and "slider" in run.columns:
        notes.say("/slider rows", found=run.rows("slider"), expected=model.slider_rows)
    return notes.check()


def other_streams(run: Reader) -> str:
    """Return the reason why the seed of a file gives other random numbers here; empty if it gives the same."""
    version = run.provenance["stream_version"]
    if version == STREAM_VERSION:
        return ""
    return (
        f"has random streams of version {version}, which can't be drawn again: this rubnoise draws version"
        f" {STREAM_VERSION}, and {run.attributes['source']} wrote the file"
    )


def machines(run: Reader) -> str:
    """Return the machines on which a run was made and played again, for rows that differ only from the replay."""
    return (
        "the areas agree with the rows, and the rows not with the play: the run was made on"
        f" {run.provenance['environment']} and played again on {json.dumps(environment())}"
    )


PLACE: Final = "/provenance scenario_toml"

WITH_VALUE: Final = frozenset(("-o", "--output", "--set", "--seed", "--engine", "--jobs", "-j", "--cluster", "--shard"))
"""Options of `run` and `sweep` that take a value."""

MOST_NAMED: Final = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Asked:
    """The content of a command line: the command of rubnoise, and the keys that it changes, as KEY=VALUE."""

    command: str
    overrides: tuple[str, ...]


def asked_by(command: str) -> Asked | None:
    """Return the content of a command line of `rubnoise run` or `rubnoise sweep`; None for any other program."""
    try:
        program, *words = split(command)
    except ValueError:
        return None
    words = [word for word in words if word != "--debug"]
    if program != "rubnoise" or words[:1] not in (["run"], ["sweep"]):
        return None
    given: dict[str, list[str]] = {"--set": [], "--seed": [], "--engine": []}
    for option, value in _options(words[1:]):
        given.setdefault(option, []).append(value)
    named = (("run.seed", given["--seed"]), ("run.engine", given["--engine"]))
    last = [f"{key}={values[-1]}" for key, values in named if values]
    return Asked(command=words[0], overrides=(*given["--set"], *last))


def _options(words: list[str]) -> Iterator[tuple[str, str]]:
    """Yield the options that have a value, with their values."""
    rest = iter(words)
    for word in rest:
        if word == "--":
            return
        option, equals, value = word.partition("=")
        if word in WITH_VALUE:
            yield word, next(rest, "")
        elif equals and option in WITH_VALUE and option.startswith("--"):
            yield option, value


def scenario_check(scenario: Scenario, provenance: Mapping[str, object]) -> tuple[Check, list[LeftOut]]:
    """Check that the text of the scenario, with the changes of the command line, gives the scenario that was run.

    A user's own program may have changed the scenario: for such a run, differences are listed as left out.
    """
    notes, text, run = Notes("scenario"), str(provenance["scenario_toml"]), scenario.resolved()
    asked = asked_by(str(provenance["command"]))
    if not text:
        notes.say(PLACE, found="empty", expected="the file as read" if asked else "empty")
        return notes.check(), []
    try:
        again = reread(text, run, asked.overrides if asked else ())
    except ScenarioRefused as refusal:
        notes.say(PLACE, found=str(refusal).partition("\n")[0], expected="the scenario of the run")
        return notes.check(), []
    different = dict(_differences(again, run, asked))
    if asked is None:
        notes.say(PLACE, found="a scenario", expected="a scenario")
        return notes.check(), _changed_elsewhere(different)
    for key in _keys(again.resolved, run):
        by_text, by_run = different.get(key, ("as run", "as run"))
        notes.say(f"{PLACE} {key}", found=by_text, expected=by_run)
    return notes.check(), [] if again.self_contained else [LeftOut(name="scenario", reason=_BASE)]


_BASE: Final = "scenario_toml extends a file that is not kept: keys that stand in that one alone are not compared"


def _differences(again: Reread, run: Mapping[str, Any], asked: Asked | None) -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield the keys in which the two scenarios differ, with the values of the text and of the run."""
    by_text, by_run = flattened(again.resolved), flattened(run)
    of_sweep = bool(again.seeds) or (asked is not None and asked.command == "sweep")
    for key in _keys(again.resolved, run):
        from_file, had = (json.dumps(flat.get(key), ensure_ascii=False) for flat in (by_text, by_run))
        if key == "run.seed" and of_sweep:
            if again.seeds and by_run[key] not in again.seeds:
                yield key, (f"{from_file}, from which no replicate has the seed of the run", had)
        elif key in {"run.seed", "run.engine"} and asked is None:
            continue  # a program hands these over beside the scenario
        elif from_file != had:
            yield key, (from_file, had)


def _changed_elsewhere(different: Mapping[str, tuple[str, str]]) -> list[LeftOut]:
    if not different:
        return []
    named = [f"{key} is {by_text} there and {by_run} in the run" for key, (by_text, by_run) in different.items()]
    more = [f"and {len(named) - MOST_NAMED} more"] if len(named) > MOST_NAMED else []
    from_file = "; ".join([*named[:MOST_NAMED], *more])
    return [LeftOut(name="scenario", reason=f"scenario_toml was changed by the program that made the run: {from_file}")]


def _keys(*scenarios: Mapping[str, Any]) -> list[str]:
    return list(dict.fromkeys(key for scenario in scenarios for key in flattened(scenario)))


class ResultFile(HashedReader, Protocol):
    """A result that lists everything in it, also objects of others."""

    def inventory(self) -> Inventory:
        """Return every group, column and attribute of the file."""
        ...


def verify(run: ResultFile, regenerate: int = 0) -> Verification:
    """Return the verification of a result file; memory does not grow with the run.

    Every row is made again from the seed. ``regenerate`` adds no check, but raises Refused if the seed gives
    other random numbers. Checks that depend on something found different are left out.
    """
    streams = other_streams(run)
    if regenerate and streams:
        raise Refused(f"{streams}; leave --regenerate away")
    hashes = hash_check(run)
    if not hashes.holds and (lost := unreadable(run)):
        return _stopped([hashes], f"{lost[0]} cannot be read")
    try:
        scenario = stored(run.provenance["scenario_resolved"])
    except RunFileRefused as refusal:
        place = "/provenance scenario_resolved"
        first = Difference(place=place, row=None, found=str(refusal), expected="the scenario of the run")
        return _stopped([hashes, Check(name="layout", values=1, different=1, first=first)], "there is no scenario")
    text, left_out = scenario_check(scenario, run.provenance)
    left_out += clock_notes(run.provenance)
    layout = layout_check(scenario.model(), run)
    checks = [hashes, layout, *attribute_checks(scenario, run, run.inventory()), text]
    if not layout.holds:
        return _stopped(checks, "the columns are not those of the scenario", left_out)
    if scenario.model().free is None:
        checks.append(curve_check(scenario.model(), run))
    rows, areas, summary = _of_rows(scenario, run, streams, left_out)
    remark = machines(run) if areas.holds and not streams and not all(check.holds for check in rows) else ""
    return Verification(checks=(*checks, *rows, areas, *summary), omitted=tuple(left_out), remark=remark)


def _of_rows(
    scenario: Scenario, run: HashedReader, streams: str, left_out: list[LeftOut]
) -> tuple[list[Check], Check, list[Check]]:
    """Return the checks of rows, of areas by another formula, and of the summary if rows are right."""
    model = scenario.model()
    tally = Tally.of(model)
    if streams:
        rows = [identity_check(model, run)]
        left_out.append(LeftOut(name="replay", reason=streams))
        for group in (name for name in run.columns if name in TALLIED):
            for chunk in chunks(run, group):
                tally.write(group, chunk.first, chunk)
    else:
        rows = replay_checks(scenario, run, tally)
    areas = _areas(scenario, run, streams)
    if all(check.holds for check in (*rows, areas)):
        return rows, areas, [summary_check(model, tally, run.summary)]
    left_out.append(LeftOut(name="summary", reason="rows of the columns that it sums up differ"))
    return rows, areas, []


def _areas(scenario: Scenario, run: HashedReader, streams: str) -> Check:
    """Return the check of areas; in free motion it needs the summits, which another stream version does not give."""
    model = scenario.model()
    if model.free is None:
        return area_check(model, run)
    if streams:
        return Check(name="areas", values=0, different=0, first=None)
    return summit_check(model, model.free, scenario.run.seed, run)


def _stopped(checks: list[Check], reason: str, left_out: Sequence[LeftOut] = ()) -> Verification:
    everything = LeftOut(name="everything else", reason=reason)
    return Verification(checks=tuple(checks), omitted=(*left_out, everything))
