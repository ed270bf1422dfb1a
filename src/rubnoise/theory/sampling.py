"""Standard errors of the figures of a finite record of area, friction force or motion, from theory alone."""

from cmath import exp as complex_exp
from cmath import sqrt as complex_sqrt
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from math import comb, hypot, inf, pi, sqrt
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model, Slider
from rubnoise.theory.campbell import Cumulants, area_cumulants, force_cumulants, strengths_of
from rubnoise.theory.correlation import Powers, joint_cumulants, lag_rule, unphased_covariance
from rubnoise.theory.drive import (
    Drive,
    drive_of,
    force_power,
    force_terms,
    motion_drive_of,
    separation_of,
    squared_strengths,
)
from rubnoise.theory.off_centre import offset_probabilities, pass_energies
from rubnoise.theory.quadrature import size_rule
from rubnoise.theory.regular_births import need_random_births, resolved_error, spectral_lines, variance_of_line_mean
from rubnoise.theory.response import mean_displacement, response, response_rules
from rubnoise.theory.spectrum import mean_spectral_density, spectral_density
from rubnoise.theory.transform import transform_of

_ORDER = 4
_SIZES = 12  # an error of an error: seven digits are plenty


@dataclass(frozen=True, slots=True, kw_only=True)
class StandardErrors:
    """Standard errors of the moments of one record: mean and std in the quantity's unit, the others plain numbers."""

    mean: float
    std: float
    skewness: float
    excess_kurtosis: float


def variance_of_time_mean(model: Model, distance: float | None = None) -> float:
    """Return the variance in um^4 of the mean of A_r over a stationary record of T um, exact for every length.

    Over ``distance`` um, Var = (2/T^2) int_0^T (T - tau) R(tau) dtau, which tends to S(0)/T; without a distance, over
    the model's ticks. Regular births leave what `variance_of_line_mean` says.
    Source: Papoulis, Probability, Random Variables and Stochastic Processes, section 12-1.
    """
    return _variance_of_mean(model, distance, 1.0, 1.0)


