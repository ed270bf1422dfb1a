"""Chosen rows of /junctions on their way to a terminal, a table or JSON, some at a time."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any, Self

from rubnoise.analysis.selection import RowNumbers, gather, select
from rubnoise.analysis.where import condition, did_you_mean
from rubnoise.analysis.where_tree import Node
from rubnoise.cli.junction_text import state_names
from rubnoise.cli.layout import grouped, number, printable
from rubnoise.cli.terminal import groups_that_fit
from rubnoise.errors import Refused
from rubnoise.record.reader import Rows
from rubnoise.record.rows import JunctionState
from rubnoise.storage.export_csv import heading
from rubnoise.storage.schema import JUNCTIONS, Column

BRIEF = ("junction", "birth_distance", "diameter", "max_area", "state")
"""What fits a terminal; columns that are asked about join them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """Rows in the order asked for, how many there are in all, and the columns to print."""

    run: Rows
    path: Path
    where: str | None
    sort: str | None
    rows: RowNumbers
    total: int
    columns: tuple[Column, ...]

    @classmethod
    def of(
        cls,
        run: Rows,
        path: Path,
        *,
        where: str | None,
        sort: str | None,
        reverse: bool,
        head: int | None,
        columns: str | None,
        brief: bool,
    ) -> Self:
        """Find the rows; raises Refused for a condition or a column that is none."""
        there = tuple(column for column in JUNCTIONS.columns if column.name in run.columns["junctions"])
        tree = None if where is None else condition(where, there)
        by = None if sort is None else _named(sort.removeprefix("-"), "--sort", there).name
        wanted = _wanted(columns, there, _asked_about(tree, by) if brief else None)
        descending = reverse != (sort is not None and sort.startswith("-"))
        rows, total = select(run, tree, sort=by, descending=descending, head=head)
        told = f"-{by or 'junction'}" if descending else by
        return cls(run=run, path=path, where=where, sort=told, rows=rows, total=total, columns=wanted)

    def values(self) -> Iterator[tuple[Any, ...]]:
        """Yield the values of each row as numbers of Python."""
        names = [column.name for column in self.columns]
        for panel in gather(self.run, self.rows, names):
            yield from zip(*(panel[name].tolist() for name in names), strict=True)


def print_csv(found: Found) -> None:
    """Print a heading of names with units, then a line a row, every number to its last bit."""
    print(",".join(map(heading, found.columns)))
    for row in found.values():
        print(",".join(map(repr, row)))


def print_json(found: Found) -> None:
    """Print one JSON object, a line a row, written as it is read."""
    about: dict[str, Any] = {"file": str(found.path), "where": found.where, "sort": found.sort}
    about |= {"rows": found.run.rows("junctions"), "matched": found.total}
    names = [column.name for column in found.columns]
    print(json.dumps(about)[:-1] + ', "junctions": [', end="")
    for i, row in enumerate(found.values()):
        told: dict[str, Any] = {
            name: value if isfinite(value) else None for name, value in zip(names, row, strict=True)
        }
        if "state" in told:
            told["state"] = state_names(JunctionState(told["state"]))
        print(",\n" if i else "\n", json.dumps(told), sep="", end="")
    print("]}")


def print_text(found: Found) -> None:
    """Print the rows in columns below their names and units, and how many more there are."""
    all_rows = grouped(found.run.rows("junctions"))
    print(f"{printable(str(found.path))}: {grouped(found.total)} of {all_rows} junctions")
    if found.rows.size:
        print()
        print("\n".join(_table(found)))
    if found.total > found.rows.size:
        print(f"\n  and {grouped(found.total - found.rows.size)} more (--head N for more, --csv for all)")


def _table(found: Found) -> Iterator[str]:
    cells = [[_cell(c.name, value) for c, value in zip(found.columns, row, strict=True)] for row in found.values()]
    names = [column.name for column in found.columns]
    units = ["" if column.units == "1" else column.units for column in found.columns]
    widths = [max(map(len, column)) + 2 for column in zip(names, units, *cells, strict=True)]
    for place, group in enumerate(groups_that_fit(widths)):
        if place:
            yield ""
        for line in (names, units, *cells):
            if not place or any(line[n] for n in group):  # no line of units where none has one
                yield "".join(_aligned(names[n], line[n], widths[n]) for n in group).rstrip()


def _aligned(name: str, cell: str, width: int) -> str:
    return f"  {cell.ljust(width - 2)}" if name == "state" else cell.rjust(width)


def _cell(name: str, value: float) -> str:
    if name == "state":
        return ", ".join(state_names(JunctionState(int(value))))
    return str(value) if isinstance(value, int) else number(value)


def _asked_about(tree: Node | None, sort: str | None) -> frozenset[str]:
    return frozenset(() if tree is None else tree.columns) | frozenset(() if sort is None else (sort,))


def _wanted(columns: str | None, there: tuple[Column, ...], asked: frozenset[str] | None) -> tuple[Column, ...]:
    if columns is not None:
        names = [name.strip() for name in columns.split(",")]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise Refused(f"--columns: {printable(twice) or 'nothing'} is named twice")
        return tuple(_named(name, "--columns", there) for name in names)
    if asked is None:
        return there
    return tuple(column for column in there if column.name in asked.union(BRIEF))


def _named(name: str, option: str, there: tuple[Column, ...]) -> Column:
    for column in there:
        if column.name == name:
            return column
    if any(column.name == name for column in JUNCTIONS.columns):
        raise Refused(f"{option}: this run has no {name}; it has {', '.join(column.name for column in there)}")
    raise Refused(f"{option}: no column {printable(name)}; {did_you_mean(name, (column.name for column in there))}")
