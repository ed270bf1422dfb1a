"""The numbers that follow from a scenario, as rows of an answer: sizes, exact means and spreads, motion and cost."""

from collections.abc import Iterator
from dataclasses import fields
from math import inf, isnan, nan
from pathlib import Path
from typing import Any, Final

from rubnoise.analysis.moments import missing_for_motion, one_way_warnings
from rubnoise.answer import Answer, Row, rows
from rubnoise.cli.layout import too_short_for_motion
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.simulation.ticks import cells_per_tick
from rubnoise.storage.forecast import Budget, check_disk_space, counted, expected
from rubnoise.theory.exact import Exact, exact

WORTH_A_NOTE = 0.01

FREE_ROWS = "free motion may touch a summit several times or not at all: rows of junctions and bytes are an estimate"

ONE_WAY_ALONE = (
    "the slider pushes back: its displacement and velocity here are those of one-way coupling; a run shows the others"
)
"""What to say beside the exact motion of a slider that is coupled two ways."""


def derived(scenario: Scenario, title: str, *, warned: bool) -> Answer:
    """Return what follows from a scenario; warnings about the file only if they were not printed: not ``warned``."""
    model = scenario.model()
    theory = exact(model)
    warnings = [*([] if warned else scenario.warnings), *motion_warnings(theory)]
    return Answer(
        title=title,
        rows=(*_contact(model, theory), *_slider(model, theory), *load_rows(theory)),
        notes=(*(f"warning: {warning}" for warning in warnings), *_notes(scenario, theory)),
    )


def motion_warnings(theory: Exact) -> list[str]:
    """Return warnings about the exact motion of a slider, and under its load."""
    validity = 0.0
    if theory.slider is not None and not _is_on_a_base(theory.model):
        validity = theory.slider.one_way_validity
    return one_way_warnings(theory.model, validity) + load_warnings(load_as_json(theory))


def _is_on_a_base(model: Model) -> bool:
    """Whether a base lifts the slider: it does not feel the motion, and sliding speed is no measure of it."""
    return model.slider is not None and model.slider.excitation == "base"


def _contact(model: Model, theory: Exact) -> Iterator[Row]:
    held = "" if model.free is None else "at constant separation"
    yield from rows(
        "contact",
        ("calibrated_diameter", model.calibrated_diameter, "um", f"d_m, calibration {model.calibration}"),
        ("mean_life_distance", model.mean_life_distance, "um", "L_jm"),
        ("mean_birth_spacing", model.mean_birth_spacing, "um", "s_jm"),
        ("junction_count_mean", theory.count_mean, "", held),
        ("junction_count_std", theory.count_std, "", held),
        ("real_contact_area_mean", theory.area.mean, "um^2", held),
        ("real_contact_area_std", theory.area.std, "um^2", held),
    )
    if theory.force is not None:
        more = 1.0 if theory.free is None else theory.free.fast_area_mean / theory.area.mean
        known = model.load is not None and not isnan(more)
        fast = "" if model.free is None or model.free.restitution == 1.0 else "at high speeds"
        yield from rows(
            "contact",
            ("friction_force_mean", theory.force.mean, "uN", held),
            ("friction_force_std", theory.force.std, "uN", held),
            ("friction_coefficient", more * theory.force.mean / model.load if known and model.load else None, "", fast),
        )
    births, junctions = round(theory.expected_births), round(theory.expected_junction_rows)
    yield from rows("contact", ("expected_births", births), ("expected_junctions", junctions))


def _slider(model: Model, theory: Exact) -> Iterator[Row]:
    if model.slider is None or theory.slider is None:
        return
    known = ("natural_frequency", model.slider.natural_frequency, "Hz"), ("damping_ratio", model.slider.damping_ratio)
    yield from rows("slider", *known)
    yield from motion_rows(theory)
    missing = missing_for_motion(model)
    yield from rows(
        "slider",
        ("cells_per_tick", None if model.is_two_way else cells_per_tick(model)),
        ("needed_distance", None if missing is None else missing.needed, "um"),
    )


def motion_rows(theory: Exact) -> Iterator[Row]:
    """Yield the motion of a slider and, unless a base drives it, the numbers that judge one-way coupling."""
    motion = theory.slider
    if theory.model.slider is None or motion is None:
        return
    yield from rows(
        "slider",
        ("displacement_mean", motion.mean_displacement, "um"),
        ("displacement_std", motion.displacement_std, "um"),
        ("velocity_std", motion.velocity_std, "um/s"),
        ("upcrossing_rate", motion.upcrossing_rate, "1/s"),
    )
    if _is_on_a_base(theory.model):
        return
    found = theory.coupling()
    change = nan if found.unknown else found.expected_change
    for name, value, note, unknown in (
        ("one_way_validity", motion.one_way_validity, "std of velocity over sliding speed", ""),
        ("coupling_strength", found.strength, "Pi; weak below 0.03", found.unknown),
        ("stick_number", found.stick_number, "theta; a slow slider sticks above 1", ""),
        ("expected_change", change, "std of displacement, two-way over one-way", found.unknown),
    ):
        if isnan(value):
            yield Row(part="slider", name=name, note=f"not known: {unknown}")
        else:
            yield Row(part="slider", name=name, value=value, note=note)


