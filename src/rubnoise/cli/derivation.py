"""The numbers that follow from a scenario, as rows of an answer: sizes, exact means and spreads, motion and cost."""

from dataclasses import fields, replace
from math import inf, isnan

from rubnoise.analysis.moments import needed_for_motion, one_way_warnings
from rubnoise.answer import Answer, Row, length
from rubnoise.cli.vocabulary import NOTES, fields_of, named
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.simulation.ticks import cells_per_tick
from rubnoise.storage.forecast import Budget
from rubnoise.theory.exact import Exact, exact

_WORTH_A_NOTE = 0.01  # differences and errors, as parts of what they are of, that are printed
_WORTH_A_SHARE = 1e-4  # and share of the time with a negative load
_FOLLOWING = 0.3  # V over c omega_c up to which first order has the displacement below the contact resonance
_FAR = 10.0  # omega_0 over omega_c from which a slider moves as at constant gap, if the force is that

FREE_ROWS = "free motion may touch a summit several times or not at all: rows of junctions and bytes are an estimate"

ONE_WAY_ALONE = (
    "the slider pushes back: its displacement and velocity here are those of one-way coupling; a run shows the others"
)
"""What to say beside the exact motion of a slider that is coupled two ways."""


def derived(scenario: Scenario, title: str, *, warned: bool) -> Answer:
    """Return what follows from a scenario; warnings about the file only if they were not printed: not ``warned``."""
    theory = exact(scenario.model())
    warnings = [*([] if warned else scenario.warnings), *motion_warnings(theory)]
    return Answer(
        title=title,
        rows=(*_contact(theory), *_slider(theory), *load_rows(theory)),
        notes=(*(f"warning: {warning}" for warning in warnings), *_notes(scenario, theory)),
    )


def _contact(theory: Exact) -> list[Row]:
    model, moments = theory.model, fields_of(theory, "count_mean count_std")
    known = fields_of(model, "calibrated_diameter mean_life_distance mean_birth_spacing")
    held = {f"junction_{name}": value for name, value in moments.items()}
    held |= {"real_contact_area_mean": theory.area.mean, "real_contact_area_std": theory.area.std}
    ratio = None
    if theory.force is not None:
        held |= {"friction_force_mean": theory.force.mean, "friction_force_std": theory.force.std}
        more = 1.0 if theory.free is None else theory.free.fast_area_mean / theory.area.mean
        ratio = more * theory.force.mean / model.load if model.load and not isnan(more) else None
    births, rows = round(theory.expected_births), round(theory.expected_junction_rows)
    last = {"friction_coefficient": ratio, "expected_births": births, "expected_junctions": rows}
    notes = NOTES | {"calibrated_diameter": f"d_m, calibration {model.calibration}"}
    if model.free is not None:
        notes |= dict.fromkeys(held, "at constant separation")
        notes |= {} if model.free.restitution == 1.0 else {"friction_coefficient": "at high speeds"}
    return named("contact", known | held | last, notes)


def _slider(theory: Exact) -> list[Row]:
    model = theory.model
    if model.slider is None or theory.slider is None:
        return []
    cells = None if model.is_two_way else cells_per_tick(model)
    last = {"cells_per_tick": cells, "needed_distance": needed_for_motion(model)}
    first = fields_of(model.slider, "natural_frequency damping_ratio")
    return [*named("slider", first), *motion_rows(theory), *named("slider", last)]


def motion_rows(theory: Exact) -> list[Row]:
    """Return the motion of a slider and, unless a base drives it, the numbers that judge one-way coupling."""
    motion = theory.slider
    if motion is None:
        return []
    known = {"displacement_mean": motion.mean_displacement}
    known |= fields_of(motion, "displacement_std velocity_std upcrossing_rate")
    if _is_on_a_base(theory.model):  # it does not feel the motion, and sliding speed is no measure of it
        return named("slider", known)
    found = theory.coupling()
    known |= {"one_way_validity": motion.one_way_validity, "coupling_strength": found.strength}
    known |= fields_of(found, "stick_number expected_change")
    why = f"not known: {found.unknown}"
    told = named("slider", known)
    return [replace(row, value=None, note=why) if isnan(row.value) else row for row in told]


