"""Forecast the rows, bytes and memory of a run before its first event, and refuse a run that does not fit."""

import os
import resource
import shutil
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import ceil, floor
from mmap import PAGESIZE
from pathlib import Path
from typing import Final

from rubnoise.errors import OutputRefused, Refused
from rubnoise.model import Model
from rubnoise.record.rows import Extent, extent_of
from rubnoise.scenario import Scenario
from rubnoise.simulation.draws import PROGRAM_BYTES, extent, working_bytes
from rubnoise.storage.layout import expected_bytes, features_of
from rubnoise.storage.output import part_of
from rubnoise.theory.moments import expected_junction_rows, force_cumulants
from rubnoise.theory.motion import response

FAR: Final = 10.0  # standard deviations beyond which nothing is taken to lie
ROOT = Path("/")  # where the files are in which Linux says what memory there is


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """What one run of a ``scenario`` needs.

    result_bytes: of the result before compression, within some kilobytes; disk_bytes: what has to be free for it, with
    the rows that wait beside a part if it is compressed, or their number is not known; working_bytes: memory beside the
    program's own, about; slider_rows_at_most: of /slider in a two-way run, None in others.
    """

    scenario: Scenario
    junctions: int
    ticks: int
    result_bytes: int
    disk_bytes: int
    working_bytes: int
    slider_rows_at_most: int | None = None

    @property
    def peak_bytes(self) -> int:
        """About the peak memory of a process in bytes; for this process, with what it holds already."""
        return max(PROGRAM_BYTES, memory_in_use()) + self.working_bytes

    @property
    def fewer_rows(self) -> str:
        """Advice on the keys to change for a smaller result."""
        model = self.scenario.model()
        sparse = model.tick * model.birth_rate < 1.0
        other = "output.tick longer" if sparse else "interface.mean_junction_count smaller"
        return f"make sliding.distance shorter or {other}"


def counted(scenario: Scenario) -> Budget:
    """Return the budget of a run, its rows counted from its seed in some 60 ns a birth; raises as `expected` does."""
    scenario.check_size()
    return _budget(scenario, extent(scenario.model(), scenario.run.seed))


def expected(scenario: Scenario) -> Budget:
    """Return the budget of a run with as many rows as are expected of any seed; nothing is drawn.

    Raises ScenarioRefused for more rows, or more live junctions, than rubnoise can write.
    """
    scenario.check_size()
    model = scenario.model()
    return _budget(scenario, extent_of(model, round(expected_junction_rows(model))))


def _budget(scenario: Scenario, rows: Extent) -> Budget:
    model = scenario.model()
    most, features = rows_at_most(model, rows), features_of(model)
    columns = expected_bytes(most, features)
    size = columns + len(scenario.text.encode())
    # Rows that grow, and all of a compressed file, lie beside the part until they are copied into it.
    beside = size if scenario.output.compression == "gzip" else columns - expected_bytes(rows, features)
    return Budget(
        scenario=scenario,
        junctions=round(expected_junction_rows(model)) if rows["junctions"] is None else rows["junctions"],
        ticks=model.tick_count + 1,
        result_bytes=size,
        disk_bytes=size + beside,
        working_bytes=working_bytes(model, scenario.run.engine),
        slider_rows_at_most=most["slider"] if model.is_two_way else None,
    )


def rows_at_most(model: Model, rows: Extent) -> Extent:
    """Return how many rows there are at most if only the end of a run shows it: of a two-way or a free slider.

    Rows that are known stay as they are. The slider comes to the end at T = (distance + x_T - x_0)/V. While w >= 0
    friction adds nothing to m x'^2/2 + (k x - F)^2/2k, F the largest force on the way, and x' <= V; so x <= F/k +
    V/omega_0, but for what a reversal brings along. F: ten standard deviations above the mean; twice V/omega_0 are
    left. A slider too fast to stick stays much nearer, within ten times what two-way coupling makes of its spread at
    most, or twice the deflection from rest. It sticks once in half a period of its own at most, about. A free slider
    touches summits at most four times as often as at constant separation, about, and leaves each once.
    """
    if model.free is not None:
        touches = 4 * round(expected_junction_rows(model)) + 1000
        return {**rows, "junctions": touches, "landmarks": 2 * touches}
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or model.strengths is None or rows["slider"] is not None:
        return rows
    force, motion = force_cumulants(model), response(model)
    push = (force.mean + FAR * force.std) / slider.stiffness
    highest = min(
        push + 2.0 * speed / slider.natural_angular_frequency, 2.0 * push + 2.0 * FAR * motion.displacement_std
    )
    moments = floor((model.distance + highest - model.equilibrium_displacement) / model.tick) + 2
    periods = moments * (model.tick / speed) * slider.natural_frequency
    return {**rows, "slider": moments, "landmarks": ceil(4.0 * periods) + 16}


