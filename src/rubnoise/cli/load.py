"""What a load that weighs does, by name and as lines to print; without one, that the separation is held."""

from collections.abc import Iterator
from math import inf
from typing import TYPE_CHECKING, Any

from rubnoise.cli.layout import line, number, remark

if TYPE_CHECKING:
    from rubnoise.theory.exact import Exact

HELD = "separation held"
"""The regime of a scenario without a load that weighs: the gap is constant, and the load is not."""

WORTH_A_SHARE = 1e-4
"""Share of time with a negative load from which it is printed."""


def load_as_json(theory: "Exact") -> dict[str, Any]:
    """Return the regime of a contact by name, and its motion under a load that weighs; an unknown error is None."""
    motion = theory.load
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


def format_load(load: dict[str, Any]) -> Iterator[str]:
    """Yield the same as lines to print, with a warning where first order is not to be trusted."""
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
