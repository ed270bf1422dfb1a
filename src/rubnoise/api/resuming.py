"""Unfinished runs resumed, with the same bits."""

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rubnoise.api.result import Run
from rubnoise.api.result import open as open_result
from rubnoise.errors import OutputRefused, Refused, RunFileRefused, RunStopped, ScenarioRefused, resume_hint
from rubnoise.record.sink import Extent
from rubnoise.runs.making import named_constants, play
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import stored
from rubnoise.scenario.reread import as_made
from rubnoise.simulation.block import Watch
from rubnoise.simulation.extent import Engine
from rubnoise.simulation.intervention import Intervention
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import check_guests
from rubnoise.simulation.state import State
from rubnoise.storage.forecast import counted_rows
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.output import OutputPaths, check_locks, check_output, sole_writer
from rubnoise.storage.resume import examined, paths_of, publish_complete
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION

if TYPE_CHECKING:
    from rubnoise.analysis.verification import ResultFile

MOST_DIFFERENCES = 3


def resume(
    part: str | os.PathLike[str],
    *,
    force: bool = False,
    watch: Watch | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
) -> Run:
    """Resume an unfinished run, ``NAME.h5.part``, and open its result, ``NAME.h5``.

    Every dataset equals that of an uninterrupted run, bit for bit. ``force`` allows an existing file to be replaced.
    ``watch`` is called at the point of resumption and after each tick range, ``observe`` for all later events. A run
    that began with an intervention needs it again as ``intervene``: a process that begins at that point. Raises
    RunFileRefused for a part that cannot be read. Raises OutputRefused if the result may not be written, or another
    process writes it. Raises Refused if this version of rubnoise would give other numbers, or if observer and
    intervention do not fit the run.

    >>> import rubnoise
    >>> try:
    ...     rubnoise.resume("nothing.h5.part")
    ... except rubnoise.Refused as refused:
    ...     print(refused)
    nothing.h5.part: no such file
    """
    check_locks(part)
    check_output(paths_of(part).final, force=True, unfinished=True)
    target = Path(part).with_suffix("")
    return go_on(target, _begun(part), force=force, watch=watch, observe=observe, intervene=intervene)


def unfinished_scenario(part: str | os.PathLike[str]) -> Scenario:
    """Return the scenario of an unfinished run; raises as `resume` does."""
    return _stored(_begun(part), str(part))


def _begun(part: str | os.PathLike[str]) -> RunDescription:
    try:
        return examined(paths_of(part))
    except RunFileRefused:
        paths_of(part)  # refuses a part whose run has ended since it was first looked at
        raise


def interrupted(scenario: Scenario, path: str | os.PathLike[str]) -> RunDescription | None:
    """Return the unfinished run at an output path, or None if there is none.

    Raises OutputRefused if it is not a run of this scenario (with any engine), or cannot be read.
    """
    paths = OutputPaths.of(path)
    if not paths.part.exists():
        return None
    part = f"{path}.part"
    try:
        description = examined(paths)
    except RunFileRefused as refusal:
        raise OutputRefused(f"{refusal} (force=True starts over)") from refusal
    resolved = description.scenario_resolved
    different = list(_differences(resolved, as_made(scenario, resolved).resolved()))
    if different:
        more = ["..."] if len(different) > MOST_DIFFERENCES else []
        raise OutputRefused(
            f"{part}: belongs to another run: {'; '.join(different[:MOST_DIFFERENCES] + more)}"
            f" (force=True starts over; {resume_hint(part)})"
        )
    return description


def go_on(
    path: str | os.PathLike[str],
    description: RunDescription,
    *,
    engine: str | None = None,
    force: bool = False,
    watch: Watch | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
) -> Run:
    """Resume the described run, whose part belongs to an output path, with its own engine or another one."""
    paths = OutputPaths.of(path)
    try:
        with sole_writer(paths):
            whole = publish_complete(paths, _check, force=force)
        if not whole:
            scenario = _scenario(description, f"{path}.part", engine)
            check_guests(scenario.model(), cast(Engine, scenario.run.engine), observe, intervene)
            _check_intervention(description, f"{path}.part", intervene)
            with RunWriter(path, None, force=force) as writer:
                if watch is not None:
                    watch(*_reached(writer.state, scenario.model().tick))
                play(writer, scenario, watch=watch, observe=observe, intervene=intervene)
    except RunStopped as stopped:
        stopped.kept = f"{path}.part"
        raise
    return open_result(path)