def mean_area_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in um^2 of the mean of A_r over a stationary record, exact for every length.

    The root of `variance_of_time_mean`, and 0 below 1e-12 of the mean, where rounding decides.
    """
    return resolved_error(variance_of_time_mean(model, distance), area_cumulants(model).mean)


def variance_of_mean_force(model: Model, distance: float | None = None) -> float:
    """Return the variance in uN^2 of the mean friction force over a stationary record, exact for every length.

    Over ``distance`` um or the model's ticks, for strengths psi independent of sizes: E[psi^2] multiplies the part of
    single junctions, E[psi]^2 that of their means. Under a load that weighs, only the deviations of strengths count.
    Raises Refused without a strength.
    """
    psi = strengths_of(model)
    if model.separation is not None:
        return _variance_of_mean(model, distance, max(psi.moment(2) - psi.mean**2, 0.0), 0.0)
    return _variance_of_mean(model, distance, psi.moment(2), psi.mean**2)


def standard_errors(model: Model, distance: float | None = None) -> StandardErrors:
    """Return the standard errors of mean, std, skewness and excess kurtosis of A_r over a stationary record.

    The record is continuous over ``distance`` um or, without one, the model's ticks. The mean's is exact; the others
    are of first order in life/distance (trust them from some 100 lives on), as are the moments' biases that they leave
    out. Each estimate moves with the mean over the record of a polynomial f in z = (A_r - mean)/std, its influence
    function: (z^2 - 1)/2 times std; z^3 - g - 3z - (3/2) g (z^2 - 1); z^4 - b - 4 g z - 2 b (z^2 - 1), g the skewness
    and b the kurtosis; and Var = sum over lags of weight times Cov[f(0), f(tau)], from the joint cumulants of A_r(s)
    and A_r(s + tau). Raises Refused unless births are a Poisson process.
    Source: Hampel (1974), doi:10.1080/01621459.1974.10482962, with shot-noise cumulants.
    """
    return _standard_errors(model, distance, area_cumulants(model), (1.0,) * (2 * _ORDER + 1))


def force_standard_errors(model: Model, distance: float | None = None) -> StandardErrors:
    """Return the standard errors of mean, std, skewness and excess kurtosis of friction force, as `standard_errors`.

    The joint cumulants of psi A gain E[psi^(i + j)]. Raises Refused without a strength and for births not at random.
    """
    cumulants, psi = force_cumulants(model), strengths_of(model)
    return _standard_errors(model, distance, cumulants, tuple(psi.moment(n) for n in range(2 * _ORDER + 1)))


def _variance_of_mean(model: Model, distance: float | None, square: float, squared_mean: float) -> float:
    lags, weights = lag_rule(model, distance)
    variance = float(weights @ unphased_covariance(model, lags, square, squared_mean))
    return variance + squared_mean * variance_of_line_mean(model, spectral_lines(model), distance)


def _standard_errors(
    model: Model, distance: float | None, cumulants: Cumulants, strength_moments: tuple[float, ...]
) -> StandardErrors:
    need_random_births(model, "the standard error of a moment")
    lags, weights = lag_rule(model, distance)
    powers: tuple[Powers, ...] = tuple((i, j) for i in range(1, _ORDER + 1) for j in range(i, _ORDER + 1))
    joint = joint_cumulants(model, lags, powers, sizes=_SIZES)
    joint = {(i, j): strength_moments[i + j] * values for (i, j), values in joint.items()}
    covariances = np.tensordot(_moment_covariances(cumulants, joint), weights, axes=1)
    mean, std, skewness, kurtosis = (sqrt(float(f @ covariances @ f)) for f in _influence(cumulants))
    return StandardErrors(
        mean=mean * cumulants.std, std=std * cumulants.std, skewness=skewness, excess_kurtosis=kurtosis
    )


def _influence(cumulants: Cumulants) -> tuple[Doubles, ...]:
    """Return the coefficients of z, z^2, z^3, z^4 in the influence functions of the four moments."""
    g, b = cumulants.skewness, cumulants.excess_kurtosis + 3.0
    rows = ([1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [-3.0, -1.5 * g, 1.0, 0.0], [-4.0 * g, -2.0 * b, 0.0, 1.0])
    return tuple(np.array(row) for row in rows)


def _moment_covariances(cumulants: Cumulants, joint: dict[Powers, Doubles]) -> Doubles:
    """Return Cov[z(0)^i, z(tau)^j] for i, j = 1 ... 4, a last axis of lags, for z = (A_r - mean)/std."""
    scaled = {(i, j): k / cumulants.std ** (i + j) for (i, j), k in joint.items()}
    scaled |= {(j, i): k for (i, j), k in scaled.items()}
    lags = next(iter(scaled.values()))
    for order in range(1, _ORDER + 1):
        value = cumulants.values[order - 1] / cumulants.std**order if order > 1 else 0.0
        scaled[order, 0] = scaled[0, order] = np.full_like(lags, value)
    moments = _joint_moments(scaled)
    orders = range(1, _ORDER + 1)
    return np.array([[moments[i, j] - moments[i, 0] * moments[0, j] for j in orders] for i in orders])


def _joint_moments(cumulants: dict[Powers, Doubles]) -> dict[Powers, Doubles]:
    """Return E[x^i y^j] up to i = j = 4 from the joint cumulants kappa_ij.

    E[x^(i+1) y^j] = sum over a <= i, b <= j of C(i, a) C(j, b) kappa_(a+1, b) E[x^(i-a) y^(j-b)], and likewise in y
    (Smith 1995, doi:10.1080/00031305.1995.10476146).
    """
    none = np.zeros_like(cumulants[1, 1])
    moments: dict[Powers, Doubles] = {(0, 0): none + 1.0}
    for i, j in product(range(_ORDER + 1), repeat=2):
        if i:
            terms = ((a, b, comb(i - 1, a) * comb(j, b)) for a in range(i) for b in range(j + 1))
            moments[i, j] = sum((c * cumulants[a + 1, b] * moments[i - 1 - a, j - b] for a, b, c in terms), none)
        elif j:
            lower = (comb(j - 1, b) * cumulants[0, b + 1] * moments[0, j - 1 - b] for b in range(j))
            moments[0, j] = sum(lower, none)
    return moments


_MOTION_SIZES = 32

Energies = Callable[[Doubles], Doubles]


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionErrors:
    """Standard errors over one run: mean and std of displacement in um, std of velocity in um/s."""

    mean_displacement: float
    displacement_std: float
    velocity_std: float


def mean_force_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in uN of the mean friction force over a stationary record, exact for every length.

    Over ``distance`` um or the model's ticks; 0 below 1e-12 of the mean, where rounding decides. Under a load that
    weighs the deviations of strengths have it, and the mean of P is known but for what momentum carries: a bound.
    Raises Refused without a strength. Source: as `rubnoise.theory.sampling.variance_of_time_mean`, for the pulse psi A.
    """
    error = resolved_error(variance_of_mean_force(model, distance), force_cumulants(model).mean)
    if model.separation is None:
        return error
    separation, length = separation_of(model), distance or (model.tick_count + 1) * model.tick
    drive = drive_of(separation)
    return error + strengths_of(model).mean / drive.strengths.mean * carried_momentum(separation) * drive.speed / length


