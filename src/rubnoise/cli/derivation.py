"""The numbers that follow from a scenario, as rows of an answer: sizes, exact means and spreads, motion and cost."""

from collections.abc import Iterator
from math import isnan, nan
from pathlib import Path

from rubnoise.analysis.moments import missing_for_motion
from rubnoise.analysis.one_way import one_way_warnings
from rubnoise.answer import Answer, Row
from rubnoise.cli.layout import too_short_for_motion
from rubnoise.cli.load import load_as_json, load_notes, load_rows, load_warnings
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
    rows: list[tuple[str, float, str, str]] = [
        ("calibrated_diameter", model.calibrated_diameter, "um", f"d_m, calibration {model.calibration}"),
        ("mean_life_distance", model.mean_life_distance, "um", "L_jm"),
        ("mean_birth_spacing", model.mean_birth_spacing, "um", "s_jm"),
        ("junction_count_mean", theory.count_mean, "", held),
        ("junction_count_std", theory.count_std, "", held),
        ("real_contact_area_mean", theory.area.mean, "um^2", held),
        ("real_contact_area_std", theory.area.std, "um^2", held),
    ]
    if theory.force is not None:
        rows.append(("friction_force_mean", theory.force.mean, "uN", held))
        rows.append(("friction_force_std", theory.force.std, "uN", held))
        more = 1.0 if theory.free is None else theory.free.fast_area_mean / theory.area.mean
        if model.load is not None and not isnan(more):
            fast = "" if model.free is None or model.free.restitution == 1.0 else "at high speeds"
            rows.append(("friction_coefficient", more * theory.force.mean / model.load, "", fast))
    rows.append(("expected_births", round(theory.expected_births), "", ""))
    rows.append(("expected_junctions", round(theory.expected_junction_rows), "", ""))
    for name, value, unit, note in rows:
        yield Row(part="contact", name=name, value=value, unit=unit, note=note)


def _slider(model: Model, theory: Exact) -> Iterator[Row]:
    if model.slider is None or theory.slider is None:
        return
    yield Row(part="slider", name="natural_frequency", value=model.slider.natural_frequency, unit="Hz")
    yield Row(part="slider", name="damping_ratio", value=model.slider.damping_ratio)
    yield from motion_rows(theory)
    if not model.is_two_way:
        yield Row(part="slider", name="cells_per_tick", value=cells_per_tick(model))
    if missing := missing_for_motion(model):
        yield Row(part="slider", name="needed_distance", value=missing.needed, unit="um")


def motion_rows(theory: Exact) -> Iterator[Row]:
    """Yield the motion of a slider and, unless a base drives it, the numbers that judge one-way coupling."""
    motion = theory.slider
    if theory.model.slider is None or motion is None:
        return
    values = {
        "displacement_mean": (motion.mean_displacement, "um"),
        "displacement_std": (motion.displacement_std, "um"),
        "velocity_std": (motion.velocity_std, "um/s"),
        "upcrossing_rate": (motion.upcrossing_rate, "1/s"),
    }
    for name, (value, unit) in values.items():
        yield Row(part="slider", name=name, value=value, unit=unit)
    if not _is_on_a_base(theory.model):
        found = theory.coupling()
        change = nan if found.unknown else found.expected_change
        yield _judging("one_way_validity", motion.one_way_validity, "std of velocity over sliding speed", "")
        yield _judging("coupling_strength", found.strength, "Pi; weak below 0.03", found.unknown)
        yield _judging("stick_number", found.stick_number, "theta; a slow slider sticks above 1", "")
        yield _judging("expected_change", change, "std of displacement, two-way over one-way", found.unknown)


def _judging(name: str, value: float, note: str, unknown: str | None) -> Row:
    """Return a number that judges one-way coupling, or why it is not known."""
    if isnan(value):
        return Row(part="slider", name=name, note=f"not known: {unknown}")
    return Row(part="slider", name=name, value=value, note=note)


def cost(scenario: Scenario) -> Iterator[Row]:
    """Yield what a run of a scenario takes; its births are counted from its seed."""
    budget = counted(scenario)
    yield from budget_rows(budget)
    yield Row(part="cost", name="events", value=2 * budget.junctions)
    yield Row(part="cost", name="working_memory", value=budget.working_bytes, unit="B", note="without the program's")


def budget_rows(budget: Budget) -> Iterator[Row]:
    """Yield the rows, bytes and memory of a run; estimates have three digits."""
    yield Row(part="cost", name="junctions", value=budget.junctions)
    yield Row(part="cost", name="ticks", value=budget.ticks)
    if budget.slider_rows_at_most is not None:
        yield Row(part="cost", name="slider_rows_at_most", value=budget.slider_rows_at_most)
    yield Row(part="cost", name="bytes", value=budget.result_bytes, unit="B", note="before compression, if any")
    yield Row(part="cost", name="disk_needed", value=budget.disk_bytes, unit="B")
    yield Row(part="cost", name="peak_memory", value=int(float(f"{budget.peak_bytes:.3g}")), unit="B")


def missing_resources(scenario: Scenario, file: Path) -> list[str]:
    """Return the resources that this machine lacks for a run of a scenario file into this folder."""
    try:
        check_disk_space(scenario, expected(scenario), f"{file.stem}.h5")
    except Refused as lack:
        return [str(lack)]
    return []


def _notes(scenario: Scenario, theory: Exact) -> list[str]:
    model = scenario.model()
    specified, mean = model.mean_junction_count, theory.count_mean
    notes = []
    if abs(mean / specified - 1.0) > WORTH_A_NOTE:
        notes.append(
            f"the mean diameter of the law {scenario.diameter.law} changes the mean count"
            f" by {mean / specified - 1.0:+.1%} from the specified {specified:g}"
        )
    wanted, area = model.mean_real_contact_area, theory.area.mean
    if abs(area / wanted - 1.0) > WORTH_A_NOTE:
        notes.append(
            f"the exact mean area differs by {area / wanted - 1.0:+.1%} from the specified {wanted:g} um^2;"
            " calibration matched gives it"
        )
    if scenario.strength is not None and model.strengths is not None:
        given = float(scenario.strength.mean)
        off = model.strengths.mean / given - 1.0
        if abs(off) > WORTH_A_NOTE:
            law = scenario.strength.law
            notes.append(f"the law {law} changes the mean strength by {off:+.1%} from {given:.7g} MPa")
    if model.is_two_way:
        notes.append(ONE_WAY_ALONE)
    notes += load_notes(load_as_json(theory))
    if model.free is not None:
        notes.append(FREE_ROWS)
    missing = missing_for_motion(model)
    return notes if missing is None else [*notes, too_short_for_motion(missing.decays, missing.needed)]