def _check(run: "ResultFile") -> None:
    """Refuse a part that is marked as complete and does not pass `verify`."""
    from rubnoise.analysis.verification import verify  # which few runs need

    try:
        wrong = [str(check.first) for check in verify(run).different]
    except (ArithmeticError, ValueError, IndexError) as problem:
        wrong = [" ".join(str(problem).split())]
    if wrong:
        raise RunFileRefused(f"{run.path}: damaged: {wrong[0]}; rubnoise.run(..., force=True) starts over")


def _check_intervention(description: RunDescription, part: str, intervene: Intervention | None) -> None:
    """Refuse to resume a run without the intervention that it was begun with, or with one that it was begun without."""
    begun = description.provenance.intervention
    if begun and intervene is None:
        raise Refused(
            f"{part}: an intervention, {begun}, takes part in this run; in Python"
            " rubnoise.resume(..., intervene=...) resumes it, rubnoise.run(..., force=True) starts over without it"
        )
    if intervene is not None and not begun:
        raise Refused(f"{part}: this run began without an intervention; resume it without one")


def _reached(state: State | None, tick: float) -> tuple[float, int, int]:
    """Return the arguments of a watch at a state: distance reached in um, junctions born, live count."""
    return (0.0, 0, 0) if state is None else (max(state.ticks - 1, 0) * tick, state.junctions, len(state.live))


def _scenario(description: RunDescription, part: str, engine: str | None) -> Scenario:
    """Return the scenario of a run; raises Refused if resuming it here would not give the same numbers."""
    scenario = _stored(description, part)
    for reason in _obstacles(scenario, description):
        made_by = description.provenance.software.get("rubnoise", "of another version")
        raise Refused(f"{part}: {reason}; rubnoise {made_by} can resume it, rubnoise.run(..., force=True) starts over")
    if engine is None:
        return scenario
    return replace(scenario, run=replace(scenario.run, engine=engine))


def _stored(description: RunDescription, part: str) -> Scenario:
    """Return the scenario in a part; raises RunFileRefused if it is not valid."""
    scenario = stored(description.scenario_resolved, what := f"{part}: the scenario in the file")
    try:
        scenario.check_size()
    except ScenarioRefused as problem:
        raise RunFileRefused(f"{what} is not valid") from problem
    return scenario


def _obstacles(scenario: Scenario, description: RunDescription) -> Iterator[str]:
    model, origin = scenario.model(), description.provenance
    if origin.seed != scenario.run.seed:
        yield f"has seed {origin.seed}, and its scenario has {scenario.run.seed}"
    elif origin.stream_version != STREAM_VERSION:
        yield f"has random numbers of stream version {origin.stream_version}, and here they are of {STREAM_VERSION}"
    elif origin.calibrated_diameter != model.calibrated_diameter:
        yield f"has calibrated diameter {origin.calibrated_diameter!r} um, here it is {model.calibrated_diameter!r} um"
    elif dict(origin.propagator_constants) != named_constants(model):
        yield "has other constants of the slider's step than here"
    elif not _has_its_rows(scenario, description):
        yield "has another number of rows than here"


def _has_its_rows(scenario: Scenario, description: RunDescription) -> bool:
    """Whether a part has as many rows as its run."""
    here = counted_rows(scenario, description.extent)
    growing: dict[str, Any] = {each.name: None for each in fields(Extent) if getattr(here, each.name, 0) is None}
    return here is not None and here == replace(description.extent, **growing)


def _differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys in which two resolved scenarios differ, except the engine, which changes no bit."""
    one, other = _flat(there), _flat(here)
    for key in dict.fromkeys([*one, *other]):
        if key != "run.engine" and one.get(key) != other.get(key):
            yield f"{key} is {_told(one.get(key))} there and {_told(other.get(key))} here"


def _flat(scenario: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in scenario.items():
        if isinstance(value, Mapping):
            found |= {f"{name}.{key}": each for key, each in value.items()}
        else:
            found[name] = value
    return found


def _told(value: object) -> str:
    return "absent" if value is None else json.dumps(value, ensure_ascii=False)
