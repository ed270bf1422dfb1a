"""The numbers that follow from a scenario: sizes, exact means and spreads, validity and cost, by name and as lines."""

from collections.abc import Iterator
from math import isnan
from pathlib import Path
from typing import Any, Final

from rubnoise.analysis.moments import missing_for_motion
from rubnoise.analysis.one_way import one_way_warnings
from rubnoise.cli.layout import ONE_WAY_ALONE, LineWords, grouped, line, lines, number, remark, too_short_for_motion
from rubnoise.cli.load import format_load, load_as_json, load_notes, load_warnings
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.simulation.ticks import cells_per_tick
from rubnoise.storage.forecast import Budget, check_disk_space, counted, expected
from rubnoise.theory.exact import Exact, exact

WORTH_A_NOTE = 0.01

FREE_ROWS = "free motion may touch a summit several times or not at all: rows of junctions and bytes are an estimate"


def derivation_as_json(scenario: Scenario) -> dict[str, Any]:
    """Return the numbers that follow from a scenario, by name, in working units; `cost` is the cost of a run."""
    model = scenario.model()
    theory = exact(model)
    answer = {
        "title": scenario.title,
        "calibrated_diameter": model.calibrated_diameter,
        "mean_life_distance": model.mean_life_distance,
        "mean_birth_spacing": model.mean_birth_spacing,
        "junction_count": {"mean": theory.count_mean, "std": theory.count_std},
        "real_contact_area": {"mean": theory.area.mean, "std": theory.area.std},
        "expected_births": theory.expected_births,
        "expected_junctions": theory.expected_junction_rows,
    }
    answer |= _dynamics(model, theory) | {"load": load_as_json(theory)}
    return answer | {
        "warnings": [*scenario.warnings, *motion_warnings(model, answer)],
        "notes": _notes(scenario, answer),
    }


def motion_warnings(model: Model, answer: dict[str, Any]) -> list[str]:
    """Return warnings about the exact motion of an answer: of its slider, and under its load."""
    one_way = one_way_warnings(model, answer.get("slider", {}).get("one_way_validity", 0.0))
    return one_way + (load_warnings(answer["load"]) if "load" in answer else [])


def _dynamics(model: Model, theory: Exact) -> dict[str, Any]:
    answer: dict[str, Any] = {}
    if theory.force is not None:
        answer["friction_force"] = {"mean": theory.force.mean, "std": theory.force.std}
        more = 1.0 if theory.free is None else theory.free.fast_area_mean / theory.area.mean
        if model.load is not None and not isnan(more):
            answer["friction_coefficient"] = more * theory.force.mean / model.load
    if model.slider is not None and (motion := motion_as_json(theory)):
        missing = missing_for_motion(model)
        answer["slider"] = {
            "natural_frequency": model.slider.natural_frequency,
            "damping_ratio": model.slider.damping_ratio,
            **motion,
        }
        answer["slider"] |= {} if model.is_two_way else {"cells_per_tick": cells_per_tick(model)}
        answer["slider"] |= {} if missing is None else {"needed_distance": missing.needed}
    return answer


def cost_as_json(scenario: Scenario) -> dict[str, float]:
    """Return the cost of a run of a scenario, by name; its births are counted from its seed."""
    budget = counted(scenario)
    return budget_as_json(budget) | {"events": 2 * budget.junctions, "working_memory": budget.working_bytes}


def missing_resources(scenario: Scenario, file: Path) -> list[str]:
    """Return the resources that this machine lacks for a run of a scenario file into this folder."""
    try:
        check_disk_space(scenario, expected(scenario), f"{file.stem}.h5")
    except Refused as lack:
        return [str(lack)]
    return []


SIZES: Final[tuple[LineWords, ...]] = (
    ("mean diameter d_m", "{calibrated_diameter} um (calibration {calibration})"),
    ("mean life L_jm", "{mean_life_distance} um"),
    ("mean birth spacing s_jm", "{mean_birth_spacing} um"),
    ("junction count", "mean {junction_count.mean}, std {junction_count.std}{held}"),
    ("real contact area", "mean {real_contact_area.mean}, std {real_contact_area.std} um^2{held}"),
    ("friction force", "mean {friction_force.mean}, std {friction_force.std} uN{held}"),
    ("friction coefficient", "{friction_coefficient}{fast}"),
    ("natural frequency", "{slider.natural_frequency} Hz"),
    ("damping ratio", "{slider.damping_ratio}"),
)
MOTION: Final[tuple[LineWords, ...]] = (
    ("displacement", "mean {displacement_mean}, std {displacement_std} um"),
    ("velocity", "std {velocity_std} um/s"),
    ("upward passages", "{upcrossing_rate} of the mean in a second, of a Gaussian displacement"),
    ("one-way validity", "{one_way_validity:.6g} (std of velocity over sliding speed)"),
    ("coupling strength", "{coupling_strength} (Pi; weak below 0.03)", "not known: {change_unknown}"),
    ("stick number", "{stick_number} (theta; a slow slider sticks above 1)"),
    ("expected change", "{expected_change:change} of std displacement, if two-way", "not known: {change_unknown}"),
)
COST: Final[tuple[LineWords, ...]] = (
    ("rows", "{junctions:grouped} junctions, {ticks:grouped} ticks ({counted_by})"),
    ("slider", "{slider_rows_at_most:grouped} rows at most"),
    ("events", "{events:about}"),
    ("file size", "{bytes:size}{before}"),
    ("disk needed", "{disk_needed:size}"),
    ("memory", "about {peak_memory:size}, {working_memory:size} beside the program's own", "about {peak_memory:size}"),
)
"""The lines of a scenario, of its slider's motion and of a run's cost."""


