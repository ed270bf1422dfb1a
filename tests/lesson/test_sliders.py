"""The page's sliders beside the simulator's: one that pushes back, one that hops; event by event, and in statistics."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.arrays import Doubles
from rubnoise.simulation.free.encounters import RoughSurface
from rubnoise.simulation.free.step import Constants
from rubnoise.simulation.free_motion import FreeRun
from rubnoise.simulation.state import LiveRows
from tests.laws.scores import seed_of, z_scores
from tests.lesson.node import answer, scenario_of, world_with
from tests.models import CoupledRun, coupled, lived
from tests.oracle.sliders import bounce

pytestmark = pytest.mark.slow

LARGEST_Z = 4.0

# The slider that pushes back: landmark by landmark on one field, and in statistics.
STICK = 1

GIVEN = """
const source = { rows: rows.map(([birth, diameter, strength], id) =>
  ({ id, birth, diameter, strength, death: birth + 2 * diameter })), until() {} };
const field = new rub.Field(world, source, source.rows, end, cells);
field.past.rows = [];
field.past.until = () => {};
const motion = new rub.Motion(world, field, start);
motion.until({ work });
const { time, displacement, velocity, phase } = motion.columns;
const plain = (column) => column.values.subarray(0, column.length);
return { landmarks: motion.landmarks, range: motion.range, isOver: motion.isOver, moments: motion.moments(motion.time),
  work: motion.work, time: plain(time), displacement: plain(displacement), velocity: plain(velocity),
  phase: plain(phase), behind: field.behind.place.length };
"""
"""Runs a slider among junctions that are given, and no others."""

MANY = """
const found = [];
for (let i = 0; i < fields; i += 1) {
  const given = { ...world, seed: seed + i };
  const contact = rub.model.contact(given);
  const source = new rub.model.Births(given);
  const motion = new rub.Motion(given, new rub.Field(given, source, [], end), start);
  motion.until({});
  const { displacementMean, displacementStd, stuckShare, sticksPerSecond } = motion.moments(motion.time);
  found.push([Math.hypot(displacementStd, displacementMean - start), stuckShare, sticksPerSecond]);
}
return found;
"""
"""Runs a slider over fields of the page's own: spread about the start, share stuck, sticks per second of each."""


def on_the_page(
    world: dict[str, Any], rows: LiveRows, *, start: float, end: float, cells: int = 200, work: float = 1e9
) -> dict[str, Any]:
    columns = np.stack([rows.birth, rows.diameter, rows.strength], axis=1).tolist()
    found: dict[str, Any] = answer(GIVEN, world=world, rows=columns, start=start, end=end, cells=cells, work=work)
    return found


LARGEST_ERROR = 1e-4  # of the displacement, over one slip, as the page promises


def apart(page: dict[str, Any], run: CoupledRun, most: int) -> tuple[float, float]:
    """Return by how much the first landmarks, all of the same kinds, differ in time (s) and displacement (um)."""
    marks = page["landmarks"][:most]
    assert [mark["kind"] for mark in marks] == run.landmarks["kind"][:most].tolist()
    assert len(marks) == most
    times = np.array([mark["time"] for mark in marks]) - run.landmarks["time"][:most]
    places = np.array([mark["displacement"] for mark in marks]) - run.landmarks["displacement"][:most]
    return float(np.abs(times).max()), float(np.abs(places).max())


PATHS = {
    "Figure 5": ({}, 400.0),
    "faster": ({"speed": 10000.0}, 1400.0),
    "slower": ({"speed": 100.0}, 200.0),
    "few junctions": ({"meanCount": 2.0}, 700.0),
    "damped": ({"damping": 5.0}, 400.0),
}


@pytest.mark.parametrize("name", PATHS)
def test_on_the_same_field_the_landmarks_are_the_simulators(name: str) -> None:
    """Errors grow by up to fifty from slip to slip, so that for eight landmarks the field is finer than on the page."""
    changes, distance = PATHS[name]
    world = world_with(**changes)
    model = scenario_of(world, distance=distance).model()
    run = coupled(model, 5, cells=1600)
    rows = lived(model, 5, -200.0, distance)
    fine = on_the_page(world, rows, start=run.start, end=distance, cells=1600)
    late, off = apart(fine, run, 8)
    assert off < 2e-2
    assert late * world["speed"] < 2e-2
    page = on_the_page(world, rows, start=run.start, end=distance)
    assert apart(page, run, 3)[1] < LARGEST_ERROR * abs(run.landmarks["displacement"][:3]).max()


