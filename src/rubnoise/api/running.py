"""Runs of scenarios: into memory, into a file; and what theory says about them."""

import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from operator import index
from pathlib import Path
from typing import cast

from rubnoise.api.playing import describe, play
from rubnoise.api.result import Record, Run
from rubnoise.api.resuming import go_on, interrupted
from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import Scenario
from rubnoise.simulation.block import Watch
from rubnoise.simulation.intervention import Intervention
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import Engine, check_guests, extent
from rubnoise.simulation.run import simulate as run_model
from rubnoise.storage.forecast import check_disk_space, check_memory, expected
from rubnoise.storage.output import check_output
from rubnoise.storage.reader import open_run
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import SEED_LIMIT
from rubnoise.theory.exact import Exact
from rubnoise.theory.exact import exact as exact_of_model


def simulate(
    scenario: Scenario,
    seed: int | None = None,
    *,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
) -> Record:
    """Run a scenario and keep the result in memory: ``simulate(scenario)["trace"]["real_contact_area"]``.

    ``seed`` replaces that of the scenario; ``observe`` is called at births, deaths, sticks ... as they happen, and
    changes nothing; ``intervene(env, live)`` is a SimPy process beside those of the junctions, begun at the start:
    ``env.now`` is the distance in um, ``live`` the LiveJunctions, of which it may end some. What either raises ends the
    run. Raises ScenarioRefused for a seed that is none, Refused where the memory of this machine does not hold the
    result, or for an observer or intervention that is none or comes with the engine "batch".
    """
    scenario = _seeded(scenario, seed)
    check_guests(scenario.model(), _engine(scenario), observe, intervene)
    budget = expected(scenario)
    check_memory(scenario, budget, kept_bytes=budget.result_bytes)
    model, seed = scenario.model(), scenario.run.seed
    record = Record(extent(model, seed), pulse=model.pulse)
    run_model(model, seed, record, engine=_engine(scenario), observe=observe, intervene=intervene)
    return record


def run(
    scenario: Scenario,
    path: str | os.PathLike[str],
    *,
    seed: int | None = None,
    force: bool = False,
    command: Sequence[str] | None = None,
    watch: Watch | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
    durable: bool = True,
) -> Run:
    """Run a scenario into a result file and open it; an unfinished run of it there is resumed.

    ``seed`` replaces that of the scenario; ``force`` allows an existing file to be replaced, once the new one is whole;
    ``command`` is what /provenance says was called; ``watch`` is called at the start, before anything is created, and
    after each range of ticks; ``observe`` and ``intervene`` are as in `simulate`, and /provenance names an
    intervention, without which its run cannot be resumed. An exception of either ends the run: a part to resume is
    kept if there was a commit, else nothing. Without ``durable`` the run does not wait until the file is flushed to
    disk, and a power cut within half a minute may take it. Raises OutputRefused before anything is
    created, also where another run did not finish there, ScenarioRefused for a seed that is none, Refused where this
    machine has too little memory or `simulate` would.
    """
    check_output(path, force=force, unfinished=True)
    scenario = _seeded(scenario, seed)
    check_guests(scenario.model(), _engine(scenario), observe, intervene)
    check_disk_space(scenario, expected(scenario), path)
    begun = None if force else interrupted(scenario, path)
    if begun is not None:
        return go_on(path, begun, engine=scenario.run.engine, watch=watch, observe=observe, intervene=intervene)
    description = describe(scenario, path, command or [Path(sys.argv[0]).name, *sys.argv[1:]], intervene)
    if watch is not None:
        watch(0.0, 0, 0)
    with RunWriter(path, description, force=force, durable=durable) as writer:
        play(writer, scenario, watch=watch, observe=observe, intervene=intervene)
    return Run(open_run(path, own=writer.written))


def exact(scenario: Scenario) -> Exact:
    """Return what theory says about a scenario: moments, spectrum and the rest at points, the slider's response."""
    return exact_of_model(scenario.model())


def _engine(scenario: Scenario) -> Engine:
    return cast(Engine, scenario.run.engine)


def _seeded(scenario: Scenario, seed: int | None) -> Scenario:
    """Return the scenario with another seed, so that what is kept of it says what was run."""
    if seed is None:
        return scenario
    try:
        # A fraction would be cut by the generator, and the file would name a seed that cannot be run again.
        number = -1 if isinstance(seed, bool) else index(seed)
    except TypeError:
        number = -1
    if not 0 <= number < SEED_LIMIT:
        raise ScenarioRefused(f"run.seed: {seed} is no whole number from 0 to {SEED_LIMIT - 1}")
    return replace(scenario, run=scenario.run.model_copy(update={"seed": number}))
