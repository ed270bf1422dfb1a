"""Sweeps: all runs of a file with a table [sweep], on this machine or on a cluster, into one folder."""

import os
import sys
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from operator import index
from pathlib import Path
from shlex import join
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any, ClassVar, Final, Self, cast
from weakref import finalize

from numpy.typing import NDArray

from rubnoise.analysis.run_summary import SummarySink, curve_theory
from rubnoise.api import keywords
from rubnoise.api.running import run
from rubnoise.api.scenarios import load, load_sweep, sizes_of
from rubnoise.api.sweep_result import SweepResult, open_sweep
from rubnoise.errors import OutputRefused, Refused
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.scenario.layers import plain
from rubnoise.scenario.points import Point, points_of
from rubnoise.scenario.reading import place_of
from rubnoise.scenario.sweep import Sweep, loads_sweep
from rubnoise.scenario.writing import text_of
from rubnoise.simulation.block import Watch
from rubnoise.simulation.extent import Engine
from rubnoise.simulation.run import simulate
from rubnoise.storage.forecast import check_sweep_space, expected, together
from rubnoise.storage.output import OutputInUse, check_locks
from rubnoise.sweep.cluster import Cluster
from rubnoise.sweep.conduct import SweepMeans, SweepOutcome, SweepProgress, conduct
from rubnoise.sweep.execution import Workers
from rubnoise.sweep.folder import Shard, SweepFolder
from rubnoise.sweep.journal import RunRow
from rubnoise.sweep.pool import CANCELLATION, Pool
from rubnoise.sweep.run_status import found_run


def keep_summary(point: Point, *, watch: Watch = CANCELLATION.check) -> RunRow:
    """Make one run of a sweep and return its summary, without writing a file.

    The arrays are those of `rubnoise.analysis.run_summary.CURVES`; ``watch`` is called after each panel and may raise,
    as the default does after the sweep received a signal to stop.
    """
    model = point.scenario.model()
    sink = SummarySink(model)
    simulate(model, point.seed, sink, engine=cast(Engine, point.scenario.run.engine), watch=watch)
    summary = sink.finish()
    figures: dict[str, float] = {}
    for figure in summary.figures:
        figures |= figure.as_attributes()
    of_point = summary_theory(model) if point.replicate == 0 else {}
    return RunRow(run_id=point.run_id, figures=figures, arrays=summary.curves, of_point=of_point)


def summary_theory(model: Model) -> dict[str, NDArray[Any]]:
    """Return the places of the curves in a model's summaries and their expected values: `spectrum_place` and so on.

    They are equal for all runs of a point; nan if theory has none.
    """
    return {
        f"{name}_{part}": getattr(theory, part)
        for name, theory in curve_theory(model).items()
        for part in ("place", "expected", "standard_error")
        # The histogram's errors are those of each run.
        if (name, part) != ("histogram", "standard_error")
    }


MOST_JOBS: Final = 1024
PATIENCE: Final = 60.0
BETWEEN: Final = 0.2
"""Seconds that a run waits for another process to be done with its file, and between two looks at it."""

ProgressWatch = Callable[[SweepProgress], None]


def run_sweep(
    file: str | os.PathLike[str] | Sweep | Scenario,
    folder: str | os.PathLike[str] | None = None,
    *,
    grid: Mapping[str, Sequence[Any]] | None = None,
    replicates: int | None = None,
    jobs: int | None = None,
    cluster: str | None = None,
    shard: str | None = None,
    security: Any = None,
) -> SweepResult:
    """Make every unfinished run of a sweep, and open its folder: ``run_sweep("paper/fig9", "fig9")``.

    The sweep is a Sweep, a file, or the name of one that comes with rubnoise. With ``grid``, such as
    ``{"sliding.speed": ["0.5 mm/s", "1 mm/s"]}``, it is a Scenario, a file or a name that the grid and ``replicates``
    make many runs of; a key of only one table needs no dots. Without a folder its runs lie in a temporary one, which
    goes with the last copy of the result, or with this process if it was pickled. ``jobs`` processes share the work, by
    default one for each processor. With ``cluster`` the workers of a Dask scheduler share it; give its address or its
    file, and a ``distributed.Security`` as ``security`` for TLS. ``shard`` "2/8" makes the second eighth. After a
    failed run the others continue; see ``.failures``. Raises ScenarioRefused. Raises OutputRefused for a folder that is
    not this sweep's, is in use, or has no room on its disk. Raises Refused if memory is too small for so many runs at
    once, and ExtraMissing without the library of a cluster.

    >>> import rubnoise
    >>> with rubnoise.run_sweep("paper/fig9", "fig9", jobs=1) as sweep:
    ...     sweep.keys, len(sweep.points)
    (('interface.mean_junction_count',), 5)
    """
    sweep = _sweep_of(file, grid, replicates)
    place = Path(mkdtemp(prefix="rubnoise-sweep-")) if folder is None else Path(folder)
    try:
        carry_out(sweep, place, jobs=jobs, cluster=cluster, shard=shard, security=security)
        result = open_sweep(place)
    except BaseException:
        if folder is None:
            rmtree(place, ignore_errors=True)
        raise
    if folder is None:
        result.temporary = TemporaryFolder(place)
    return result


