"""The slow references of tests/oracle, which share no code with rubnoise nor with any other tool."""

import sys
from pathlib import Path
from types import ModuleType

from bench.case import DAMPING, MASS, SPEED, STIFFNESS, STRENGTH, Case, Doubles
from bench.peers.coupled_sliders import Stretch

if "tests" not in sys.modules:
    # A peer's package brings a folder of this name into the environment, which would hide the project's.
    sys.modules["tests"] = ModuleType("tests")
    sys.modules["tests"].__path__ = [str(Path(__file__).resolve().parents[2] / "tests")]

import numpy as np

from tests.oracle import coupled_slider
from tests.oracle.sliders import Oscillator, theta_motion
from tests.oracle.slow_contact import Rows, traces


def rows(birth: Doubles, diameter: Doubles) -> Rows:
    """Return junctions as the references take them."""
    strength = np.full(birth.size, STRENGTH)
    return Rows(birth=birth, diameter=diameter, strength=strength, death=birth + 2.0 * diameter)


def area(case: Case, birth: Doubles, diameter: Doubles) -> Doubles:
    """Return the real contact area (um^2) at the ticks: the sum over all live junctions, one by one."""
    return traces(rows(birth, diameter), case.ticks)[0]


def displacement(case: Case, birth: Doubles, diameter: Doubles) -> Doubles:
    """Return the slider's displacement (um) at the ticks, by exact convolution."""
    slider = Oscillator(mass=MASS, stiffness=STIFFNESS, damping=DAMPING)
    return theta_motion(slider, SPEED, case.ticks, rows(birth, diameter), (0.0, 0.0)).displacement


def coupled_displacement(stretch: Stretch, tolerance: float) -> Doubles:
    """Return the displacement (um) of a slider that pushes back, by an adaptive method with events."""
    slider = Oscillator(mass=stretch.mass, stiffness=stretch.stiffness, damping=stretch.damping)
    junctions = Rows(
        birth=stretch.birth,
        diameter=stretch.diameter,
        strength=stretch.strength,
        death=stretch.birth + 2.0 * stretch.diameter,
    )
    end = float(stretch.times[-1]) + 1e-9
    moved = coupled_slider.motion(slider, stretch.speed, junctions, stretch.displacement, end, tolerance=tolerance)
    return moved.at(stretch.times)[0]
