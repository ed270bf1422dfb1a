"""Autocovariances at chosen lags with their standard errors: from the model's theory, or from the record alone."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from rubnoise.analysis.batch_means import batch_length, error_of_mean
from rubnoise.analysis.covariance import LaggedProducts
from rubnoise.analysis.moments import needed_for_mean
from rubnoise.analysis.records import RecordTooShort
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.quadrature import size_rule

_GRID = 1024
_SIZES = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Covariances:
    """Autocovariances of a record at lags in um, in the square of its unit."""

    lag: Doubles
    value: Doubles
    standard_error: Doubles


def sample_covariances(values: Doubles, tick: float, lags: Sequence[int], model: Model | None = None) -> Covariances:
    """Return autocovariances of a record of equal ticks (um) at lags in ticks, with standard errors.

    With a model the record is its real contact area, stationary, from births at random, and the errors are those of
    `covariance_errors`; without one they are batch means of the products. Raises RecordTooShort, carrying the
    Covariances, where the record is too short for errors.
    """
    products = LaggedProducts(lags, float(values.mean()))
    products.add(values)
    lag, length = tick * np.array(lags, dtype=np.float64), values.size * tick
    found = Covariances(lag=lag, value=products.covariances(), standard_error=np.full(lag.size, inf))
    if model is not None:
        if length < needed_for_mean(model):
            raise RecordTooShort("autocovariance", found, length=length, needed=needed_for_mean(model))
        return replace(found, standard_error=covariance_errors(model, lag, length, tick))
    away = values - values.mean()
    batch = batch_length(values, tick, "autocovariance", found)
    errors = [float(error_of_mean(away[: values.size - j] * away[j:], batch)) for j in lags]
    return replace(found, standard_error=np.array(errors))


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
    diameters, probabilities = size_rule(model.sizes, _SIZES)
    alike = [replace(model, sizes=Fixed(value=d)) for d in diameters.tolist()]
    shared = np.stack([autocovariance(each, lag) for each in alike]) / model.birth_rate
    return np.sqrt((np.array(gaussian) + model.birth_rate * (probabilities @ np.square(shared))) / length)
