"""The forecast of memory and processor time of a run, from a few measured constants.

A few milliseconds of work like that of a run measure how fast this machine is. `tools/studies run_cost` measures runs
of many kinds; it prints how far these forecasts are off, and which constants would fit the machine on which it runs.
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from functools import cache
from heapq import heappop, heappush
from math import ceil, inf
from time import perf_counter
from typing import Final

import numpy as np

from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.simulation.draws import births_drawn_at_once, births_per_block
from rubnoise.simulation.extent import Engine
from rubnoise.simulation.ticks import LARGEST_TICK_RANGE, cells_per_tick, coupled_spacing, narrow

REPEATS: Final = 5
EVENTS: Final = 500
VALUES: Final = 4096
TERMS: Final = 30

EVENTS_SECONDS: Final = 4.2e-4
TERMS_SECONDS: Final = 6.6e-5
"""Times of the two pieces of work on the machine on which the constants of this module were measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineSpeed:
    """How many times longer a machine takes than the reference machine: for process steps, and for sums over arrays."""

    processes: float = 1.0
    arrays: float = 1.0


@cache
def machine_speed() -> MachineSpeed:
    """Return how fast this machine is, measured once per process: the best of a few repeats of about 0.3 ms."""
    return MachineSpeed(processes=_best(_step) / EVENTS_SECONDS, arrays=_best(_sum) / TERMS_SECONDS)


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


PROGRAM_BYTES: Final = 218_000_000
"""Memory of a process before the run, with everything loaded that a run needs."""

DRAWN_BYTES: Final = 50
ROW_BYTES: Final[Mapping[Engine, int]] = {"events": 480, "batch": 260}
ALIVE_BYTES: Final[Mapping[Engine, int]] = {"events": 1000, "batch": 0}
POSITION_BYTES: Final = 140
"""Memory for each birth drawn in a block, each row of the block that is played, each junction alive at the same time,
and each position of a tick range."""

PROGRAM_SECONDS: Final = 1.2
"""Time to start the program and to load everything."""

SECONDS: Final[Mapping[str, float]] = {
    "run": 1.5e-2,
    "draw": 6e-8,
    "row": 2.2e-7,
    "event": 1.1e-6,
    "crowd": 4.2e-8,
    "tick": 1.3e-8,
    "overlap": 2.2e-10,
    "off-centre overlap": 4.4e-10,
    "cell": 1.2e-8,
    "push": 1.3e-9,
    "fine push": 8.0e-10,
    "off-centre push": 4.5e-9,
    "growing": 1.2e-2,
    "met": 6.0e-7,
    "written row": 1.3e-7,
    "row life": 4.5e-9,
    "slow cell": 1.6e-7,
    "swing": 1.7e-7,
    "packed byte": 1.7e-8,
}
"""Time of one unit of each kind of work; `work` counts the units."""

IN_PROCESSES: Final = frozenset({"run", "event", "crowd"})
CROWDING: Final = 0.4
"""Power of the live count with which an event costs more: the memory of live junctions is visited at random."""


def working_bytes(model: Model, engine: Engine) -> int:
    """Return the memory that a run needs besides its program: one block and one tick range, however long the run is."""
    drawn, alive = births_drawn_at_once(model), _alive(model)
    played = min(drawn, model.birth_rate * model.distance) + alive
    positions = min(LARGEST_TICK_RANGE, (model.tick_count + 1) * cells_per_tick(model))
    junctions = DRAWN_BYTES * drawn + ROW_BYTES[engine] * played + ALIVE_BYTES[engine] * alive
    return round(junctions + POSITION_BYTES * positions)


def work(model: Model, engine: Engine, junctions: int, ticks: int) -> dict[str, float]:
    """Return the amount of each kind of work in a run with these numbers of rows and ticks.

    The kinds are births to draw, in whole blocks; rows to make and to write; events, and their higher cost among many
    live junctions ("crowd"); ticks; overlaps, one for each junction at each tick of its life; cells of the slider's
    ticks; pushes, one for each junction in each cell of its life; and those of `_two_way_work`.
    """
    alive, events = _alive(model), 2 * junctions if engine == "events" else 0
    summed = 1 if model.strengths is None or isinstance(model.strengths, Fixed) else 2
    moves = not model.is_two_way and (model.slider is not None or model.separation is not None)
    cells = cells_per_tick(model) if moves else 0
    centred = model.pulse.offset == "none"
    overlaps = "overlap" if centred else "off-centre overlap"
    pushes = ("fine push" if narrow(model, cells) else "push") if centred else "off-centre push"
    return {
        "run": 1.0,
        "draw": ceil(max(junctions - alive, 1.0) / births_per_block(model)) * births_per_block(model),
        "row": junctions,
        "event": events,
        "crowd": events * alive**CROWDING,
        "tick": ticks,
        overlaps: ticks * alive * summed,
        "cell": ticks * cells,
        pushes: ticks * cells * alive,
    } | _two_way_work(model, junctions, ticks)


def _two_way_work(model: Model, junctions: int, ticks: int) -> dict[str, float]:
    """Return the work of a two-way slider: its growing file, junctions met, rows, lives in them, slow cells, swings.

    Rows in sticks cost little: at a low speed the slider sticks four fifths of the time. When it hardly moves, a cell
    needs extra steps; the share of such cells goes as (V/V_0)^-0.2 N_jm^-0.5, where V_0 is the deflection times
    omega_0. A swing is a time of 1/omega_0, with at least one step. All of this is a fit to the measured times of runs.
    """
    slider, speed, strengths = model.slider, model.sliding_speed, model.strengths
    if not model.is_two_way or slider is None or speed is None or strengths is None:
        return {}
    omega = slider.natural_angular_frequency
    deflection = strengths.moment(1) * model.stationary_mean_area / slider.stiffness
    part = speed / (deflection * omega) if deflection else inf
    moving, count = ticks * min(0.2 + 2.4 * part, 1.0), max(model.mean_junction_count, 0.3)
    return {
        "growing": 1.0,
        "met": junctions,
        "written row": moving,
        "row life": moving * count,
        "slow cell": model.distance / coupled_spacing(model) * part**-0.2 * count**-0.5,
        "swing": model.distance / speed * omega,
    }


def seconds(amounts: Mapping[str, float], machine_speed: MachineSpeed) -> float:
    """Return how long these amounts of work take one process on such a machine, without the start of the program."""
    return sum(
        amount * SECONDS[kind] * (machine_speed.processes if kind in IN_PROCESSES else machine_speed.arrays)
        for kind, amount in amounts.items()
    )


def _alive(model: Model) -> float:
    return model.birth_rate * model.pulse.mean_life * model.sizes.moment(1)
