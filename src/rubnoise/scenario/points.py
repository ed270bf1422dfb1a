"""The points of a sweep: scenarios ready to run, each with its seed and its name."""

import json
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from typing import Any

import numpy as np

from rubnoise.scenario.document import SECTIONS
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.scenario import Scenario

_ID_DIGITS = 16
_NOT_THE_CONTACT = ("title", "output", "run")
"""What a scenario says about writing and running: a point keeps its seed when only this changes."""
_NOT_THE_FIELD = ("coupling", "cells")
"""Keys of the slider that change only when each distance is reached: points that differ in them alone share seeds."""
_NOT_THE_SIZES = ("file", "column", "hash")
"""Where diameters were read: their values are all that counts."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """The values of the swept keys at one point, as written, and the whole scenario there."""

    values: Mapping[str, Any]
    scenario: Scenario


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """One run of a sweep: its swept values as written, the number of its replicate, its name, seed and scenario.

    The scenario has the seed, too; replicates are counted from 0.
    """

    values: Mapping[str, Any]
    replicate: int
    run_id: str
    seed: int
    scenario: Scenario


def points_of(cases: Iterable[Case], replicates: int, first: int = 0) -> tuple[Point, ...]:
    """Return the runs of every case from replicate ``first`` on, the replicates of a case one after another."""
    found = []
    for case in cases:
        scenario, resolved = case.scenario, case.scenario.resolved()
        words = _seed_words(resolved)
        for replicate in range(first, replicates):
            seed = _derived(scenario.run.seed, words, replicate)
            found.append(
                Point(
                    values=case.values,
                    replicate=replicate,
                    run_id=name_of(resolved, seed),
                    seed=seed,
                    scenario=replace(scenario, run=replace(scenario.run, seed=seed)),
                )
            )
    return tuple(found)


def _seed_words(resolved: Mapping[str, Any]) -> tuple[int, ...]:
    slider = {key: value for key, value in (resolved.get("slider") or {}).items() if key not in _NOT_THE_FIELD}
    digest = sha256(canonical({**resolved, "slider": slider}, without=_NOT_THE_CONTACT)).digest()
    return tuple(int.from_bytes(digest[at : at + 4], "big") for at in range(0, len(digest), 4))


def _derived(seed: int, words: tuple[int, ...], replicate: int) -> int:
    """Return the seed of a replicate: 53 bits from the seed in the scenario and the physics of the scenario.

    It does not depend on the order of points, on the other swept values, on output and title, or on the coupling:
    one-way and two-way sliders meet the same junctions. From numpy's SeedSequence, whose numbers are the same in every
    version (O'Neill's seed_seq_fe).
    """
    sequence = np.random.SeedSequence(seed, spawn_key=(*words, replicate))
    return int(sequence.generate_state(1, np.uint64)[0]) >> 11


def run_id(scenario: Scenario) -> str:
    """Return the name of a run, 16 hexadecimal digits of the SHA-256 of its scenario with the seed."""
    return name_of(scenario.resolved(), scenario.run.seed)


def name_of(resolved: Mapping[str, Any], seed: int) -> str:
    """Return the name of a resolved scenario's run with a seed. Neither its title nor its engine changes the name."""
    run = resolved["run"] | {"seed": seed, "engine": keys_of(SECTIONS["run"])["engine"].default}
    return sha256(canonical({**resolved, "run": run}, without=("title",))).hexdigest()[:_ID_DIGITS]


def canonical(resolved: Mapping[str, Any], without: Collection[str]) -> bytes:
    """Return the canonical JSON text of a resolved scenario: keys sorted, defaults left out, in working units.

    Defaults are left out so that a key of a later version, with its default, changes no name and no seed. A calibration
    is left out if it is exact, the first default, or does what exact does: matched, for equal diameters.
    """
    resolved = {
        name: _without_defaults(name, value) if isinstance(value, dict) else value
        for name, value in _without_calibration(resolved).items()
        if name not in without
    }
    kept = {name: value for name, value in resolved.items() if value != {}}
    return json.dumps(kept, sort_keys=True, separators=(",", ":"), ensure_ascii=True).encode()


def _without_defaults(section: str, table: dict[str, Any]) -> dict[str, Any]:
    fields, left_out = keys_of(SECTIONS[section]), _NOT_THE_SIZES if section == "diameter" else ()
    kept = {key: value for key, value in table.items() if key not in left_out}
    return {key: value for key, value in kept.items() if key == "calibration" or value != fields[key].default}


def _without_calibration(resolved: Mapping[str, Any]) -> Mapping[str, Any]:
    interface = resolved["interface"]
    same_as_exact = {"exact", "matched"} if resolved["diameter"]["law"] == "fixed" else {"exact"}
    if interface.get("calibration", "exact") not in same_as_exact:
        return resolved
    return {**resolved, "interface": {key: value for key, value in interface.items() if key != "calibration"}}
