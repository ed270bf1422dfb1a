"""How fast a machine is, told from a few milliseconds of work like that of a run."""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from functools import cache
from heapq import heappop, heappush
from time import perf_counter
from typing import Final

import numpy as np

REPEATS: Final = 5
EVENTS: Final = 500
VALUES: Final = 4096
TERMS: Final = 30

EVENTS_SECONDS: Final = 4.2e-4
TERMS_SECONDS: Final = 6.6e-5
"""What the two pieces of work took where the constants of `rubnoise.simulation.cost` were measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """How many times longer a machine takes than the measured one: for steps of processes, and for sums over arrays."""

    processes: float = 1.0
    arrays: float = 1.0


@cache
def pace() -> Pace:
    """Return the pace of this machine, measured once in a process: the best of a few repeats of some 0.3 ms."""
    return Pace(processes=_best(_step) / EVENTS_SECONDS, arrays=_best(_sum) / TERMS_SECONDS)


def _best(work: Callable[[], None]) -> float:
    return min(_timed(work) for _ in range(REPEATS))


def _timed(work: Callable[[], None]) -> float:
    begin = perf_counter()
    work()
    return perf_counter() - begin


def _step() -> None:
    """Wake generators in the order of a queue, as an event loop does."""
    queue: list[tuple[float, int, Generator[float, None, None]]] = []
    for number in range(EVENTS):
        heappush(queue, (float(number * 7919 % EVENTS), number, _sleeper(float(number))))
    while queue:
        place, number, sleeper = heappop(queue)
        for wait in sleeper:
            heappush(queue, (place + wait, number, sleeper))
            break


def _sleeper(wait: float) -> Generator[float, None, None]:
    yield wait


def _sum() -> None:
    """Evaluate a polynomial over an array that fits into the processor's cache."""
    values = np.linspace(0.0, 1.0, VALUES)
    total = np.zeros(VALUES)
    for _ in range(TERMS):
        total *= values
        total += 0.5
