"""Standard errors of the figures of a finite record of area, friction force or motion, from theory alone."""

from dataclasses import replace
from itertools import product
from math import factorial, hypot, inf, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.distributions import Law
from rubnoise.model import Model
from rubnoise.theory.moments import area_cumulants, shot_cumulants
from rubnoise.theory.motion import (
    FORCE,
    MOTION,
    Drive,
    contact_drive_of,
    drive_of,
    response,
    spread_errors,
    std_of,
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


def mean_force_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in uN of the mean friction force over a stationary record, exact for every length.

    Under a load only the deviations of strengths err, and momentum bounds the mean of P. Refused without a strength.
    """
    psi = strengths_of(model)
    noise = area_noise(model, psi)
    if model.separation is None:
        return noise.error_of_mean(distance)
    deviations = replace(noise, square=max(noise.square - noise.squared_mean, 0.0), squared_mean=0.0)
    drive, slid = contact_drive_of(model), distance or (model.tick_count + 1) * model.tick
    carried = _carried_momentum(drive, std_of(model, "separation"), std_of(model, "normal_velocity"), slid)
    return deviations.error_of_mean(distance) + psi.mean / drive.gain * carried


def standard_errors(model: Model, distance: float | None = None, strengths: Law = AREA_ITSELF) -> dict[str, float]:
    """Return the standard errors of mean, std, skewness and excess_kurtosis of psi A_r over a stationary record.

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
    errors = np.sqrt(np.diag(influence @ covariances @ influence.T)) * [cumulants.std, cumulants.std, 1.0, 1.0]
    return dict(zip(("mean", "std", "skewness", "excess_kurtosis"), errors.tolist(), strict=True))


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


def expected_mean_displacement(model: Model, distance: float) -> float:
    """Return the expected mean of x in um over a run of ``distance`` um, from the slider's start.

    From rest the mean decay of -x_e is missing, (c (y(0) - y(T)) - m y'(T)) / (k T), x_e being the mean.
    """
    from scipy.linalg import expm

    drive, still = drive_of(model), response(model).mean_displacement
    slider, duration = drive.slider, distance / drive.speed
    if slider.start == "equilibrium":
        return still
    decay = np.array([[0.0, 1.0], [-slider.stiffness / slider.mass, -slider.damping / slider.mass]])
    y, velocity = expm(decay * duration)[:, 0].tolist()
    return still * (1.0 - (slider.damping * (1.0 - y) - slider.mass * velocity) / (slider.stiffness * duration))


def mean_displacement_error(model: Model, distance: float) -> float:
    """Return an upper bound in um of the standard error of the mean of x over ``distance`` um, exact for long runs.

    k mean x = mean F - (m dv + c dx)/T, dv and dx the changes over the run; over a base y, k mean y + (c dy - m dv - c
    dx)/T. inf without damping.
    """
    drive, motion = drive_of(model), response(model)
    change = _carried_momentum(drive, motion.displacement_std, motion.velocity_std, distance)
    if drive.slider.excitation != "base":
        return (mean_force_error(model, distance) + change) / drive.slider.stiffness
    change += 2.0 * drive.slider.damping * model.base_per_area * area_cumulants(model).std * drive.speed / distance
    return model.base_per_area * area_noise(model).error_of_mean(distance) + change / drive.slider.stiffness


def _carried_momentum(drive: Drive, std: float, velocity_std: float, distance: float) -> float:
    """Return a bound in uN of the spread of (m dv + c dx)/T: of stationary motion plus a decaying start."""
    slider, natural = drive.slider, drive.slider.natural_angular_frequency
    start = hypot(std, velocity_std / natural)
    carried = slider.damping * (std + start) + slider.mass * (velocity_std + natural * start)
    return carried * drive.speed / distance


def motion_errors(model: Model, distance: float) -> dict[str, float]:
    """Return standard errors of mean_displacement and displacement_std (um) and velocity_std (um/s) over a run.

    ``distance`` is in um, the contact stationary; of the stds as `spread_errors`, inf without damping. Raises Refused
    as `drive_of`, and unless births are a Poisson process.
    """
    drive = drive_of(model)
    need_random_births(model, "the standard error of the slider's motion")
    names, errors = ("mean_displacement", "displacement_std", "velocity_std"), [inf] * 3
    if drive.slider.damping > 0.0:
        errors = [mean_displacement_error(model, distance), *spread_errors(model, MOTION, distance)]
    return dict(zip(names, errors, strict=True))


def load_errors(model: Model, distance: float, *, from_start: bool = True) -> dict[str, float]:
    """Return standard errors of the motion under a load over a run of ``distance`` um, in um, um/s and uN.

    Of stds as `spread_errors`; of the mean of P (m dz' + c dz)/T. A run ``from_start`` z = z' = 0 has the squares of a
    decay less in z' and P - W, as uncertain as they are large: for Gaussian z and z' at most sqrt(3) times as much.
    """
    names = ("separation", "normal_velocity", "load", *((FORCE,) if model.strengths else ()))
    place, velocity, load, *force = spread_errors(model, names, distance)
    std, fast, varying = (std_of(model, name) for name in names[:3])
    drive, psi = contact_drive_of(model), model.strengths
    slider, slid = drive.slider, drive.speed / distance
    mean_load = _carried_momentum(drive, std, fast, distance)
    # Of the free decay of a stationary separation int z'^2 dt = e/c, e = (m z'_0^2 + K z_0^2)/2, and
    # K int z^2 dt = c z_0^2/2 + m z_0 z'_0 + m e/c.
    energy = 0.5 * (slider.mass * fast**2 + slider.stiffness * std**2)
    decay = (0.5 * slider.damping * std**2 + slider.mass / slider.damping * energy) * slider.stiffness
    faster, more = (sqrt(3.0) * each * slid * from_start for each in (energy / slider.damping, decay))
    errors = {
        "separation_mean": (drive.gain * area_noise(model).error_of_mean(distance) + mean_load) / slider.stiffness,
        "separation_std": place,
        "velocity_std": hypot(velocity, faster / (2.0 * fast)),
        "load_mean": mean_load,
        "load_std": hypot(load, more / (2.0 * varying)),
    }
    if psi is not None:
        part = (psi.mean / drive.gain) ** 2 * more / (2.0 * std_of(model, FORCE))
        errors |= {"force_mean": mean_force_error(model, distance), "force_std": hypot(force[0], part)}
    return errors
