"""The two-way slider against an adaptive integrator, and the same bits however a run is cut."""

import math

import numpy as np
import pytest

from rubnoise.model import Model, Slider
from rubnoise.simulation import two_way
from tests.frozen import examples
from tests.laws.scores import seed_of
from tests.models import UNEQUAL, CoupledRun, coupled, field_of, lived, model, oscillator_of
from tests.oracle import coupled_slider

# The two-way slider against an adaptive integrator with events that shares no line with it.
PROMISED = 5e-9
"""Of the largest displacement with FINE cells a diameter; the reference itself is off by some 1e-9."""
FINE = 4000

UNDAMPED = Slider(mass=0.005, stiffness=300.0, damping=0.0)
OVERDAMPED = Slider(mass=0.005, stiffness=300.0, damping=20.0)
STIFF = Slider(mass=0.005, stiffness=300.0, damping=1000.0)


def reference(
    run: Model, seed: int, found: CoupledRun, start: float | None, end: float = np.inf
) -> coupled_slider.Coupled:
    begin = float(found.slider["distance"].min()) - 1.0
    place = run.equilibrium_displacement if start is None else start
    assert run.sliding_speed is not None
    rows = field_of(run, seed, min(begin, 0.0))
    return coupled_slider.motion(oscillator_of(run), run.sliding_speed, rows, place, min(end, 0.999 * found.duration))


def agree(found: CoupledRun, expected: coupled_slider.Coupled, end: float = np.inf) -> None:
    end = min(end, 0.999 * found.duration)
    here = found.slider["time"] < end
    x, _ = expected.at(found.slider["time"][here])
    assert np.abs(found.slider["displacement"][here] - x).max() < PROMISED * np.abs(x).max()
    early = found.landmarks["time"] < end
    landmarks = [mark for mark in expected.landmarks if mark.time < end]
    assert found.landmarks["kind"][early].tolist() == [mark.kind for mark in landmarks]
    for mine, theirs in (("time", "time"), ("distance", "distance"), ("displacement", "displacement")):
        values = np.array([getattr(mark, theirs) for mark in landmarks])
        assert np.abs(found.landmarks[mine][early] - values).max(initial=0.0) < 1e-8 * np.abs(x).max()


@pytest.mark.slow
@pytest.mark.parametrize("case", range(examples(4, 10)))
def test_cases_at_random(case: int) -> None:
    draw = np.random.default_rng(seed_of(f"two-way/{case}")).random(8)
    mass, stiffness = 10.0 ** (-3.0 + draw[0]), 10.0 ** (2.0 + draw[1])
    ratio, count, speed = 10.0 ** (-2.5 + 2.5 * draw[2]), 20.0 ** draw[3], 300.0 * 60.0 ** draw[4]
    slider = Slider(mass=mass, stiffness=stiffness, damping=2.0 * ratio * math.sqrt(mass * stiffness))
    some = model(slider=slider, count=count, speed=speed)
    distance = round((40.0 + 20.0 * draw[5]) * some.mean_birth_spacing + some.mean_life_distance, 1)
    run = model(slider=slider, count=count, speed=speed, distance=distance)
    start = float(1.5 * draw[6] * run.equilibrium_displacement)
    found = coupled(run, case, displacement=start, cells=FINE)
    agree(found, reference(run, case, found, start))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("run", "start", "end", "kinds"),
    [
        (model(distance=100.0, count=2.0), -600.0, 0.05, {0, 2, 3}),
        (model(distance=40.0, count=3.0, start="empty"), -600.0, 0.03, {2, 3}),
        (model(distance=60.0, count=2.0, births="regular"), -700.0, 0.04, {0, 2, 3}),
        (model(distance=1500.0, count=0.2), None, np.inf, {0, 1, 2, 3}),
        (model(distance=30.0, slider=UNDAMPED), 100.0, np.inf, {0, 1}),
        (model(distance=30.0, slider=OVERDAMPED), 0.0, np.inf, {0, 1}),
        (model(distance=4.0, slider=STIFF), None, np.inf, set()),
        (model(distance=15.0, speed=100.0), None, np.inf, {0, 1}),
    ],
    ids=[
        "back before the start",
        "an empty start",
        "regular births",
        "no contact",
        "undamped",
        "over-damped",
        "stiff",
        "slow",
    ],
)
def test_cases_of_a_kind(run: Model, start: float | None, end: float, kinds: set[int]) -> None:
    found = coupled(run, 5, displacement=start, cells=FINE)
    early = found.landmarks["time"] < end
    assert set(found.landmarks["kind"][early].tolist()) == kinds
    agree(found, reference(run, 5, found, start, end), end)


@pytest.mark.slow
def test_another_speed_of_the_drive_is_seen() -> None:
    run, other = model(distance=40.0), model(distance=40.0, speed=1010.0)
    found = coupled(run, 2, cells=FINE)
    expected = reference(run, 2, found, None)
    agree(found, expected)
    with pytest.raises(AssertionError):
        agree(coupled(other, 2, cells=FINE), expected)


def test_first_passages_are_those_of_the_farthest_distance() -> None:
    """Going back and on again over the same junctions, nothing is born or dies twice."""
    run = model(distance=150.0, count=2.0)
    found = coupled(run, 5, displacement=-600.0)
    rows = field_of(run, 5)
    slider = found.slider
    assert (np.diff(slider["distance"]) < 0.0).sum() > 10
    places = [rows.birth[rows.birth > 0.0], rows.death[rows.death < run.distance]]
    for (junctions, times), place in zip((found.passed("birth"), found.passed("death")), places, strict=True):
        assert np.unique(junctions).size == junctions.size == place.size
        farthest = np.maximum.accumulate(slider["distance"])
        row = np.searchsorted(farthest, np.sort(place))
        inside = row < farthest.size
        assert np.all(np.sort(times)[inside] <= slider["time"][row[inside]] + 1e-12)
        assert np.all(np.sort(times)[inside] >= slider["time"][np.maximum(row[inside] - 1, 0)] - 1e-12)