def test_another_junction_leads_to_other_landmarks() -> None:
    world = world_with()
    model = scenario_of(world, distance=700.0).model()
    run, rows = coupled(model, 5, cells=1600), lived(model, 5, -200.0, 700.0)
    wider = rows.diameter.copy()
    wider[np.searchsorted(rows.birth, run.landmarks["distance"][0] - 5.0)] *= 1.01
    other = LiveRows(
        junction=rows.junction, birth=rows.birth, diameter=wider, strength=rows.strength, departure=rows.departure
    )
    assert apart(on_the_page(world, other, start=run.start, end=700.0), run, 3)[1] > 1e-2


def simulated(world: dict[str, Any], distance: float, fields: int, seed: int) -> tuple[Doubles, float]:
    """Return of each run the spread about the start, the share stuck and sticks per second; and where it starts."""
    model = scenario_of(world, distance=distance).model()
    found = []
    for i in range(fields):
        run = coupled(model, seed + i)
        x, phase = run.slider["displacement"], run.slider["phase"]
        sticks = np.count_nonzero(run.landmarks["kind"] == 0)
        found.append([sqrt(np.mean((x - run.start) ** 2)), np.mean(phase == STICK), sticks / run.duration])
    return np.array(found), run.start


STATISTICS = {"Figure 5": ({}, 1000.0), "faster": ({"speed": 10000.0}, 3000.0)}


def compare_statistics(name: str, fields: int, longer: float) -> None:
    changes, distance = STATISTICS[name]
    world, seed = world_with(**changes), seed_of(f"two-way page {name}") % 2**40
    there, start = simulated(world, longer * distance, fields, seed)
    given = {"start": start, "end": longer * distance, "fields": fields, "seed": seed + 10**6}
    here = np.array(answer(MANY, world=world, **given))
    assert np.abs(z_scores(here, there)).max() <= LARGEST_Z
    # Weaker by a half, a contact lets the slider swing less: a few fields notice it.
    weaker = np.array(answer(MANY, world=world | {"strength": 125.0}, **given | {"fields": 8}))
    assert np.abs(z_scores(weaker, there)).max() > LARGEST_Z


@pytest.mark.parametrize("name", STATISTICS)
def test_statistics_are_the_simulators(name: str) -> None:
    compare_statistics(name, 8, 0.75)


BEHIND = """
const found = [];
for (let i = 0; i < fields; i += 1) {
  const given = { ...world, seed: seed + i };
  const field = new rub.Field(given, new rub.model.Births(given), [], 10);
  let node = -1;
  while (field.place(node) > -place) node -= 1;
  found.push([field.force(node) / given.strength, Math.abs(field.force(-1) - field.force(0))]);
}
return found;
"""


@pytest.mark.parametrize("births", ["poisson", "regular"])
@pytest.mark.parametrize("place", [6.0, 60.0])
def test_behind_the_start_the_contact_is_what_it_is_elsewhere(births: str, place: float) -> None:
    """Its mean and variance, nearer and further than a life; and nothing jumps at the start."""
    world = world_with(births=births, spread=1.5, meanCount=4.0)
    theory, fields = rubnoise.exact(scenario_of(world)), 1500
    found = np.array(answer(BEHIND, world=world, fields=fields, place=place, seed=seed_of(f"past {births}") % 2**40))
    area = found[:, 0]
    assert abs(area.mean() - theory.area.mean) <= LARGEST_Z * theory.area.std / sqrt(fields)
    assert abs(area.mean() - 0.9 * theory.area.mean) > LARGEST_Z * theory.area.std / sqrt(fields)
    squares = (area - theory.area.mean) ** 2
    assert abs(squares.mean() - theory.area.variance) <= LARGEST_Z * squares.std() / sqrt(fields)
    assert found[:, 1].max() < 0.1 * world["strength"] * theory.area.mean


# The slider that hops: beside Verlet over the same summits, and beside the simulator's statistics.
LARGEST_FLIGHT_ERROR = 3e-4  # of the height scale, over a few impacts
LOSS = 0.3
SETTLED = 20.0
TICK_TIME = 0.01  # of 1/omega_c

