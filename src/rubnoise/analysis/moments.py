"""The length that a record needs for errors of its moments, and the errors of the contact's autocovariances."""

from dataclasses import dataclass, replace
from math import ceil, inf
from typing import Final

import numpy as np

from rubnoise.analysis.records import longer
from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import Fixed
from rubnoise.model import Model, Slider
from rubnoise.theory.coupling import coupling
from rubnoise.theory.motion import response
from rubnoise.theory.sampling import motion_errors
from rubnoise.theory.second_order import are_at_random, autocovariance
from rubnoise.theory.sizes import COARSE, longest_life, sizes_of

FEWEST_LIVES = 50
FEWEST_BIRTHS = 1000
"""Mean lives and expected births from which the mean of a record is near enough to a normal law for a score.

Shorter runs get no standard errors of higher moments either: these are of first order in life/run.
"""

LARGEST_ERRORS = {"std": 0.1, "skewness": 0.2, "excess_kurtosis": 0.4}
"""Standard errors (that of the std over the std itself) up to which an estimate counts as defended.

All three are of first order in life/record: what they leave out is about their square.
"""


def over_ticks(model: Model, ticks: int, tick: float) -> Model:
    """Return the model of a stationary stretch of ``ticks`` ticks, ``tick`` um apart."""
    return replace(model, start="stationary", tick=tick, tick_count=ticks - 1, distance=max(ticks - 1, 1) * tick)


def first_stationary_tick(model: Model) -> int:
    """Return the first tick from which the contact is stationary: after a longest life if the start was empty."""
    return 0 if model.start == "stationary" else ceil(longest_life(model) / model.tick)


def needed_for_mean(model: Model) -> float:
    """Return the length in um from which a mean over a record of the contact has a score: 50 lives, 1000 births."""
    return max(FEWEST_LIVES * model.mean_life_distance, FEWEST_BIRTHS * model.mean_birth_spacing)


FEWEST_DECAYS = 10
"""Least decay times of the slider in a run with standard errors of its motion."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MissingMotion:
    """The length that a run lacks for standard errors of its slider's motion.

    It lasts ``decays`` decay times, and FEWEST_DECAYS are needed; after ``needed`` um of sliding the standard
    deviations of displacement and velocity would be known to a tenth.
    """

    decays: float
    needed: float


def missing_for_motion(model: Model) -> MissingMotion | None:
    """Return the length that a run lacks for standard errors of its slider's motion; None if it has or never has them.

    It never has them without slider or damping, or from an empty start. Errors fall as one over the root of the
    distance; births that are not random have only the error of the mean, which needs only the decay times.
    """
    decays = decays_of(model, model.slider)
    if decays is None or decays >= FEWEST_DECAYS or model.start != "stationary":
        return None
    shortest = model.distance * FEWEST_DECAYS / decays
    if not are_at_random(model):
        return MissingMotion(decays=decays, needed=shortest)
    errors, exact = motion_errors(model, shortest), response(model)
    relative = max(errors["displacement_std"] / exact.displacement_std, errors["velocity_std"] / exact.velocity_std)
    return MissingMotion(decays=decays, needed=max(shortest, longer(shortest, relative, LARGEST_ERRORS["std"])))


def decays_of(model: Model, slider: Slider | None) -> float | None:
    """Return the length of a run in the slowest decay times of an oscillator; None if nothing decays."""
    speed = model.sliding_speed
    if slider is None or speed is None or slider.damping == 0.0:
        return None
    if model.free is not None or (model.is_two_way and coupling(model).unknown is not None):
        return None
    return model.distance / speed / slowest_decay(slider)


def slowest_decay(slider: Slider) -> float:
    """Return the time in s in which the slowest free motion decays by e: 2m/c, or about c/k if that is longer."""
    if slider.damping == 0.0:
        return inf
    return max(2.0 * slider.mass / slider.damping, slider.damping / slider.stiffness)


_GRID = 1024


def covariance_errors(model: Model, lag: Doubles, length: float, tick: float) -> Doubles:
    """Return standard errors in um^4 of autocovariances at lags in um, from a record of ``length`` T um.

    Var = (1/T) (int (R(u)^2 + R(u + tau) R(u - tau)) du + lam E[(int A(s) A(s + tau) ds)^2]) for a contact with births
    at random, of first order in life/T; the integral over u is a sum over ticks where these are wide apart.
    Source: Bartlett (1946), doi:10.2307/2983611, with the fourth cumulant of shot noise, integrated over u.
    """
    longest = 2.0 * model.sizes.support[1]
    step = max(tick, longest / _GRID)
    reach = int(np.ceil(longest / step)) + 1
    grid = step * np.arange(reach + 1)
    covariance = autocovariance(model, grid)

    def at(places: Doubles) -> Doubles:
        return np.interp(np.abs(places), grid, covariance, right=0.0)

    u = step * np.arange(-2 * reach, 2 * reach + 1, dtype=np.float64)
    gaussian = [step * float((at(u) ** 2 + at(u + tau) * at(u - tau)).sum()) for tau in lag.tolist()]
    sizes = sizes_of(model.sizes, COARSE)
    alike = [replace(model, sizes=Fixed(value=d)) for d in sizes.diameter.tolist()]
    shared = np.stack([autocovariance(each, lag) for each in alike]) / model.birth_rate
    return np.sqrt((np.array(gaussian) + model.birth_rate * (sizes.probability @ np.square(shared))) / length)


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
