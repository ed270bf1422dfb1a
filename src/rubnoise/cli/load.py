"""What a load that weighs does, by name and as lines to print; without one, that the separation is held."""

from collections.abc import Iterator
from math import inf, isnan
from typing import TYPE_CHECKING, Any

from rubnoise.cli.layout import line, number, remark

if TYPE_CHECKING:
    from rubnoise.theory.exact import Exact
    from rubnoise.theory.free_motion import FreeMotion

HELD = "separation held"
"""The regime of a scenario without a load that weighs: the gap is constant, and the load is not."""

FREE = "free"
"""The regime of a slider that may leave its contact, of which N, v and the loss decide what it does."""

WORTH_A_SHARE = 1e-4
"""Share of time with a negative load from which it is printed."""


def load_as_json(theory: "Exact") -> dict[str, Any]:
    """Return the regime of a contact by name, and its motion under a load that weighs; an unknown error is None."""
    motion, free = theory.load, theory.free
    if free is not None:
        return {"regime": FREE} | _known(free)
    if motion is None:
        return {"regime": HELD, "load_variation": theory.area.std / theory.area.mean}
    return {
        "regime": motion.regime,
        "contact_resonance": motion.contact_resonance,
        "damping_ratio": motion.damping_ratio,
        "relative_speed": motion.relative_speed,
        "separation_std": motion.separation_std,
        "velocity_std": motion.velocity_std,
        "velocity_level": motion.velocity_level,
        "load_std": motion.load_std,
        "suppression": motion.suppression,
        "negative_share": motion.negative_share,
        "error_bound": None if motion.error == inf else motion.error,
    }


def _known(free: "FreeMotion") -> dict[str, Any]:
    """Return the scales and exact means of free motion by name; what is not known is left out."""
    found = {
        "contact_resonance": free.contact_resonance,
        "relative_speed": free.relative_speed,
        "live": free.live,
        "damping_ratio": free.damping_ratio,
        "restitution": free.restitution,
        "impact_damping": free.impact_damping,
        "load_mean": free.load_mean,
        "area_mean": free.area_mean,
        "force_mean": free.force_mean,
    }
    linear = free.first_order
    if linear is not None:
        found |= {"first_order_separation_std": linear.separation_std, "first_order_velocity_std": linear.velocity_std}
    return {name: value for name, value in found.items() if not isnan(value)}


def _free_lines(load: dict[str, Any]) -> Iterator[str]:
    speed = number(load["relative_speed"])
    yield line(
        "normal motion", f"free to leave the contact (V is {speed} times c omega_c, N is {number(load['live'])})"
    )
    loss = (
        f"restitution {number(load['restitution'])}"
        if "restitution" in load
        else f"impact damping {number(load['impact_damping'])} of 1/(s_0 omega_c)"
    )
    yield line("contact resonance", f"{number(load['contact_resonance'])} Hz, {loss}")
    yield line("load", f"mean {number(load['load_mean'])} uN")
    if "area_mean" in load:
        yield line("mean area", f"{number(load['area_mean'])} um^2")
    if "first_order_velocity_std" in load:
        linear = f"normal velocity std {number(load['first_order_velocity_std'])} um/s"
        yield line("of first order", f"{linear}, the limit of many junctions at a low speed")
    yield remark(
        "note: these are exact, and so is that the level's exponents obey m = (1 + n)/2 where nothing but height and"
        " speed changes; other lines are for constant separation, which free motion has at high speeds alone"
    )


def format_load(load: dict[str, Any]) -> Iterator[str]:
    """Yield the same as lines to print, with a warning where first order is not to be trusted."""
    if load["regime"] == FREE:
        yield from _free_lines(load)
        return
    if load["regime"] == HELD:
        share = f"{100.0 * load['load_variation']:.3g} %"
        yield line("normal motion", f"{HELD}; the load that it takes varies by {share} (std over mean)")
        return
    speed = number(load["relative_speed"])
    yield line("regime", f"{load['regime']} (V is {speed} times c omega_c)")
    ratio = f"damping ratio {number(load['damping_ratio'])}"
    yield line("contact resonance", f"{number(load['contact_resonance'])} Hz, {ratio}")
    yield line("separation", f"std {number(load['separation_std'])} um")
    level = f"{load['velocity_level']:.1f} dB re 50 nm/s"
    yield line("normal velocity", f"std {number(load['velocity_std'])} um/s, {level}")
    yield line("load", f"std {number(load['load_std'])} uN")
    yield line("suppression", f"{number(load['suppression'])} times less excitation than at constant separation")
    yield from map(remark, _doubts(load))


def _doubts(load: dict[str, Any]) -> Iterator[str]:
    if load["regime"] == "bouncing":
        yield (
            "warning: with fewer than about 10 live junctions the slider leaves its contact and bounces;"
            " the linear motion is no guide to that"
        )
    elif load["error_bound"] is None:
        yield (
            "warning: first order was compared with exact motion from a damping ratio of 0.05 on;"
            " near the resonance less damping errs more"
        )
    elif load["error_bound"] > 0.01:
        yield f"note: first order misses these spreads by up to {100.0 * load['error_bound']:.2g} %"
    if load["negative_share"] > WORTH_A_SHARE:
        share = f"{100.0 * load['negative_share']:.2g} %"
        yield f"warning: the load would be negative for {share} of the time, while a contact only pushes"
