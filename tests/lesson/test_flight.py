"""The page's slider that hops: beside Verlet over the same summits, and beside the simulator's statistics."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

from rubnoise.simulation.free import motion
from rubnoise.simulation.free.fold import FreeContact, FreeRun
from tests.lesson.node import answer, world_with
from tests.oracle.free_slider import bounce
from tests.verification.scores import seed_of, z_scores

LARGEST_Z = 4.0
LARGEST_ERROR = 3e-4  # of the height scale, over a few impacts
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

MANY = """
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
    contact = FreeContact(live=live, speed=speed, tick=speed * TICK_TIME, impact_damping=LOSS)
    return FreeRun(contact, seed)


def simulated(live: float, speed: float, duration: float, seed: int) -> list[float]:
    blocks = list(free_run(live, speed, seed).through(round(duration / TICK_TIME)))
    ticks = np.concatenate([block.ticks for block in blocks], axis=1)[:, round(SETTLED / TICK_TIME) :]
    apart, rise = float(np.mean(ticks[motion.TICK_LIVE] == 0.0)), sqrt(float(np.mean(ticks[motion.TICK_W] ** 2)))
    return [apart, rise, float(np.mean(ticks[motion.TICK_LOAD]))]


@pytest.mark.parametrize(("live", "speed"), [(0.5, 0.4), (0.5, 1.0), (3.0, 0.6)])
def test_over_the_same_summits_it_goes_as_verlet_does(live: float, speed: float) -> None:
    """Steps of second order, 40 to 60 times as long as Verlet's, until chaos parts them."""
    duration, steps = 6.0, 48_000
    around = free_run(live, speed, 5).surface.around(0, 1)
    near = np.abs(around.place) < 9.0
    place, height = around.place[near], around.height[near]
    times = np.linspace(0.0, duration, steps // 10 + 1)
    z = bounce(place, height, live, speed, lambda rate: np.maximum(0.0, 1.0 + LOSS * rate), duration, steps, finer=1)
    given = {"place": place.tolist(), "height": height.tolist(), "duration": 0.98 * duration, "speed": speed}
    at, found = np.array(answer(ALONG, world=light(meanCount=live), **given))
    assert np.ptp(found) > 0.5
    assert np.abs(found - np.interp(at / speed, times, z)).max() < LARGEST_ERROR
    # A summit less, among those that are touched, leads elsewhere.
    touched = int(np.argmax(np.where(np.abs(place - 0.5 * speed * duration) < 1.0, height, -np.inf)))
    given |= {"place": np.delete(place, touched).tolist(), "height": np.delete(height, touched).tolist()}
    at, other = np.array(answer(ALONG, world=light(meanCount=live), **given))
    assert np.abs(other - np.interp(at / speed, times, z)).max() > 100.0 * LARGEST_ERROR


@pytest.mark.parametrize("speed", [0.4, 0.8])
def test_hops_have_the_statistics_of_the_simulators(speed: float) -> None:
    """Share of time apart, rms of z' and mean load: of runs on summits of their own, both with 0.3 of loss."""
    runs, duration, seed = 24, 300.0, seed_of(f"flight of the page {speed}") % 2**40
    there = np.array([simulated(0.5, speed, duration, seed + i) for i in range(runs)])
    given = {"duration": duration, "runs": runs, "seed": seed + 10**6}
    here = np.array(answer(MANY, world=light(), speed=speed, **given))
    assert np.abs(z_scores(here, there)).max() <= LARGEST_Z
    # Faster by a quarter it hops more: it would be noticed.
    faster = np.array(answer(MANY, world=light(), speed=1.25 * speed, **given))
    assert z_scores(faster, there).max() > LARGEST_Z


def test_the_speed_over_the_root_of_the_height_is_all_that_counts() -> None:
    """Four times the height at half the speed: bit for bit the same motion, and at equal speed another."""
    given = {"duration": 60.0, "runs": 2, "seed": 3}
    low, high = (answer(MANY, world=light(heights=height), speed=0.4, **given) for height in (0.5, 2.0))
    assert low == high
    assert answer(MANY, world=light(heights=2.0), speed=0.8, **given) != low


SPEEDS = "return worlds.map((world) => rub.flight.scalesOf(world).speed);"


def test_half_the_speed_makes_up_for_four_times_the_height() -> None:
    worlds = [light(speed=8e4), light(speed=4e4, heights=2.0), light(speed=8e4, heights=2.0)]
    low, half, same = answer(SPEEDS, worlds=worlds)
    assert half == pytest.approx(low, rel=1e-12)
    assert same == pytest.approx(2.0 * low, rel=1e-12)


EVENTS = """
const flight = new rub.flight.Flight(world);
const found = [];
for (let next = flight.next(0, 2000); next; next = flight.next(next.distance, 2000)) found.push(next);
return found;
"""


def test_events_are_contact_lost_and_made_in_turn() -> None:
    events = answer(EVENTS, world=light(speed=8e4))
    assert len(events) > 10
    distances = [each["distance"] for each in events]
    assert distances == sorted(distances)
    kinds = [each["kind"] for each in events]
    assert {*kinds[::2]} | {*kinds[1::2]} == {"contact lost", "contact made"}
    assert kinds[::2] == kinds[:1] * len(kinds[::2])
    assert distances[-1] <= 2000.0
