"""CPU time of this process and its children, in interleaved repeats."""

import gc
import resource
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from time import process_time


def cpu_time() -> float:
    """Return the CPU time in s that this process and its ended children have used."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return process_time() + children.ru_utime + children.ru_stime


@dataclass(frozen=True)
class Timing:
    """CPU times of the repeats of one task in s, and how many units (junctions, ticks) each repeat worked on."""

    seconds: tuple[float, ...]
    units: float

    @property
    def each(self) -> float:
        """Median CPU time in s of one unit."""
        return median(self.seconds) / self.units

    @property
    def spread(self) -> float:
        """Half the range of the repeats over their median."""
        return (max(self.seconds) - min(self.seconds)) / (2.0 * median(self.seconds))


@dataclass(frozen=True)
class Task:
    """Something to be timed, its number of units, and what is done before it and not timed."""

    call: Callable[[], object]
    units: float
    prepare: Callable[[], object] = lambda: None


def interleaved(tasks: Mapping[str, Task], repeats: int) -> dict[str, Timing]:
    """Return the timings of tasks that take turns, A B C A B C ..., so that a slow minute hits all of them."""
    seconds: dict[str, list[float]] = {name: [] for name in tasks}
    for _ in range(repeats):
        for name, task in tasks.items():
            task.prepare()
            seconds[name].append(_timed(task.call))
    return {name: Timing(tuple(taken), tasks[name].units) for name, taken in seconds.items()}


def _timed(call: Callable[[], object]) -> float:
    gc.collect()
    begin = cpu_time()
    call()
    return cpu_time() - begin
