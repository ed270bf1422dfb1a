"""Where a run forgets its start, the length that errors of its moments need, and errors of its autocovariances."""

from contextlib import suppress
from dataclasses import replace
from functools import lru_cache
from math import ceil, hypot, inf, log
from typing import Final

import numpy as np

from rubnoise.analysis.findings import LARGEST_ERROR
from rubnoise.analysis.records import longer
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.coupling import coupling, load_motion, weak_motion
from rubnoise.theory.motion import contact_drive_of, response
from rubnoise.theory.sampling import motion_errors
from rubnoise.theory.second_order import are_at_random, autocovariance
from rubnoise.theory.sizes import COARSE, longest_life, sizes_of
from rubnoise.theory.unit_pulse import area_life

_FORGOTTEN: Final = 1e-3  # part of its spread that the start of a motion still adds where it counts as forgotten

FEWEST_LIVES = 50
FEWEST_BIRTHS = 1000
"""Mean lives and expected births from which the mean of a record is near enough to a normal law for a score.

Shorter runs get no standard errors of higher moments either: these are of first order in life/run.
"""


def over_ticks(model: Model, ticks: int) -> Model:
    """Return the model of a stationary stretch of ``ticks`` ticks."""
    return replace(model, start="stationary", tick_count=ticks - 1, distance=max(ticks - 1, 1) * model.tick)


def forgetting(model: Model) -> dict[str, int]:
    """Return the first tick of each group at which its start is forgotten, however long the run.

    The contact is stationary after a longest life, if its start was empty. The start of a motion is forgotten where it
    leaves a thousandth of its spread. At its start the load lacks the part of the separation, W/s_0 std z, and W after
    an empty start. Where theory has no motion to compare nothing more is forgotten.
    """
    empty, slider = model.start == "empty", model.slider
    found = dict.fromkeys(("trace", "slider", "load"), ceil(longest_life(model) / model.tick) if empty else 0)
    if slider is not None and slider.damping > 0.0 and model.free is None:
        with suppress(Refused):
            exact = weak_motion(model) if model.is_two_way else response(model)
            spread = hypot(exact.displacement_std, exact.velocity_std / slider.natural_angular_frequency)
            away = abs(exact.mean_displacement - (0.0 if empty else model.equilibrium_displacement))
            if spread > 0.0:
                found["slider"] += _ticks_to_forget(model, "slider", 1.0 + away / spread)
    if model.separation is not None:
        drive, motion = contact_drive_of(model), load_motion(model)
        lacking = drive.slider.stiffness * motion.separation_std + (model.load or 0.0) * empty
        found["load"] += _ticks_to_forget(model, "load", max(lacking / motion.load_std, 1.0))
    return found


def _ticks_to_forget(model: Model, group: str, spreads: float) -> int:
    """Return the ticks in which a start that is so many spreads away decays to a thousandth of one."""
    return ceil(log(spreads / _FORGOTTEN) * decay(model, group) / model.tick)


@lru_cache(maxsize=8)
def settled(model: Model) -> dict[str, int | None]:
    """Return the first tick of each group at which its start is forgotten; None if too little of the run is left.

    After an empty start 50 mean lives must be left, of a motion 10 decay times.
    """
    lives = FEWEST_LIVES * model.mean_life_distance if model.start == "empty" else 0.0
    return {
        group: first if model.distance - first * model.tick >= max(lives, FEWEST_DECAYS * decay(model, group)) else None
        for group, first in forgetting(model).items()
    }


def needed_for_mean(model: Model) -> float:
    """Return the length in um from which a mean over a record of the contact has a score: 50 lives, 1000 births."""
    return max(FEWEST_LIVES * model.mean_life_distance, FEWEST_BIRTHS * model.mean_birth_spacing)


FEWEST_DECAYS = 10
"""Least decay times of a motion that a run has, and after its start is forgotten one with standard errors of it."""


