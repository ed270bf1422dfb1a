"""What follows from a sweep, point by point: as figures, and as a table to print."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import zip_longest
from textwrap import wrap
from typing import Any

from rubnoise.cli.layout import about, grouped, line, printable
from rubnoise.cli.terminal import groups_that_fit
from rubnoise.scenario.sweep import Sweep, expand
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.occupancy import expected_junction_rows

MOST_ROWS = 100
LONGEST_CELL = 16
NUMBER_WIDTH = 5
HEADINGS = {
    "calibrated_diameter": "d_m (um)",
    "real_contact_area_mean": "area mean (um^2)",
    "real_contact_area_std": "area std (um^2)",
    "expected_junctions": "junctions expected",
}
"""What is told of each point, and how its column is headed."""


def contents(sweep: Sweep) -> dict[str, Any]:
    """Return what follows from a sweep, by name, in working units; means and standard deviations are exact."""
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


def described(answer: Mapping[str, Any]) -> list[str]:
    """Return the lines of a sweep's table, below a heading; of many points the first."""
    points, replicates = answer["points"], answer["replicates"]
    junctions, ticks = (replicates * sum(point[name] for point in points) for name in ("expected_junctions", "ticks"))
    lines = [
        *([line("title", answer["title"])] if answer["title"] else []),
        line("points", grouped(len(points))),
        line("runs", f"{grouped(answer['runs'])}, {replicates} of each point"),
        line("rows of all runs", f"{about(junctions)} junctions, {grouped(ticks)} ticks"),
        *(line("swept", key) for key in answer["keys"]),
        "",
        *_table(answer["keys"], points[:MOST_ROWS]),
    ]
    left = len(points) - MOST_ROWS
    return lines + ([f"  and {grouped(left)} more; --json has all"] if left > 0 else [])


def _table(keys: Sequence[str], points: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield heading and rows, every column as wide as its widest cell or the longest word above it."""
    headings = [key.rpartition(".")[2].replace("_", " ") for key in keys] + list(HEADINGS.values())
    rows = [[*(_cell(point["values"][key]) for key in keys), *_figures(point)] for point in points]
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


def _figures(point: Mapping[str, Any]) -> list[str]:
    *sizes, junctions = (point[name] for name in HEADINGS)
    return [*(f"{size:#.5g}" for size in sizes), grouped(junctions)]


def _cell(value: Any) -> str:
    text = printable(str(value))
    return text if len(text) <= LONGEST_CELL else f"{text[: LONGEST_CELL - 3]}..."
