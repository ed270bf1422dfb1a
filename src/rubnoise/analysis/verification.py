"""Verification of a result file: hashes, invariants of its rows, and blocks computed again."""

from collections.abc import Sequence
from typing import Protocol

from rubnoise.analysis.stored_model import stored_scenario
from rubnoise.analysis.verifying.attributes import attribute_checks, clock_notes
from rubnoise.analysis.verifying.balance import balance_check
from rubnoise.analysis.verifying.blocks import block_check
from rubnoise.analysis.verifying.contact import contact_checks
from rubnoise.analysis.verifying.derived import curve_check, summary_check
from rubnoise.analysis.verifying.findings import Check, Difference, LeftOut, Verification
from rubnoise.analysis.verifying.hashes import hash_check, unreadable
from rubnoise.analysis.verifying.lives import life_checks
from rubnoise.analysis.verifying.origin import (
    cells_per_tick,
    layout_check,
    need_same_streams,
    origin_check,
    scenario_check,
)
from rubnoise.analysis.verifying.slider import slider_checks
from rubnoise.analysis.verifying.two_way import two_way_checks
from rubnoise.analysis.verifying.two_way_motion import motion_checks
from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import HashedReader
from rubnoise.scenario import Scenario
from rubnoise.storage.inventory import Inventory


class ResultFile(HashedReader, Protocol):
    """A result that lists all that there is in it, known or not."""

    def inventory(self) -> Inventory:
        """Return every group, column and attribute, as HDF5 has them."""
        ...


def verify(run: ResultFile, regenerate: int = 0) -> Verification:
    """Return everything that a file can be asked about itself, in chunks: a longer run needs no more memory.

    ``regenerate``: how many blocks to make again from the seed and compare bit for bit. Checks that build on what has
    been found different are left out. Raises Refused for ``regenerate`` where the seed stands for other numbers.
    """
    if regenerate:
        need_same_streams(run)
    hashes = hash_check(run)
    if not hashes.holds and (lost := unreadable(run)):
        return _stopped([hashes], f"{lost[0]} cannot be read")
    try:
        scenario = stored_scenario(run)
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
    return _asked(scenario, run, regenerate, checks, left_out)


def _asked(
    scenario: Scenario, run: HashedReader, regenerate: int, checks: list[Check], left_out: list[LeftOut]
) -> Verification:
    model = scenario.model()
    origin, lives = origin_check(scenario, run), life_checks(model, run)
    checks = [*checks, origin, curve_check(model, run), *lives]
    if all(check.holds for check in lives):
        checks += _of_sums(model, run, left_out)
    else:
        left_out.append(LeftOut(name="ticks and what follows", reason="rows of /junctions differ"))
    if regenerate:
        checks += _made_again(model, run, regenerate, [origin, *lives], left_out)
    return Verification(checks=tuple(checks), left_out=tuple(left_out))


def _of_sums(model: Model, run: HashedReader, left_out: list[LeftOut]) -> list[Check]:
    """Return the checks that need sound rows of /junctions."""
    checks = contact_checks(model, run)
    if model.is_two_way:
        checks += _of_two_way(model, run, left_out)
    elif model.slider is not None:
        checks += slider_checks(model, run, cells_per_tick(run))
    if all(check.holds for check in checks):
        checks.append(summary_check(model, run))
    else:
        left_out.append(LeftOut(name="summary", reason="the columns that it sums up differ"))
    checks.append(block_check(model, run))
    return checks


def _of_two_way(model: Model, run: HashedReader, left_out: list[LeftOut]) -> list[Check]:
    """Return what is asked of a two-way slider; its motion is made again where its rows agree with each other."""
    checks, balance = two_way_checks(model, run), balance_check(model, run)
    if all(check.holds for check in checks):
        motion, partly = motion_checks(model, run)
        left_out += partly
        return [*checks, balance, *motion]
    left_out.append(LeftOut(name="motion", reason="rows of the slider differ"))
    return [*checks, balance]


def _made_again(
    model: Model, run: HashedReader, count: int, needed: list[Check], left_out: list[LeftOut]
) -> list[Check]:
    """Return the check that makes blocks again, which needs a right seed, and right rows to go on from."""
    # What is asked of rows needs nothing of the simulation but its compiler.
    from rubnoise.analysis.verifying.regenerating import regeneration_check

    wrong = [check.name for check in needed if not check.holds]
    if wrong:
        left_out.append(LeftOut(name="regenerated", reason=f"its starting values differ: {', '.join(wrong)}"))
        return []
    check, partly = regeneration_check(model, run, int(run.provenance["seed"]), count)
    left_out += partly
    return [check]


def _stopped(checks: list[Check], reason: str, left_out: Sequence[LeftOut] = ()) -> Verification:
    everything = LeftOut(name="everything else", reason=reason)
    return Verification(checks=tuple(checks), left_out=(*left_out, everything))
