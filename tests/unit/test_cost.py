"""Estimates of memory and time: how they grow, and that they are near what a process really takes."""

from dataclasses import replace
from time import process_time
from typing import Any

import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.record.tally import Tally
from rubnoise.simulation import cost
from rubnoise.simulation.cost import PROGRAM_BYTES, MachineSpeed, machine_speed, seconds, work, working_bytes
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate
from tests.models import UNEQUAL, bare, model

ENGINES = ("events", "batch")


def _seconds(engine: Any, **changes: Any) -> float:
    run = model(**changes)
    rows = extent(run, 1)
    return seconds(work(run, engine, rows.junctions, rows.ticks), MachineSpeed())


@pytest.mark.parametrize("engine", ENGINES)
def test_memory_does_not_depend_on_the_length_of_a_run(engine: Any) -> None:
    assert working_bytes(model(distance=1e5), engine) == working_bytes(model(distance=1e7), engine)


@pytest.mark.parametrize("engine", ENGINES)
def test_memory_grows_with_the_number_of_junctions_at_once(engine: Any) -> None:
    equal = Spread(absolute=0.0)
    needs = [working_bytes(bare(count=count, spread=equal, distance=1e4), engine) for count in (1e4, 1e5, 1e6)]
    assert 3.0 < needs[1] / needs[0] < 10.0
    assert needs[2] / needs[1] == pytest.approx(10.0, rel=0.2)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_thin_contact_needs_no_more_memory_than_another(engine: Any) -> None:
    assert working_bytes(model(count=0.01, distance=1e6), engine) <= 2 * working_bytes(model(distance=1e6), engine)
    assert working_bytes(model(count=0.01, distance=1e6), engine) < 0.2 * PROGRAM_BYTES


def test_time_grows_with_all_that_a_run_does_more() -> None:
    for engine in ENGINES:
        plain = _seconds(engine)
        more: list[dict[str, Any]] = [
            {"distance": 1000.0}, {"tick": 0.05}, {"count": 200.0}, {"strength": UNEQUAL}, {"speed": 20.0},
        ]  # fmt: skip
        assert all(_seconds(engine, **changes) > plain for changes in more)
        assert _seconds(engine, slider=None) < plain
    assert _seconds("batch") < _seconds("events")


def _two_way_seconds(**changes: Any) -> float:
    run = model(**changes)
    assert run.slider is not None
    run = replace(run, slider=replace(run.slider, coupling="two-way"))
    rows = extent(run, 1)
    return seconds(work(run, "batch", rows.junctions, rows.ticks), MachineSpeed())


def test_a_slider_that_pushes_back_takes_longer_where_it_moves_slowly() -> None:
    """Measured were 550 us for each junction at 10 um/s with half a junction, and 1.3 us at 0.1 m/s with 20."""
    thin = _two_way_seconds(count=0.5, speed=10.0, distance=30_000.0, tick=1.0) / (
        30_000.0 * model(count=0.5).birth_rate
    )
    assert 2e-4 < thin < 2e-3
    many = _two_way_seconds(speed=1e5, distance=30_000.0, tick=0.2) / (30_000.0 * model().birth_rate)
    assert 7e-7 < many < 4e-6
    assert _two_way_seconds(tick=0.005) > _two_way_seconds(tick=0.04)
    assert work(model(), "batch", 1000, 5000).keys().isdisjoint({"met", "written row", "swing"})


def test_time_is_told_in_that_of_this_machine() -> None:
    amounts = work(model(), "events", 1000, 5000)
    assert seconds(amounts, MachineSpeed(processes=2.0, arrays=2.0)) == pytest.approx(
        2.0 * seconds(amounts, MachineSpeed())
    )
    apart = [seconds(amounts, MachineSpeed(processes=p, arrays=a)) for p, a in ((1.0, 0.0), (0.0, 1.0))]
    assert min(apart) > 0.0
    assert sum(apart) == pytest.approx(seconds(amounts, MachineSpeed()))


def test_a_machine_at_half_the_speed_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    ticking = iter(range(10**6))
    monkeypatch.setattr(cost, "perf_counter", lambda: 1e-3 * next(ticking))
    machine_speed.cache_clear()
    slow = machine_speed()
    machine_speed.cache_clear()
    assert slow.processes == pytest.approx(1e-3 / cost.EVENTS_SECONDS)
    assert slow.arrays == pytest.approx(1e-3 / cost.TERMS_SECONDS)


RUNS: dict[str, dict[str, Any]] = {
    "Figure 5": {"distance": 2e4},
    "fine ticks": {"distance": 2e3, "tick": 0.005},
    "dense": {"count": 5000.0, "distance": 10.0, "tick": 0.005},
    "slow": {"distance": 500.0, "speed": 20.0},
    "thin": {"count": 0.05, "distance": 1e5, "tick": 0.5},
    "triangles": {"distance": 2e4, "pulse": TRIANGLE, "strength": UNEQUAL},
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("changes", RUNS.values(), ids=RUNS)
def test_time_is_about_what_the_processor_needs(engine: Any, changes: dict[str, Any]) -> None:
    run = model(**changes)
    rows = extent(run, 1)
    told = seconds(work(run, engine, rows.junctions, rows.ticks), machine_speed())
    taken = min(_taken(run, engine) for _ in range(2))
    assert taken / 3.0 < told < 3.0 * taken + 0.05


def _taken(run: Any, engine: Any) -> float:
    begin = process_time()
    simulate(run, 1, Tally(), engine=engine)
    return process_time() - begin
