"""Two references for the slider that share only the list of junctions give the same motion, and see small faults."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.oracle import dop853_slider, straight_slider, theta_slider
from tests.oracle.oscillator import Doubles, Motion, Oscillator
from tests.oracle.slow_contact import Rows, naive_rows

SPEED = 1000.0
MASS, STIFFNESS = 0.005, 300.0
CRITICAL = 2 * math.sqrt(MASS * STIFFNESS)
EQUILIBRIUM = (250 * 204.6736 / STIFFNESS, 0.0)
SLIDERS = {
    "figure 5": (0.05, 200.0),
    "over-damped": (20 * CRITICAL, 40.0),
    "critical": (CRITICAL, 40.0),
    "nearly critical": (1.001 * CRITICAL, 40.0),
}
AGREEMENT = 1e-12


def slider(damping: float) -> Oscillator:
    return Oscillator(mass=MASS, stiffness=STIFFNESS, damping=damping)


def figure_5_rows(distance: float) -> Rows:
    generator = np.random.default_rng(20)
    return naive_rows(
        mean_area=200, mean_count=20, diameter_std=0.2, strength=250, distance=distance, generator=generator
    )


def ticks(distance: float, tick: float) -> Doubles:
    return np.arange(round(distance / tick) + 1) * tick


def difference(one: Motion, other: Motion) -> float:
    """Return the largest difference of displacement or velocity, each relative to its largest value."""
    displacement = np.abs(one.displacement - other.displacement).max() / np.abs(one.displacement).max()
    velocity = np.abs(one.velocity - other.velocity).max() / np.abs(one.velocity).max()
    return float(max(displacement, velocity))


@pytest.mark.parametrize("name", SLIDERS)
def test_both_references_give_the_same_motion(name: str) -> None:
    damping, distance = SLIDERS[name]
    rows, places = figure_5_rows(distance), ticks(distance, 2.0)
    theta = theta_slider.motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    stepped = dop853_slider.motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) < AGREEMENT


def test_both_references_agree_from_rest_and_in_motion_at_a_slow_speed() -> None:
    rows, places = figure_5_rows(12.0), ticks(12.0, 1.0)
    start = (0.0, 500.0)
    theta = theta_slider.motion(slider(0.05), 50.0, places, rows, start)
    stepped = dop853_slider.motion(slider(0.05), 50.0, places, rows, start)
    assert difference(theta, stepped) < AGREEMENT


@pytest.mark.parametrize("name", SLIDERS)
def test_both_references_for_triangles_give_the_same_motion(name: str) -> None:
    damping, distance = SLIDERS[name]
    rows, places = figure_5_rows(distance), ticks(distance, 2.0)
    rows = rows.ending_early(7, rows.birth[7] + 0.4 * rows.diameter[7])
    rows = rows.ending_early(33, rows.birth[33] + 1.3 * rows.diameter[33])
    straight = straight_slider.motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    triangles = dop853_slider.motion(slider(damping), SPEED, places, rows, EQUILIBRIUM, dop853_slider.triangle_areas)
    lenses = dop853_slider.motion(slider(damping), SPEED, places, rows, EQUILIBRIUM)
    assert difference(straight, triangles) < AGREEMENT
    assert difference(straight, lenses) > 1e-3


@pytest.mark.parametrize("damping", [0.05, CRITICAL, 20 * CRITICAL])
def test_the_theta_reference_does_not_depend_on_its_ticks(damping: float) -> None:
    rows = figure_5_rows(40.0)
    coarse = theta_slider.motion(slider(damping), SPEED, ticks(40.0, 2.0), rows, EQUILIBRIUM)
    fine = theta_slider.motion(slider(damping), SPEED, ticks(40.0, 0.1), rows, EQUILIBRIUM)
    sampled = Motion(displacement=fine.displacement[::20], velocity=fine.velocity[::20])
    assert difference(coarse, sampled) < 1e-13


def test_a_junction_that_ends_early_ends_early_in_both() -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    row = int(np.searchsorted(rows.birth, 5.0))
    for share in (0.4, 1.3):
        changed = rows.ending_early(row, rows.birth[row] + share * rows.diameter[row])
        theta = theta_slider.motion(slider(0.05), SPEED, places, changed, EQUILIBRIUM)
        stepped = dop853_slider.motion(slider(0.05), SPEED, places, changed, EQUILIBRIUM)
        whole = theta_slider.motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
        assert difference(theta, stepped) < AGREEMENT
        assert difference(whole, stepped) > 1e-3


def test_a_death_moved_by_a_hundredth_of_a_life_is_seen() -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    row = int(np.searchsorted(rows.birth, 1.0))
    moved = rows.ending_early(row, rows.birth[row] + 1.98 * rows.diameter[row])
    theta = theta_slider.motion(slider(0.05), SPEED, places, moved, EQUILIBRIUM)
    stepped = dop853_slider.motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) > 1e4 * AGREEMENT


def test_a_forgotten_kink_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    rows, places = figure_5_rows(20.0), ticks(20.0, 1.0)
    stepped = dop853_slider.motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    cut = theta_slider.pieces

    def without_mid_life(rows: Rows, row: int, places: Doubles) -> Doubles:
        cuts = cut(rows, row, places)
        return cuts[cuts != rows.birth[row] + rows.diameter[row]]

    monkeypatch.setattr(theta_slider, "pieces", without_mid_life)
    theta = theta_slider.motion(slider(0.05), SPEED, places, rows, EQUILIBRIUM)
    assert difference(theta, stepped) > 1e4 * AGREEMENT


def test_free_motion_is_the_textbook_one() -> None:
    # Without junctions the under-damped answer is a decaying cosine; a wrong transition cannot hide behind the force.
    none = np.empty(0)
    rows = Rows(birth=none, diameter=none, strength=none, death=none)
    places = ticks(100.0, 1.0)
    decay = 0.05 / (2 * MASS)
    rate = math.sqrt(STIFFNESS / MASS - decay**2)
    time = places / SPEED
    expected = 3.0 * np.exp(-decay * time) * (np.cos(rate * time) + decay / rate * np.sin(rate * time))
    for oracle in (theta_slider, dop853_slider):
        x = oracle.motion(slider(0.05), SPEED, places, rows, (3.0, 0.0)).displacement
        assert np.abs(x - expected).max() < 1e-11
