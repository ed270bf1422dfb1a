"""A slider under a friction force that falls with speed, and has no junctions: Block's and Oden and Martins' vibration.

m x'' + c x' + k x = F(V - x'), F(v) = F_m - a (v - V) while it slides forward: the same mean force as the contact's,
falling by the slope a. Small vibrations decay for a < c, grow for a > c, and no noise is left of either.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.campbell import force_cumulants

_TURNS = 200.0  # natural periods within which a slip has to end
_TOLERANCE = 1e-10
_PLACES = 20001


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
    """Return what a slider does under a force that falls with speed, by its slope in N s/m.

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