ALONG = """
const unit = rub.flight.scalesOf({ ...world, speed: 1 }).speed;
const flight = new rub.flight.Flight({ ...world, speed: speed / unit },
  { between: () => [0, place.length], place: { values: place }, height: { values: height } });
flight.until(duration * flight.speed * flight.length);
const { place: at, z } = flight.columns;
return [at.values.subarray(0, at.length), z.values.subarray(0, z.length)];
"""
"""Returns places in c, and z in s0 there, over summits that are given."""

HOPS = """
const unit = rub.flight.scalesOf({ ...world, speed: 1 }).speed;
return Array.from({ length: runs }, (_, i) => {
  const flight = new rub.flight.Flight({ ...world, speed: speed / unit, seed: seed + i });
  const end = duration * flight.speed * flight.length;
  flight.until(end);
  const { apartShare, loadMean, riseStd } = flight.moments(end);
  return [apartShare, riseStd / (flight.height * flight.rate), loadMean];
});
"""
"""Returns the share of time apart, the rms of z' and the mean load, each in the model's units."""


def light(**changes: Any) -> dict[str, Any]:
    """Return the slider of the lesson, with changes."""
    rough = {"pulse": "parabola", "sizes": "rayleigh", "calibration": "matched", "spread": 0.0, "support": "free"}
    return world_with(**(rough | {"meanCount": 0.5, "heights": 0.5} | changes))


def free_run(live: float, speed: float, seed: int) -> FreeRun:
    return FreeRun(Constants(speed, 1.0 / live, growth=LOSS), RoughSurface.of(live, seed, speed * TICK_TIME))


def hopped(live: float, speed: float, duration: float, seed: int) -> list[float]:
    blocks = list(free_run(live, speed, seed).through(round(duration / TICK_TIME)))
    ticks = np.concatenate([block.ticks for block in blocks])[round(SETTLED / TICK_TIME) :]
    apart, rise = float(np.mean(ticks["live"] == 0.0)), sqrt(float(np.mean(ticks["w"] ** 2)))
    return [apart, rise, float(np.mean(ticks["load"]))]


@pytest.mark.parametrize(("live", "speed"), [(0.5, 0.4), (0.5, 1.0), (3.0, 0.6)])
def test_over_the_same_summits_it_goes_as_verlet_does(live: float, speed: float) -> None:
    """Steps of second order, 40 to 60 times as long as Verlet's, until chaos parts them."""
    duration, steps = 6.0, 48_000
    around = free_run(live, speed, 5).surface.around(0, 1)
    near = np.abs(around["place"]) < 9.0
    place, height = around["place"][near], around["height"][near]
    times = np.linspace(0.0, duration, steps // 10 + 1)
    z = bounce(place, height, live, speed, lambda rate: np.maximum(0.0, 1.0 + LOSS * rate), duration, steps, finer=1)
    given = {"place": place.tolist(), "height": height.tolist(), "duration": 0.98 * duration, "speed": speed}
    at, found = np.array(answer(ALONG, world=light(meanCount=live), **given))
    assert np.ptp(found) > 0.5
    assert np.abs(found - np.interp(at / speed, times, z)).max() < LARGEST_FLIGHT_ERROR
    # A summit less, among those that are touched, leads elsewhere.
    touched = int(np.argmax(np.where(np.abs(place - 0.5 * speed * duration) < 1.0, height, -np.inf)))
    given |= {"place": np.delete(place, touched).tolist(), "height": np.delete(height, touched).tolist()}
    at, other = np.array(answer(ALONG, world=light(meanCount=live), **given))
    assert np.abs(other - np.interp(at / speed, times, z)).max() > 100.0 * LARGEST_FLIGHT_ERROR


@pytest.mark.parametrize("speed", [0.4, 0.8])
def test_hops_have_the_statistics_of_the_simulators(speed: float) -> None:
    """Share of time apart, rms of z' and mean load: of runs on summits of their own, both with 0.3 of loss."""
    runs, duration, seed = 24, 300.0, seed_of(f"flight of the page {speed}") % 2**40
    there = np.array([hopped(0.5, speed, duration, seed + i) for i in range(runs)])
    given = {"duration": duration, "runs": runs, "seed": seed + 10**6}
    here = np.array(answer(HOPS, world=light(), speed=speed, **given))
    assert np.abs(z_scores(here, there)).max() <= LARGEST_Z
    # Faster by a quarter it hops more: it would be noticed.
    faster = np.array(answer(HOPS, world=light(), speed=1.25 * speed, **given))
    assert z_scores(faster, there).max() > LARGEST_Z