def cost(scenario: Scenario) -> Iterator[Row]:
    """Yield what a run of a scenario takes; its births are counted from its seed."""
    budget = counted(scenario)
    yield from budget_rows(budget)
    memory = budget.working_bytes, "B", "without the program's"
    yield from rows("cost", ("events", 2 * budget.junctions), ("working_memory", *memory))


def budget_rows(budget: Budget) -> Iterator[Row]:
    """Yield the rows, bytes and memory of a run; estimates have three digits."""
    yield from rows(
        "cost",
        ("junctions", budget.junctions),
        ("ticks", budget.ticks),
        ("slider_rows_at_most", budget.slider_rows_at_most),
        ("bytes", budget.result_bytes, "B", "before compression, if any"),
        ("disk_needed", budget.disk_bytes, "B"),
        ("peak_memory", int(float(f"{budget.peak_bytes:.3g}")), "B"),
    )


def missing_resources(scenario: Scenario, file: Path) -> list[str]:
    """Return the resources that this machine lacks for a run of a scenario file into this folder."""
    try:
        check_disk_space(scenario, expected(scenario), f"{file.stem}.h5")
    except Refused as lack:
        return [str(lack)]
    return []


def _notes(scenario: Scenario, theory: Exact) -> list[str]:
    model, law, notes = scenario.model(), scenario.diameter.law, []
    specified, wanted = model.mean_junction_count, model.mean_real_contact_area
    more, larger = theory.count_mean / specified - 1.0, theory.area.mean / wanted - 1.0
    if abs(more) > WORTH_A_NOTE:
        changed = f"the mean diameter of the law {law} changes the mean count by {more:+.1%}"
        notes.append(f"{changed} from the specified {specified:g}")
    if abs(larger) > WORTH_A_NOTE:
        differs = f"the exact mean area differs by {larger:+.1%} from the specified {wanted:g} um^2"
        notes.append(f"{differs}; calibration matched gives it")
    if scenario.strength is not None and model.strengths is not None:
        given, strength_law = float(scenario.strength.mean), scenario.strength.law
        off = model.strengths.mean / given - 1.0
        if abs(off) > WORTH_A_NOTE:
            notes.append(f"the law {strength_law} changes the mean strength by {off:+.1%} from {given:.7g} MPa")
    if model.is_two_way:
        notes.append(ONE_WAY_ALONE)
    notes += load_notes(load_as_json(theory))
    if model.free is not None:
        notes.append(FREE_ROWS)
    missing = missing_for_motion(model)
    return notes if missing is None else [*notes, too_short_for_motion(missing.decays, missing.needed)]


# What a load that weighs does.

HELD, LIFTED, FREE = "separation held", "lifted by a base", "free"
"""Regimes without a load that weighs (the gap is constant), over a base that moves, and of a slider that may fly."""

CONSTANT_GAP, BOUNCING = "constant gap", "bouncing"
"""Regimes in which the force is that of a constant gap, and of so few junctions that first order is no guide."""

ERROR_WORTH_A_NOTE, WORTH_A_SHARE = 0.01, 1e-4
"""Error of first order over a spread, and share of time with a negative load, from which they are printed."""

FOLLOWING, FAR = 0.3, 10.0
"""V over c omega_c up to which first order has the displacement below the contact resonance; omega_0 over omega_c from
which a slider moves as at constant gap, if the force is that."""

BESIDE: Final[dict[str, tuple[str, ...]]] = {
    "load_variation": ("", "of the load that it takes, std over mean"),
    "contact_resonance": ("Hz",),
    "relative_speed": ("", "V over c omega_c"),
    "relative_frequency": ("", "omega_0 over omega_c"),
    "separation_std": ("um",),
    "velocity_std": ("um/s",),
    "velocity_level": ("dB", "re 50 nm/s"),
    "load_std": ("uN",),
    "load_mean": ("uN",),
    "area_mean": ("um^2",),
    "fast_area_mean": ("um^2", "at high speeds"),
    "force_mean": ("uN",),
    "first_order_separation_std": ("um",),
    "first_order_velocity_std": ("um/s",),
    "live": ("", "N, mean number of junctions in contact at rest"),
    "impact_damping": ("", "times s_0 omega_c"),
    "suppression": ("", "of the excitation at constant separation"),
}
"""Units of the numbers, and what there is to say beside them."""


def load_rows(theory: Exact) -> Iterator[Row]:
    """Yield the regime of a contact and its motion under a load that weighs; what is not known is left away."""
    yield from rows("load", *((name, value, *BESIDE.get(name, ())) for name, value in load_as_json(theory).items()))


def load_as_json(theory: Exact) -> dict[str, Any]:
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
    known = {each.name: getattr(motion, each.name) for each in fields(motion)}
    return {name: value for name, value in known.items() if name not in {"error", "covariances"}} | {
        "velocity_level": motion.velocity_level,
        "relative_frequency": None if slider is None else slider.natural_frequency / motion.contact_resonance,
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
