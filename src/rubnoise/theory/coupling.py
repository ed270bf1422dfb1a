"""The numbers that judge one-way coupling: how strongly the slider acts back on the contact that drives it."""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import hypot, inf, nan, pi, sqrt

import numpy as np

from rubnoise.contact.births import RegularBirths
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.motion import Response, drive_of, need_friction, response, strengths_of
from rubnoise.theory.sampling import motion_errors
from rubnoise.theory.second_order import are_at_random, area_noise, is_one_life
from rubnoise.theory.sizes import panels

_ROUNDING = 1e-12  # of the variance for births at random, below which a variance is none
_FASTEST = 3000.0  # phase k times the mean life to which the slope of the force is followed
WEAK = 0.1  # first change of the variance, 3 Pi + q, from which more than the law of weak coupling is at work
WHITE = 0.95  # r^2 / Pi below which the slider feels that junctions live for a while


def force_slope_std(model: Model) -> float:
    """Return the standard deviation of F' = dF/ds in uN/um, F the stationary friction force; its mean is 0.

    Var F' = lam E[psi^2] b m_3, b d^3 the integral of A'^2 over a life (Campbell); other births add E[psi]^2 times the
    integral of k^2 of their part of the spectrum, to 1e-4. Raises Refused without a strength.
    """
    psi, noise = strengths_of(model), area_noise(model)
    at_random = model.birth_rate * psi.moment(2) * model.pulse.squared_slope * model.sizes.moment(3)
    if are_at_random(model):
        return sqrt(at_random)
    lines, power = noise.lines
    births = 2.0 * float(power @ lines**2)
    if is_one_life(model) and isinstance(model.births, RegularBirths):
        births -= at_random / psi.moment(2)  # equal lives leave nothing between lines
    else:
        k, weight = panels(np.linspace(0.0, _FASTEST / model.mean_life_distance, 401), 16)
        births += float((weight / pi * noise.together(k)) @ k**2)
    variance = at_random + psi.mean**2 * births
    return sqrt(variance) if variance > _ROUNDING * at_random else 0.0


@dataclass(frozen=True, slots=True)
class Coupling:
    """Pi, theta, and std x over that in one-way coupling: numbers, nan where unknown, and why that is."""

    strength: float
    stick_number: float
    expected_change: float
    unknown: str | None


@lru_cache(maxsize=8)
def coupling(model: Model) -> Coupling:
    """Return how strongly a slider acts back on its contact, and the change of vibration for weak coupling.

    strength Pi = S_F(0)/(2 m c V^3), Poisson births at constant separation, inf without damping: the square of r = std
    x'/V, one-way, for a force white in s. stick_number theta = std F'/k: beyond about 1 a slow slider sticks.
    expected_change as `weak_coupling_change`, for r^2 >= 0.95 Pi and 3 Pi + q < 0.1, q = c_1 E[psi^3] m_9 / (E[psi^2]
    m_6 m V^2). Raises Refused as `drive_of`, and over a base.
    """
    need_friction(model)
    drive, known = drive_of(model), are_at_random(model) and model.separation is None
    slider, psi, sizes = drive.slider, strengths_of(model), model.sizes
    strength = inf if known else nan  # a force of other births, or under a load, says nothing at low frequency
    if known and slider.damping > 0.0:
        density = float(area_noise(model, psi).density(0.0))
        strength = density / (2.0 * slider.mass * slider.damping * drive.speed**3)
    impulse = model.pulse.cubed_integral / model.pulse.squared_integral * psi.moment(3) / psi.moment(2)
    kick = impulse * sizes.moment(9) / sizes.moment(6) / (slider.mass * drive.speed**2)
    unknown = _unknown(model, strength, kick)
    change = nan if unknown else weak_coupling_change(strength, kick)
    return Coupling(strength, force_slope_std(model) / slider.stiffness, change, unknown)


def _unknown(model: Model, strength: float, kick: float) -> str | None:
    """Return the reason why the change is unknown, if it is."""
    if strength == inf:
        return "without damping nothing is stationary"
    if not are_at_random(model):
        return "it is known for births at random alone"
    if model.separation is not None:
        return "it is known at constant separation alone"
    if 3.0 * strength + kick >= WEAK:
        return "the coupling is too strong for the law of weak coupling"
    if response(model).one_way_validity ** 2 < WHITE * strength:
        return "a junction lives too long for the slider to take its force for white noise"
    return None


def weak_coupling_change(strength: float, kick: float) -> float:
    """Return sqrt(u/Pi), u the smaller root of u = Pi (1 + q + (3 + 10 q) u + 15 u^2); nan if there is none.

    u = Var x'/V^2 by the balance of energy: a junction with J = int psi A ds takes 2 J/m from w^2, w = V - x', and
    brings V (w - sqrt(w^2 - 2 J/m)) - J/m of energy per mass, lam w a second; c Var x' is lost, x' nearly Gaussian:
    <V^2/w^2> = 1 + 3 u + 15 u^2, <V^4/w^4> = 1 + 10 u. The kick q = E[J^3]/(E[J^2] m V^2).
    """
    lost = 1.0 - (3.0 + 10.0 * kick) * strength
    under_root = lost * lost - 60.0 * strength**2 * (1.0 + kick)
    if lost <= 0.0 or under_root < 0.0:
        return nan
    return sqrt(2.0 * (1.0 + kick) / (lost + sqrt(under_root)))


def weak_motion(model: Model) -> Response:
    """Return the stationary motion of a two-way slider with weak coupling; Refused if the law does not hold.

    Spreads are those of one-way coupling times `expected_change`; the mean force exceeds it by c Var x'/V.
    """
    found = coupling(model)
    if found.unknown is not None:
        raise Refused(f"no theory has the motion here, since this slider pushes back: {found.unknown}")
    drive, one_way, change = drive_of(model), response(model), found.expected_change
    excess = drive.slider.damping * (one_way.velocity_std * change) ** 2 / drive.speed
    return replace(
        one_way,
        mean_displacement=one_way.mean_displacement + excess / drive.slider.stiffness,
        displacement_std=one_way.displacement_std * change,
        velocity_std=one_way.velocity_std * change,
    )


def weak_motion_errors(model: Model, distance: float) -> dict[str, float]:
    """Return standard errors of the figures of `weak_motion` over a run of ``distance`` um; Refused as both.

    Those of one-way coupling grow with the spread. The law itself errs by its next term, 105 u^3 in <V^2/w^2>, and by
    the share 1 - r^2/Pi of the feedback that a force loses which is not quite white.
    """
    motion, found = weak_motion(model), coupling(model)
    change, u = found.expected_change, found.strength * found.expected_change**2
    coloured = max(1.0 - response(model).one_way_validity ** 2 / found.strength, 0.0)
    unknown = hypot(52.5 * u**3, coloured * (change - 1.0))
    errors = {name: change * error for name, error in motion_errors(model, distance).items()}
    for name, spread in (("displacement_std", motion.displacement_std), ("velocity_std", motion.velocity_std)):
        errors[name] = hypot(errors[name], unknown * spread)
    return errors
