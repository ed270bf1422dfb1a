"""The story of a contact, as processes: junctions are born, live through 2d of sliding, and die.

Distance is the clock: ``env.now`` is the sliding distance in um. Only births and deaths are events; the aggregator and
the slider wake for a panel of ticks at a time and see in it exactly the junctions that joined and left before.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import inf

from simpy import Environment, Interrupt, Process
from simpy.events import Event, ProcessGenerator

from rubnoise.simulation.area import Sample
from rubnoise.simulation.clock import DistanceClock
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.intervention import Intervening
from rubnoise.simulation.live_set import LiveSet
from rubnoise.simulation.observer import Telling
from rubnoise.simulation.panels import Panel
from rubnoise.simulation.process import LifeProcess, PromptProcess, Wait
from rubnoise.simulation.state import LiveRows, State

Life = Callable[[Environment, LiveSet, int, float, float], ProcessGenerator]


def junction(env: Environment, live: LiveSet, row: int, death: float, rest: float) -> ProcessGenerator:
    """Live from now through ``rest`` um of sliding; die at ``death``, or wherever an interrupt ends it."""
    try:
        yield Wait(env, rest)
    except Interrupt:
        death = ended(env, live, row, death)
    del live.processes[live.numbers[row]]
    live.departure[row] = death


def ended(env: Environment, live: LiveSet, row: int, death: float) -> float:
    """Return where a life ends that is ended now: within itself, though the clock, which adds gaps, rounds."""
    return min(max(env.now, live.birth_and_diameter(row)[0]), death)


def told_junction(
    env: Environment, live: LiveSet, row: int, death: float, rest: float, telling: Telling
) -> ProcessGenerator:
    """Live as a junction does, and have mid-life and death told."""
    number, (birth, diameter) = live.numbers[row], live.birth_and_diameter(row)
    try:
        rise = birth + diameter - env.now
        if telling.is_rising(number) and rise > 0.0:
            yield Wait(env, rise)
            telling.mid_life(number, birth + diameter)
            rest = max(rest - rise, 0.0)
        yield Wait(env, rest)
    except Interrupt:
        death = ended(env, live, row, death)
    del live.processes[number]
    live.departure[row] = death
    telling.death(number, death)


def told_newborn(
    env: Environment, live: LiveSet, row: int, death: float, rest: float, telling: Telling
) -> ProcessGenerator:
    """Have a birth told, and the life after it."""
    telling.birth(live.numbers[row], live.birth_and_diameter(row)[0])
    yield from told_junction(env, live, row, death, rest, telling)


def births(
    env: Environment, live: LiveSet, state: State, block: BlockBirths, run_end: float, newborn: Life
) -> ProcessGenerator:
    """Wait for a gap, start a junction, and so on to the birth that opens the next block, or to the end of the run."""
    wait = state.next_birth - env.now
    life_distances = 2.0 * block.diameter
    deaths = block.birth + life_distances
    lives = zip(deaths.tolist(), life_distances.tolist(), block.gaps.tolist(), strict=True)
    processes, numbers = live.processes, live.numbers
    for row, (death, life, gap) in enumerate(lives, start=len(state.live)):
        yield Wait(env, wait)
        processes[numbers[row]] = LifeProcess(env, newborn(env, live, row, death, life))
        live.joined = row + 1
        wait = gap
    last = block.next_birth > run_end
    # The clock adds gaps and rounds; a birth at the very end may have put it a trifle beyond.
    yield env.timeout(max(run_end - env.now, 0.0) if last else wait)


class Desk:
    """Where the aggregator lays what it has sampled: the event that the next panel will be."""

    def __init__(self, env: Environment) -> None:
        """Wait for the first panel."""
        self._env = env
        self.awaited: Event = env.event()

    def lay(self, rows: LiveRows, found: Sample) -> None:
        """Let the awaited panel happen; it is forgotten once it has been taken."""
        done, self.awaited = self.awaited, self._env.event()
        done.succeed((rows, found))


def aggregate(
    env: Environment,
    panels: Sequence[Panel],
    desk: Desk,
    block_end: Process,
    sample: Callable[[Panel, LiveRows], Sample],
    live: LiveSet,
) -> ProcessGenerator:
    """Wake once a panel, when all that happens up to its last tick has happened, and sample the live set at its ticks.

    Half a tick late, so that a birth or death at that very tick has been told, whatever the order of the queue.
    """
    for panel in panels:
        if panel is panels[-1]:
            yield block_end
        else:
            yield env.timeout(panel.last_distance + 0.5 * panel.tick - env.now)
        rows = live.rows()
        desk.lay(rows, sample(panel, rows))
    yield block_end


def slide(panels: Sequence[Panel], desk: Desk, move: Callable[[Panel, LiveRows, Sample], None]) -> ProcessGenerator:
    """Wait until a panel has been sampled, then move the slider through it."""
    for panel in panels:
        rows, found = yield desk.awaited
        move(panel, rows, found)


def play_block(
    *,
    state: State,
    births_of_block: BlockBirths,
    born: LiveRows,
    panels: Sequence[Panel],
    run_end: float,
    sample: Callable[[Panel, LiveRows], Sample],
    move: Callable[[Panel, LiveRows, Sample], None] | None,
    intervening: Intervening | None,
    telling: Telling | None,
) -> tuple[LiveRows, int]:
    """Let one block happen; return its rows at its end, carried ones first, and how many events it took."""
    env = DistanceClock(state.begin) if intervening is None else intervening.clock(state.begin)
    live = LiveSet(state.live, born, state.begin)
    newborn, survivor = _lives(telling)
    if telling is not None:
        telling.begin(state.live, state.begin)
    for row, death in _survivors(state.live, state.begin):
        live.processes[live.numbers[row]] = LifeProcess(env, survivor(env, live, row, death, death - state.begin))
    block_end = LifeProcess(env, births(env, live, state, births_of_block, run_end, newborn))
    desk = Desk(env)
    last: Process = PromptProcess(env, aggregate(env, panels, desk, block_end, sample, live))
    if move is not None:
        last = PromptProcess(env, slide(panels, desk, move))
    if intervening is not None:
        intervening.join(env, live)
    env.run_to(env.all_of([block_end, last]))
    rows = live.rows()
    if telling is not None:
        telling.settle(rows, min(births_of_block.next_birth, run_end))
    return rows, env.count()


def _lives(telling: Telling | None) -> tuple[Life, Life]:
    """Return how a junction lives that is born in this block, and one that was born before."""
    if telling is None:
        return junction, junction
    return partial(told_newborn, telling=telling), partial(told_junction, telling=telling)


def _survivors(live: LiveRows, begin: float) -> Iterator[tuple[int, float]]:
    """Yield the index and death of every carried row that is still alive where a block begins."""
    for row, (departure, death) in enumerate(zip(live.departure.tolist(), live.death.tolist(), strict=True)):
        if departure == inf and death > begin:
            yield row, death
