"""Runs of random contacts: their rows and ticks are right, and they repeat to the bit."""

from contextlib import suppress
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, PULSES
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation.extent import extent
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import State
from tests.models import UNEQUAL, contents, model, recorded

BRIEF = settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])
FEW = settings(BRIEF, max_examples=20)

COUNTS = st.floats(-2.0, 2.7).map(lambda power: float(f"{10.0**power:.3g}"))
SPREADS = st.one_of(
    st.just(Spread()),
    st.floats(0.01, 3.0).map(lambda share: Spread(relative=share)),
    st.floats(0.01, 8.0).map(lambda std: Spread(absolute=std)),
)
SLIDERS = st.builds(
    Slider,
    mass=st.sampled_from([0.001, 0.005, 1.0]),
    stiffness=st.sampled_from([30.0, 300.0, 3e5]),
    damping=st.sampled_from([0.0, 0.05, 50.0]),
    start=st.sampled_from(["equilibrium", "rest"]),
)
SEEDS = st.integers(0, 2**53 - 1)


@st.composite
def models(draw: st.DrawFn) -> Model:
    """Return a model of at most a few thousand births and ticks."""
    count = draw(COUNTS)
    rough = 200.0 / count
    life = 2.0 * (rough / 0.327) ** 0.5
    births, ticks = draw(st.floats(0.0, 3000.0)), draw(st.integers(1, 800))
    distance = float(f"{max(births, 0.3) / count * life:.4g}")
    slider = draw(st.none() | SLIDERS)
    full = slider is not None
    pulse = draw(st.sampled_from(list(PULSES.values())))
    return model(
        count=count,
        spread=draw(SPREADS),
        calibration=draw(st.sampled_from(["paper", "exact"])) if pulse is LENS else "exact",
        distance=distance,
        tick=float(f"{distance / ticks:.4g}"),
        start=draw(st.sampled_from(["stationary", "empty"])),
        slider=slider,
        speed=draw(st.sampled_from([1e3, 1e5]) if full else st.none() | st.just(1e3)),
        strength=draw(st.sampled_from([250.0, UNEQUAL]) if full else st.sampled_from([None, 250.0, UNEQUAL])),
        births=draw(st.sampled_from(["poisson", "regular"])),
        pulse=pulse,
    )


def run_of(run: Model, seed: int) -> MemoryRecord | None:
    """Return the record of a run, or None where its slider would need too many steps."""
    with suppress(Refused):
        return recorded(run, seed)
    assert run.slider is not None
    return None


@BRIEF
@given(run=models(), seed=SEEDS)
def test_rows_and_ticks_are_sound(run: Model, seed: int) -> None:
    record = run_of(run, seed)
    if record is None:
        return
    sound_rows(run, record["junctions"])
    sound_trace(run, record)
    if run.slider is not None:
        sound_slider(run, record)


def sound_rows(run: Model, rows: dict[str, Any]) -> None:
    birth, diameter, death = rows["birth_distance"], rows["diameter"], rows["death_distance"]
    assert rows["junction"].tolist() == list(range(birth.size))
    assert np.all(np.diff(birth) >= 0.0)
    assert np.all(diameter > 0.0)
    assert np.array_equal(death, birth + 2.0 * diameter)
    assert np.array_equal(rows["life_distance"], 2.0 * diameter)
    assert np.all(birth <= run.distance)
    assert np.all(death >= 0.0)
    assert run.start == "stationary" or np.all(birth >= 0.0)
    assert np.array_equal(rows["state"] & 1 > 0, birth < 0.0)
    assert np.array_equal(rows["state"] & 2 > 0, death > run.distance)
    assert ("shear_strength" in rows) == (run.strengths is not None)
    assert ("birth_time" in rows) == (run.sliding_speed is not None)


def sound_trace(run: Model, record: MemoryRecord) -> None:
    rows, trace = record["junctions"], record["trace"]
    s = trace["distance"]
    assert np.array_equal(s, np.arange(run.tick_count + 1) * run.tick)
    born = np.searchsorted(rows["birth_distance"], s, side="right")
    died = np.searchsorted(np.sort(rows["death_distance"]), s, side="right")
    assert np.array_equal(trace["junction_count"], born - died)
    area = trace["real_contact_area"]
    assert np.all(area >= 0.0)
    assert not area[born == died].any()
    largest = np.max(rows["max_area"], initial=0.0)
    assert np.all(area <= trace["junction_count"] * largest * (1.0 + 1e-12))
    assert ("friction_force" in trace) == (run.strengths is not None)


def sound_slider(run: Model, record: MemoryRecord) -> None:
    slider, trace = record["slider"], record["trace"]
    assert np.array_equal(slider["distance"], trace["distance"])
    assert np.array_equal(slider["time"], trace["distance"] / run.sliding_speed)
    assert np.array_equal(slider["friction_force"], trace["friction_force"])
    assert slider["displacement"][0] == run.equilibrium_displacement
    assert slider["velocity"][0] == 0.0
    assert np.all(np.isfinite(slider["displacement"]))
    assert np.all(np.isfinite(slider["velocity"]))


@FEW
@given(run=models(), seed=SEEDS)
def test_a_seed_gives_the_same_bytes_twice(run: Model, seed: int) -> None:
    record = run_of(run, seed)
    if record is not None:
        assert contents(recorded(run, seed)) == contents(record)


@FEW
@given(run=models(), seed=SEEDS, where=st.floats(0.0, 1.0))
def test_a_run_goes_on_from_any_cut_to_the_same_bytes(run: Model, seed: int, where: float) -> None:
    whole, states = MemoryRecord(extent(run, seed)), []
    try:
        simulate(run, seed, whole, commit=lambda state: states.append(state.pack()))
    except Refused:
        return
    cut = State.unpack(states[int(where * (len(states) - 1))])
    again = MemoryRecord(whole.extent, {g: {n: v.copy() for n, v in c.items()} for g, c in whole.groups.items()})
    for group, columns in again.groups.items():
        for values in columns.values():
            values[cut.junctions if group == "junctions" else cut.ticks :] = 0
    last = simulate(run, seed, again, state=cut)
    assert last.pack() == states[-1]
    assert contents(again) == contents(whole)


@FEW
@given(run=models(), seed=SEEDS, other=SEEDS)
def test_another_seed_gives_other_junctions(run: Model, seed: int, other: int) -> None:
    counted = extent(run, seed).junctions
    if seed == other or counted < 3 or extent(run, other).junctions < 3:
        return
    one, two = run_of(run, seed), run_of(run, other)
    if one is None or two is None:
        return
    assert not np.isin(one["junctions"]["birth_distance"], two["junctions"]["birth_distance"]).any()
