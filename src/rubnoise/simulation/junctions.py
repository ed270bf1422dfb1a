"""The story of a contact, as processes: junctions are born, live through 2d of sliding, and die.

Distance is the clock: ``env.now`` is the sliding distance in um. Only births and deaths are events; the aggregator and
the slider wake for a range of ticks at a time and see in it exactly the junctions that joined and left before.
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
    """Live from now through ``rest`` um of sliding; die at ``death``, or wherever an interrupt ends it."""
    try:
        yield Wait(env, rest)
    except Interrupt:
        death = ended(env, live, row, death)
    del live.processes[live.numbers[row]]
    live.departure[row] = death


def ended(env: Environment, live: LiveSet, row: int, death: float) -> float:
    """Return where a life ends that is ended now: within itself, though the clock, which adds gaps, rounds."""
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
    """Report a birth to the observer, then the life after it."""
    notifier.birth(live.numbers[row], live.birth_and_half_life(row)[0])
    yield from observed_junction(env, live, row, death, rest, notifier)


def births(
    env: Environment, live: LiveSet, state: State, block: BlockBirths, run_end: float, newborn: Life
) -> ProcessGenerator:
    """Wait for a gap, start a junction, and so on to the birth that opens the next block, or to the end of the run."""
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
    # The clock adds gaps and rounds; a birth at the very end may have put it a trifle beyond.
    yield env.timeout(max(run_end - env.now, 0.0) if last else wait)


class NextSample:
    """The event at which the aggregator publishes what it has sampled of the next tick range."""

    def __init__(self, env: Environment) -> None:
        """Wait for the first tick range."""
        self._env = env
        self.awaited: Event = env.event()

    def publish(self, rows: LiveRows, found: Sample) -> None:
        """Let the awaited tick range happen; it is forgotten once it has been taken."""
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
    """Wake once a tick range, when all up to its last tick has happened, and sample the live set at its ticks.

    Half a tick late, so that a birth or death at that very tick has happened, whatever the order of the queue.
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
    """Let one block happen; return its rows at its end, carried ones first, and how many events it took."""
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
    """Be in contact with a free slider from now through ``rest`` um of sliding."""
    yield Wait(env, rest)


def touches(env: Environment, made: list[float], lost: list[float]) -> ProcessGenerator:
    """Wait for contact to be made, start a touch, and so on."""
    for begin, end in zip(made, lost, strict=True):
        yield Wait(env, max(begin - env.now, 0.0))
        LifeProcess(env, touch(env, end - begin))


def play_touches(begin: float, end: float, made: Doubles, lost: Doubles) -> int:
    """Let the touches of a block happen, in order of contact made (um), and return how many events it took.

    As with a two-way slider, the motion says where; the clock of the processes writes no row.
    """
    env = DistanceClock(begin)
    PromptProcess(env, touches(env, made.tolist(), lost.tolist()))
    env.run_to(env.timeout(max(end - begin, 0.0)))
    return env.count()


def _lives(notifier: Notifier | None) -> tuple[Life, Life]:
    """Return how a junction lives that is born in this block, and one that was born before."""
    if notifier is None:
        return junction, junction
    return partial(observed_newborn, notifier=notifier), partial(observed_junction, notifier=notifier)


def _survivors(live: LiveRows, begin: float) -> Iterator[tuple[int, float]]:
    """Yield the index and death of every carried row that is still alive where a block begins."""
    for row, (departure, death) in enumerate(zip(live.departure.tolist(), live.death.tolist(), strict=True)):
        if departure == inf and death > begin:
            yield row, death
