"""The contact as SimPy processes: junctions are born, live for 2d of sliding, and die.

Distance is the clock: ``env.now`` is the sliding distance in um. Only births, deaths and observed mid-lives are events.
The aggregator and the slider wake once per tick range, and compute it from exactly the junctions that have joined and
left by then.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import inf

from simpy import Environment, Interrupt, Process
from simpy.events import Event, ProcessGenerator

from rubnoise.arrays import Doubles
from rubnoise.contact.off_centre import half_life
from rubnoise.simulation.area import Sample
from rubnoise.simulation.draws import BlockBirths
from rubnoise.simulation.intervention import Intervening
from rubnoise.simulation.observer import Notifier
from rubnoise.simulation.process import DistanceClock, LifeProcess, LiveSet, PromptProcess, Wait
from rubnoise.simulation.state import LiveRows, State
from rubnoise.simulation.ticks import TickRange

Life = Callable[[Environment, LiveSet, int, float, float], ProcessGenerator]


def junction(env: Environment, live: LiveSet, row: int, death: float, rest: float) -> ProcessGenerator:
    """Live for another ``rest`` um of sliding and die at ``death``, or die earlier at an interrupt."""
    try:
        yield Wait(env, rest)
    except Interrupt:
        death = ended(env, live, row, death)
    del live.processes[live.numbers[row]]
    live.departure[row] = death


def ended(env: Environment, live: LiveSet, row: int, death: float) -> float:
    """Return the death (um) of a life that is ended now: within the life, although the clock adds gaps and rounds."""
    return min(max(env.now, live.birth_and_half_life(row)[0]), death)


def observed_junction(
    env: Environment, live: LiveSet, row: int, death: float, rest: float, notifier: Notifier
) -> ProcessGenerator:
    """Live as a junction does, and report mid-life and death to the observer."""
    number, (birth, rise_distance) = live.numbers[row], live.birth_and_half_life(row)
    try:
        rise = birth + rise_distance - env.now
        if notifier.is_rising(number) and rise > 0.0:
            yield Wait(env, rise)
            notifier.mid_life(number, birth + rise_distance)
            rest = max(rest - rise, 0.0)
        yield Wait(env, rest)
    except Interrupt:
        death = ended(env, live, row, death)
    del live.processes[number]
    live.departure[row] = death
    notifier.death(number, death)


def observed_newborn(
    env: Environment, live: LiveSet, row: int, death: float, rest: float, notifier: Notifier
) -> ProcessGenerator:
    """Report the birth to the observer, then live as an observed junction."""
    notifier.birth(live.numbers[row], live.birth_and_half_life(row)[0])
    yield from observed_junction(env, live, row, death, rest, notifier)


def births(
    env: Environment, live: LiveSet, state: State, block: BlockBirths, run_end: float, newborn: Life
) -> ProcessGenerator:
    """Wait for a gap, start a junction, and repeat until the first birth of the next block or the end of the run."""
    wait = state.next_birth - env.now
    life_distances = 2.0 * half_life(block.diameter, block.offset)
    deaths = block.birth + life_distances
    lives = zip(deaths.tolist(), life_distances.tolist(), block.gaps.tolist(), strict=True)
    processes, numbers = live.processes, live.numbers
    for row, (death, life, gap) in enumerate(lives, start=len(state.live)):
        yield Wait(env, wait)
        processes[numbers[row]] = LifeProcess(env, newborn(env, live, row, death, life))
        live.joined = row + 1
        wait = gap
    last = block.next_birth > run_end
    # The clock adds gaps and rounds, so a birth at the very end may have put it slightly beyond the end.
    yield env.timeout(max(run_end - env.now, 0.0) if last else wait)


class NextSample:
    """The event at which the aggregator publishes the sample of the next tick range."""

    def __init__(self, env: Environment) -> None:
        """Make the event of the first tick range."""
        self._env = env
        self.awaited: Event = env.event()

    def publish(self, rows: LiveRows, found: Sample) -> None:
        """Trigger the awaited event with rows and sample, and make the next event; the old one is not kept."""
        done, self.awaited = self.awaited, self._env.event()
        done.succeed((rows, found))


def aggregate(
    env: Environment,
    tick_ranges: Sequence[TickRange],
    next_sample: NextSample,
    block_end: Process,
    sample: Callable[[TickRange, LiveRows], Sample],
    live: LiveSet,
) -> ProcessGenerator:
    """Wake once per tick range, after all events up to its last tick, and sample the live set at its ticks.

    It wakes half a tick late, so that a birth or death at exactly that tick has happened, whatever the queue's order.
    """
    for tick_range in tick_ranges:
        if tick_range is tick_ranges[-1]:
            yield block_end
        else:
            yield env.timeout(tick_range.wake - env.now)
        rows = live.rows()
        next_sample.publish(rows, sample(tick_range, rows))
    yield block_end


def slide(
    tick_ranges: Sequence[TickRange], next_sample: NextSample, move: Callable[[TickRange, LiveRows, Sample], None]
) -> ProcessGenerator:
    """Wait until a tick range has been sampled, then move the slider through it."""
    for tick_range in tick_ranges:
        rows, found = yield next_sample.awaited
        move(tick_range, rows, found)


def play_block(
    *,
    state: State,
    births_of_block: BlockBirths,
    born: LiveRows,
    tick_ranges: Sequence[TickRange],
    run_end: float,
    sample: Callable[[TickRange, LiveRows], Sample],
    move: Callable[[TickRange, LiveRows, Sample], None] | None,
    intervening: Intervening | None,
    notifier: Notifier | None,
) -> tuple[LiveRows, int]:
    """Play one block; return its rows at its end, carried ones first, and the number of events."""
    env = DistanceClock(state.begin) if intervening is None else intervening.clock(state.begin)
    live = LiveSet(state.live, born, state.begin)
    newborn, survivor = _lives(notifier)
    if notifier is not None:
        notifier.begin(state.live, state.begin)
    for row, death in _survivors(state.live, state.begin):
        live.processes[live.numbers[row]] = LifeProcess(env, survivor(env, live, row, death, death - state.begin))
    block_end = LifeProcess(env, births(env, live, state, births_of_block, run_end, newborn))
    next_sample = NextSample(env)
    last: Process = PromptProcess(env, aggregate(env, tick_ranges, next_sample, block_end, sample, live))
    if move is not None:
        last = PromptProcess(env, slide(tick_ranges, next_sample, move))
    if intervening is not None:
        intervening.join(env, live)
    env.run_to(env.all_of([block_end, last]))
    rows = live.rows()
    if notifier is not None:
        notifier.end_block(rows, min(births_of_block.next_birth, run_end))
    return rows, env.count()


def touch(env: Environment, rest: float) -> ProcessGenerator:
    """Stay in contact with a free slider for ``rest`` um of sliding."""
    yield Wait(env, rest)


def touches(env: Environment, made: list[float], lost: list[float]) -> ProcessGenerator:
    """Wait until contact is made, start a touch, and repeat."""
    for begin, end in zip(made, lost, strict=True):
        yield Wait(env, max(begin - env.now, 0.0))
        LifeProcess(env, touch(env, end - begin))


def play_touches(begin: float, end: float, made: Doubles, lost: Doubles) -> int:
    """Play the touches of a block and return the number of events.

    made, lost (um): where each touch begins, in increasing order, and where it ends. The motion has decided this
    already, as with a two-way slider; no row is computed from the clock.
    """
    env = DistanceClock(begin)
    PromptProcess(env, touches(env, made.tolist(), lost.tolist()))
    env.run_to(env.timeout(max(end - begin, 0.0)))
    return env.count()


def _lives(notifier: Notifier | None) -> tuple[Life, Life]:
    """Return the process function of a junction born in this block, and that of one born before."""
    if notifier is None:
        return junction, junction
    return partial(observed_newborn, notifier=notifier), partial(observed_junction, notifier=notifier)


def _survivors(live: LiveRows, begin: float) -> Iterator[tuple[int, float]]:
    """Yield index and death (um) of each carried row that is still alive when the block begins, at ``begin`` um."""
    for row, (departure, death) in enumerate(zip(live.departure.tolist(), live.death.tolist(), strict=True)):
        if departure == inf and death > begin:
            yield row, death
