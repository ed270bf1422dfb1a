"""Models of others: a force that falls with speed (Block), white noise (Kilburn)."""

from cmath import exp as turned
from dataclasses import dataclass
from math import atan2, exp, inf, pi, sqrt

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.cumulants import force_cumulants
from rubnoise.theory.motion import drive_of, force_spectral_density, need_friction
from rubnoise.theory.second_order import are_at_random, half_power_wavenumber


@dataclass(frozen=True, slots=True, kw_only=True)
class Weakening:
    """What becomes of the slider: steady at ``mean_displacement`` (um), or a cycle of sticks and slips.

    border: slope in N s/m from which sliding is unstable, c; amplitude: half of the range of x in um; slowest and
    fastest velocity in um/s; period in s, stick_fraction of it.
    """

    steady: bool
    border: float
    mean_displacement: float
    amplitude: float = 0.0
    slowest: float = 0.0
    fastest: float = 0.0
    period: float = 0.0
    stick_fraction: float = 0.0


def velocity_weakening(model: Model) -> Weakening:
    """Return what a slider does under m x'' + c x' + k x = F(V - x'), F(v) = F_m - a (v - V) while it slides forward.

    Beyond a = c, where nothing grows yet, the slider sticks, V = x', until k x + c V reaches F(0) = F_m + a V, and
    slips until its speed is V again. Raises Refused for a slider that is not driven so, and if the force would change
    its sign.
    Source: Block (1940), J. Acoust. Soc. Am. 12; Oden and Martins (1985), doi:10.1016/0045-7825(85)90009-X.
    """
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or slider.excitation != "velocity-weakening":
        raise Refused('this needs slider.excitation = "velocity-weakening" with its slope')
    force = force_cumulants(model).mean
    if slider.slope <= slider.damping:
        return Weakening(steady=True, border=slider.damping, mean_displacement=force / slider.stiffness)
    return _cycle(slider, speed, force)


def _cycle(slider: Slider, speed: float, force: float) -> Weakening:
    """Return the cycle of sticks and slips: with y = x - F_m/k and g = a - c a slip is m y'' - g y' + k y = 0.

    y' = V Re((1 + i s/w) e^(r t)), r = s + i w, s = g/2m, w^2 = k/m - s^2. It is slowest at pi/w and V again before 2
    pi/w; y = (g y' - m y'')/k is largest where y' = 0 for the first time, and least a half turn later.
    """
    from scipy.optimize import brentq

    growth = slider.slope - slider.damping
    rise = 0.5 * growth / slider.mass
    turn = sqrt(max(slider.natural_angular_frequency**2 - rise * rise, 0.0))
    if not turn or force < slider.slope * speed * exp(min(rise * pi / turn, 700.0)):
        raise Refused("slider.slope: the force would fall below 0 in the slip; a smaller slope or a larger mean force")
    rate, begun = complex(rise, turn), speed * complex(1.0, rise / turn)

    def velocity(time: float) -> float:
        return (begun * turned(rate * time)).real

    def place(time: float) -> float:
        bend = (begun * rate * turned(rate * time)).real
        return (growth * velocity(time) - slider.mass * bend) / slider.stiffness

    slowest, first_still = pi / turn, atan2(turn, rise) / turn
    slipped = float(brentq(lambda time: velocity(time) - speed, slowest, 2.0 * slowest, xtol=1e-15 * slowest))
    start, end = place(0.0), place(slipped)
    stuck = (start - end) / speed
    # The integral of y over the slip is g/k times the way; over the stick y is straight.
    mean = (start + end) * (0.5 * stuck) + growth / slider.stiffness * (end - start)
    return Weakening(
        steady=False,
        border=slider.damping,
        mean_displacement=force / slider.stiffness + mean / (slipped + stuck),
        amplitude=0.5 * (place(first_still) - place(first_still + slowest)),
        slowest=velocity(slowest),
        fastest=speed,
        period=slipped + stuck,
        stick_fraction=stuck / (slipped + stuck),
    )


@dataclass(frozen=True, slots=True)
class WhiteNoise:
    """White noise S_F in uN^2 s (two-sided, per rad/s), and the spread of a slider that it drives, in um and um/s.

    At ``wavenumber`` in rad/um the contact's own spectrum is a half, ``life_phase`` is that times the mean life; None
    unless births are Poisson.
    """

    force_density: float
    displacement_std: float
    velocity_std: float
    wavenumber: float | None
    life_phase: float | None


def white_noise(model: Model) -> WhiteNoise:
    """Return white noise that matches the contact's force at low frequency, S_F = S_force(0)/V, and what it drives.

    Exact: Var x = S_F/(2 c k), Var x' = S_F/(2 c m), inf without damping. Raises Refused as `drive_of`.
    Source: Kilburn (1974); Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    density, slider = _level(model), drive_of(model).slider
    lost = 2.0 * slider.damping
    place, speed = (sqrt(density / (lost * each)) if lost else inf for each in (slider.stiffness, slider.mass))
    corner = half_power_wavenumber(model) if are_at_random(model) else None
    phase = None if corner is None else corner * model.mean_life_distance
    return WhiteNoise(density, place, speed, corner, phase)


def white_displacement_spectrum(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F / ((k - m w^2)^2 + (c w)^2) in um^2 per rad/s, what white noise would leave; w in rad/s."""
    drive = drive_of(model)
    return _level(model) * np.square(np.abs(drive.compliance(np.asarray(angular_frequency) / drive.speed)))


def white_force_spectrum(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F in uN^2 per rad/s at every w in rad/s; errors and source as `white_noise`."""
    return np.full_like(angular_frequency, _level(model))


def _level(model: Model) -> float:
    need_friction(model)
    return float(force_spectral_density(model, 0.0)) / drive_of(model).speed
