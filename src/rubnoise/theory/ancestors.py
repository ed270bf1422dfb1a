"""Models of others beside the contact's own: a lifted base, a force that falls with speed, and white noise.

Rice and Moslehy's asperities lift the base of the slider; Block's and Oden and Martins' force falls with speed and has
no junctions; Kilburn's is a mean force with white noise of the contact's level at low frequency.
"""

from dataclasses import dataclass, replace
from math import inf, sqrt
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.cumulants import area_cumulants, force_cumulants
from rubnoise.theory.motion import drive_of, force_spectral_density, response
from rubnoise.theory.second_order import half_power_wavenumber

_TURNS = 200.0  # natural periods within which a slip has to end
_TOLERANCE = 1e-10
_PLACES = 20001


@dataclass(frozen=True, slots=True, kw_only=True)
class BaseResponse:
    """Stationary motion over a base: mean and spread of the base and of the slider in um, of its velocity in um/s."""

    base_mean: float
    base_std: float
    displacement_std: float
    velocity_std: float


def base_response(model: Model) -> BaseResponse:
    """Return the stationary motion of a slider that its base drives; the mean of x is that of y.

    A triangle of height r d is 4 r/(pi d) times the area of a triangular life of one size d, and so is y of the area;
    S_x(w) = S_y(w/V)/V (k^2 + c^2 w^2) / |k - m w^2 + i c w|^2. Infinite without damping. Raises Refused for a slider
    without a base, and for unequal sizes. Source: Rice and Moslehy (1997); Crandall and Mark (1963).
    """
    slider = model.slider
    if slider is None or model.sliding_speed is None or slider.excitation != "base":
        raise Refused('this needs slider.excitation = "base" with its asperity_height')
    triangles = replace(model, pulse=TRIANGLE)
    motion, area = response(triangles), area_cumulants(triangles)
    return BaseResponse(
        base_mean=model.base_per_area * area.mean,
        base_std=model.base_per_area * area.std,
        displacement_std=motion.displacement_std,
        velocity_std=motion.velocity_std,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Weakening:
    """What becomes of the slider: steady at ``mean_displacement`` (um), or a cycle of sticks and slips.

    border: slope in N s/m from which steady sliding is unstable, c; amplitude: half of the range of the displacement in
    um, velocity_range in um/s, period in s, stick_fraction of it; all 0 if it is steady.
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

    The border a = c is exact. Beyond it the slider sticks, V = x', until k x + c V reaches F(0) = F_m + a V, and slips
    until its speed is V again; the slip is solved to 1e-10. A slope of c exactly is taken for steady: nothing grows.
    Raises Refused for a slider that is not driven so, and if the force would change its sign.
    Source: Block (1940), J. Acoust. Soc. Am. 12; Oden and Martins (1985), doi:10.1016/0045-7825(85)90009-X.
    """
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None or slider.excitation != "velocity-weakening":
        raise Refused('this needs slider.excitation = "velocity-weakening" with its slope')
    force, still = force_cumulants(model).mean, force_cumulants(model).mean / slider.stiffness
    if slider.slope <= slider.damping:
        return Weakening(steady=True, border=slider.damping, mean_displacement=still)
    return _cycle(slider, speed, force, still)


def _cycle(slider: Any, speed: float, force: float, still: float) -> Weakening:
    """Return the cycle of sticks and slips; y is the displacement less the static one."""
    from scipy.integrate import solve_ivp

    growth = slider.slope - slider.damping
    start = growth * speed / slider.stiffness  # k y = (a - c) V: the spring pulls as hard as F(0) allows

    def motion(_time: float, state: Any) -> list[float]:
        y, velocity = state
        return [velocity, (growth * velocity - slider.stiffness * y) / slider.mass]

    def as_fast(_time: float, state: Any) -> float:
        return float(state[1] - speed)

    as_fast.terminal = True  # type: ignore[attr-defined]
    as_fast.direction = 1.0  # type: ignore[attr-defined]
    turn = 2.0 * np.pi / slider.natural_angular_frequency
    # It leaves the stick with no acceleration: a nudge begins the slip, too small to be seen in what follows.
    begin = [start * (1.0 + 1e-9), speed * (1.0 - 1e-9)]
    fine: dict[str, Any] = {"method": "DOP853", "rtol": _TOLERANCE, "atol": 1e-12, "dense_output": True}
    slip = solve_ivp(motion, (0.0, _TURNS * turn), begin, events=as_fast, **fine)
    if not slip.t_events[0].size:
        raise Refused("the slider slips on and on: slope and damping differ too little for a cycle to be found")
    slipped, end = float(slip.t_events[0][0]), float(slip.y_events[0][0][0])
    times = np.linspace(0.0, slipped, _PLACES)
    y, velocity = slip.sol(times)
    if force - slider.slope * -float(velocity.min()) < 0.0:
        raise Refused("slider.slope: the force would fall below 0 in the slip; a smaller slope or a larger mean force")
    stuck = (start - end) / speed
    mean = (float(np.trapezoid(y, times)) + 0.5 * (start + end) * stuck) / (slipped + stuck)
    return Weakening(
        steady=False,
        border=slider.damping,
        mean_displacement=still + mean,
        amplitude=0.5 * float(np.ptp(y)),
        slowest=float(velocity.min()),
        fastest=speed,
        period=slipped + stuck,
        stick_fraction=stuck / (slipped + stuck),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class WhiteNoise:
    """White noise S_F in uN^2 s (two-sided, per rad/s), and the spread of a slider that it drives, in um and um/s.

    ``wavenumber`` in rad/um is where the contact's own spectrum has fallen to a half, ``life_phase`` that times the
    mean life; both are None if the spectrum has no such corner.
    """

    force_density: float
    displacement_std: float
    velocity_std: float
    wavenumber: float | None
    life_phase: float | None


def white_noise(model: Model) -> WhiteNoise:
    """Return white noise that matches the contact's force at low frequency, S_F = S_force(0)/V, and what it drives.

    For Poisson births S_force(0) is E[psi^2] S_A(0). Exact: Var x = S_F/(2 c k), Var x' = S_F/(2 c m), inf without
    damping. Raises Refused without slider, strength or speed.
    Source: Kilburn (1974); Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    density, slider = _level(model), drive_of(model).slider
    still = 2.0 * slider.damping
    try:
        corner = half_power_wavenumber(model)
    except Refused:
        corner = None
    return WhiteNoise(
        force_density=density,
        displacement_std=sqrt(density / (still * slider.stiffness)) if still else inf,
        velocity_std=sqrt(density / (still * slider.mass)) if still else inf,
        wavenumber=corner,
        life_phase=None if corner is None else corner * model.mean_life_distance,
    )


def white_displacement_spectrum(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F / ((k - m w^2)^2 + (c w)^2), the two-sided density in um^2 per rad/s that white noise would leave.

    w in rad/s of any shape; w^2 times it is that of the velocity. Errors and source as `white_noise`.
    """
    slider, w = drive_of(model).slider, np.asarray(angular_frequency, dtype=np.float64)
    still = np.square(slider.stiffness - slider.mass * w * w) + np.square(slider.damping * w)
    return np.asarray(_level(model) / still, dtype=np.float64)


def white_force_spectrum(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F in uN^2 per rad/s at every w in rad/s; errors and source as `white_noise`."""
    return np.full_like(angular_frequency, _level(model))


def _level(model: Model) -> float:
    drive = drive_of(model)
    return float(force_spectral_density(model, drive.strengths, 0.0)) / drive.speed
