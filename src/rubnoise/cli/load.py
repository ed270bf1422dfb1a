"""The effect of a load that weighs, by name and as lines to print; without one, that separation is held or a lift."""

from collections.abc import Iterator
from dataclasses import fields
from math import inf, isnan
from typing import TYPE_CHECKING, Any, Final

from rubnoise.answer import Row

if TYPE_CHECKING:
    from rubnoise.theory.exact import Exact

HELD = "separation held"
"""The regime of a scenario without a load that weighs: the gap is constant, and the load is not."""

LIFTED = "lifted by a base"
"""The regime of a slider over a base, which moves as asperities lift it."""

FREE = "free"
"""The regime of a slider that may leave its contact, of which N, v and the loss decide what it does."""

CONSTANT_GAP = "constant gap"
"""The regime in which the force is that of a constant separation."""

BOUNCING = "bouncing"
"""The regime of so few junctions that first order is no guide."""

ERROR_WORTH_A_NOTE = 0.01
"""Error of first order, relative to a spread, from which it is printed."""

FOLLOWING = 0.3
"""V over c omega_c up to which first order has the displacement of a slider below the contact resonance."""

FAR = 10.0
"""omega_0 over omega_c from which a slider moves as at constant separation, if the force is that."""

WORTH_A_SHARE = 1e-4
"""Share of time with a negative load from which it is printed."""


UNITS: Final = {
    "contact_resonance": "Hz",
    "separation_std": "um",
    "velocity_std": "um/s",
    "velocity_level": "dB",
    "load_std": "uN",
    "load_mean": "uN",
    "area_mean": "um^2",
    "fast_area_mean": "um^2",
    "force_mean": "uN",
    "first_order_separation_std": "um",
    "first_order_velocity_std": "um/s",
}
NOTES: Final = {
    "load_variation": "of the load that it takes, std over mean",
    "relative_speed": "V over c omega_c",
    "relative_frequency": "omega_0 over omega_c",
    "velocity_level": "re 50 nm/s",
    "live": "N, mean number of junctions in contact at rest",
    "impact_damping": "times s_0 omega_c",
    "fast_area_mean": "at high speeds",
    "suppression": "of the excitation at constant separation",
}
"""Units of the numbers, and what there is to say beside them."""


def load_rows(theory: "Exact") -> Iterator[Row]:
    """Yield the regime of a contact and its motion under a load that weighs; what is not known is left away."""
    for name, value in load_as_json(theory).items():
        if value is not None:
            yield Row(part="load", name=name, value=value, unit=UNITS.get(name, ""), note=NOTES.get(name, ""))


def load_as_json(theory: "Exact") -> dict[str, Any]:
    """Return the regime of a contact by name, and its motion under a load that weighs; an unknown error is None."""
    motion, free = theory.load, theory.free
    if free is not None:
        known = {each.name: getattr(free, each.name) for each in fields(free) if each.name != "first_order"}
        if (linear := free.first_order) is not None:
            known["first_order_separation_std"] = linear.separation_std
            known["first_order_velocity_std"] = linear.velocity_std
        return {"regime": FREE} | {name: value for name, value in known.items() if not isnan(value)}
    if theory.model.slider is not None and theory.model.slider.excitation == "base":
        return {"regime": LIFTED}
    if motion is None:
        return {"regime": HELD, "load_variation": theory.area.std / theory.area.mean}
    slider = theory.model.slider
    return {
        "regime": motion.regime,
        "contact_resonance": motion.contact_resonance,
        "damping_ratio": motion.damping_ratio,
        "relative_speed": motion.relative_speed,
        "separation_std": motion.separation_std,
        "velocity_std": motion.velocity_std,
        "velocity_level": motion.velocity_level,
        "load_std": motion.load_std,
        "relative_frequency": None if slider is None else slider.natural_frequency / motion.contact_resonance,
        "suppression": motion.suppression,
        "negative_share": motion.negative_share,
        "error_bound": None if motion.error == inf else motion.error,
    }


def load_notes(load: dict[str, Any]) -> list[str]:
    """Return how exact these numbers are."""
    if load["regime"] == FREE:
        exact = "the numbers of free motion are exact, and so is that the level's exponents obey m = (1 + n)/2"
        changed = "where nothing but height and speed changes"
        return [f"{exact} {changed}; others are for constant separation, which free motion does not have"]
    notes = []
    if load["regime"] == CONSTANT_GAP and (load["relative_frequency"] or inf) < FAR:
        notes.append(
            "the force is that of a constant gap, but not the slider's motion: momentum keeps the mean load at every"
            " speed, so a slider moves as in the paper only if omega_0, too, is far above omega_c"
        )
    if load["regime"] != BOUNCING and (load.get("error_bound") or 0.0) > ERROR_WORTH_A_NOTE:
        error = f"{100.0 * load['error_bound']:.2g} %"
        notes.append(f"first order misses the spreads of separation, normal velocity and load by up to {error}")
    return notes


def load_warnings(load: dict[str, Any]) -> list[str]:
    """Return the reasons why first order is doubtful, if there are any."""
    if load["regime"] == FREE and load.get("restitution") == 1.0 and load["damping_ratio"] == 0.0:
        lossless = "with a restitution of 1 and no dashpot nothing takes away the energy that sliding brings"
        return [f"{lossless}: there is no stationary state, and levels grow as long as the run lasts"]
    if load["regime"] in {HELD, LIFTED, FREE}:
        return []
    warnings = []
    if load["regime"] == BOUNCING:
        warnings.append(
            "with fewer than about 10 live junctions the slider leaves its contact and bounces;"
            " the linear motion is no guide to that"
        )
    elif load["error_bound"] is None:
        warnings.append(
            "first order was compared with exact motion from a damping ratio of 0.05 on;"
            " near the resonance less damping errs more"
        )
    if load["regime"] != BOUNCING and load["relative_speed"] > FOLLOWING and (load["relative_frequency"] or 1.0) < 1.0:
        warnings.append(
            "the displacement is a lower bound, and the suppression an upper one: swings at the contact resonance are"
            " rectified into slow motion, which first order does not have"
        )
    if load["negative_share"] > WORTH_A_SHARE:
        share = f"{100.0 * load['negative_share']:.2g} %"
        warnings.append(f"the load would be negative for {share} of the time, while a contact only pushes")
    return warnings
