"""A two-way run as a fold: the state of the motion and the rows it may still meet in, the same and columns out."""

from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.simulation.coupled import motion, rows
from rubnoise.simulation.coupled.field import GROUP, Field
from rubnoise.simulation.coupled.quadrature import NODES, TABLE
from rubnoise.simulation.coupled.steps import WORK
from rubnoise.simulation.kernels import Room
from rubnoise.simulation.state import LiveRows

Doubles = NDArray[np.float64]

FINENESS: Final = 100.0
"""Cells to a diameter at least: from 96 on the kernels sum lives as series."""

_LANDMARKS: Final = 4096
_ROWS: Final = 65_536


def spacing(model: Model) -> float:
    """Return the width of a cell in um: the tick times a power of two."""
    width = model.tick
    while width * FINENESS > model.calibrated_diameter:
        width *= 0.5
    while 2.0 * width * FINENESS <= model.calibrated_diameter:
        width *= 2.0
    return width


def constants(model: Model, tolerance: float) -> Doubles:
    """Return the numbers that stay the same through a run, at the places that `steps` and `rows` name."""
    slider, strengths, speed = model.slider, model.strengths, model.sliding_speed
    assert slider is not None and strengths is not None and speed is not None
    width = spacing(model)
    scale = strengths.moment(1) * model.stationary_mean_area / slider.stiffness
    error = tolerance * scale
    kink = 3.0 * strengths.moment(1) * model.calibrated_diameter * max(1.0, (4.0 * width * model.birth_rate)) ** 0.5
    bend = 0.4
    while (bend / 0.2) ** 6 > tolerance / 1e-9:
        bend *= 0.9375
    found = np.zeros(rows.CONSTANTS)
    found[:4] = slider.mass, slider.stiffness, slider.damping, speed
    found[rows.SPACING] = width
    found[rows.ROW_TIME] = model.tick / speed
    found[rows.LIMIT] = 0.3 * error
    found[rows.BEND_LIMIT] = bend
    found[rows.KINK_LIMIT] = 0.3 * error * slider.mass / (7e-4 * kink * width * width * width)
    found[rows.TOUCH] = 0.1 * tolerance * speed
    found[rows.LONGEST] = 1.0 / slider.natural_angular_frequency
    return found
