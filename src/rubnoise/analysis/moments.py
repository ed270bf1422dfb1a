"""The length that a record of the contact needs for errors of its moments, and the errors of its autocovariances."""

from dataclasses import replace
from math import ceil

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.theory.second_order import autocovariance
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