def test_after_a_breakaway_the_slider_moves_on() -> None:
    """w and w' are 0 there, and rounding decides their sign: whoever asks for it sticks again at the same place."""
    told = coupled(model(distance=2000.0), 3).landmarks
    slip = np.flatnonzero(told["kind"][:-1] == 1)
    assert slip.size > 20
    assert np.all(told["distance"][slip + 1] > told["distance"][slip] + 1e-3)


@pytest.mark.parametrize("damping", [0.0, 0.05, 5.0])
def test_rows_obey_the_equation_between_them(damping: float) -> None:
    """s = V t - (x - x_0) in every row, x' is the slope of x, and stuck the force is k x + c V."""
    slider = Slider(mass=0.005, stiffness=300.0, damping=damping)
    run = model(slider=slider, distance=300.0, tick=0.02)
    rows = coupled(run, 3).slider
    travelled = 1000.0 * rows["time"] - (rows["displacement"] - run.equilibrium_displacement)
    assert np.abs(rows["distance"] - travelled).max() < 1e-9
    assert rows["time"] == pytest.approx(np.arange(rows["time"].size) * 2e-5, rel=1e-14)
    slope = (rows["displacement"][2:] - rows["displacement"][:-2]) / 4e-5
    assert np.abs(slope - rows["velocity"][1:-1]).max() < 2e-3 * np.abs(slope).max()
    stuck = rows["phase"] == 1
    assert damping == 5.0 or stuck.sum() > 1000
    held = 300.0 * rows["displacement"] + damping * rows["velocity"]
    assert rows["friction_force"][stuck] == pytest.approx(held[stuck], rel=1e-12)
    assert np.all(rows["velocity"][stuck] == 1000.0)
    field = field_of(run, 3)
    for n in range(0, rows["time"].size, 97):
        bears = coupled_slider.force_at(field, float(rows["distance"][n]))
        if stuck[n]:
            assert abs(rows["friction_force"][n]) <= bears * (1.0 + 1e-9)
        else:
            assert rows["friction_force"][n] == pytest.approx(bears, rel=1e-9, abs=1e-5 * 250.0 * 200.0)


# A two-way run in pieces: the same bits however it is cut, and nothing that grows with its length.
RUNS = {
    "figure 5": (model(distance=1500.0), None),
    "few, with reversals before the start": (model(distance=300.0, count=2.0), -600.0),
    "unequal strengths": (model(distance=1500.0, strength=UNEQUAL), None),
    "coarse ticks": (model(distance=1500.0, tick=7.0), None),
    "fine ticks": (model(distance=60.0, tick=0.004), None),
    "a distance off the grid": (model(distance=77.73), None),
    "empty": (model(distance=77.73, start="empty"), None),
}


@pytest.mark.parametrize("name", RUNS)
def test_bits_do_not_depend_on_where_a_run_is_cut(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    run, begin = RUNS[name]
    whole = coupled(run, 3, displacement=begin)
    assert coupled(run, 3, displacement=begin, pieces=7).contents() == whole.contents()
    monkeypatch.setattr(two_way, "CELLS", 2056)
    assert coupled(run, 3, displacement=begin).contents() == whole.contents()
    assert coupled(run, 4, displacement=begin).contents() != whole.contents()


def test_time_stays_sharp_however_far() -> None:
    """Rows lie at whole multiples of a tick over the speed, and the first at 0."""
    run = model(distance=500.0, speed=1e6)
    rows = coupled(run, 2).slider
    assert rows["time"].tobytes() == (np.arange(rows["time"].size) * 0.1 / 1e6).tobytes()
    assert rows["distance"][0] == 0.0
    assert rows["velocity"][0] == 0.0
    assert rows["displacement"][0] == run.equilibrium_displacement


@pytest.mark.parametrize("births", ["poisson", "regular"])
def test_the_past_of_a_stationary_start_is_stationary(births: str) -> None:
    """Counts behind the start have the mean of those beyond it: lam 2 E[d]; without the dead half of it is missing."""
    run = model(distance=10.0, births=births, count=10.0)
    places = -np.arange(3.0, 300.0, 30.0)
    counts, without = [], []
    for n in range(40):
        seed = seed_of(f"past/{births}/{n}")
        rows = lived(run, seed, -400.0, 10.0)
        live = (rows.birth <= places[:, None]) & (places[:, None] < rows.birth + 2.0 * rows.diameter)
        counts.append(live.sum(axis=1))
        without.append((live & (rows.birth + 2.0 * rows.diameter > 0.0)).sum(axis=1))
        assert np.all(np.diff(rows.birth) >= 0.0)
        assert np.unique(rows.junction).size == len(rows)
    expected = 2.0 * run.sizes.moment(1) * run.birth_rate
    deviation = np.mean(counts) - expected
    error = (expected / np.size(counts)) ** 0.5
    assert abs(deviation) < 4.0 * error
    assert abs(np.mean(without) - expected) > 4.0 * error
    assert np.mean(np.array(counts)[:, 0]) == pytest.approx(expected, abs=4.0 * (expected / 40) ** 0.5)
