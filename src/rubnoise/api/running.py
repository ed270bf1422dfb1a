"""Run scenarios, one into memory or a file, or the many of a sweep into a folder; and their theory."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.run import Run
from rubnoise.api.scenarios import load, load_sweep, sizes_of
from rubnoise.api.sweep_result import SweepResult, open_sweep
from rubnoise.errors import Refused
from rubnoise.runs.making import KeptRun, describe, play
from rubnoise.runs.sweep import carry_out
from rubnoise.scenario import Scenario
from rubnoise.scenario.layers import plain
from rubnoise.scenario.reading import place_of
from rubnoise.scenario.sweep import Sweep, loads_sweep
from rubnoise.scenario.text import text_of
from rubnoise.simulation.draws import Engine, extent
from rubnoise.simulation.observer import Intervention, Observer, name_of
from rubnoise.simulation.run import check_guests
from rubnoise.simulation.run import simulate as run_model
from rubnoise.simulation.state import Watch
from rubnoise.storage.forecast import check_disk_space, check_memory, expected
from rubnoise.storage.layout import this_command
from rubnoise.storage.output import check_output
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.writer import RunWriter
from rubnoise.theory.exact import Exact
from rubnoise.theory.exact import exact as exact_of_model


class Record(Run):
    """A run kept in memory: ``record.trace["real_contact_area"]``, with groups and columns named as in a file."""

    _called = "a run in memory"
    _reader: KeptRun

    def __init__(self, kept: KeptRun) -> None:
        super().__init__(kept)
        self.scenario = kept.scenario

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Run:
        """Write the run into a result file and open it: the bits are those of `rubnoise.run`.

        ``force`` allows an existing file to be replaced. Raises OutputRefused if the file may not be written.
        """
        check_output(path, force=force)
        check_disk_space(expected(self.scenario), path)
        description = describe(self.scenario, path, this_command(), self._reader.intervention)
        with RunWriter(path, description, force=force) as writer:
            self._reader.play_into(writer)
            writer.publish(self._reader.summary)
        return Run(open_run(path))

    @contextmanager
    def _file_of(self) -> Iterator[RunFile]:
        with TemporaryDirectory(prefix="rubnoise-") as folder, self.save(Path(folder) / "record.h5") as run:
            yield run.reader()  # type: ignore[misc]


def simulate(
    scenario: Scenario | str | os.PathLike[str],
    seed: int | None = None,
    *,
    engine: Engine | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
    **unknown: Any,
) -> Record:
    """Run a scenario and keep the result in memory: ``simulate("paper/fig5").trace["real_contact_area"]``.

    The scenario is a Scenario, a file, or the name of one that comes with rubnoise. ``seed`` replaces its seed, and
    ``engine``, "events" or "batch", its engine. ``observe`` is called at births, deaths, sticks and so on, when they
    happen, and changes nothing. ``intervene(env, live)`` is a SimPy process beside those of the junctions, which begins
    at the start. ``env.now`` is the distance in um, and ``live`` the LiveJunctions, of which it may end some. An
    exception of either ends the run. Raises ScenarioRefused for an invalid seed, Refused if the memory is too small,
    for an invalid observer or intervention, or for one with the engine "batch".

    >>> import rubnoise
    >>> record = rubnoise.simulate("paper/fig5", seed=7)
    >>> record.trace["real_contact_area"].units, len(record.trace), record.compare().passed
    ('um^2', 200001, True)
    """
    scenario = _asked(scenario, seed, engine, unknown, observe, intervene)
    model, seed, budget = scenario.model(), scenario.run.seed, expected(scenario)
    check_memory(budget, kept_bytes=budget.result_bytes)
    intervention = "" if intervene is None else name_of(intervene)
    kept = KeptRun(extent=extent(model, seed), scenario=scenario, intervention=intervention)
    run_model(model, seed, kept, engine=scenario.run.engine, observe=observe, intervene=intervene)
    kept.protect()
    return Record(kept)


def run(
    scenario: Scenario | str | os.PathLike[str],
    path: str | os.PathLike[str] | None = None,
    *,
    seed: int | None = None,
    force: bool = False,
    command: Sequence[str] | None = None,
    watch: Watch | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
    **unknown: Any,
) -> Run:
    """Run a scenario into a result file and open it; without a path keep it in memory.

    ``scenario``, ``seed``, ``observe`` and ``intervene`` are as in `simulate`; /provenance names an intervention, and
    shows ``command`` as the command line. ``force`` allows an existing file to be replaced, when the new one is
    complete. ``watch`` is called at the start, before anything is created, and after each tick range. An exception, or
    a signal, ends the run, and nothing of it remains; the same call gives the same bits. Raises what `simulate` raises,
    and OutputRefused before anything is created, also if another process writes the same result.

    >>> import rubnoise
    >>> with rubnoise.run("paper/fig4", "fig4.h5", seed=7, force=True) as run:
    ...     run.provenance["seed"]
    7
    """
    if path is None:
        return simulate(scenario, seed, observe=observe, intervene=intervene, **unknown)
    scenario = _asked(scenario, seed, None, unknown, observe, intervene)
    check_output(path, force=force, reads=scenario.files)
    check_disk_space(expected(scenario), path)
    intervention = "" if intervene is None else name_of(intervene)
    description = describe(scenario, path, command or this_command(), intervention)
    if watch is not None:
        watch(0.0, 0, 0)
    with RunWriter(path, description, force=force) as writer:
        play(writer, scenario, watch=watch, observe=observe, intervene=intervene)
    return Run(open_run(path))


def exact(scenario: Scenario | str | os.PathLike[str]) -> Exact:
    """Return what theory says about a scenario: moments, spectrum and the rest at points, the slider's response.

    >>> import rubnoise
    >>> round(rubnoise.exact("paper/fig5").area.mean, 4)
    204.6736
    """
    return exact_of_model(load(scenario).model())


def _asked(source: Any, seed: int | None, engine: Engine | None, unknown: Mapping[str, Any], *guests: Any) -> Scenario:
    """Return the scenario that is to be run, with its seed, so that this one is stored; its text stays as read.

    Refuses unknown keywords, since keys of a scenario belong to `Scenario.replace`, and guests that do not suit it: an
    observer or an intervention.
    """
    for name, value in unknown.items():
        form = f'right form: rubnoise.load("paper/fig5").replace({name}={value!r}), and run that'
        raise Refused(f"{name}=: is no keyword here; {form}")
    scenario = load(source)
    if seed is not None:
        scenario = replace(scenario.replace(seed=seed), text=scenario.text)
    scenario = scenario if engine is None else scenario.replace(engine=engine)
    check_guests(scenario.model(), scenario.run.engine, *guests)
    return scenario


Source = str | os.PathLike[str] | Sweep | Scenario


def sweep(
    scenario: Source,
    folder: str | os.PathLike[str] | None = None,
    *,
    grid: Mapping[str, Sequence[Any]] | None = None,
    replicates: int | None = None,
    jobs: int | None = None,
    executor: Any = None,
    shard: str | None = None,
    force: bool = False,
    **over: Any,
) -> SweepResult:
    """Make every run of a sweep that is not done, and open its folder: ``sweep("paper/fig9", "fig9")``.

    The sweep is a Sweep, a file, or the name of one that comes with rubnoise; or a Scenario, its file or its name, of
    which ``grid``, such as ``{"sliding.speed": ["0.5 mm/s", "1 mm/s"]}``, and ``replicates`` (1 by default) make many
    runs. Further keywords change keys of that scenario, as in `Scenario.replace`; several values,
    ``speed=["0.5 mm/s", "1 mm/s"]``, belong to the grid. Without a folder its runs lie in a temporary one, which goes
    with this process. ``jobs`` processes share the work, by default one for each processor; or an ``executor`` makes
    the runs: the address or the client of a Dask scheduler, or anything with ``submit(function, *arguments)`` that
    returns a Future, which gets ``jobs`` calls at a time. ``shard`` "2/8" makes the second eighth. After a failed run
    the others continue; see ``.failures``. Raises ScenarioRefused; OutputRefused for a folder of something else, or
    that holds the runs of another scenario, which ``force`` leaves there, or that has no room on its disk; Refused if
    memory is too small for so many runs at once.

    >>> import rubnoise
    >>> with rubnoise.sweep("paper/fig9", "fig9", jobs=1) as sweep:
    ...     sweep.keys, len(sweep.points)
    (('interface.mean_junction_count',), 5)
    """
    made = _sweep_of(scenario, grid, replicates, over)
    place = Path(mkdtemp(dir=_temporary().name)) if folder is None else Path(folder)
    carry_out(made, place, jobs=jobs, executor=executor, shard=shard, force=force)
    return open_sweep(place)


def run_sweep(
    file: Source, folder: str | os.PathLike[str] | None = None, *, cluster: str | None = None, **options: Any
) -> SweepResult:
    """Do what `sweep` does, under its old name for one version; ``cluster`` is now one of its executors.

    >>> import rubnoise
    >>> rubnoise.run_sweep("paper/fig9", "fig9", jobs=1).count("done")
    5
    """
    return sweep(file, folder, executor=options.pop("executor", cluster), **options)


@cache
def _temporary() -> "TemporaryDirectory[str]":
    """Return the folder of sweeps that were given none, which goes with this process."""
    return TemporaryDirectory(prefix="rubnoise-sweep-")


def _sweep_of(
    source: Source, grid: Mapping[str, Sequence[Any]] | None, replicates: int | None, over: Mapping[str, Any]
) -> Sweep:
    """Return the sweep; raises ScenarioRefused for a single scenario without a grid."""
    several: dict[str, Any] = {name: each for name, each in over.items() if isinstance(each, list | tuple | np.ndarray)}
    over = {name: value for name, value in over.items() if name not in several}
    grid = {**several, **(grid or {})} if several else grid
    if grid is None and replicates is None and not over and not isinstance(source, Scenario):
        return source if isinstance(source, Sweep) else load_sweep(source)
    if isinstance(source, Sweep):
        raise Refused("grid=: a Sweep has its own grid and replicates; give a Scenario")
    scenario = load(source)
    scenario = scenario.replace(**over) if over else scenario
    if not grid and replicates is None:
        raise Refused('grid= is needed for one scenario, such as grid={"sliding.speed": ["0.5 mm/s", "1 mm/s"]}')
    keys = scenario.resolved()
    if "tick" not in scenario.given.get("output", {}):
        keys["output"].pop("tick")  # its default follows the size of the junctions of each point
    axes = _axes(scenario, grid or {})
    if {"diameter.file", "diameter.column"} & axes.keys():
        keys["diameter"] = {key: value for key, value in keys["diameter"].items() if key not in ("values", "hash")}
    table = {"grid": axes} | ({} if replicates is None else {"replicates": plain(replicates)})
    return loads_sweep(text_of({**keys, "sweep": table}), "grid", read=sizes_of)


def _axes(scenario: Scenario, grid: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Return a grid by full keys, each with its values in the form of a file; raises Refused for a wrong one."""
    axes: dict[str, list[Any]] = {}
    for name, values in grid.items():
        if not isinstance(name, str):
            raise Refused(f"grid=: {name!r:.40} is no name of a key")
        key = ".".join(filter(None, place_of(name, scenario.given, "grid=")))
        if key in axes:
            raise Refused(f"grid=: {name}: {key} is there already; name it once")
        if isinstance(values, str | Mapping) or not hasattr(values, "__iter__") or getattr(values, "ndim", 1) == 0:
            one = keywords.shown(values)
            raise Refused(f'grid=: {key}: {one}: a list of values is needed; right form: grid={{"{key}": [{one}]}}')
        axes[key] = [keywords.unit_text(plain(each)) for each in values]
    return axes