def format_derivation(scenario: Scenario, answer: dict[str, Any]) -> Iterator[str]:
    """Yield the numbers that follow from a scenario, as lines to print under a heading."""
    model = scenario.model()
    yield from [line("title", scenario.title)] if scenario.title else []
    yield from lines(answer | words_of_model(model), SIZES)
    if "slider" in answer:
        yield from lines(answer["slider"], MOTION)
    yield from format_load(answer["load"])
    yield line("births", f"{grouped(answer['expected_births'])} expected")
    if "cost" in answer:
        known = {
            "counted_by": "this seed" if model.free is None else "an estimate, at constant separation",
            "before": "" if scenario.output.compression == "none" else " before compression",
            "engine": scenario.run.engine,
        }
        yield from format_cost(answer["cost"] | known)
    # Those of the scenario are printed when it is loaded.
    yield from (remark(f"warning: {warning}") for warning in answer["warnings"][len(scenario.warnings) :])
    yield from (remark(f"note: {note}") for note in answer["notes"])


def words_of_model(model: Model) -> dict[str, str]:
    """Return how sizes were found, and for free motion that numbers are for constant separation or high speeds."""
    free = model.free
    return {
        "calibration": model.calibration,
        "held": "" if free is None else " (at constant separation)",
        "fast": "" if free is None or free.restitution == 1.0 else " (at high speeds)",
    }


def format_cost(cost: dict[str, Any]) -> Iterator[str]:
    """Yield what a run takes, as lines to print; the disk needed only if that is more than its file."""
    shown = {name: value for name, value in cost.items() if name != "disk_needed" or value > cost["bytes"]}
    yield from lines({"before": ""} | shown, COST)


def _notes(scenario: Scenario, answer: dict[str, Any]) -> list[str]:
    model = scenario.model()
    specified, mean = model.mean_junction_count, answer["junction_count"]["mean"]
    notes = []
    if abs(mean / specified - 1.0) > WORTH_A_NOTE:
        notes.append(
            f"the mean diameter of the law {scenario.diameter.law} changes the mean count"
            f" by {mean / specified - 1.0:+.1%} from the specified {specified:g}"
        )
    wanted, area = model.mean_real_contact_area, answer["real_contact_area"]["mean"]
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
            notes.append(f"the law {law} changes the mean strength by {off:+.1%} from {number(given)} MPa")
    if model.is_two_way:
        notes.append(ONE_WAY_ALONE)
    notes += load_notes(answer["load"])
    if model.free is not None:
        notes.append(FREE_ROWS)
    missing = missing_for_motion(model)
    return notes if missing is None else [*notes, too_short_for_motion(missing.decays, missing.needed)]


def motion_as_json(theory: Exact) -> dict[str, Any]:
    """Return by name the motion of a slider, and the numbers that judge one-way coupling; an unknown change is None.

    Empty if the model has no slider; without the judging numbers if a base drives it.
    """
    slider, motion = theory.model.slider, theory.slider
    if slider is None or motion is None:
        return {}
    figures: dict[str, Any] = {
        "displacement_mean": motion.mean_displacement,
        "displacement_std": motion.displacement_std,
        "velocity_std": motion.velocity_std,
        "upcrossing_rate": motion.upcrossing_rate,
    }
    if slider.excitation == "base":
        return figures  # a base lifts: it does not feel the motion, and sliding speed is no measure of it
    figures["one_way_validity"] = motion.one_way_validity
    found = theory.coupling()
    figures |= {
        "coupling_strength": None if isnan(found.strength) else found.strength,
        "stick_number": found.stick_number,
        "expected_change": found.expected_change if found.unknown is None else None,
    }
    return figures if found.unknown is None else figures | {"change_unknown": found.unknown}


def budget_as_json(budget: Budget) -> dict[str, float]:
    """Return a budget under the names of answers; estimates have three digits."""
    grown = budget.slider_rows_at_most
    return {
        "junctions": budget.junctions,
        "ticks": budget.ticks,
        **({} if grown is None else {"slider_rows_at_most": grown}),
        "bytes": budget.result_bytes,
        "disk_needed": budget.disk_bytes,
        "peak_memory": int(float(f"{budget.peak_bytes:.3g}")),
    }