def expected_mean_displacement(model: Model, distance: float) -> float:
    """Return the expected mean of x in um over a run of ``distance`` um, from the slider's start.

    From equilibrium it is x_e = E[psi] mean A_r / k; from rest the free decay y of -x_e is added, with
    (1/T) int_0^T y dt = (c (y(0) - y(T)) - m y'(T)) / (k T), from m y'' + c y' + k y = 0.
    """
    drive = motion_drive_of(model)
    slider, still = drive.slider, mean_displacement(model)
    if slider.start == "equilibrium":
        return still
    duration = distance / drive.speed
    y, velocity = _free_decay(slider, duration)
    missing = (slider.damping * (1.0 - y) - slider.mass * velocity) / (slider.stiffness * duration)
    return still * (1.0 - missing)


def mean_displacement_error(model: Model, distance: float) -> float:
    """Return an upper bound in um of the standard error of the mean of x over ``distance`` um, the contact stationary.

    It holds for every length and is exact for long runs: k mean x = mean F - (m dv + c dx)/T, where dv and dx, the
    changes over the run, spread by no more than their stationary std plus that of the decaying start (whose energy
    only falls). Over a base y, k mean x = k mean y + (c dy - m dv - c dx)/T. Raises Refused without slider, strength or
    speed; inf without damping.
    """
    drive = motion_drive_of(model)
    change = carried_momentum(model) * drive.speed / distance
    if drive.slider.excitation == "base":
        lifted = replace(model, strengths=drive.strengths)
        change += 2.0 * drive.slider.damping * force_cumulants(lifted).std * drive.speed / distance
        return mean_force_error(lifted, distance) + change / drive.slider.stiffness
    return (mean_force_error(model, distance) + change) / drive.slider.stiffness


def carried_momentum(model: Model) -> float:
    """Return a bound in uN s of the spread of m dv + c dx over a run, which the mean force does not balance."""
    drive, motion = motion_drive_of(model), response(model)
    slider, natural = drive.slider, drive.slider.natural_angular_frequency
    start = hypot(motion.displacement_std, motion.velocity_std / natural)
    return slider.damping * (motion.displacement_std + start) + slider.mass * (motion.velocity_std + natural * start)


