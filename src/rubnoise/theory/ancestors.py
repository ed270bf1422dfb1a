"""Models of others: rough contact at rest (Greenwood and Williamson), a force that falls with speed, white noise."""

from cmath import exp as turned
from dataclasses import dataclass
from functools import partial
from math import atan2, exp, gamma, inf, pi, sqrt
from typing import Any, Literal

import numpy as np

from rubnoise.arrays import Doubles, number_in
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.moments import force_cumulants
from rubnoise.theory.motion import FORCE, density_of, drive_of, need_friction
from rubnoise.theory.second_order import are_at_random, half_power_wavenumber
from rubnoise.units import AREA, DENSITY, LENGTH, STRESS
from rubnoise.units import FORCE as FORCE_UNIT

_FARTHEST = 12.0  # separations over the height scale, to either side, among which a load is looked for


def velocity_weakening(model: Model) -> dict[str, float]:
    """Return what a slider does under m x'' + c x' + k x = F(V - x'), F(v) = F_m - a (v - V) while it slides forward.

    Beyond a = c, the border (N s/m), where nothing grows yet, the slider sticks, V = x', until k x + c V reaches
    F(0) = F_m + a V, and slips until its speed is V again: a cycle, else it is steady at mean_displacement (um).
    amplitude: half of the range of x in um; slowest and fastest velocity in um/s; period in s, stick_fraction of it.
    Raises Refused for a slider that is not driven so, and if the force would change its sign.
    Source: Block (1940), J. Acoust. Soc. Am. 12; Oden and Martins (1985), doi:10.1016/0045-7825(85)90009-X.
    """
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or slider.excitation != "velocity-weakening":
        raise Refused('this needs slider.excitation = "velocity-weakening" with its slope')
    force, steady = force_cumulants(model).mean, slider.slope <= slider.damping
    known = {"steady": steady, "border": slider.damping, "mean_displacement": force / slider.stiffness}
    if steady:
        return known | dict.fromkeys(("amplitude", "slowest", "fastest", "period", "stick_fraction"), 0.0)
    return known | _cycle(slider, speed, force)


def _cycle(slider: Slider, speed: float, force: float) -> dict[str, float]:
    """Return the cycle of sticks and slips: with y = x - F_m/k and g = a - c a slip is m y'' - g y' + k y = 0."""
    # y' = V Re((1 + i s/w) e^(r t)), r = s + i w, s = g/2m, w^2 = k/m - s^2. It is slowest at pi/w and V again before
    # 2 pi/w; y = (g y' - m y'')/k is largest where y' = 0 for the first time, and least a half turn later.
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
    return {
        "mean_displacement": force / slider.stiffness + mean / (slipped + stuck),
        "amplitude": 0.5 * (place(first_still) - place(first_still + slowest)),
        "slowest": velocity(slowest),
        "fastest": speed,
        "period": slipped + stuck,
        "stick_fraction": stuck / (slipped + stuck),
    }


