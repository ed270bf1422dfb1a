"""Standard errors of the figures of a finite record of area, friction force or motion, from theory alone."""

from dataclasses import dataclass, replace
from itertools import product
from math import factorial, hypot, inf, nan, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.model import Model, Slider
from rubnoise.theory.cumulants import area_cumulants, shot_cumulants
from rubnoise.theory.load import load_motion
from rubnoise.theory.motion import (
    FORCE,
    MOTION,
    contact_drive_of,
    drive_of,
    response,
    separation_of,
    spread_errors,
    strengths_of,
)
from rubnoise.theory.second_order import (
    AREA_ITSELF,
    area_noise,
    joint_cumulant,
    lag_rule,
    need_random_births,
)

_ORDERS = 5  # 0 to 4


@dataclass(frozen=True, slots=True)
class StandardErrors:
    """Standard errors of the moments of one record: mean and std in the quantity's unit, the others plain numbers."""

    mean: float
    std: float
    skewness: float
    excess_kurtosis: float


def variance_of_time_mean(model: Model, distance: float | None = None) -> float:
    """Return the variance in um^4 of the mean of A_r over T um or the ticks, (2/T^2) int_0^T (T - tau) R dtau."""
    return area_noise(model).variance_of_mean(distance)


def mean_area_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in um^2 of the mean of A_r: the root of `variance_of_time_mean`."""
    return area_noise(model).error_of_mean(distance)


def mean_force_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in uN of the mean friction force over a stationary record, exact for every length.

    Under a load only the deviations of strengths err, and momentum bounds the mean of P. Refused without a strength.
    """
    psi = strengths_of(model)
    noise = area_noise(model, psi)
    if model.separation is None:
        return noise.error_of_mean(distance)
    deviations = replace(noise, square=max(noise.square - noise.squared_mean, 0.0), squared_mean=0.0)
    carried = _mean_load_error(model, distance or (model.tick_count + 1) * model.tick)
    return deviations.error_of_mean(distance) + psi.mean / model.separation.hardness * carried


def _mean_load_error(model: Model, distance: float) -> float:
    """Return a bound in uN of the standard error of the mean of P, whose mean less W is (m dz' + c dz)/T."""
    drive, motion = contact_drive_of(model), load_motion(model)
    return _carried_momentum(drive.slider, motion.separation_std, motion.velocity_std) * drive.speed / distance


def force_standard_errors(model: Model, distance: float | None = None) -> StandardErrors:
    """Return `standard_errors` of friction force at constant separation: joint cumulants gain E[psi^(i + j)]."""
    return standard_errors(model, distance, strengths_of(model))


