"""The prompt process keeps SimPy's promises."""

import pytest
from simpy import Environment, Interrupt

from rubnoise.simulation.process import LifeProcess, PromptProcess


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