class TemporaryFolder:
    """Removes a folder when the last reference to it is gone, at the latest when the process ends."""

    PICKLED: ClassVar[list["TemporaryFolder"]] = []
    """Those of pickles, which may be read as long as the process runs."""

    def __init__(self, path: Path) -> None:
        """Take over a folder."""
        self.path = path
        finalize(self, _removed, path, os.getpid())

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        self.PICKLED.append(self)
        return Path, (self.path,)


def _removed(path: Path, process: int) -> None:
    if os.getpid() == process:  # and no copy of it, which ends earlier
        rmtree(path, ignore_errors=True)


def _sweep_of(
    source: str | os.PathLike[str] | Sweep | Scenario, grid: Mapping[str, Sequence[Any]] | None, replicates: int | None
) -> Sweep:
    """Return the sweep; raises ScenarioRefused for a single scenario without a grid."""
    if isinstance(source, Sweep) or (grid is None and replicates is None and not isinstance(source, Scenario)):
        if isinstance(source, Sweep) and not (grid is None and replicates is None):
            raise Refused("grid=: a Sweep has its own grid and replicates; give a Scenario")
        return source if isinstance(source, Sweep) else load_sweep(source)
    scenario = load(source)
    if not grid and replicates is None:
        raise Refused('grid= is needed for one scenario, such as grid={"sliding.speed": ["0.5 mm/s", "1 mm/s"]}')
    keys = scenario.resolved()
    if "tick" not in scenario.given.get("output", {}):
        keys["output"].pop("tick")  # its default follows the size of the junctions of each point
    axes = _axes(scenario, grid or {})
    if {"diameter.file", "diameter.column"} & axes.keys():
        keys["diameter"] = {key: value for key, value in keys["diameter"].items() if key not in ("values", "hash")}
    table: dict[str, Any] = {"grid": axes}
    if replicates is not None:
        table["replicates"] = plain(replicates)
    return loads_sweep(text_of({**keys, "sweep": table}), "grid", read=sizes_of)