def white_noise(model: Model) -> dict[str, float | None]:
    """Return white noise that matches the contact's force at low frequency, S_F = S_force(0)/V, and what it drives.

    force_density: S_F in uN^2 s (two-sided, per rad/s); exact displacement_std, Var x = S_F/(2 c k) in um^2, and
    velocity_std, Var x' = S_F/(2 c m), inf without damping. At ``wavenumber`` in rad/um the contact's own spectrum is a
    half, life_phase is that times the mean life; None unless births are Poisson. Raises Refused as `drive_of`.
    Source: Kilburn (1974); Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    density, slider = float(white_spectrum(FORCE, model, np.zeros(1))[0]), drive_of(model).slider
    lost = 2.0 * slider.damping
    place, speed = (sqrt(density / (lost * each)) if lost else inf for each in (slider.stiffness, slider.mass))
    corner = half_power_wavenumber(model) if are_at_random(model) else None
    known = {"force_density": density, "displacement_std": place, "velocity_std": speed}
    return known | {"wavenumber": corner, "life_phase": corner and corner * model.mean_life_distance}


def white_spectrum(name: str, model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F per rad/s, or S_F / ((k - m w^2)^2 + (c w)^2) of displacement, w^2 times that of velocity."""
    need_friction(model)
    density, drive = density_of(model, FORCE, np.zeros(1)), drive_of(model)
    if name == FORCE:
        return np.full_like(angular_frequency, density[0] / drive.speed)
    moved = drive.compliance(angular_frequency / drive.speed) * (angular_frequency if name == "velocity" else 1.0)
    return np.asarray(density[0] / drive.speed * np.square(np.abs(moved)), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class RoughContact:
    """A static contact in um, uN, um^2, MPa; plasticity index (E*/H) sqrt(s/R): elastic below 0.6, plastic above 1."""

    separation: float
    load: float
    real_contact_area: float
    junction_count: float
    mean_pressure: float
    plasticity_index: float | None

    def interface(self) -> str:
        """Return the table [interface] of a scenario with this area and count."""
        area, count = f"{self.real_contact_area:.9g} um^2", f"{self.junction_count:.9g}"
        return f'[interface]\nmean_real_contact_area = "{area}"\nmean_junction_count = {count}\n'


def height_integral(heights: str, power: float, separation: float) -> float:
    """Return F_n(h) = int_h^inf (t - h)^n phi(t) dt for heights of unit scale, n >= 0; exp(-h) n! if exponential.

    n! exp(-h^2/4) D_(-n-1)(h)/sqrt(2 pi) if Gaussian, D a parabolic cylinder function; error some 1e-9.
    Source: Greenwood and Williamson (1966), doi:10.1098/rspa.1966.0242, Eqs. 10 to 14.
    """
    if heights == "exponential":
        return exp(-separation) * gamma(power + 1.0)
    from scipy.special import pbdv

    cylinder = float(pbdv(-power - 1.0, separation)[0])
    return gamma(power + 1.0) * exp(-0.25 * separation**2) * cylinder / sqrt(2.0 * pi)


def greenwood_williamson(
    *,
    radius: Any,
    height: Any,
    density: Any,
    modulus: Any,
    load: Any = None,
    separation: Any = None,
    nominal_area: Any = "1 mm^2",
    hardness: Any = None,
    heights: Literal["gaussian", "exponential"] = "gaussian",
    regime: Literal["elastic", "plastic"] = "elastic",
) -> RoughContact:
    """Return the static contact of a rough surface with a smooth one, at a load or at a separation of mean planes.

    radius R, height scale s (standard deviation; of exponential heights the mean), density eta of asperities, modulus
    E* (of both, plane strain), as texts with units, quantities of pint, or numbers in um, 1/um^2, MPa, uN.
    With h the separation over s, n eta times the nominal area: N = n F_0(h), elastic A = pi n R s F_1(h),
    P = (4/3) n E* sqrt(R) s^1.5 F_1.5(h); plastic twice that area, and P = H A. Sliding changes it. Raises Refused.
    Source: Greenwood and Williamson (1966), doi:10.1098/rspa.1966.0242.

    >>> import rubnoise
    >>> found = rubnoise.greenwood_williamson(
    ...     radius="50 um", height="0.5 um", density="300 1/mm^2", modulus="100 GPa", load="1 N"
    ... )
    >>> round(found.real_contact_area, 1), round(found.junction_count, 2)
    (294.8, 9.61)
    """
    if (load is None) == (separation is None):
        raise Refused("either a load or a separation")
    if regime == "plastic" and hardness is None:
        raise Refused("a plastic contact needs a hardness")
    if heights not in {"gaussian", "exponential"} or regime not in {"elastic", "plastic"}:
        raise Refused("heights are gaussian or exponential, and a regime elastic or plastic")
    sizes = (radius, LENGTH), (height, LENGTH), (density, DENSITY), (nominal_area, AREA), (modulus, STRESS)
    names = "radius", "height", "density", "nominal area", "modulus"
    r, s, eta, nominal, stiff = (
        number_in(value, name, kind, positive=True) for name, (value, kind) in zip(names, sizes, strict=True)
    )
    hard = inf if hardness is None else number_in(hardness, "hardness", STRESS, positive=True)
    count, plastic, integral = eta * nominal, regime == "plastic", partial(height_integral, heights)

    def area_at(h: float) -> float:
        return (1.0 + plastic) * pi * count * r * s * integral(1.0, h)

    def load_at(h: float) -> float:
        return hard * area_at(h) if plastic else 4.0 / 3.0 * count * stiff * sqrt(r) * s**1.5 * integral(1.5, h)

    if load is None:
        h = number_in(separation, "separation", LENGTH) / s
    else:
        from scipy.optimize import brentq

        least = 0.0 if heights == "exponential" else -_FARTHEST
        wanted = number_in(load, "load", FORCE_UNIT, positive=True)
        fewest, most = load_at(_FARTHEST), load_at(least)
        if not fewest <= wanted <= most:
            raise Refused(f"a load of {wanted:g} uN: this surface carries {fewest:.3g} to {most:.3g} uN")
        h = float(brentq(lambda h: load_at(h) - wanted, least, _FARTHEST, xtol=1e-14, rtol=1e-14))
    if heights == "exponential" and h < 0.0:
        raise Refused("exponential heights begin at the mean plane: the separation is not negative")
    if h < -_FARTHEST:
        raise Refused(f"separation: {h:g} heights below the mean plane, where {-_FARTHEST:g} is the least")
    area, force = area_at(h), load_at(h)
    pressure, plasticity = force / area if area else 0.0, None if hardness is None else stiff / hard * sqrt(s / r)
    return RoughContact(h * s, force, area, count * integral(0.0, h), pressure, plasticity)