def needed_for_motion(model: Model) -> float | None:
    """Return the length in um that standard errors of a slider's motion need, if a run is far too short for them.

    Its start is forgotten then, and FEWEST_DECAYS are left, in which the standard deviations would be known to a tenth.
    It never has them without slider or damping, or from an empty start. Errors fall as one over the root of the
    distance; births that are not random have only the error of the mean, which needs only the decay times.
    """
    needed = FEWEST_DECAYS * decay(model, "slider")
    if not model.distance < needed < inf or model.start != "stationary":
        return None
    if are_at_random(model):
        errors, exact = motion_errors(model, needed), response(model)
        relative = max(errors["displacement_std"] / exact.displacement_std, errors["velocity_std"] / exact.velocity_std)
        needed = max(needed, longer(needed, relative, LARGEST_ERROR))
    return forgetting(model)["slider"] * model.tick + needed


def decay(model: Model, group: str) -> float:
    """Return the sliding distance in um in which the slowest free motion of a group decays by e.

    It is 0 without a motion, and inf if it never decays or theory does not know it.
    """
    slider = model.slider
    if group == "load":
        slider = model.separation.oscillator if model.separation is not None else None
    if group == "trace" or slider is None:
        return 0.0
    unknown = model.free is not None or (model.is_two_way and coupling(model).unknown is not None)
    if unknown or model.sliding_speed is None or slider.damping == 0.0:
        return inf
    return max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness) * model.sliding_speed


_GRID = 1024


def covariance_errors(model: Model, lag: Doubles, length: float, tick: float) -> Doubles:
    """Return standard errors in um^4 of autocovariances at lags in um, from a record of ``length`` T um.

    Var = (1/T) (int (R(u)^2 + R(u + tau) R(u - tau)) du + lam E[(int A(s) A(s + tau) ds)^2]) for a contact with births
    at random, of first order in life/T; the integral over u is a sum over ticks where these are wide apart.
    Source: Bartlett (1946), doi:10.2307/2983611, with the fourth cumulant of shot noise, integrated over u.
    """
    longest = 2.0 * model.sizes.support[1]
    step = max(tick, longest / _GRID)
    reach = ceil(longest / step) + 1
    half = autocovariance(model, step * np.arange(reach + 1))
    covariance = np.concatenate([half[:0:-1], half])
    # R is even, so that int R(u + tau) R(u - tau) du is its convolution with itself at 2 tau.
    pairs = step * np.convolve(covariance, covariance)
    gaussian = pairs[2 * reach] + np.interp(2.0 * lag, step * np.arange(-2 * reach, 2 * reach + 1), pairs, right=0.0)
    sizes, overlap = sizes_of(model.sizes, COARSE), area_life(model.pulse).overlap
    shared = np.stack([d**5 * overlap(lag / d) for d in sizes.diameter.tolist()])
    return np.sqrt((gaussian + model.birth_rate * (sizes.probability @ np.square(shared))) / length)


WORTH_A_WARNING: Final = 0.1
"""Spread of the slider's velocity over the sliding speed from which one-way coupling is in doubt."""


def one_way_warnings(model: Model, validity: float) -> list[str]:
    """Return warnings about one-way coupling for a spread of the slider's velocity, compared with the sliding speed.

    They advise two-way coupling only if the scenario allows it.
    """
    if model.slider is None or model.is_two_way or not validity > WORTH_A_WARNING:
        return []
    if model.slider.excitation == "base":
        return []  # which lifts the slider, normal to the sliding
    if model.held is not None:
        advice = "two-way coupling is known at constant separation alone, so without [load]"
    else:
        advice = f'two-way coupling (slider.coupling = "two-way") is needed above {WORTH_A_WARNING:g}'
    spread = f"the velocity of the slider spreads by {validity:.3g} times the sliding speed"
    return [f"{spread}, which one-way coupling takes for constant; {advice}"]
