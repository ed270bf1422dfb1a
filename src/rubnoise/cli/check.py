"""`rubnoise new`, `examples`, `schema` and `check`: scenario files to begin with, and what follows from one."""

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.answer import Answer, Table, rows
from rubnoise.cli.terminal import AsCsv, AsJson, Changes, argument, option, sentence, show
from rubnoise.cli.vocabulary import UNITS
from rubnoise.errors import OutputRefused, Refused, RubnoiseError

if TYPE_CHECKING:
    from rubnoise.scenario.sweep import Sweep


def check(
    files: Annotated[list[Path], argument("FILE", "Scenario files.")],
    *,
    changes: Changes = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
) -> None:
    """Check scenarios, and print what follows from them.

    These are sizes, exact means and spreads, validity and cost.

    For a file with a table [sweep], check and list every point.

    Example: rubnoise check scenarios/paper/fig5.toml
    """
    if as_csv and len(files) > 1:
        raise typer.BadParameter("--csv is for one file; --json answers for several")
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
            show(answer, as_csv=as_csv)
    if as_json:
        print(json.dumps(answers, allow_nan=False))
    if answers["refused"]:
        raise typer.Exit(2)


def _checked(file: Path, changes: Sequence[str], *, quiet: bool) -> tuple[str, Answer]:
    """Return the group of the answer for a file, and the answer."""
    from rubnoise.cli import derivation
    from rubnoise.cli.loading import loaded
    from rubnoise.scenario import Scenario
    from rubnoise.scenario.sweep import load_either
    from rubnoise.storage.forecast import check_disk_space, counted, expected

    found = loaded(load_either, file, changes, quiet=quiet)
    title = f"{file}: ok" + (f": {found.title}" if found.title else "")
    if not isinstance(found, Scenario):
        return "sweeps", _sweep_answer(found, title, warned=not quiet)
    known = derivation.derived(found, title, warned=not quiet)
    notes = [*known.notes]
    try:
        check_disk_space(expected(found), f"{file.stem}.h5")
    except Refused as lack:
        notes.append(str(lack))
    return "scenarios", replace(known, rows=(*known.rows, *derivation.cost(counted(found))), notes=tuple(notes))


_MOST_ROWS: Final = 100  # points that text lists


def _sweep_answer(sweep: "Sweep", title: str, *, warned: bool) -> Answer:
    """Return the points of a sweep with exact means and deviations, and the seed of each run."""
    from rubnoise.scenario.sweep import expand
    from rubnoise.theory.moments import area_cumulants, expected_junction_rows

    runs, models = expand(sweep), [case.scenario.model() for case in sweep.cases]
    areas = [area_cumulants(model) for model in models]
    rows_of_each = [round(expected_junction_rows(model)) for model in models]
    ticks = [model.tick_count + 1 for model in models]
    columns: dict[str, list[Any]] = {"point": list(range(1, len(models) + 1))}
    columns |= {key: [str(dict(case.values)[key]) for case in sweep.cases] for key in sweep.keys}
    columns |= {
        "calibrated_diameter": [model.calibrated_diameter for model in models],
        "real_contact_area_mean": [area.mean for area in areas],
        "real_contact_area_std": [area.std for area in areas],
        "expected_junctions": rows_of_each,
        "ticks": ticks,
    }
    each_run = {
        "point": [1 + number // sweep.replicates for number in range(len(runs))],
        "seed": [run.seed for run in runs],
        "run_id": [run.run_id for run in runs],
    }
    told = rows(
        "",
        ("keys", list(sweep.keys)),
        ("replicates", sweep.replicates, "", "runs of each point"),
        ("runs", len(runs)),
        ("junctions", sweep.replicates * sum(rows_of_each), "", "expected in all runs"),
        ("ticks", sweep.replicates * sum(ticks), "", "of all runs"),
    )
    points = Table(name="points", columns=columns, units=UNITS, shown=range(min(len(models), _MOST_ROWS)))
    return Answer(
        title=title,
        rows=tuple(told),
        tables=(points, Table(name="seeds", columns=each_run, shown=())),
        notes=tuple(f"warning: {warning}" for warning in ([] if warned else sweep.warnings)),
    )


def shipped_scenarios(incomplete: str) -> list[str]:
    """Return the shipped scenarios whose names begin with a text, for completion in shells."""
    from rubnoise.scenario.layers import shipped_names

    return [name for name in shipped_names() if name.startswith(incomplete)]


def new(
    file: Annotated[Path, argument("NAME.toml", "The scenario file to make, which must not exist; - prints it.")],
    *,
    source: Annotated[
        str | None,
        option(
            "EXAMPLE",
            "Copy this scenario of rubnoise's, such as paper/fig5; `rubnoise examples` lists them.",
            "--from",
            autocompletion=shipped_scenarios,
        ),
    ] = None,
) -> None:
    """Make a scenario file with every key, each explained.

    Optional keys are comments.

    It runs as it is. With --from it is a copy of a scenario that comes with rubnoise. An existing file is never
    replaced.

    Example: rubnoise new contact.toml
    """
    from rubnoise.scenario.written import copy_of, template
    from rubnoise.storage.output import whole_file

    text = template() if source is None else copy_of(source)
    if str(file) == "-":
        print(text, end="")
        return
    if os.path.lexists(file):
        raise OutputRefused(f"{file}: exists already; choose another name")
    with whole_file(file, force=False) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    print(sentence(f"{file}: written; `rubnoise check {file}` says what it means, `rubnoise run {file}` runs it"))


def examples() -> None:
    """List the scenarios that come with rubnoise.

    Commands take their names where they take a scenario file.

    Example: rubnoise examples
    """
    from rubnoise.scenario.layers import shipped_titles

    titles = shipped_titles()
    width = max(map(len, titles), default=0)
    for name in sorted(titles, key=lambda each: not each.startswith("first/")):
        print(f"{name:<{width}}  {titles[name]}".rstrip())


def schema() -> None:
    """Print the JSON schema of scenario files, for editors that check and complete TOML.

    Example: rubnoise schema > scenarios/scenario.schema.json
    """
    from rubnoise.scenario import json_schema

    print(json.dumps(json_schema(), indent=2, ensure_ascii=False))
