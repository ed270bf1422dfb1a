"""Processes, and what an engine carries from block to block: ticks, counted births, its state."""

from dataclasses import replace

import numpy as np
import pytest
from simpy import Environment, Interrupt

from rubnoise.model import Model
from rubnoise.simulation import draws
from rubnoise.simulation import ticks as module
from rubnoise.simulation.draws import (
    BlockBirths,
    CountedBirths,
    births_by_block,
    blocks_drawn_at_once,
    draw_blocks,
    first_birth,
    start,
)
from rubnoise.simulation.process import LifeProcess, PromptProcess
from rubnoise.simulation.state import State
from rubnoise.simulation.ticks import LARGEST_TICK_RANGE, tick_ranges
from tests.models import bare


# The prompt process keeps SimPy's promises.
def sleeper(env, seconds, value=None):
    yield env.timeout(seconds)
    return value


def test_runs_to_its_first_yield_where_it_is_made():
    env, told = Environment(), []

    def body():
        told.append(env.now)
        yield env.timeout(1)

    PromptProcess(env, body())
    assert told == [0]


def test_an_unwatched_life_is_one_event():
    env = Environment()
    PromptProcess(env, sleeper(env, 3))
    env.run()
    assert (env.now, next(env._eid)) == (3, 1)


def test_is_alive_until_its_generator_ends():
    env = Environment()
    process = PromptProcess(env, sleeper(env, 3, "done"))
    assert process.is_alive
    env.run()
    assert not process.is_alive
    assert process.value == "done"


def test_another_process_waits_for_its_value():
    env = Environment()

    def waits():
        value = yield PromptProcess(env, sleeper(env, 2, "late"))
        return value, env.now

    assert env.run(until=PromptProcess(env, waits())) == ("late", 2)


def test_another_process_waits_for_one_that_has_ended():
    env = Environment()
    ended = PromptProcess(env, sleeper(env, 1, "early"))

    def waits():
        yield env.timeout(5)
        value = yield ended
        return value, env.now

    assert env.run(until=PromptProcess(env, waits())) == ("early", 5)


def test_takes_part_in_conditions_before_and_after_its_end():
    env = Environment()
    short, long = PromptProcess(env, sleeper(env, 1)), PromptProcess(env, sleeper(env, 4))
    env.run(until=short | long)
    assert env.now == 1
    env.run(until=short & long)
    assert env.now == 4


def test_an_interrupt_reaches_it_with_its_cause():
    env, told = Environment(), []

    def body():
        try:
            yield env.timeout(10)
        except Interrupt as interrupt:
            told.append((env.now, interrupt.cause))

    def interrupts(process):
        yield env.timeout(4)
        process.interrupt("sheared off")

    PromptProcess(env, interrupts(PromptProcess(env, body())))
    env.run()
    assert told == [(4, "sheared off")]


def test_goes_on_waiting_after_an_interrupt():
    env, told = Environment(), []

    def body():
        rest = env.timeout(10)
        try:
            yield rest
        except Interrupt:
            yield rest
        told.append(env.now)

    process = PromptProcess(env, body())
    process.interrupt()
    env.run()
    assert told == [10]


def test_a_dead_process_refuses_an_interrupt():
    env = Environment()
    process = PromptProcess(env, sleeper(env, 1))
    env.run()
    with pytest.raises(RuntimeError, match="has terminated and cannot be interrupted"):
        process.interrupt()


def test_a_failure_reaches_who_waits_and_nobody_else():
    env = Environment()

    def fails():
        yield env.timeout(1)
        raise ValueError("worn out")

    def waits():
        try:
            yield PromptProcess(env, fails())
        except ValueError as error:
            return str(error)

    assert env.run(until=PromptProcess(env, waits())) == "worn out"


def test_a_failure_nobody_waits_for_ends_the_run():
    env = Environment()

    def fails():
        yield env.timeout(1)
        raise ValueError("worn out")

    PromptProcess(env, fails())
    with pytest.raises(ValueError, match="worn out"):
        env.run()


