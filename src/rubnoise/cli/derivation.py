"""The numbers that follow from a scenario, as rows of an answer: sizes, exact means and spreads, motion and cost."""

from collections.abc import Iterator
from math import inf, isnan, nan
from typing import Final

from rubnoise.analysis.moments import needed_for_motion, one_way_warnings
from rubnoise.answer import Answer, Row, length, rows
from rubnoise.cli.vocabulary import NOTES, fields_of, named
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.simulation.ticks import cells_per_tick
from rubnoise.storage.forecast import Budget
from rubnoise.theory.coupling import LoadMotion
from rubnoise.theory.exact import Exact, exact

WORTH_A_NOTE, WORTH_A_SHARE = 0.01, 1e-4
"""Differences and errors, as parts of what they are of, and share of time with a negative load, that are printed."""

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
    return one_way_warnings(theory.model, validity) + _load_warnings(theory)


def _is_on_a_base(model: Model) -> bool:
    """Whether a base lifts the slider: it does not feel the motion, and sliding speed is no measure of it."""
    return model.slider is not None and model.slider.excitation == "base"


def _contact(model: Model, theory: Exact) -> Iterator[Row]:
    held = "" if model.free is None else "at constant separation"
    sizes = fields_of(model, "calibrated_diameter mean_life_distance mean_birth_spacing")
    yield from named("contact", sizes, NOTES | {"calibrated_diameter": f"d_m, calibration {model.calibration}"})
    yield from rows(
        "contact",
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
    yield from named("slider", fields_of(model.slider, "natural_frequency damping_ratio"))
    yield from motion_rows(theory)
    cells = None if model.is_two_way else cells_per_tick(model)
    yield from named("slider", {"cells_per_tick": cells, "needed_distance": needed_for_motion(model)})


def motion_rows(theory: Exact) -> Iterator[Row]:
    """Yield the motion of a slider and, unless a base drives it, the numbers that judge one-way coupling."""
    motion = theory.slider
    if theory.model.slider is None or motion is None:
        return
    known = {"displacement_mean": motion.mean_displacement}
    yield from named("slider", known | fields_of(motion, "displacement_std velocity_std upcrossing_rate"))
    if _is_on_a_base(theory.model):
        return
    found = theory.coupling()
    judged = {
        "one_way_validity": motion.one_way_validity,
        "coupling_strength": found.strength,
        "stick_number": found.stick_number,
        "expected_change": nan if found.unknown else found.expected_change,
    }
    for name, value in judged.items():
        if isnan(value):
            yield Row(part="slider", name=name, note=f"not known: {found.unknown}")
        else:
            yield from named("slider", {name: value})


def cost(budget: Budget) -> list[Row]:
    """Return the rows, bytes and memory that a run takes; estimates have three digits."""
    known = {
        **fields_of(budget, "junctions ticks slider_rows_at_most"),
        "bytes": budget.result_bytes,
        "disk_needed": budget.disk_bytes,
        "peak_memory": int(float(f"{budget.peak_bytes:.3g}")),
        "events": 2 * budget.junctions,
        "working_memory": budget.working_bytes,
    }
    return named("cost", known)


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
    notes += load_notes(theory)
    if model.free is not None:
        notes.append(FREE_ROWS)
    return notes + too_short_for_motion(model)


def too_short_for_motion(model: Model) -> list[str]:
    """Return that a run is too short for standard errors of its slider's motion, if it is, and what it needs."""
    needed, short = needed_for_motion(model), "the run is too short for standard errors of the slider's motion"
    return [] if needed is None else [f"{short}; it needs about {length(needed)}"]


# What a load that weighs does.

FOLLOWING, FAR = 0.3, 10.0
"""V over c omega_c up to which first order has the displacement below the contact resonance; omega_0 over omega_c from
which a slider moves as at constant gap, if the force is that."""

_FREE_FIGURES: Final = (
    "contact_resonance relative_speed live damping_ratio restitution impact_damping"
    " load_mean area_mean force_mean fast_area_mean"
)
_LOAD_FIGURES: Final = (
    "separation_std velocity_std load_std contact_resonance damping_ratio relative_speed regime suppression"
    " negative_share velocity_level"
)


def load_rows(theory: Exact) -> list[Row]:
    """Return the regime of a contact and its motion under a load that weighs; what is not known is left away."""
    motion, free = theory.load, theory.free
    if free is not None:
        known = {name: value for name, value in fields_of(free, _FREE_FIGURES).items() if not isnan(value)}
        if free.first_order is not None:
            known["first_order_separation_std"] = free.first_order.separation_std
            known["first_order_velocity_std"] = free.first_order.velocity_std
        return named("load", {"regime": "free"} | known)
    if motion is not None:
        error = None if motion.error == inf else motion.error
        known = {"relative_frequency": _relative_frequency(theory.model, motion), "error_bound": error}
        return named("load", fields_of(motion, _LOAD_FIGURES) | known)
    if _is_on_a_base(theory.model):
        return named("load", {"regime": "lifted by a base"})
    variation = theory.area.std / theory.area.mean
    return named("load", {"regime": "separation held", "load_variation": variation})


def _relative_frequency(model: Model, motion: LoadMotion) -> float | None:
    return None if model.slider is None else model.slider.natural_frequency / motion.contact_resonance


def load_notes(theory: Exact) -> list[str]:
    """Return how exact the numbers of a load that weighs are."""
    if theory.free is not None:
        exact = "the numbers of free motion are exact, and so is that the level's exponents obey m = (1 + n)/2"
        changed = "where nothing but height and speed changes"
        return [f"{exact} {changed}; others are for constant separation, which free motion does not have"]
    motion, notes = theory.load, []
    if motion is None:
        return []
    if motion.regime == "constant gap" and (_relative_frequency(theory.model, motion) or inf) < FAR:
        notes.append(
            "the force is that of a constant gap, but not the slider's motion: momentum keeps the mean load at every"
            " speed, so a slider moves as in the paper only if omega_0, too, is far above omega_c"
        )
    if motion.regime != "bouncing" and WORTH_A_NOTE < motion.error < inf:
        error = f"{100.0 * motion.error:.2g} %"
        notes.append(f"first order misses the spreads of separation, normal velocity and load by up to {error}")
    return notes


def _load_warnings(theory: Exact) -> list[str]:
    """Return the reasons why first order is doubtful, if there are any."""
    free, motion, warnings = theory.free, theory.load, []
    if free is not None and free.restitution == 1.0 and free.damping_ratio == 0.0:
        lossless = "with a restitution of 1 and no dashpot nothing takes away the energy that sliding brings"
        return [f"{lossless}: there is no stationary state, and levels grow as long as the run lasts"]
    if motion is None:
        return []
    if motion.regime == "bouncing":
        warnings.append(
            "with fewer than about 10 live junctions the slider leaves its contact and bounces;"
            " the linear motion is no guide to that"
        )
    elif motion.error == inf:
        warnings.append(
            "first order was compared with exact motion from a damping ratio of 0.05 on;"
            " near the resonance less damping errs more"
        )
    slow = (_relative_frequency(theory.model, motion) or 1.0) < 1.0
    if motion.regime != "bouncing" and motion.relative_speed > FOLLOWING and slow:
        warnings.append(
            "the displacement is a lower bound, and the suppression an upper one: swings at the contact resonance are"
            " rectified into slow motion, which first order does not have"
        )
    if motion.negative_share > WORTH_A_SHARE:
        share = f"{100.0 * motion.negative_share:.2g} %"
        warnings.append(f"the load would be negative for {share} of the time, while a contact only pushes")
    return warnings
