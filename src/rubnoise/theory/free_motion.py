"""The exact results for a slider that is free to leave its contact; for the rest there is no theory.

With c, s_0, 1/omega_c and W as units, only N, v = V/(c omega_c) and the loss remain. So with these laws and a
loss without a scale of its own, the velocity is (V s_0/c) F(V^2 s_0 m/(c^2 W); N, loss): its exponent n of speed and m
of height obey m = (1 + n)/2, in every regime.
"""

from dataclasses import dataclass, replace
from math import nan

from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.load import LoadMotion, load_motion, relative_speed


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeMotion:
    """Scales of free motion (Hz; the rest without units), its exact means (uN, um^2), and its limit.

    live: N; restitution, or impact_damping as beta s_0 omega_c, the other nan; area_mean and force_mean: nan unless the
    contact is elastic, and force_mean also without a strength; fast_area_mean: what the mean area tends to at high
    speeds, nan with impact damping; first_order: the limit of small v and large N, of a contact with no loss but that
    of a dashpot, else None.
    """

    contact_resonance: float
    relative_speed: float
    live: float
    damping_ratio: float
    restitution: float
    impact_damping: float
    load_mean: float
    area_mean: float
    force_mean: float
    fast_area_mean: float
    first_order: LoadMotion | None


def height_exponent(speed_exponent: float) -> float:
    """Return m = (1 + n)/2, the exponent of height (at constant c and N) that goes with an exponent n of speed."""
    return 0.5 * (1.0 + speed_exponent)


def free_motion(model: Model) -> FreeMotion:
    """Return the exact results of free motion.

    Momentum: the mean of P is W. If nothing is lost in the contact (restitution 1), P = H sum A_i, so the mean area
    is A_rm, the mean summed overlap N s_0, and the mean friction force E[psi] A_rm: strengths do not move the slider.
    At high speeds sliding alone changes overlaps, so that half of the area grows and half shrinks, which bears e^2 as
    much: W = H A (1 + e^2)/2, and the mean area tends to 2 A_rm/(1 + e^2).
    Raises Refused without free motion.
    """
    if model.free is None:
        raise Refused('the slider leaves its contact with load.motion = "free" alone')
    free, held = model.free, model.free.held
    linear = replace(model, free=None, separation=held)
    resonance = held.oscillator
    elastic = free.restitution == 1.0
    return FreeMotion(
        contact_resonance=resonance.natural_frequency,
        relative_speed=relative_speed(linear),
        live=model.mean_junction_count,
        damping_ratio=resonance.damping_ratio,
        restitution=nan if free.restitution is None else free.restitution,
        impact_damping=nan
        if free.impact_damping is None
        else free.impact_damping * held.height_scale * resonance.natural_angular_frequency,
        load_mean=held.load,
        area_mean=model.mean_real_contact_area if elastic else nan,
        force_mean=model.strengths.mean * model.mean_real_contact_area
        if elastic and model.strengths is not None
        else nan,
        fast_area_mean=nan
        if free.restitution is None
        else 2.0 * model.mean_real_contact_area / (1.0 + free.restitution**2),
        first_order=load_motion(linear) if elastic and held.damping > 0.0 else None,
    )