def test_the_maker_is_active_again_after_making():
    env, active = Environment(), []

    def maker():
        active.append(env.active_process)
        PromptProcess(env, sleeper(env, 1))
        active.append(env.active_process)
        yield env.timeout(1)

    process = PromptProcess(env, maker())
    assert active == [process, process]


def life(env, *events, told=None):
    """A life that returns nothing: it waits for events and notes what they bring."""
    for event in events:
        try:
            brought = yield event
        except Interrupt as interrupt:
            brought = interrupt.cause
        if told is not None:
            told.append((env.now, brought))


def test_a_life_is_one_event_and_ends_without_a_value():
    env = Environment()
    process = LifeProcess(env, life(env, env.timeout(3)))
    assert process.is_alive
    env.run()
    assert (env.now, next(env._eid)) == (3, 1)
    assert not process.is_alive
    assert process.ok
    assert process.value is None


def test_a_life_is_waited_for_before_and_after_its_end():
    env, told = Environment(), []
    first, second = (LifeProcess(env, life(env, env.timeout(after))) for after in (1, 4))
    LifeProcess(env, life(env, env.timeout(2), first, second, first & second, told=told))
    env.run()
    assert [now for now, _ in told] == [2, 2, 4, 4]


def test_a_life_gets_what_events_bring_and_is_interrupted():
    env, told = Environment(), []
    happened = env.timeout(1, "early")
    process = LifeProcess(env, life(env, env.timeout(2, "late"), happened, env.timeout(50), told=told))

    def ends():
        yield env.timeout(7)
        process.interrupt("enough")

    PromptProcess(env, ends())
    env.run(until=60)
    assert told == [(2, "late"), (2, "early"), (7, "enough")]
    assert not process.is_alive


def test_a_life_that_fails_is_heard_of():
    env = Environment()

    def breaks():
        yield env.timeout(1)
        raise ValueError("broken")

    LifeProcess(env, breaks())
    with pytest.raises(ValueError, match="broken"):
        env.run()


# Births between their being counted and their being played.
RUN = bare(distance=3_000.0, tick=1.0)
BIRTHS = (np.arange(3.0), np.ones(2))
PLACE = (0, 0.5, 16)


def test_births_are_looked_at_often_and_taken_once() -> None:
    kept = CountedBirths()
    assert kept.look(RUN, 1, PLACE) is None
    kept.keep(RUN, 1, PLACE, BIRTHS)
    for _ in range(2):
        assert kept.look(replace(RUN), 1, PLACE) is BIRTHS
    assert kept.take(RUN, 1, PLACE) is BIRTHS
    assert kept.take(RUN, 1, PLACE) is kept.look(RUN, 1, PLACE) is None


def test_another_run_or_place_has_other_births() -> None:
    kept = CountedBirths()
    kept.keep(RUN, 1, PLACE, BIRTHS)
    for run, seed, place in ((RUN, 2, PLACE), (replace(RUN, tick=0.5), 1, PLACE), (RUN, 1, (1, 0.5, 16))):
        assert kept.look(run, seed, place) is kept.take(run, seed, place) is None
    kept.keep(RUN, 2, PLACE, (BIRTHS[1], BIRTHS[0]))
    assert kept.look(RUN, 1, PLACE) is None
    assert kept.look(RUN, 2, PLACE) is not None


def test_no_more_are_kept_than_fit() -> None:
    kept = CountedBirths()
    for block in range(draws._MOST_KEPT + 5):
        kept.keep(RUN, 1, (block, 0.5, 16), BIRTHS)
    found = [kept.look(RUN, 1, (block, 0.5, 16)) is not None for block in range(draws._MOST_KEPT + 5)]
    assert found == [True] * draws._MOST_KEPT + [False] * 5


