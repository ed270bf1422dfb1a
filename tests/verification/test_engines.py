"""Two engines, a fold over blocks and one compilation: the same bits."""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from simpy import Environment
from simpy.events import ProcessGenerator

import rubnoise
from rubnoise.contact.laws import Spread
from rubnoise.contact.off_centre import OFF_CENTRE, OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE
from rubnoise.errors import Refused
from rubnoise.record.sink import Extent
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import build
from rubnoise.simulation import draws, kernel, linear, ticks
from rubnoise.simulation.extent import Engine, extent
from rubnoise.simulation.intervention import LiveJunctions
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import finished, simulate
from rubnoise.simulation.state import LiveRows
from tests.cli.terminal import spawn_program
from tests.models import UNEQUAL, bare, contents, model, recorded, run_to_end

# Two engines, one result: with processes or without, every column has the same bits.
MANY = settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
FEW = settings(MANY, max_examples=5)

DIAMETERS = st.one_of(
    st.just({"law": "fixed"}),
    st.just({"law": "exponential"}),
    st.builds(
        lambda law, spread: {"law": law, "spread": spread},
        st.sampled_from(["normal", "lognormal", "gamma"]),
        st.sampled_from(["20 %", "0.2 um", "150 %"]),
    ),
)
STRENGTHS = st.one_of(
    st.just({"mean": "250 MPa"}),
    st.builds(
        lambda law, spread: {"mean": "250 MPa", "law": law, "spread": spread},
        st.sampled_from(["normal", "lognormal", "weibull"]),
        st.sampled_from(["20 %", "300 MPa"]),
    ),
)
SLIDER = {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"}


@st.composite
def scenarios(draw: st.DrawFn) -> Scenario:
    """Return a scenario of at most some thousand births and 20 000 ticks, of any laws, thin to dense."""
    count = float(f"{10.0 ** draw(st.floats(-2.0, 3.7)):.3g}")
    life = 2.0 * (600.0 / count) ** 0.5
    lives = min(draw(st.floats(0.5, 2500.0)) / count, 4000.0)
    distance, tick = life * lives, life * max(draw(st.floats(0.003, 0.7)), lives / 20_000.0)
    pulse, aside = draw(st.sampled_from([*((name, False) for name in PULSES), *((name, True) for name in OFF_CENTRE)]))
    values: dict[str, Any] = {
        "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": count},
        "diameter": draw(DIAMETERS),
        "birth": {"law": draw(st.sampled_from(["poisson"] if aside else ["poisson", "regular"]))},
        "pulse": {"shape": pulse, "offset": "uniform" if aside else "none"},
        "sliding": {"distance": f"{distance:.6f} um", "start": draw(st.sampled_from(["stationary", "empty"]))},
        "output": {"tick": f"{min(tick, distance):.6f} um"},
        "run": {"seed": draw(st.integers(0, 2**53 - 1))},
    }
    # The ticks are parts of a life of these calibrations; `matched` makes lives shorter, if it has a solution at all.
    values["interface"]["calibration"] = draw(
        st.sampled_from(["paper", "exact"] if (pulse, aside) == ("lens", False) else ["exact"])
    )
    if draw(st.booleans()):
        values["strength"] = draw(STRENGTHS)
        values["sliding"]["speed"] = draw(st.sampled_from(["10 mm/s", "1 m/s"]))
        if draw(st.booleans()):
            values["slider"] = SLIDER | {"start": draw(st.sampled_from(["equilibrium", "rest"]))}
    return build(values)


def by(scenario: Scenario, engine: str) -> Scenario:
    """Return the scenario with an engine."""
    return build(scenario.resolved() | {"run": {"seed": scenario.run.seed, "engine": engine}})


@MANY
@given(scenario=scenarios())
def test_both_engines_give_every_bit(scenario: Scenario) -> None:
    one, other = (outcome(by(scenario, engine)) for engine in ("events", "batch"))
    assert one == other


def outcome(scenario: Scenario) -> dict[tuple[str, str], bytes] | str:
    """Return the columns of a run, or why it is refused: its slider may move too fast within a tick."""
    try:
        return contents(rubnoise.simulate(scenario).reader())
    except Refused as refused:
        return str(refused)


@FEW
@given(scenario=scenarios())
def test_both_engines_write_the_same_datasets(tmp_path_factory: pytest.TempPathFactory, scenario: Scenario) -> None:
    folder = tmp_path_factory.mktemp("engines")
    written = {engine: folder / f"{engine}.h5" for engine in ("events", "batch")}
    for engine, path in written.items():
        rubnoise.run(by(scenario, engine), path).close()
    assert datasets(written["batch"]) == datasets(written["events"])


