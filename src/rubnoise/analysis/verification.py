"""Verification of a result file: hashes, structure, and its run played again and compared row by row."""

from collections.abc import Sequence
from typing import Protocol

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.verifying.attributes import attribute_checks, clock_notes
from rubnoise.analysis.verifying.columns import area_check, curve_check, hash_check, summary_check, unreadable
from rubnoise.analysis.verifying.findings import Check, Difference, Verification
from rubnoise.analysis.verifying.origin import layout_check, machines, other_streams, scenario_check
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.record.reader import HashedReader, chunks
from rubnoise.record.tally import TALLIED, Tally
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import stored
from rubnoise.storage.inventory import Inventory


class ResultFile(HashedReader, Protocol):
    """A result that lists all that there is in it, known or not."""

    def inventory(self) -> Inventory:
        """Return every group, column and attribute, as HDF5 has them."""
        ...


def verify(run: ResultFile, regenerate: int = 0) -> Verification:
    """Return everything that a file can be asked about itself; a longer run needs no more memory.

    Every row is made again from the seed. ``regenerate`` asks for nothing more, but raises Refused if the seed
    stands for other numbers. Checks that build on what has been found different are left out.
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
    # Opening a result needs nothing of the simulation.
    from rubnoise.analysis.verifying.columns import identity_check, touch_check
    from rubnoise.analysis.verifying.replay import replay_checks

    model = scenario.model()
    tally = Tally.of(model)
    if streams:
        rows = [identity_check(model, run) if model.free is None else touch_check(model, run)]
        left_out.append(LeftOut(name="replay", reason=streams))
        for group in run.columns.keys() & TALLIED.keys():
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
    """Return the check of areas; those of free motion need its summits, which other streams do not give."""
    from rubnoise.analysis.verifying.columns import summit_check

    model = scenario.model()
    if model.free is None:
        return area_check(model, run)
    if streams:
        return Check(name="areas", values=0, different=0, first=None)
    return summit_check(model, model.free, scenario.run.seed, run)


def _stopped(checks: list[Check], reason: str, left_out: Sequence[LeftOut] = ()) -> Verification:
    everything = LeftOut(name="everything else", reason=reason)
    return Verification(checks=tuple(checks), omitted=(*left_out, everything))