def test_a_run_is_played_from_what_was_counted_to_the_same_bits() -> None:
    begin, together = first_birth(RUN, 7), blocks_drawn_at_once(RUN, 0)
    assert draws._counted.take(RUN, 7, (0, begin, together)) is None
    drawn = draw_blocks(RUN, 7, 0, begin, together)
    assert len(drawn) == sum(births_by_block(RUN, 7))
    assert draws._counted.look(RUN, 7, (0, begin, together)) is not None
    played = draw_blocks(RUN, 7, 0, begin, together)
    assert draws._counted.look(RUN, 7, (0, begin, together)) is None
    for name in ("birth", "gaps", "diameter", "strength"):
        assert np.array_equal(getattr(drawn, name), getattr(played, name))
    assert (drawn.blocks, drawn.next_birth) == (played.blocks, played.next_birth)


# Panels cover every tick once, whatever the block and however large they may be.
def block_up_to(next_birth: float) -> BlockBirths:
    none = np.empty(0)
    return BlockBirths(birth=none, gaps=none, diameter=none, strength=none, blocks=1, next_birth=next_birth)


def covered(run: Model, begin: State, next_birth: float, cells: int = 1) -> list[int]:
    return [
        tick
        for tick_range in tick_ranges(run, begin, block_up_to(next_birth), cells)
        for tick in range(tick_range.first, tick_range.end)
    ]


SHORT_RUN = bare(distance=10.0, tick=0.1)
BEGIN = start(SHORT_RUN, 1)


def test_a_block_owns_the_ticks_before_the_next_birth() -> None:
    assert covered(SHORT_RUN, BEGIN, 2.05) == list(range(21))
    assert covered(SHORT_RUN, BEGIN, 2.0) == list(range(20))  # a tick at the birth itself sees the newborn
    assert covered(SHORT_RUN, BEGIN, np.nextafter(2.0, 3.0)) == list(range(21))
    assert covered(SHORT_RUN, BEGIN, 0.0) == []


def test_the_last_block_ends_the_run() -> None:
    assert covered(SHORT_RUN, BEGIN, 11.0) == list(range(101))
    assert covered(SHORT_RUN, BEGIN, np.nextafter(10.0, 11.0)) == list(range(101))
    assert covered(SHORT_RUN, BEGIN, 10.0) == list(range(100))


def test_a_birth_after_the_last_tick_but_within_the_run_ends_nothing_early() -> None:
    run = bare(distance=10.05, tick=0.1)
    assert covered(run, start(run, 1), 10.04) == list(range(101))


def test_a_block_begins_where_the_one_before_ended() -> None:
    assert covered(SHORT_RUN, replace(BEGIN, ticks=21), 5.05) == list(range(21, 51))
    assert covered(SHORT_RUN, replace(BEGIN, ticks=21), 2.08) == []


@pytest.mark.parametrize("tick", [0.1, 0.3, 1.0 / 3.0, 1e-3, 7.7])
def test_ticks_and_births_are_told_apart_to_the_last_bit(tick: float) -> None:
    """The distance of a tick is i * tick as a float, not what i * tick would be in exact arithmetic."""
    run = replace(SHORT_RUN, distance=1e6 * tick, tick=tick, tick_count=1_000_000)
    for i in (1, 3, 7, 999, 123_457):
        at = float(i) * tick
        for birth, last in ((np.nextafter(at, 0.0), i - 1), (at, i - 1), (np.nextafter(at, np.inf), i)):
            found = list(tick_ranges(run, BEGIN, block_up_to(float(birth)), 1))
            assert found[-1].end - 1 == last


@pytest.mark.parametrize("cells", [1, 4, 64, 2 * LARGEST_TICK_RANGE])
def test_panels_are_no_larger_than_allowed_and_cover_all(monkeypatch: pytest.MonkeyPatch, cells: int) -> None:
    monkeypatch.setattr(module, "LARGEST_TICK_RANGE", 128)
    assert covered(SHORT_RUN, BEGIN, 11.0, cells) == list(range(101))
    sizes = [
        tick_range.end - tick_range.first for tick_range in tick_ranges(SHORT_RUN, BEGIN, block_up_to(11.0), cells)
    ]
    assert max(sizes) == min(max(128 // cells, 1), 101)