def _axes(scenario: Scenario, grid: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Return a grid by full keys, each with its values; raises Refused for an unknown or repeated key."""
    axes: dict[str, list[Any]] = {}
    for name, values in grid.items():
        if not isinstance(name, str):
            raise Refused(f"grid=: {name!r:.40} is no name of a key")
        key = ".".join(part for part in place_of(name, scenario.given, "grid=") if part)
        if key in axes:
            raise Refused(f"grid=: {name}: {key} is there already; name it once")
        axes[key] = _values(key, values)
    return axes


def _values(key: str, values: Any) -> list[Any]:
    """Return the values of a key in the form of a file: numbers of Python, and texts for quantities of pint."""
    try:
        several = None if isinstance(values, str | Mapping) else list(values)
    except TypeError:
        several = None
    if several is None:
        one = keywords.shown(values)
        raise Refused(f'grid=: {key}: {one}: a list of values is needed; right form: grid={{"{key}": [{one}]}}')
    return [keywords.unit_text(plain(each)) for each in several]


def carry_out(
    sweep: Sweep,
    folder: str | os.PathLike[str],
    *,
    jobs: int | None = None,
    cluster: str | None = None,
    shard: str | None = None,
    security: Any = None,
    command: Sequence[str] | None = None,
    watch: ProgressWatch = lambda _standing: None,
) -> SweepOutcome:
    """Carry out a sweep, and return its outcome; see run_sweep.

    ``command`` is the command line in its results, ``watch`` is called with the progress, and may raise RunStopped.
    """
    check_locks(folder)
    place = SweepFolder(Path(folder).absolute())
    part = None if shard is None else Shard.of(shard)
    workers = _workers(jobs, cluster, security)
    place.check()
    command = tuple(command or [Path(sys.argv[0]).name, *sys.argv[1:]])
    here = 0 if cluster is not None else jobs or processors()
    means = SweepMeans(
        work=_work(sweep, place, command, durable=cluster is not None),
        workers=workers,
        recover=partial(found_run, root=place.root) if sweep.keep == "runs" else None,
        affordable=partial(_check_room, sweep, place, here),
        watch=watch,
        synced=cluster is not None or sweep.keep == "summary",
    )
    if not place.root.exists():  # nothing is made before it is known that there is room
        points = points_of(sweep.cases, sweep.replicates)
        means.affordable(points if part is None else part.of_points(points, points))
    return conduct(place, sweep, means, shard=part, command=join(command))


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _workers(jobs: int | None, cluster: str | None, security: Any) -> Callable[[], AbstractContextManager[Workers]]:
    if cluster is not None:
        if jobs is not None:
            raise Refused("jobs=: the workers of a cluster are its own; leave one of jobs= and cluster= out")
        return partial(Cluster, cluster, security)
    if security is not None:
        raise Refused("security=: is for a cluster, and none is named")
    if jobs is not None and not 1 <= index(jobs) <= MOST_JOBS:
        raise Refused(f"jobs=: {jobs} is no number of processes from 1 to {MOST_JOBS}")
    return partial(Pool, processors() if jobs is None else index(jobs))


def _work(sweep: Sweep, folder: SweepFolder, command: Sequence[str], *, durable: bool) -> Callable[[Point], RunRow]:
    if sweep.keep == "summary":
        return keep_summary
    return partial(keep_run, root=folder.root, command=tuple(command), durable=durable)


def keep_run(
    point: Point, *, root: Path, command: Sequence[str], patience: float = PATIENCE, durable: bool = True
) -> RunRow:
    """Make one run of a sweep into its own file, and return its row; an existing result is used.

    A file that another process is writing, such as a worker that has not noticed yet that its sweep was stopped, is
    waited for so many seconds. Without ``durable`` the file is on
    the disk only after a later flush (see sync_many). Raises OutputRefused for one in its place that is not the run.
    """
    last = time.monotonic() + patience
    while (row := found_run(point, root=root)) is None:
        try:
            row = _made(point, SweepFolder(root), command, durable=durable)
            break
        except OutputInUse:
            if time.monotonic() >= last:
                raise
            CANCELLATION.check(0.0, 0, 0)
            time.sleep(BETWEEN)
    return row


def _made(point: Point, folder: SweepFolder, command: Sequence[str], *, durable: bool) -> RunRow:
    path = folder.run(point.run_id)
    if path.exists():
        if (row := found_run(point, root=folder.root)) is not None:
            return row  # another process has just made it
        raise OutputRefused(f"{path}: is not the result of this run; move it away, and the same command makes it")
    with run(point.scenario, path, command=command, watch=CANCELLATION.check, durable=durable) as result:
        figures: dict[str, float] = {}
        for figure in result.summary:
            figures |= figure.as_attributes()
    return RunRow(run_id=point.run_id, file=folder.relative(point.run_id), figures=figures)


def _check_room(sweep: Sweep, folder: SweepFolder, jobs: int, points: Sequence[Point]) -> None:
    """Refuse a sweep if its results do not fit on the disk, or the runs at one time not into memory."""
    counts = Counter(point.scenario.model() for point in points)
    one_of_each = {point.scenario.model(): point.scenario for point in points}
    budget = together((expected(one_of_each[model]), count) for model, count in counts.items())
    if sweep.keep == "summary":
        budget = replace(budget, result_bytes=0, disk_bytes=0)
    check_sweep_space(budget, folder.root, jobs=min(jobs, len(points)))