def motion_errors(model: Model, distance: float) -> MotionErrors:
    """Return standard errors of the slider's motion over a run of ``distance`` um from a stationary contact.

    The mean's is that of `mean_displacement_error`. The stds' are for runs of many lives and decay times:
    Var[mean of x^2] = (1/T) int Cov[x^2(0), x^2(t)] dt = (2/pi T) int_0^inf S_x^2 dw
    + (lam V/T) E[psi^4] E[(int y^2 dt)^2], y the response to one junction of unit strength; the error of the std is the
    root of it over 2 std. The last mean is over lives of any size and offset. Raises Refused without slider, strength
    or speed, and unless births are a Poisson process; inf without damping.
    Source: cumulants of filtered shot noise (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    drive, motion = motion_drive_of(model), response(model)
    need_random_births(model, "the standard error of the slider's motion")
    if drive.slider.damping == 0.0:
        return MotionErrors(mean_displacement=inf, displacement_std=inf, velocity_std=inf)

    def gains(k: Doubles) -> Doubles:
        gain = drive.gain(k)
        return np.stack([gain, gain * np.square(drive.speed * k)])

    displacement, velocity = np.sqrt(mean_square_variances(model, drive, gains) * drive.speed / distance)
    return MotionErrors(
        mean_displacement=mean_displacement_error(model, distance),
        displacement_std=float(displacement) / (2.0 * motion.displacement_std),
        velocity_std=float(velocity) / (2.0 * motion.velocity_std),
    )


def force_std_error(model: Model, distance: float) -> float:
    """Return the standard error in uN of the std of friction force under a load, as those of `motion_errors`."""
    drive = drive_of(separation_of(model))
    drive = replace(drive, strengths=strengths_of(model))
    square = mean_square_variances(model, drive, lambda k: np.ones((1, k.size)))[0]
    return sqrt(float(square) * drive.speed / distance) / (2.0 * force_cumulants(model).std)


def mean_square_variances(model: Model, drive: Drive, gains: Callable[[Doubles], Doubles]) -> Doubles:
    """Return the integrals over all lags in s of Cov[u^2, u^2], u the force after filters of some power gains."""
    diameters, probabilities = size_rule(model.sizes, _MOTION_SIZES)
    lives, shares = _energies_of_lives(model.pulse)
    rules = response_rules(model, drive)
    squares: Any = 0.0
    energies: Any = 0.0
    for (k, weights), density, square in zip(rules, (spectral_density, mean_spectral_density), lives, strict=True):
        powers, life = gains(k), square(np.multiply.outer(k, diameters)) * diameters**6
        power = density(model, k) * force_power(model, drive.strengths, k) * powers
        squares = squares + np.square(power) @ weights
        energies = energies + np.stack(
            [np.einsum("vk,lkd->vld", powers * weights * term, life) for term in force_terms(model, drive.strengths, k)]
        )
    first = 2.0 / (pi * drive.speed) * squares
    fourth = shares @ squared_strengths(drive.strengths, energies / (pi * drive.speed)) @ probabilities
    return first + model.birth_rate * drive.speed * fourth


def _energies_of_lives(pulse: Pulse) -> tuple[tuple[Energies, Energies], Doubles]:
    """Return |a^(z)|^2 of each kind of life of unit diameter, itself and without its swing, and their probabilities."""
    if pulse.offset != "none":
        own = partial(pass_energies, pulse)
        return (own, own), offset_probabilities()
    transform = transform_of(pulse)
    return (lambda z: transform.square(z)[None], lambda z: transform.mean_square(z)[None]), np.ones(1)


def _free_decay(slider: Slider, duration: float) -> tuple[float, float]:
    """Return displacement (from 1) and velocity of the free slider after a time in s; every damping."""
    rate, natural = slider.damping / (2.0 * slider.mass), slider.natural_angular_frequency
    root = complex_sqrt(rate * rate - natural * natural)
    slow, fast = complex_exp(-natural * natural / (rate + root) * duration), complex_exp(-(rate + root) * duration)
    divided = (slow - fast) / (2.0 * root) if abs(root) * duration > 1e-6 else duration * complex_exp(-rate * duration)
    return (0.5 * (slow + fast) + rate * divided).real, (-natural * natural * divided).real