def datasets(path: Path) -> dict[str, tuple[bytes, bytes]]:
    """Return every dataset of a file, and its hash."""
    found: dict[str, tuple[bytes, bytes]] = {}
    with h5py.File(path, "r") as file:
        for group in ("junctions", "trace", "slider"):
            for name, dataset in file.get(group, {}).items():
                found[f"{group}/{name}"] = dataset[:].tobytes(), dataset.attrs["xxh3_128"]
    return found


@pytest.mark.parametrize("births", ["poisson", "regular"])
@pytest.mark.parametrize("count", [0.01, 0.5, 20.0, 5000.0])
def test_thin_and_dense_contacts_over_several_blocks(count: float, births: str) -> None:
    life = 2.0 * (600.0 / count) ** 0.5
    run = model(
        count=count, distance=float(f"{2800 / min(count, 200.0) * life:.6g}"), tick=life / 7.0, births=births,
        strength=UNEQUAL, speed=1e6,
    )  # fmt: skip
    (one, last), (other, end) = (run_to_end(run, 3, engine=engine) for engine in ("events", "batch"))
    assert last.block == end.block >= 2
    assert last.junctions == end.junctions > 2500
    assert contents(one) == contents(other)


@pytest.mark.parametrize("engine", ["events", "batch"])
def test_small_blocks_are_played_together_to_the_same_bits(monkeypatch: pytest.MonkeyPatch, engine: Engine) -> None:
    run = model(distance=4003.0, tick=0.5)
    together, last = run_to_end(run, 9, engine=engine)
    assert draws.blocks_drawn_at_once(run, 0) > 1
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)
    alone, end = run_to_end(run, 9, engine=engine)
    assert contents(alone) == contents(together)
    assert (end.block, end.junctions, end.ticks) == (last.block, last.junctions, last.ticks)
    assert last.block > 5


def test_both_tell_of_their_progress(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ticks, "LARGEST_TICK_RANGE", 400)
    run = model(distance=600.0, tick=0.1)
    for engine in ("events", "batch"):
        told: list[tuple[float, int, int]] = []
        record = recorded(run, 6, engine=engine, watch=lambda *what, told=told: told.append(what))
        assert len(told) > 12
        assert told[-1][:2] == (600.0, record.extent.junctions)
        for distance, born, live in told:
            tick = round(distance / 0.1)
            assert live == record["trace"]["junction_count"][tick]
            at = int(np.searchsorted(record["junctions"]["birth_distance"], distance, side="right"))
            # With events, a panel's end is heard of half a tick late.
            assert 0 <= born - at <= 3


def test_an_intervention_needs_events() -> None:
    with pytest.raises(
        Refused, match='intervene: an intervention is a process among events: it needs the engine "events"'
    ):
        recorded(model(), engine="batch", intervene=lambda env, live: iter(()))
    with pytest.raises(Refused, match='observe: births, mid-lives and deaths are events: it needs the engine "events"'):
        recorded(model(), engine="batch", observe=Observer())


def test_a_diameter_less_by_one_bit_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    run = model(distance=300.0)
    expected = contents(recorded(run, engine="events"))
    born = LiveRows.then

    def shrunk(self: LiveRows, other: LiveRows) -> LiveRows:
        rows = born(self, other)
        rows.diameter[-1] = rows.diameter[-1] * (1.0 - 2.0**-53)
        return rows

    monkeypatch.setattr(LiveRows, "then", shrunk)
    assert contents(recorded(run, engine="batch")) != expected


# A run is a fold over blocks.
RUNS = {
    "figure 5": model(distance=2000.0, tick=0.5),
    "empty start": model(distance=1500.0, tick=0.7, start="empty"),
    "few": model(count=0.5, distance=400_000.0, tick=200.0),
    "many": model(count=5000.0, distance=20.0, tick=0.05),
    "wide sizes": model(count=8.0, spread=Spread(absolute=12.0), distance=9000.0, tick=2.7),
    "Rabinowicz": model(pulse=TRIANGLE, births="regular", spread=Spread(), distance=2000.0, tick=0.5),
    "unequal triangles": model(
        pulse=TRIANGLE, strength=UNEQUAL, spread=Spread(relative=0.4), distance=1500.0, tick=0.7
    ),
    "off the centre line": model(
        pulse=OFF_CENTRE_LENS, strength=UNEQUAL, spread=Spread(relative=0.4), distance=1500.0, tick=0.7
    ),
    "parabolas off the centre line": model(
        pulse=OFF_CENTRE_PARABOLA, strength=UNEQUAL, spread=Spread(relative=0.4), distance=1500.0, tick=0.7
    ),
    **{
        name: model(births=name, spread=Spread(relative=0.4), distance=2000.0, tick=2.7)
        for name in ("gamma", "clustered", "jittered")
    },
    "regular and wide": model(count=8.0, births="regular", spread=Spread(relative=2.0), distance=9000.0, tick=2.7),
}


