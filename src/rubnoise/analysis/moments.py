"""Moments and autocovariances of a record with standard errors: from the theory of its model, or the record alone."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from rubnoise.analysis.covariance import LaggedProducts
from rubnoise.analysis.records import RecordTooShort, batch_length, error_of_mean, longer
from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.record.tally import Moments
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.quadrature import size_rule
from rubnoise.theory.sampling import StandardErrors, standard_errors

FEWEST_LIVES = 50
FEWEST_BIRTHS = 1000
"""Mean lives and expected births from which the mean of a record is near enough to a normal law for a score.

Shorter runs get no standard errors of higher moments either: these are of first order in life/run.
"""

LARGEST_ERRORS = {"std": 0.1, "skewness": 0.2, "excess_kurtosis": 0.4}
"""Standard errors (that of the std over the std itself) up to which an estimate counts as defended.

All three are of first order in life/record: what they leave out is about their square.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SampleMoments:
    """Mean and std of a record in its unit, skewness and excess kurtosis; a record that never varies has zeros."""

    mean: PooledEstimate
    std: PooledEstimate
    skewness: PooledEstimate
    excess_kurtosis: PooledEstimate


def sample_moments(values: Doubles, tick: float, model: Model | None = None) -> SampleMoments:
    """Return the moments of a record of equal ticks (um), with their standard errors.

    With a model the record is its real contact area, stationary, and the errors come from the exact autocovariance
    (`rubnoise.theory.sampling.standard_errors`); without one they are those of batch means of the moments' influence
    functions. Raises RecordTooShort, carrying the SampleMoments, for a record too short for any of the four.
    """
    seen = Moments()
    seen.add(values)
    figures = (seen.mean, seen.std, seen.skewness, seen.excess_kurtosis)
    if seen.variance == 0.0:
        return _estimates(figures, (0.0, 0.0, 0.0, 0.0))
    if model is None:
        return _from_batches(values, tick, seen, figures)
    errors = standard_errors(over_ticks(model, values.size, tick))
    found = _estimates(figures, (errors.mean, errors.std, errors.skewness, errors.excess_kurtosis))
    needed = needed_length(model, values.size * tick, errors, seen.std)
    if needed > values.size * tick:
        raise RecordTooShort("moments", found, length=values.size * tick, needed=needed)
    return found


def over_ticks(model: Model, ticks: int, tick: float) -> Model:
    """Return the model of a stationary stretch of so many ticks, ``tick`` um apart."""
    return replace(model, start="stationary", tick=tick, tick_count=ticks - 1, distance=max(ticks - 1, 1) * tick)


def needed_for_mean(model: Model) -> float:
    """Return the length in um from which a mean over a record of the contact has a score: 50 lives, 1000 births."""
    return max(FEWEST_LIVES * model.mean_life_distance, FEWEST_BIRTHS * model.mean_birth_spacing)


def needed_length(model: Model, length: float, errors: StandardErrors, std: float) -> float:
    """Return the length in um that all four moments need, from their errors over a record of a given one."""
    relative = {"std": errors.std / std, "skewness": errors.skewness, "excess_kurtosis": errors.excess_kurtosis}
    needed = (longer(length, error, LARGEST_ERRORS[name]) for name, error in relative.items())
    return max(needed_for_mean(model), *needed)


def _from_batches(
    values: Doubles, tick: float, seen: Moments, figures: tuple[float, float, float, float]
) -> SampleMoments:
    z = (values - seen.mean) / seen.std
    powers = np.stack([z, z**2, z**3, z**4])
    # The square decorrelates faster than the values, and so do all powers: one length serves all four.
    length = batch_length(values, tick, "moments", _estimates(figures, (inf, inf, inf, inf)))
    g, b = seen.skewness, seen.excess_kurtosis + 3.0
    influence = (powers[0], 0.5 * powers[1], powers[2] - 3.0 * powers[0] - 1.5 * g * powers[1])
    errors = [float(error_of_mean(each, length)) for each in influence]
    errors.append(float(error_of_mean(powers[3] - 4.0 * g * powers[0] - 2.0 * b * powers[1], length)))
    return _estimates(figures, (seen.std * errors[0], seen.std * errors[1], errors[2], errors[3]))


def _estimates(figures: tuple[float, float, float, float], errors: tuple[float, float, float, float]) -> SampleMoments:
    mean, std, skewness, kurtosis = (
        PooledEstimate(value=value, standard_error=error) for value, error in zip(figures, errors, strict=True)
    )
    return SampleMoments(mean=mean, std=std, skewness=skewness, excess_kurtosis=kurtosis)


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
    Covariances, if the record is too short for errors.
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
