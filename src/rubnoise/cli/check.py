"""`rubnoise check`: the content of scenario files, the numbers that follow from them, and their problems."""

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rubnoise.answer import printable
from rubnoise.cli.layout import about, as_wide_text, grouped, groups_that_fit, json_text, line
from rubnoise.cli.options import AsJson, Changes
from rubnoise.errors import RubnoiseError

if TYPE_CHECKING:
    from rubnoise.scenario.sweep import Sweep


def command(
    files: Annotated[list[Path], typer.Argument(help="Scenario files.", metavar="FILE")],
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
            group, answer, lines = _checked(file, changes or (), quiet=as_json)
        except RubnoiseError as problem:
            print(problem, file=sys.stderr)
            answers["refused"][str(file)] = str(problem)
            continue
        answers[group][str(file)] = answer
        if not as_json:
            print("\n".join(lines))
    if as_json:
        print(json_text(answers))
    if answers["refused"]:
        raise typer.Exit(2)


def _checked(file: Path, changes: Sequence[str], *, quiet: bool) -> tuple[str, dict[str, Any], Iterable[str]]:
    """Return the group of the answer for a file, the answer, and its lines to print."""
    from rubnoise.cli import derivation
    from rubnoise.cli.loading import scenario_or_sweep
    from rubnoise.scenario import Scenario

    found = scenario_or_sweep(file, changes, quiet=quiet)
    if isinstance(found, Scenario):
        title = f"{file}: ok" + (f": {found.title}" if found.title else "")
        known = derivation.derived(found, title, warned=not quiet)
        rows, notes = (*known.rows, *derivation.cost(found)), (*known.notes, *derivation.missing_resources(found, file))
        known = replace(known, rows=rows, notes=notes)
        return "scenarios", known.to_json(), as_wide_text(known).splitlines()
    answer = sweep_table_as_json(found)
    return "sweeps", answer, [f"{file}: ok", *format_sweep_table(answer)]


MOST_ROWS = 100
LONGEST_CELL = 16
NUMBER_WIDTH = 5
HEADINGS = {
    "calibrated_diameter": "d_m (um)",
    "real_contact_area_mean": "area mean (um^2)",
    "real_contact_area_std": "area std (um^2)",
    "expected_junctions": "junctions expected",
}
"""The values listed for each point, and the headings of their columns."""


def sweep_table_as_json(sweep: "Sweep") -> dict[str, Any]:
    """Return the numbers that follow from a sweep, by name, in working units; means and deviations are exact."""
    from rubnoise.scenario.sweep import expand

    points = [_point(dict(case.values), case.scenario) for case in sweep.cases]
    runs = expand(sweep)
    for number, point in enumerate(points):
        own = runs[number * sweep.replicates : (number + 1) * sweep.replicates]
        point |= {"seeds": [run.seed for run in own], "run_ids": [run.run_id for run in own]}
    return {
        "title": sweep.title,
        "keys": list(sweep.keys),
        "replicates": sweep.replicates,
        "runs": len(runs),
        "points": points,
        "warnings": list(sweep.warnings),
    }


def _point(values: dict[str, Any], scenario: Any) -> dict[str, Any]:
    from rubnoise.theory.moments import area_cumulants, expected_junction_rows

    model = scenario.model()
    area = area_cumulants(model)
    return {
        "values": values,
        "calibrated_diameter": model.calibrated_diameter,
        "real_contact_area_mean": area.mean,
        "real_contact_area_std": area.std,
        "expected_junctions": expected_junction_rows(model),
        "ticks": model.tick_count + 1,
    }


def format_sweep_table(answer: Mapping[str, Any]) -> list[str]:
    """Return the lines of a sweep's table, below a heading; if there are many points, only the first."""
    points, replicates = answer["points"], answer["replicates"]
    junctions, ticks = (replicates * sum(point[name] for point in points) for name in ("expected_junctions", "ticks"))
    lines = [
        *([line("title", answer["title"])] if answer["title"] else []),
        line("points", grouped(len(points))),
        line("runs", f"{grouped(answer['runs'])}, {replicates} of each point"),
        line("rows of all runs", f"{about(junctions)} junctions, {grouped(ticks)} ticks"),
        *(line("swept", key) for key in answer["keys"]),
        "",
        *_table_lines(answer["keys"], points[:MOST_ROWS]),
    ]
    left = len(points) - MOST_ROWS
    return lines + ([f"  and {grouped(left)} more; --json has all"] if left > 0 else [])


def _table_lines(keys: Sequence[str], points: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield heading and rows, every column as wide as its widest cell or the longest word above it."""
    headings = [key.rpartition(".")[2].replace("_", " ") for key in keys] + list(HEADINGS.values())
    rows = []
    for point in points:
        *sizes, junctions = (point[name] for name in HEADINGS)
        swept = (_cell(point["values"][key]) for key in keys)
        rows.append([*swept, *(f"{size:#.5g}" for size in sizes), grouped(junctions)])
    widths = [max(map(len, [*heading.split(), *(row[n] for row in rows)])) + 2 for n, heading in enumerate(headings)]
    above = [wrap(heading, width - 2) for heading, width in zip(headings, widths, strict=True)]
    # From the bottom up, so that the words end on the line above the rows.
    over = [("", *words) for words in reversed(list(zip_longest(*map(reversed, above), fillvalue="")))]
    lines = [*over, *((str(number), *row) for number, row in enumerate(rows, 1))]
    widths = [NUMBER_WIDTH, *widths]
    for place, group in enumerate(groups_that_fit(widths)):
        if place:
            yield ""
        yield from ("".join(f"{line[n]:>{widths[n]}}" for n in group).rstrip() for line in lines)


def _cell(value: Any) -> str:
    text = printable(str(value))
    return text if len(text) <= LONGEST_CELL else f"{text[: LONGEST_CELL - 3]}..."
