"""What follows from a scenario: sizes, exact means and spreads, validity and cost, by name and as lines to print."""

from pathlib import Path
from typing import Any

from rubnoise.analysis.one_way import WORTH_A_WARNING, one_way_warning
from rubnoise.analysis.summary import missing_for_motion
from rubnoise.cli.layout import (
    ONE_WAY_ALONE,
    about,
    duration,
    grouped,
    line,
    number,
    remark,
    size,
    too_short_for_motion,
)
from rubnoise.cli.load import format_load, load_as_json
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.simulation.cells import cells_per_tick
from rubnoise.storage.forecast import Budget, check_disk_space, counted, expected
from rubnoise.theory.exact import Exact, exact

WORTH_A_NOTE = 0.01


def derivation_as_json(scenario: Scenario) -> dict[str, Any]:
    """Return what follows from a scenario, by name, in working units; what a run would cost is `cost`."""
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
    return answer | {"warnings": list(scenario.warnings), "notes": _notes(scenario, answer)}


def _dynamics(model: Model, theory: Exact) -> dict[str, Any]:
    answer: dict[str, Any] = {}
    if theory.force is not None:
        answer["friction_force"] = {"mean": theory.force.mean, "std": theory.force.std}
        if model.load is not None:
            answer["friction_coefficient"] = theory.force.mean / model.load
    if model.slider is not None and theory.slider is not None:
        missing = missing_for_motion(model)
        answer["slider"] = {
            "natural_frequency": model.slider.natural_frequency,
            "damping_ratio": model.slider.damping_ratio,
            "displacement_mean": theory.slider.mean_displacement,
            "displacement_std": theory.slider.displacement_std,
            "velocity_std": theory.slider.velocity_std,
            "one_way_validity": theory.slider.one_way_validity,
            **coupling_as_json(theory),
        }
        answer["slider"] |= {} if model.is_two_way else {"cells_per_tick": cells_per_tick(model)}
        answer["slider"] |= {} if missing is None else {"needed_distance": missing.needed}
    return answer


def cost_as_json(scenario: Scenario) -> dict[str, float]:
    """Return what a run of a scenario would take, by name; its births are counted from its seed."""
    budget = counted(scenario)
    return budget_as_json(budget) | {"events": 2 * budget.junctions, "working_memory": budget.working_bytes}


def missing_resources(scenario: Scenario, file: Path) -> list[str]:
    """Return what this machine lacks for a run of a scenario file into this folder, if anything."""
    try:
        check_disk_space(scenario, expected(scenario), f"{file.stem}.h5")
    except Refused as lack:
        return [str(lack)]
    return []


def format_derivation(scenario: Scenario, answer: dict[str, Any]) -> list[str]:
    """Return what follows from a scenario, as lines to print under a heading."""

    def spread(name: str, unit: str) -> str:
        return f"mean {number(answer[name]['mean'])}, std {number(answer[name]['std'])}{unit}"

    model = scenario.model()
    lines = [
        *([line("title", scenario.title)] if scenario.title else []),
        line("mean diameter d_m", f"{number(answer['calibrated_diameter'])} um (calibration {model.calibration})"),
        line("mean life L_jm", f"{number(answer['mean_life_distance'])} um"),
        line("mean birth spacing s_jm", f"{number(answer['mean_birth_spacing'])} um"),
        line("junction count", spread("junction_count", "")),
        line("real contact area", spread("real_contact_area", " um^2")),
    ]
    if "friction_force" in answer:
        lines.append(line("friction force", spread("friction_force", " uN")))
    if "friction_coefficient" in answer:
        lines.append(line("friction coefficient", number(answer["friction_coefficient"])))
    lines += _slider_lines(answer.get("slider"), two_way=model.is_two_way)
    lines += format_load(answer["load"])
    lines.append(line("births", f"{grouped(answer['expected_births'])} expected"))
    lines += _cost_lines(scenario, answer["cost"]) if "cost" in answer else []
    return lines + [remark(f"note: {note}") for note in answer["notes"]]


