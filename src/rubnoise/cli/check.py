"""`rubnoise check`: the content of scenario files, the numbers that follow from them, and their problems."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.answer import Answer, Table, rows
from rubnoise.cli.layout import json_text, show
from rubnoise.cli.options import AsJson, Changes, argument
from rubnoise.errors import RubnoiseError

if TYPE_CHECKING:
    from rubnoise.scenario import Scenario
    from rubnoise.scenario.sweep import Sweep


def command(
    files: Annotated[list[Path], argument("FILE", "Scenario files.")],
    *,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Check scenarios, and print what follows from them.

    These are sizes, exact means and spreads, validity and cost.

    For a file with a table [sweep], check and list every point.

    Example: rubnoise check scenarios/paper/fig5.toml
    """
    answers: dict[str, dict[str, Any]] = {"scenarios": {}, "sweeps": {}, "refused": {}}
    for file in files:
        try:
            group, answer = _checked(file, changes or (), quiet=as_json)
        except RubnoiseError as problem:
            print(problem, file=sys.stderr)
            answers["refused"][str(file)] = str(problem)
            continue
        answers[group][str(file)] = answer.to_json()
        if not as_json:
            show(answer, as_json=False)
    if as_json:
        print(json_text(answers))
    if answers["refused"]:
        raise typer.Exit(2)


def _checked(file: Path, changes: Sequence[str], *, quiet: bool) -> tuple[str, Answer]:
    """Return the group of the answer for a file, and the answer."""
    from rubnoise.cli import derivation
    from rubnoise.cli.loading import scenario_or_sweep
    from rubnoise.scenario import Scenario

    found = scenario_or_sweep(file, changes, quiet=quiet)
    title = f"{file}: ok" + (f": {found.title}" if found.title else "")
    if not isinstance(found, Scenario):
        return "sweeps", sweep_answer(found, title, warned=not quiet)
    known = derivation.derived(found, title, warned=not quiet)
    notes = (*known.notes, *derivation.missing_resources(found, file))
    return "scenarios", replace(known, rows=(*known.rows, *derivation.cost(found)), notes=notes)


MOST_ROWS: Final = 100
"""Points that text lists."""

UNITS: Final = {"calibrated_diameter": "um", "real_contact_area_mean": "um^2", "real_contact_area_std": "um^2"}


def sweep_answer(sweep: "Sweep", title: str, *, warned: bool) -> Answer:
    """Return the points of a sweep with exact means and deviations, and the seed of each run."""
    from rubnoise.scenario.sweep import expand

    runs = expand(sweep)
    points = [_point(case.scenario) for case in sweep.cases]
    columns: dict[str, list[Any]] = {"point": list(range(1, len(points) + 1))}
    columns |= {key: [str(dict(case.values)[key]) for case in sweep.cases] for key in sweep.keys}
    columns |= {name: [point[name] for point in points] for name in points[0]}
    each_run = {
        "point": [1 + number // sweep.replicates for number in range(len(runs))],
        "seed": [run.seed for run in runs],
        "run_id": [run.run_id for run in runs],
    }
    every = {name: sweep.replicates * sum(point[name] for point in points) for name in ("expected_junctions", "ticks")}
    told = rows(
        "",
        ("keys", list(sweep.keys)),
        ("replicates", sweep.replicates, "", "runs of each point"),
        ("runs", len(runs)),
        ("junctions", every["expected_junctions"], "", "expected in all runs"),
        ("ticks", every["ticks"], "", "of all runs"),
    )
    return Answer(
        title=title,
        rows=tuple(told),
        tables=(
            Table(name="points", columns=columns, units=UNITS, shown=range(min(len(points), MOST_ROWS))),
            Table(name="seeds", columns=each_run, shown=()),
        ),
        notes=tuple(f"warning: {warning}" for warning in ([] if warned else sweep.warnings)),
    )


def _point(scenario: "Scenario") -> dict[str, Any]:
    from rubnoise.theory.moments import area_cumulants, expected_junction_rows

    model = scenario.model()
    area = area_cumulants(model)
    return {
        "calibrated_diameter": model.calibrated_diameter,
        "real_contact_area_mean": area.mean,
        "real_contact_area_std": area.std,
        "expected_junctions": round(expected_junction_rows(model)),
        "ticks": model.tick_count + 1,
    }