def check_disk_space(budget: Budget, path: str | os.PathLike[str]) -> None:
    """Raise OutputRefused, naming keys to change, if the disk has no room for a result; see also `check_memory`."""
    room, needed, advice = free_disk_bytes(path), budget.disk_bytes, budget.fewer_rows
    if needed > room:
        what = "the result" if needed == budget.result_bytes else "the result and the rows that wait beside it"
        if budget.result_bytes <= room and budget.scenario.output.compression == "gzip":
            advice = 'output.compression = "none" lets none wait'
        there = f"{Path(path).absolute().parent} has room for {room:,}"
        raise OutputRefused(f"{path}: {what} may take {needed:,} bytes, and {there}; {advice}")
    check_memory(budget)


def check_memory(budget: Budget, *, kept_bytes: int = 0) -> None:
    """Raise Refused, naming keys to change, if memory is too small for a run and ``kept_bytes`` of its result."""
    room, more = free_memory_bytes(), budget.peak_bytes - memory_in_use() + kept_bytes
    if room is None or more <= room:
        return
    remedy = "make interface.mean_junction_count smaller"
    if budget.working_bytes <= kept_bytes:
        remedy = budget.fewer_rows
    elif more - room <= budget.working_bytes - working_bytes(budget.scenario.model(), "batch"):
        remedy = 'run.engine = "batch" needs less'
    raise _no_memory("the run needs", more, room, remedy, " more")


def check_sweep_space(runs: Sequence[Scenario], folder: Path, *, jobs: int, keep: str) -> None:
    """Raise OutputRefused or Refused if disk or memory are too small for a sweep; its folder may still be missing."""
    alike = Counter(scenario.model() for scenario in runs)
    budgets = {model: expected(scenario) for model, scenario in {each.model(): each for each in runs}.items()}
    size = sum(alike[model] * each.result_bytes for model, each in budgets.items())
    size += max(each.disk_bytes - each.result_bytes for each in budgets.values())
    there = next(place for place in (folder, *folder.absolute().parents) if place.is_dir())
    if keep == "runs" and size > (room := free_disk_bytes(there / "run.h5")):
        raise OutputRefused(
            f"{folder}: the results of {len(runs):,} runs may take {size:,} bytes, and there is room for {room:,};"
            ' sweep.keep = "summary" keeps kilobytes of each run, or make sliding.distance shorter or sweep.replicates'
            " fewer"
        )
    each = PROGRAM_BYTES + max(budget.working_bytes for budget in budgets.values())
    memory, jobs = free_memory_bytes(), min(jobs, len(runs))
    if memory is not None and jobs * each > memory:
        fits = f"jobs={memory // each} fits" if memory >= each else "make interface.mean_junction_count smaller"
        raise _no_memory(f"{jobs} runs at once need", jobs * each, memory, fits)


def _no_memory(who: str, needed: int, room: int, remedy: str, more: str = "") -> Refused:
    told, left = (f"{count / 1e6:,.0f} MB" for count in (needed, room))
    return Refused(f"{who} about {told} of memory{more}, and {left} are left; {remedy}")


BLOCK_BYTES: Final = 512


def free_disk_bytes(path: str | os.PathLike[str]) -> int:
    """Return the number of bytes that may be written at a path: the free space of its disk, at most RLIMIT_FSIZE.

    The space of a part file counts as free: the new result uses it or gives it back.
    Raises OSError if the folder does not exist.
    """
    final = Path(path).absolute()
    room, most = shutil.disk_usage(final.parent).free, resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    with suppress(FileNotFoundError):
        room += part_of(final).lstat().st_blocks * BLOCK_BYTES
    return room if most == resource.RLIM_INFINITY else min(room, most)


def memory_in_use(which: int = 1) -> int:
    """Return the bytes of memory that this process holds, or of its address space (0); 0 if the system does not say."""
    return int(_said("proc/self/statm", "0 0").split()[which]) * PAGESIZE


def free_memory_bytes() -> int | None:
    """Return what machine, container and `ulimit -v` leave this process of memory in bytes; None if unknown."""
    left = []
    # Inside a container the name of its control group may belong to the host's tree: what is missing says nothing.
    inner = Path(_said("proc/self/cgroup").partition("0::/")[2].strip())
    for group in (inner, *inner.parents):
        limit = _said(f"sys/fs/cgroup/{group}/memory.max").strip()
        left += [int(limit) - memory_in_use()] if limit.isdecimal() else []
    if (address_space := resource.getrlimit(resource.RLIMIT_AS)[0]) != resource.RLIM_INFINITY:
        left.append(address_space - memory_in_use(0))
    if available := _said("proc/meminfo").partition("MemAvailable:")[2]:
        left.append(int(available.split(maxsplit=1)[0]) * 1024)
    elif "SC_PHYS_PAGES" in os.sysconf_names:
        left.append(os.sysconf("SC_PHYS_PAGES") * PAGESIZE)
    return max(min(left), 0) if left else None


def _said(name: str, without: str = "") -> str:
    """Return the text of a file of the system, or what stands for one that is missing."""
    with suppress(OSError):
        return (ROOT / name).read_text(encoding="utf-8", errors="replace")
    return without
