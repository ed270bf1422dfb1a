"""Standard errors of the slider's motion over a finite one-way run."""

from cmath import exp as complex_exp
from cmath import sqrt as complex_sqrt
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import hypot, inf, pi, sqrt
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model, Slider
from rubnoise.theory.campbell import force_cumulants, strengths_of
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
from rubnoise.theory.regular_births import need_random_births, resolved_error
from rubnoise.theory.response import mean_displacement, response, response_rules
from rubnoise.theory.sampling import variance_of_mean_force
from rubnoise.theory.spectrum import mean_spectral_density, spectral_density
from rubnoise.theory.transform import transform_of

_SIZES = 32

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
    """Return a bound in uN s of the spread of m dv + c dx over a run: what the mean force need not balance."""
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
    diameters, probabilities = size_rule(model.sizes, _SIZES)
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