@pytest.fixture
def each_block_alone(monkeypatch):
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)


@pytest.mark.parametrize("pulse", [LENS, TRIANGLE, OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA], ids=lambda pulse: pulse.name)
@pytest.mark.parametrize(("size", "distance"), [(1, 20.0), (7, 60.0), (1000, 300.0)])
def test_panels_are_only_how_a_block_is_written(monkeypatch, size, distance, pulse):
    run = model(distance=distance, tick=0.05, pulse=pulse, strength=UNEQUAL)
    expected = contents(recorded(run))
    monkeypatch.setattr(ticks, "LARGEST_TICK_RANGE", size)
    assert contents(recorded(run)) == expected


@pytest.mark.usefixtures("each_block_alone")
def test_a_block_owns_exactly_its_births():
    run, written = model(distance=3000.0, tick=1.0), []

    class Counting:
        def write(self, group, first_row, columns):
            if group == "junctions":
                written.append(next(iter(columns.values())).size)

    simulate(run, 1, Counting(), engine="batch")
    assert len(written) > 3
    assert set(written[1:-1]) == {draws.births_per_block(run)}


def test_same_seed_same_bytes_other_seed_other_bytes():
    run = model(distance=200.0)
    assert contents(recorded(run, 3)) == contents(recorded(run, 3))
    assert contents(recorded(run, 3)) != contents(recorded(run, 4))


def test_the_extent_is_known_before_the_run():
    for run in RUNS.values():
        record, state = run_to_end(run, 2)
        assert record.extent.junctions == state.junctions == record["junctions"]["birth_distance"].size
        assert record.extent.ticks == state.ticks == run.tick_count + 1
        assert finished(run, state)


def test_a_run_without_births_is_one_block():
    run = model(count=0.01, distance=1e-3, tick=1e-3, start="empty")
    record, state = run_to_end(run)
    assert record.extent == Extent(junctions=0, ticks=2, slider=2)
    assert state.next_birth > run.distance
    assert state.block == 1


def test_a_short_run_is_the_beginning_of_a_long_one():
    short, long = recorded(model(distance=700.0)), recorded(model(distance=900.0))
    rows = short.extent.junctions
    assert np.array_equal(short["junctions"]["birth_distance"], long["junctions"]["birth_distance"][:rows])
    ticks = short.extent.ticks
    for group, column in (("trace", "real_contact_area"), ("slider", "velocity")):
        assert np.array_equal(short[group][column], long[group][column][:ticks])


def test_rows_are_written_once_and_in_order():
    run = model(distance=2000.0, tick=0.5)
    seen = {"junctions": 0, "trace": 0, "slider": 0}

    class Watchful:
        def write(self, group, first_row, columns):
            assert first_row == seen[group]
            seen[group] += next(iter(columns.values())).size

    simulate(run, 1, Watchful())
    rows, ticks = extent(run, 1), run.tick_count + 1
    assert seen == {"junctions": rows.junctions, "trace": ticks, "slider": ticks}


# Every kernel is compiled for one kind of arrays only: a second kind would cost seconds in the middle of a run.
KERNELS = (
    kernel.add_areas,
    kernel.add_cells,
    kernel.add_values,
    kernel.count_changes,
    linear.add_pushes,
    linear.advance,
)
KINDS_OF_RUNS = (
    model(distance=600.0, tick=0.5),
    model(distance=30.0, tick=0.5, speed=20.0),
    model(distance=600.0, tick=0.5, pulse=TRIANGLE, births="regular"),
    model(distance=600.0, tick=0.5, strength=UNEQUAL, start="empty"),
    bare(distance=600.0),
)


def test_runs_of_all_kinds_share_one_compilation() -> None:
    # In a process of its own: another test may have called a kernel with arrays of another kind.
    done = spawn_program("from tests.verification.test_engines import counted; print(counted())")
    assert (done.out, done.err) == ("{1}\n", "")


def counted() -> set[int]:
    """Run everything with both engines and return how often the kernels have been compiled."""
    for run in KINDS_OF_RUNS:
        for engine in ("events", "batch"):
            recorded(run, engine=engine)
    recorded(model(distance=600.0, tick=0.05), intervene=_end_all)
    return {len(each.signatures) for each in KERNELS}


def _end_all(env: Environment, live: LiveJunctions) -> ProcessGenerator:
    """End all junctions alive in the middle of a run."""
    yield env.timeout(max(300.0 - env.now, 0.0))
    for junction in live:
        live.end(junction.number)
