"""Standard errors of the slider's motion over a finite one-way run."""

from cmath import exp as complex_exp
from cmath import sqrt as complex_sqrt
from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf, pi

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model, Slider
from rubnoise.theory.campbell import force_cumulants
from rubnoise.theory.drive import Drive, drive_of
from rubnoise.theory.off_centre import offset_probabilities, pass_energies
from rubnoise.theory.quadrature import size_rule
from rubnoise.theory.regular_births import need_random_births, resolved_error
from rubnoise.theory.response import Rule, mean_displacement, response, response_rules
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

    Over ``distance`` um or the model's ticks; 0 below 1e-12 of the mean, where rounding decides. Raises Refused without
    a strength. Source: as `rubnoise.theory.sampling.variance_of_time_mean`, for the pulse psi A.
    """
    return resolved_error(variance_of_mean_force(model, distance), force_cumulants(model).mean)


def expected_mean_displacement(model: Model, distance: float) -> float:
    """Return the expected mean of x in um over a run of ``distance`` um, from the slider's start.

    From equilibrium it is x_e = E[psi] mean A_r / k; from rest the free decay y of -x_e is added, with
    (1/T) int_0^T y dt = (c (y(0) - y(T)) - m y'(T)) / (k T), from m y'' + c y' + k y = 0.
    """
    drive = drive_of(model)
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
    only falls). Raises Refused without slider, strength or speed; inf without damping.
    """
    drive, motion = drive_of(model), response(model)
    slider, natural = drive.slider, drive.slider.natural_angular_frequency
    start = hypot(motion.displacement_std, motion.velocity_std / natural)
    change = slider.damping * (motion.displacement_std + start) + slider.mass * (motion.velocity_std + natural * start)
    return (mean_force_error(model, distance) + change * drive.speed / distance) / slider.stiffness


def motion_errors(model: Model, distance: float) -> MotionErrors:
    """Return standard errors of the slider's motion over a run of ``distance`` um from a stationary contact.

    The mean's is that of `mean_displacement_error`. The stds' are for runs of many lives and decay times:
    Var[mean of x^2] = (1/T) int Cov[x^2(0), x^2(t)] dt = (2/pi T) int_0^inf S_x^2 dw
    + (lam V/T) E[psi^4] E[(int y^2 dt)^2], y the response to one junction of unit strength; the error of the std is the
    root of it over 2 std. The last mean is over lives of any size and offset. Raises Refused without slider, strength
    or speed, and unless births are a Poisson process; inf without damping.
    Source: cumulants of filtered shot noise (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    drive, motion = drive_of(model), response(model)
    need_random_births(model, "the standard error of the slider's motion")
    if drive.slider.damping == 0.0:
        return MotionErrors(mean_displacement=inf, displacement_std=inf, velocity_std=inf)
    displacement, velocity = np.sqrt(_mean_square_variances(model, drive) * drive.speed / distance)
    return MotionErrors(
        mean_displacement=mean_displacement_error(model, distance),
        displacement_std=float(displacement) / (2.0 * motion.displacement_std),
        velocity_std=float(velocity) / (2.0 * motion.velocity_std),
    )


def _mean_square_variances(model: Model, drive: Drive) -> Doubles:
    """Return the integrals over all lags in s of Cov[x^2, x^2] and Cov[x'^2, x'^2]."""
    diameters, probabilities = size_rule(model.sizes, _SIZES)
    lives, shares = _energies_of_lives(model.pulse)
    rules = response_rules(model, drive)
    squares, energies = np.zeros(2), np.zeros((2, shares.size, diameters.size))
    for rule, density, square in zip(rules, (spectral_density, mean_spectral_density), lives, strict=True):
        k, weights, powers = _weighted(rule, drive)
        squares += np.square(density(model, k) * powers) @ weights
        energies += np.einsum("vk,lkd->vld", powers * weights, square(np.multiply.outer(k, diameters)) * diameters**6)
    first = drive.strengths.moment(2) ** 2 * 2.0 / (pi * drive.speed) * squares
    fourth = shares @ np.square(energies / (pi * drive.speed)) @ probabilities
    return first + model.birth_rate * drive.speed * drive.strengths.moment(4) * fourth


def _energies_of_lives(pulse: Pulse) -> tuple[tuple[Energies, Energies], Doubles]:
    """Return |a^(z)|^2 of each kind of life of unit diameter, itself and without its swing, and their probabilities."""
    if pulse.offset != "none":
        return (pass_energies, pass_energies), offset_probabilities()
    transform = transform_of(pulse)
    return (lambda z: transform.square(z)[None], lambda z: transform.mean_square(z)[None]), np.ones(1)


def _weighted(rule: Rule, drive: Drive) -> tuple[Doubles, Doubles, Doubles]:
    """Return wavenumbers, weights, and the gains of displacement and velocity."""
    k, weights = rule
    gain = drive.gain(k)
    return k, weights, np.stack([gain, gain * np.square(drive.speed * k)])


def _free_decay(slider: Slider, duration: float) -> tuple[float, float]:
    """Return displacement (from 1) and velocity of the free slider after a time in s; every damping."""
    rate, natural = slider.damping / (2.0 * slider.mass), slider.natural_angular_frequency
    root = complex_sqrt(rate * rate - natural * natural)
    slow, fast = complex_exp(-natural * natural / (rate + root) * duration), complex_exp(-(rate + root) * duration)
    divided = (slow - fast) / (2.0 * root) if abs(root) * duration > 1e-6 else duration * complex_exp(-rate * duration)
    return (0.5 * (slow + fast) + rate * divided).real, (-natural * natural * divided).real
