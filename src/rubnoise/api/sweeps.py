"""Sweeps: all runs of a file with a table [sweep], or of a scenario with a grid, into one folder."""

import os
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory, mkdtemp
from typing import Any

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.scenarios import load, load_sweep, sizes_of
from rubnoise.api.sweep_result import SweepResult, open_sweep
from rubnoise.errors import Refused
from rubnoise.runs.sweep import carry_out
from rubnoise.scenario import Scenario
from rubnoise.scenario.layers import plain
from rubnoise.scenario.reading import place_of
from rubnoise.scenario.sweep import Sweep, loads_sweep
from rubnoise.scenario.text import text_of

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
