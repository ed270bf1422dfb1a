"""Two engines, a fold over blocks and one compilation: the same bits."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from simpy import Environment

import rubnoise
from rubnoise.contact.pulses import LENS, OFF_CENTRE, PULSES
from rubnoise.errors import Refused
from rubnoise.record.rows import JunctionState
from rubnoise.scenario import Scenario
from rubnoise.scenario.reading import build
from rubnoise.simulation import draws, ticks
from rubnoise.simulation.draws import Engine
from rubnoise.simulation.observer import LiveJunctions, Observer
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import cells_per_tick
from tests.models import contents, model, recorded

# Two engines, one result: with processes or without, every column has the same bits.
MANY = settings(max_examples=50, suppress_health_check=[HealthCheck.too_slow])
FEW = settings(MANY, max_examples=3)

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


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.parametrize("engine", ["events", "batch"])
def test_lives_go_on_into_the_next_block(monkeypatch: pytest.MonkeyPatch, engine: Engine) -> None:
    monkeypatch.setattr(draws, "BLOCK", 250)
    run = model(distance=600.0, tick=0.5, slider=None)
    record = recorded(run, 9, engine=engine)
    lives, trace = record["junctions"], record["trace"]
    assert lives["junction"].size > 3 * draws.births_per_block(run)
    ages = trace["distance"][:, None] - lives["birth_distance"]
    assert trace["real_contact_area"] == pytest.approx(LENS.area(ages, lives["diameter"]).sum(axis=1), rel=1e-12)
    assert np.array_equal(trace["junction_count"], ((ages >= 0.0) & (ages < lives["life_distance"])).sum(axis=1))


def test_an_end_in_the_last_cell_of_a_life_is_not_known_a_range_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cells of a natural death are summed in another way than those of an early one, so bits would tell."""
    monkeypatch.setattr(ticks, "LARGEST_TICK_RANGE", 1)
    run = model(distance=25.0, tick=0.05)
    assert cells_per_tick(run) == 1

    def late(env: Environment, live: LiveJunctions) -> Iterator[Any]:
        while True:
            yield env.timeout(0.004)
            for each in live:
                if each.birth_distance + 2.0 * each.diameter - env.now < 0.01:
                    live.end(each.number)

    played = recorded(run, 9, intervene=late)
    rows = played["junctions"]
    early = (rows["state"] & JunctionState.ENDED_EARLY) > 0
    assert early.sum() > 20
    departure = np.where(early, rows["death_distance"], np.inf)
    assert contents(recorded(run, 9, engine="batch", ended=lambda numbers: departure[numbers])) == contents(played)


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


def test_a_short_run_is_the_beginning_of_a_long_one():
    short, long = recorded(model(distance=700.0)), recorded(model(distance=900.0))
    rows = short.extent["junctions"]
    assert np.array_equal(short["junctions"]["birth_distance"], long["junctions"]["birth_distance"][:rows])
    ticks = short.extent["trace"]
    for group, column in (("trace", "real_contact_area"), ("slider", "velocity")):
        assert np.array_equal(short[group][column], long[group][column][:ticks])