def standard_errors(model: Model, distance: float | None = None, strengths: Law = AREA_ITSELF) -> StandardErrors:
    """Return the standard errors of mean, std, skewness and excess kurtosis of A_r over a stationary record.

    The record is as in `lag_rule`; the errors are of first order in life/distance (from some 100 lives on). Each
    estimate moves with the mean of its influence function of z = (A_r - mean)/std: z; (z^2 - 1)/2; z^3 - g - 3z - (3/2)
    g (z^2 - 1); z^4 - b - 4 g z - 2 b (z^2 - 1), g the skewness and b the kurtosis. Raises Refused unless births are a
    Poisson process.
    Source: Hampel (1974), doi:10.1080/01621459.1974.10482962, with shot-noise cumulants.
    """
    need_random_births(model, "the standard error of a moment")
    cumulants = shot_cumulants(model, strengths)
    lags, weights = lag_rule(model, distance)
    series = np.zeros((_ORDERS, _ORDERS, lags.size))
    for i, j in product(range(_ORDERS), repeat=2):
        if i and j:
            joint = strengths.moment(i + j) * joint_cumulant(model, lags, i, j)
        else:
            joint = np.full(lags.size, cumulants.values[i + j - 1] if i + j > 1 else 0.0)
        series[i, j] = joint / (cumulants.std ** (i + j) * factorial(i) * factorial(j))
    moments = _exponential(series)
    covariances = (moments - moments[:, :1] * moments[:1]) @ weights
    scale = np.array([factorial(i) for i in range(_ORDERS)])
    covariances = (covariances * np.outer(scale, scale))[1:, 1:]
    g, b = cumulants.skewness, cumulants.excess_kurtosis + 3.0
    influence = np.array(
        [[1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [-3.0, -1.5 * g, 1.0, 0.0], [-4.0 * g, -2.0 * b, 0.0, 1.0]]
    )
    mean, std, skewness, kurtosis = np.sqrt(np.diag(influence @ covariances @ influence.T)).tolist()
    return StandardErrors(mean * cumulants.std, std * cumulants.std, skewness, kurtosis)


def _exponential(series: Doubles) -> Doubles:
    """Return exp of a power series in x and y without a constant: of cumulants over i! j! that gives the moments'."""
    found = term = np.zeros_like(series)
    found[0, 0] = 1.0
    for power in range(1, 2 * _ORDERS - 1):
        longer = np.zeros_like(series)
        for i, j in product(range(_ORDERS), repeat=2):
            longer[i:, j:] += series[i, j] * term[: _ORDERS - i, : _ORDERS - j] / power
        found, term = found + longer, longer
    return found


@dataclass(frozen=True, slots=True)
class MotionErrors:
    """Standard errors over one run: mean and std of displacement in um, std of velocity in um/s."""

    mean_displacement: float
    displacement_std: float
    velocity_std: float


def expected_mean_displacement(model: Model, distance: float) -> float:
    """Return the expected mean of x in um over a run of ``distance`` um, from the slider's start.

    From rest the mean decay of -x_e is missing, (c (y(0) - y(T)) - m y'(T)) / (k T), x_e being the mean.
    """
    from scipy.linalg import expm

    slider, still = drive_of(model).slider, response(model).mean_displacement
    if slider.start == "equilibrium":
        return still
    duration = distance / drive_of(model).speed
    decay = np.array([[0.0, 1.0], [-slider.stiffness / slider.mass, -slider.damping / slider.mass]])
    y, velocity = expm(decay * duration)[:, 0].tolist()
    return still * (1.0 - (slider.damping * (1.0 - y) - slider.mass * velocity) / (slider.stiffness * duration))


def mean_displacement_error(model: Model, distance: float) -> float:
    """Return an upper bound in um of the standard error of the mean of x over ``distance`` um, exact for long runs.

    k mean x = mean F - (m dv + c dx)/T, dv and dx the changes over the run; over a base y, k mean y + (c dy - m dv - c
    dx)/T. inf without damping.
    """
    drive, motion = drive_of(model), response(model)
    slider, rate = drive.slider, drive.speed / distance
    change = _carried_momentum(slider, motion.displacement_std, motion.velocity_std) * rate
    if slider.excitation != "base":
        return (mean_force_error(model, distance) + change) / slider.stiffness
    change += 2.0 * slider.damping * model.base_per_area * area_cumulants(model).std * rate
    return model.base_per_area * mean_area_error(model, distance) + change / slider.stiffness


def _carried_momentum(slider: Slider, std: float, velocity_std: float) -> float:
    """Return a bound in uN s of the spread of m dv + c dx over a run: of stationary motion plus a decaying start."""
    natural = slider.natural_angular_frequency
    start = hypot(std, velocity_std / natural)
    return slider.damping * (std + start) + slider.mass * (velocity_std + natural * start)


def motion_errors(model: Model, distance: float) -> MotionErrors:
    """Return standard errors of the slider's motion over a run of ``distance`` um from a stationary contact.

    Of the stds as `spread_errors`; inf without damping. Raises Refused as `drive_of`, and unless births are a Poisson
    process.
    """
    drive = drive_of(model)
    need_random_births(model, "the standard error of the slider's motion")
    if drive.slider.damping == 0.0:
        return MotionErrors(inf, inf, inf)
    return MotionErrors(mean_displacement_error(model, distance), *spread_errors(model, MOTION, distance))


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadErrors:
    """Standard errors over one run: um, um/s and uN; those of the friction force are nan without a strength."""

    separation_mean: float
    separation_std: float
    velocity_std: float
    load_mean: float
    load_std: float
    force_mean: float = nan
    force_std: float = nan


def load_errors(model: Model, distance: float, *, from_start: bool = True) -> LoadErrors:
    """Return standard errors of the motion under a load over a run of ``distance`` um.

    Of stds as `spread_errors`; of the mean of P (m dz' + c dz)/T. A run ``from_start`` has `_start_excess` in the
    squares of z' and P - W, as uncertain as it is large: for Gaussian z and z' at most sqrt(3) times as much.
    """
    contact, psi, motion = separation_of(model), model.strengths, load_motion(model)
    fast, excess = (sqrt(3.0) * each * from_start for each in _start_excess(model, distance))
    names = ("separation", "normal_velocity", "load", *((FORCE,) if psi else ()))
    place, velocity, load, *force = spread_errors(model, names, distance)
    mean_load, known = _mean_load_error(model, distance), {}
    if psi is not None:
        part = (psi.mean / contact.hardness) ** 2 * excess / (2.0 * sqrt(motion.covariances.of(FORCE)))
        known = {"force_mean": mean_force_error(model, distance), "force_std": hypot(force[0], part)}
    return LoadErrors(
        separation_mean=(contact.hardness * mean_area_error(model, distance) + mean_load) / contact.stiffness,
        separation_std=place,
        velocity_std=hypot(velocity, fast / (2.0 * motion.velocity_std)),
        load_mean=mean_load,
        load_std=hypot(load, excess / (2.0 * motion.load_std)),
        **known,
    )


def _start_excess(model: Model, distance: float) -> tuple[float, float]:
    """Return the part of the start at z = z' = 0 in the mean squares of z' (um^2/s^2) and P - W (uN^2) over a run.

    Of the free decay of a stationary separation: int y'^2 dt = e/c, e = (m y'_0^2 + K y_0^2)/2, and int y^2 dt = (c
    y_0^2/2 + m y_0 y'_0 + m e/c)/K.
    """
    drive, motion = contact_drive_of(model), load_motion(model)
    slider, square, rate = drive.slider, motion.separation_std**2, drive.speed / distance
    energy = 0.5 * (slider.mass * motion.velocity_std**2 + slider.stiffness * square)
    decay = (0.5 * slider.damping * square + slider.mass / slider.damping * energy) * slider.stiffness
    return energy / slider.damping * rate, decay * rate
