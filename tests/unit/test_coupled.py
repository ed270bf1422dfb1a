"""The balance of energy of a two-way run, and its sticks and slips."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from rubnoise.analysis.motion import Balance, Sticks
from rubnoise.model import Slider
from rubnoise.record.rows import LandmarkKind

# The balance of a two-way run: its laws in closed form, and the work of friction against quadrature.
SLIDER = Slider(mass=0.005, stiffness=300.0, damping=0.05)
BEARS, SPEED, START, TIME = 3000.0, 40_000.0, 60.0, 0.0731


def sliding(bears: float = BEARS) -> Balance:
    """Return that of a slider on a constant force, which never comes to w = 0: a damped oscillation about G/k."""
    m, k, c = SLIDER.mass, SLIDER.stiffness, SLIDER.damping
    decay = c / (2.0 * m)
    rate = np.sqrt(k / m - decay * decay)
    away = START - bears / k
    nodes, weights = np.polynomial.legendre.leggauss(200)
    time = np.append(0.5 * TIME * (nodes + 1.0), TIME)
    phase = rate * time
    x = bears / k + away * np.exp(-decay * time) * (np.cos(phase) + decay / rate * np.sin(phase))
    v = -away * np.exp(-decay * time) * (decay * decay / rate + rate) * np.sin(phase)
    assert np.abs(v).max() < SPEED
    w = 0.5 * TIME * weights
    distance = SPEED * TIME - (x[-1] - START)
    return Balance(
        slider=SLIDER,
        speed=SPEED,
        start=START,
        time=TIME,
        distance=distance,
        displacement=float(x[-1]),
        velocity=float(v[-1]),
        time_stuck=0.0,
        displacement_integral=float(w @ x[:-1]),
        displacement_squared_integral=float(w @ x[:-1] ** 2),
        velocity_squared_integral=float(w @ v[:-1] ** 2),
        friction_work=bears * distance,
        reverse_work=0.0,
    )


@pytest.mark.parametrize("bears", [0.0, BEARS])
def test_a_constant_force_is_balanced(bears: float) -> None:
    found = sliding(bears)
    assert abs(found.energy_residual) < 1e-12
    assert found.impulse == pytest.approx(bears * TIME, rel=1e-11, abs=1e-11)
    assert found.mean_force == pytest.approx(bears, rel=1e-11, abs=1e-9)
    assert found.excess_over(found.friction_along) == pytest.approx(found.expected_excess(), abs=1e-9 * BEARS)
    # Moving towards the drive it slides less far in the same time: the mean force over time is not that over distance.
    assert found.distance != pytest.approx(SPEED * TIME, rel=1e-6)


@pytest.mark.parametrize(
    "column",
    ["displacement", "velocity", "displacement_integral", "velocity_squared_integral", "friction_work"],
)
def test_what_is_wrong_is_missing_in_the_balance(column: str) -> None:
    found = sliding()
    wrong = replace(found, **{column: 1.001 * getattr(found, column)})
    assert abs(wrong.energy_residual) > 1e-7
    assert wrong.excess_over(wrong.friction_along) != pytest.approx(wrong.expected_excess(), rel=1e-6)


def test_the_end_term_is_added_and_a_reversal_counts_twice() -> None:
    found = sliding()
    size = found.speed * found.time
    without = (found.dissipated + 2.0 * found.reverse_work) / size
    assert abs(found.expected_excess() - without) > 1.0
    assert found.expected_excess() == pytest.approx(without + found.stored / size, rel=1e-12)
    back = replace(found, friction_work=found.friction_work + 7.0, reverse_work=3.5)
    assert back.friction_along == pytest.approx(found.friction_along, rel=1e-15)


# Sticks and slips, read off landmarks that were written by hand.
@dataclass(frozen=True, kw_only=True)
class Held:
    """Rows of a made-up slider."""

    groups: dict[str, dict[str, Any]]
    columns: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def rows(self, group: str) -> int:
        return len(next(iter(self.groups[group].values())))

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> np.ndarray:
        return np.asarray(self.groups[group][name])[start:stop]


def _held(*landmarks: tuple[float, float, LandmarkKind]) -> Held:
    time, distance, kind = zip(*landmarks, strict=True)
    return Held(groups={"landmarks": {"time": time, "distance": distance, "displacement": distance, "kind": kind}})


def test_sticks_and_slips_are_those_of_the_landmarks() -> None:
    stick, slip, back, forward = LandmarkKind
    rows = _held(
        (1.0, 5.0, stick), (1.5, 5.0, slip), (1.8, 9.0, back), (2.0, 7.0, forward), (2.5, 8.0, stick), (4.0, 8.0, slip)
    )
    found = Sticks.of(rows, 0.0, 5.0)
    assert (found.begin.tolist(), found.end.tolist()) == ([1.0, 2.5], [1.5, 4.0])
    assert found.times.tolist() == [0.5, 1.5]
    assert found.slip_lengths.tolist() == [4.0]  # up to where it turns; the last slip never ends


def test_of_very_many_landmarks_the_first_are_taken() -> None:
    stick, slip, *_ = LandmarkKind
    rows = _held((1.0, 5.0, stick), (1.5, 5.0, slip), (2.5, 8.0, stick), (4.0, 8.0, slip))
    found = Sticks.of(rows, 0.0, 9.0, most=3)
    assert (found.begin.tolist(), found.end.tolist()) == ([1.0, 2.5], [1.5, 4.0])
    assert found.times.tolist() == [0.5]