def _is_on_a_base(model: Model) -> bool:
    return model.slider is not None and model.slider.excitation == "base"


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
    model, notes = theory.model, []
    specified, wanted = model.mean_junction_count, model.mean_real_contact_area
    if more := _difference(theory.count_mean, specified):
        changed = f"the mean diameter of the law {scenario.diameter.law} changes the mean count by {more}"
        notes.append(f"{changed} from the specified {specified:g}")
    if larger := _difference(theory.area.mean, wanted):
        differs = f"the exact mean area differs by {larger} from the specified {wanted:g} um^2"
        notes.append(f"{differs}; calibration matched gives it")
    if scenario.strength is not None and model.strengths is not None:
        given, law = float(scenario.strength.mean), scenario.strength.law
        if off := _difference(model.strengths.mean, given):
            notes.append(f"the law {law} changes the mean strength by {off} from {given:.7g} MPa")
    notes += [ONE_WAY_ALONE] if model.is_two_way else []
    notes += load_notes(theory)
    notes += [] if model.free is None else [FREE_ROWS]
    return notes + too_short_for_motion(model)


def _difference(value: float, wanted: float) -> str:
    """Return how much a value is more than what was wanted; empty if that is not worth a note."""
    more = value / wanted - 1.0
    return f"{more:+.1%}" if abs(more) > _WORTH_A_NOTE else ""


def too_short_for_motion(model: Model) -> list[str]:
    """Return that a run is too short for standard errors of its slider's motion, if it is, and what it needs."""
    needed, short = needed_for_motion(model), "the run is too short for standard errors of the slider's motion"
    return [] if needed is None else [f"{short}; it needs about {length(needed)}"]


def load_rows(theory: Exact) -> list[Row]:
    """Return the regime of a contact and its motion under a load that weighs; what is not known is left away."""
    motion, free = theory.load, theory.free
    if free is not None:
        scales = {each.name: getattr(free, each.name) for each in fields(free) if each.name != "first_order"}
        known = {"regime": "free"} | {name: value for name, value in scales.items() if not isnan(value)}
        if free.first_order is not None:
            known["first_order_separation_std"] = free.first_order.separation_std
            known["first_order_velocity_std"] = free.first_order.velocity_std
    elif motion is not None:
        known = {each.name: getattr(motion, each.name) for each in fields(motion)}
        known |= {"velocity_level": motion.velocity_level, "relative_frequency": _relative_frequency(theory)}
        known |= {"error_bound": None if motion.error == inf else motion.error, "error": None, "covariances": None}
    elif _is_on_a_base(theory.model):
        known = {"regime": "lifted by a base"}
    else:
        known = {"regime": "separation held", "load_variation": theory.area.std / theory.area.mean}
    return named("load", known)


def _relative_frequency(theory: Exact) -> float | None:
    slider, motion = theory.model.slider, theory.load
    return None if slider is None or motion is None else slider.natural_frequency / motion.contact_resonance


def load_notes(theory: Exact) -> list[str]:
    """Return how exact the numbers of a load that weighs are."""
    motion, notes = theory.load, []
    if theory.free is not None:
        notes.append(
            "the numbers of free motion are exact, and so is that the level's exponents obey m = (1 + n)/2 where"
            " nothing but height and speed changes; others are for constant separation, which free motion does not have"
        )
    if motion is None:
        return notes
    if motion.regime == "constant gap" and (_relative_frequency(theory) or inf) < _FAR:
        notes.append(
            "the force is that of a constant gap, but not the slider's motion: momentum keeps the mean load at every"
            " speed, so a slider moves as in the paper only if omega_0, too, is far above omega_c"
        )
    if motion.regime != "bouncing" and _WORTH_A_NOTE < motion.error < inf:
        error = f"{100.0 * motion.error:.2g} %"
        notes.append(f"first order misses the spreads of separation, normal velocity and load by up to {error}")
    return notes


def motion_warnings(theory: Exact) -> list[str]:
    """Return warnings about the exact motion of a slider, and the reasons why first order is doubtful under a load."""
    motion, free = theory.load, theory.free
    warnings = one_way_warnings(theory.model, theory.slider.one_way_validity if theory.slider else 0.0)
    if free is not None and free.restitution == 1.0 and free.damping_ratio == 0.0:
        warnings.append(
            "with a restitution of 1 and no dashpot nothing takes away the energy that sliding brings: there is no"
            " stationary state, and levels grow as long as the run lasts"
        )
    if motion is None:
        return warnings
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
    slow = (_relative_frequency(theory) or 1.0) < 1.0
    if motion.regime != "bouncing" and motion.relative_speed > _FOLLOWING and slow:
        warnings.append(
            "the displacement is a lower bound, and the suppression an upper one: swings at the contact resonance are"
            " rectified into slow motion, which first order does not have"
        )
    if motion.negative_share > _WORTH_A_SHARE:
        share = f"{100.0 * motion.negative_share:.2g} %"
        warnings.append(f"the load would be negative for {share} of the time, while a contact only pushes")
    return warnings