def _cost_lines(scenario: Scenario, cost: dict[str, float]) -> list[str]:
    counted_by = "this seed" if scenario.model().free is None else "at constant separation"
    return [
        line("rows", f"{grouped(cost['junctions'])} junctions, {grouped(cost['ticks'])} ticks ({counted_by})"),
        *(
            [line("slider", f"{grouped(cost['slider_rows_at_most'])} rows at most")]
            if "slider_rows_at_most" in cost
            else []
        ),
        line("events", about(cost["events"])),
        line(
            "file size",
            size(cost["bytes"]) + (" before compression" if scenario.output.compression != "none" else ""),
        ),
        *([line("free disk", size(cost["free_disk"]))] if cost["free_disk"] > cost["bytes"] else []),
        line("memory", f"about {size(cost['peak_memory'])}, {size(cost['working_memory'])} beside the program's own"),
        line("time", f"{duration(cost['seconds'])} on this machine, engine {scenario.run.engine}"),
    ]


def _slider_lines(slider: dict[str, Any] | None, *, two_way: bool) -> list[str]:
    if slider is None:
        return []
    return [
        line("natural frequency", f"{number(slider['natural_frequency'])} Hz"),
        line("damping ratio", number(slider["damping_ratio"])),
        line(
            "displacement", f"mean {number(slider['displacement_mean'])}, std {number(slider['displacement_std'])} um"
        ),
        line("velocity", f"std {number(slider['velocity_std'])} um/s"),
        *format_coupling(slider, two_way=two_way),
    ]


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
    missing = missing_for_motion(model)
    return notes if missing is None else [*notes, too_short_for_motion(missing.decays, missing.needed)]


def coupling_as_json(theory: Exact) -> dict[str, Any]:
    """Return by name what judges one-way coupling, of a model with a slider; a change not known is None, with why.

    Nothing of a slider that a base drives.
    """
    slider = theory.model.slider
    if slider is not None and slider.excitation == "base":
        return {}  # a base does not feel the motion
    found = theory.coupling()
    figures: dict[str, Any] = {
        "coupling_strength": found.strength,
        "stick_number": found.stick_number,
        "expected_change": found.expected_change,
    }
    return figures if found.unknown is None else figures | {"expected_change": None, "change_unknown": found.unknown}


def format_coupling(slider: dict[str, Any], *, two_way: bool) -> list[str]:
    """Return the same as lines to print, one-way validity first, and a warning where two-way coupling is needed."""
    validity = slider["one_way_validity"]
    doubt = [remark(f"warning: {one_way_warning(validity)}")] if validity > WORTH_A_WARNING and not two_way else []
    valid = line("one-way validity", f"{validity:.6g} (std of velocity over sliding speed)")
    if "coupling_strength" not in slider:
        return [valid, *doubt]
    return [
        valid,
        line("coupling strength", f"{number(slider['coupling_strength'])} (Pi; weak below 0.03)"),
        line("stick number", f"{number(slider['stick_number'])} (theta; a slow slider sticks above 1)"),
        line("expected change", _change(slider)),
        *doubt,
    ]


def _change(slider: dict[str, Any]) -> str:
    change = slider["expected_change"]
    if change is None:
        return f"not known: {slider['change_unknown']}"
    return f"{change - 1.0:+.2%} of std displacement, if two-way"


def budget_as_json(budget: Budget) -> dict[str, float]:
    """Return a budget by the names that answers have for it; estimates to three digits."""
    grown = budget.slider_rows_at_most
    return {
        "junctions": budget.junctions,
        "ticks": budget.ticks,
        **({} if grown is None else {"slider_rows_at_most": grown}),
        "bytes": budget.result_bytes,
        "free_disk": budget.disk_bytes,
        "peak_memory": int(float(f"{budget.peak_bytes:.3g}")),
        "seconds": float(f"{budget.seconds:.3g}"),
    }
