"""Standard errors of the figures of a finite record of area, friction force or motion, from theory alone."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from math import factorial, hypot, inf, nan, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.cumulants import AREA_ITSELF, force_cumulants, shot_cumulants, strengths_of
from rubnoise.theory.load import FORCE, load_motion
from rubnoise.theory.motion import (
    drive_of,
    frequencies,
    mean_displacement,
    motion_drive_of,
    response,
    separation_of,
    spread_of,
)
from rubnoise.theory.second_order import area_noise, joint_cumulant, lag_rule, need_random_births, resolved_error
from rubnoise.theory.sizes import COARSE, sizes_of
from rubnoise.theory.unit_pulse import pass_energies

_ORDERS = 5  # 0 to 4


@dataclass(frozen=True, slots=True, kw_only=True)
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
    return resolved_error(variance_of_time_mean(model, distance), model.stationary_mean_area)


def mean_force_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in uN of the mean friction force over a stationary record, exact for every length.

    Under a load only the deviations of strengths err, and momentum bounds the mean of P. Refused without a strength.
    """
    psi, noise = strengths_of(model), area_noise(model)
    mean = psi.mean * model.stationary_mean_area
    if model.separation is None:
        return resolved_error(noise.variance_of_mean(distance, psi.moment(2), psi.mean**2), mean)
    separation, length = separation_of(model), distance or (model.tick_count + 1) * model.tick
    drive = drive_of(separation)
    carried = carried_momentum(separation) * drive.speed / length
    deviations = resolved_error(noise.variance_of_mean(distance, spread_of(psi), 0.0), mean)
    return deviations + psi.mean / drive.strengths.mean * carried


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
    influence = ([1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [-3.0, -1.5 * g, 1.0, 0.0], [-4.0 * g, -2.0 * b, 0.0, 1.0])
    mean, std, skewness, kurtosis = (sqrt(float(f @ covariances @ f)) for f in map(np.array, influence))
    return StandardErrors(
        mean=mean * cumulants.std, std=std * cumulants.std, skewness=skewness, excess_kurtosis=kurtosis
    )


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


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionErrors:
    """Standard errors over one run: mean and std of displacement in um, std of velocity in um/s."""

    mean_displacement: float
    displacement_std: float
    velocity_std: float


def expected_mean_displacement(model: Model, distance: float) -> float:
    """Return the expected mean of x in um over a run of ``distance`` um, from the slider's start.

    From equilibrium x_e = E[psi] mean A_r / k; from rest plus the mean decay of -x_e, (c (y(0) - y(T)) - m y'(T)) / (k
    T).
    """
    from scipy.linalg import expm

    drive = motion_drive_of(model)
    slider, still, duration = drive.slider, mean_displacement(model), distance / drive.speed
    if slider.start == "equilibrium":
        return still
    decay = np.array([[0.0, 1.0], [-slider.stiffness / slider.mass, -slider.damping / slider.mass]])
    y, velocity = expm(decay * duration)[:, 0].tolist()
    missing = (slider.damping * (1.0 - y) - slider.mass * velocity) / (slider.stiffness * duration)
    return still * (1.0 - missing)


def mean_displacement_error(model: Model, distance: float) -> float:
    """Return an upper bound in um of the standard error of the mean of x over ``distance`` um, exact for long runs.

    k mean x = mean F - (m dv + c dx)/T, dv and dx the changes over the run; over a base y, k mean y + (c dy - m dv - c
    dx)/T. inf without damping.
    """
    drive = motion_drive_of(model)
    change = carried_momentum(model) * drive.speed / distance
    if drive.slider.excitation != "base":
        return (mean_force_error(model, distance) + change) / drive.slider.stiffness
    lifted = replace(model, strengths=drive.strengths)
    change += 2.0 * drive.slider.damping * force_cumulants(lifted).std * drive.speed / distance
    return mean_force_error(lifted, distance) + change / drive.slider.stiffness


def carried_momentum(model: Model) -> float:
    """Return a bound in uN s of the spread of m dv + c dx over a run: of stationary motion plus a decaying start."""
    slider, motion = motion_drive_of(model).slider, response(model)
    natural = slider.natural_angular_frequency
    start = hypot(motion.displacement_std, motion.velocity_std / natural)
    return slider.damping * (motion.displacement_std + start) + slider.mass * (motion.velocity_std + natural * start)


def motion_errors(model: Model, distance: float) -> MotionErrors:
    """Return standard errors of the slider's motion over a run of ``distance`` um from a stationary contact.

    Of the stds, for runs of many lives and decay times, the root of `mean_square_variances` over 2 std; inf without
    damping. Raises Refused as `motion_drive_of`, and unless births are a Poisson process.
    """
    drive, motion = motion_drive_of(model), response(model)
    need_random_births(model, "the standard error of the slider's motion")
    if drive.slider.damping == 0.0:
        return MotionErrors(mean_displacement=inf, displacement_std=inf, velocity_std=inf)

    def gains(k: Doubles) -> Doubles:
        return drive.gain(k) * np.stack([np.ones_like(k), np.square(drive.speed * k)])

    displacement, velocity = np.sqrt(mean_square_variances(model, drive.strengths, gains, distance)).tolist()
    return MotionErrors(
        mean_displacement=mean_displacement_error(model, distance),
        displacement_std=displacement / (2.0 * motion.displacement_std),
        velocity_std=velocity / (2.0 * motion.velocity_std),
    )


def mean_square_variances(
    model: Model, strengths: Law, gains: Callable[[Doubles], Doubles], distance: float
) -> Doubles:
    """Return the variances of the mean of u^2 over a long run, u the force after filters of some power gains.

    (2/T)(1/2 pi) int S_u^2 dw + (lam V/T) E[(int y^2 dt)^2], y the response to one junction; under a load one brings
    psi - E[psi] + r E[psi], r as in `Drive.borne`. Source: cumulants of filtered shot noise (Rice 1944).
    """
    rule, sizes, psi = frequencies(model), sizes_of(model.sizes, COARSE), sizes_of(strengths, COARSE)
    powers, borne = gains(rule.wavenumber), np.ones_like(rule.wavenumber, dtype=np.complex128)
    if model.separation is not None:
        borne = drive_of(separation_of(model)).borne(rule.wavenumber)
    brought = rule.weight * np.square(np.abs(psi.diameter[:, None] - strengths.mean + strengths.mean * borne))
    gaussian = 2.0 * np.square(rule.force(model, strengths) * powers) @ (1.0 / rule.weight)
    fourth = np.zeros(len(powers))
    for diameter, probability in zip(sizes.diameter.tolist(), sizes.probability.tolist(), strict=True):
        lives, shares = pass_energies(model.pulse, rule.wavenumber * diameter)
        energies = diameter**6 * np.einsum("vk,pk,lk->vpl", powers, brought, lives)
        fourth += probability * np.square(energies) @ shares @ psi.probability
    return (gaussian + model.birth_rate * fourth) / distance


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadErrors:
    """Standard errors over one run: um, um/s and uN; those of the friction force are nan without a strength."""

    separation_mean: float
    separation_std: float
    velocity_std: float
    load_mean: float
    load_std: float
    force_mean: float
    force_std: float


def load_errors(model: Model, distance: float, *, from_start: bool = True) -> LoadErrors:
    """Return standard errors of the motion under a load over a run of ``distance`` um.

    Of the separation as `motion_errors`; of the mean of P (m dz' + c dz)/T. A run ``from_start`` has `_start_excess` in
    the squares of z' and P - W, as uncertain as it is large: for Gaussian z and z' at most sqrt(3) times as much.
    """
    separation, psi = separation_of(model), model.strengths
    drive, motion = drive_of(separation), load_motion(model)
    errors = motion_errors(separation, distance)
    fast, excess = (sqrt(3.0) * each * from_start for each in _start_excess(model, distance))

    def held(k: Doubles) -> Doubles:
        return np.square(np.abs(drive.borne(k)))[None]

    square = float(mean_square_variances(separation, drive.strengths, held, distance)[0])
    force_std = nan
    if psi is not None:
        std, share = motion.covariance(FORCE, FORCE) ** 0.5, psi.mean / drive.strengths.mean
        own = float(mean_square_variances(model, psi, lambda k: np.ones((1, k.size)), distance)[0])
        force_std = hypot(sqrt(own), share**2 * excess) / (2.0 * std)
    return LoadErrors(
        separation_mean=errors.mean_displacement,
        separation_std=errors.displacement_std,
        velocity_std=hypot(errors.velocity_std, fast / (2.0 * motion.velocity_std)),
        load_mean=carried_momentum(separation) * drive.speed / distance,
        load_std=hypot(sqrt(square), excess) / (2.0 * motion.load_std),
        force_mean=nan if psi is None else mean_force_error(model, distance),
        force_std=force_std,
    )


def _start_excess(model: Model, distance: float) -> tuple[float, float]:
    """Return the part of the start at z = z' = 0 in the mean squares of z' (um^2/s^2) and P - W (uN^2) over a run.

    Of the free decay of a stationary separation: int y'^2 dt = e/c, e = (m y'_0^2 + K y_0^2)/2, and int y^2 dt = (c
    y_0^2/2 + m y_0 y'_0 + m e/c)/K.
    """
    drive, motion = drive_of(separation_of(model)), load_motion(model)
    slider, square = drive.slider, motion.separation_std**2
    energy = 0.5 * (slider.mass * motion.velocity_std**2 + slider.stiffness * square)
    decay = (0.5 * slider.damping * square + slider.mass / slider.damping * energy) * slider.stiffness
    rate = drive.speed / distance
    return energy / slider.damping * rate, decay * rate
