"""An answer: what a command prints, a function of Python returns and a notebook shows, in one form.

An answer has rows (a name, a value with its unit, and where theory has them the exact value, its error and a score) and
tables (curves), and it is true unless a row fails. One renderer each makes text, JSON, CSV and HTML of any answer.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from math import isfinite
from textwrap import fill
from typing import TYPE_CHECKING, Any, Final

from rubnoise.errors import needing
from rubnoise.tables import as_html, as_text

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]

HEADS: Final = ("part", "name", "value", "unit", "exact", "error", "interval", "z", "note")
"""The columns of a table of rows."""

BESIDE: Final[Mapping[str, tuple[int, str]]] = {
    "exact": (14, ".7g"),
    "error": (11, ".3g"),
    "interval": (21, ".4g"),
    "z": (8, "+.2f"),
}
"""What may stand beside a value in text: the width of its column, and how its numbers are written."""

WIDTH: Final = 80
LABEL: Final = 34
NUMBER: Final = 13


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line of an answer: a number or words under a name, in a part; ``note`` says what there is to say of it.

    Without a value it is a question without an answer, and the note is the reason. ``error`` is the standard error; of
    a relation that holds but for rounding, what rounding makes. ``interval`` holds 95 %.
    """

    part: str = ""
    name: str
    value: Any = None
    unit: str = ""
    exact: float | None = None
    error: float | None = None
    interval: tuple[float, float] | None = None
    z: float | None = None
    note: str = ""
    fails: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return what the row has, by name."""
        found = {name: getattr(self, name) for name in HEADS[2:]}
        return {name: value for name, value in found.items() if value is not None and value != ""}


def rows(part: str, *found: tuple[Any, ...]) -> Iterator[Row]:
    """Return the rows of a part, each given as name, value and perhaps unit and note; one without value is left out."""
    known = ((name, value, dict(zip(("unit", "note"), rest, strict=False))) for name, value, *rest in found)
    return (Row(part=part, name=name, value=value, **beside) for name, value, beside in known if value is not None)


def left_out(name: str, reason: str) -> Row:
    """Return the row of a question that could not be answered for a run, or only in part."""
    return Row(part="left_out", name=name, note=reason)


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A curve, or any list of equal things: columns by name, with their units.

    Text shows the rows whose numbers are in ``shown``, and all if that is None; of an empty one not even its name.
    """

    name: str
    columns: Mapping[str, Any]
    units: Mapping[str, str] = field(default_factory=dict)
    shown: Sequence[int] | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Answer:
    """Rows, tables and notes under a title; it is true unless a row fails: ``if run.compare(): ...``.

    ``judged`` says in words what was judged; an answer without it has no verdict.

    >>> from rubnoise.answer import Answer, Row
    >>> answer = Answer(title="fig5.h5", rows=(Row(part="contact", name="count", value=20.1, exact=20.0, z=0.4),))
    >>> bool(answer), answer["count"].exact, answer.to_json()["contact"]["count"]["z"]
    (True, 20.0, 0.4)
    """

    title: str = ""
    rows: tuple[Row, ...] = ()
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()
    judged: str = ""

    @property
    def failing(self) -> tuple[str, ...]:
        """Names of the rows that fail."""
        return tuple(row.name for row in self.rows if row.fails)

    @property
    def passed(self) -> bool:
        """Whether no row fails."""
        return not self.failing

    def __bool__(self) -> bool:
        return self.passed

    @property
    def left_out(self) -> dict[str, str]:
        """The reasons for the questions that could not be answered, by name."""
        return {row.name: row.note for row in self.rows if row.value is None}

    def __getitem__(self, name: str) -> Row:
        """Return a row by its name; raises KeyError without one."""
        for row in self.rows:
            if row.name == name:
                return row
        raise KeyError(name)

    def to_json(self) -> dict[str, Any]:
        """Return the answer by name: parts of rows, tables of columns; None for numbers that are not finite."""
        found: dict[str, Any] = {"title": self.title, "passed": self.passed, "failing": self.failing}
        for row in self.rows:
            (found.setdefault(row.part, {}) if row.part else found)[row.name] = row.to_json()
        for table in self.tables:
            found[table.name] = found.get(table.name, {}) | dict(table.columns)
        return dict(finite(found | {"notes": self.notes}))

    def to_csv(self) -> str:
        """Return a line for each row and each number of a table, with all digits; a table alone is written wide."""
        if len(self.tables) == 1 and not self.rows:
            columns = self.tables[0].columns
            return "\n".join([_csv(*columns), *(_csv(*cells) for cells in zip(*columns.values(), strict=True))])
        lines = [_csv("part", "name", "at", *HEADS[2:])]
        lines += [_csv(row.part, row.name, "", *(getattr(row, name) for name in HEADS[2:])) for row in self.rows]
        for table in self.tables:
            place, *others = table.columns
            for name in others:
                for at, value in zip(table.columns[place], table.columns[name], strict=True):
                    lines.append(_csv(table.name, name, at, value, table.units.get(name, ""), *[""] * len(HEADS[4:])))
        return "\n".join(lines)

    def to_pandas(self) -> "pd.DataFrame":
        """Return the rows as a pandas DataFrame; raises ExtraMissing without pandas."""
        with needing("analysis", "to_pandas"):
            import pandas as pd
        return pd.DataFrame([{name: getattr(row, name) for name in HEADS} for row in self.rows], columns=list(HEADS))

    def to_text(self, width: int = WIDTH, widest: int | None = None) -> str:
        """Return the answer as lines for a terminal of a width; tables are as wide as they are, at most ``widest``."""
        lines = [printable(self.title)]
        tables = {table.name: table for table in self.tables if table.shown is None or len(table.shown)}
        for part, rows in groupby(self.rows, key=lambda row: row.part):
            lines += _part_lines(part, list(rows), width)
            lines += _table_lines(tables.pop(part), widest) if part in tables else []
        for table in tables.values():
            lines += ["", *filter(None, [table.name.replace("_", " ")]), *_table_lines(table, widest)]
        for note in self.notes:
            lines.append(sentence(note if note.startswith("warning: ") else f"note: {note}", width, "  "))
        return "\n".join([*lines, "", *self._verdict(width)] if self.judged else lines)

    def _verdict(self, width: int) -> Iterator[str]:
        found = "passed" if self else f"not passed: {', '.join(self.failing)}"
        yield sentence(f"{found} ({self.judged})" if not self else f"{found}: {self.judged}", width, "")

    __repr__ = to_text

    def _repr_html_(self) -> str:
        cells = [[_cell(name, getattr(row, name)) for name in HEADS] for row in self.rows]
        return as_html(self.title, HEADS, cells, "\n".join([*self.notes, *self._verdict(10_000)]))


def finite(value: Any) -> Any:
    """Return a value for JSON: arrays as lists, and None for numbers that are not finite."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, Mapping):
        return {name: finite(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def printable(text: str) -> str:
    """Return a text from a file with characters that control a terminal escaped."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def shown(value: Any, unit: str = "") -> str:
    """Return a value with its unit as text: numbers with seven digits, yes or no."""
    if unit == "B":
        return size(value)
    if isinstance(value, list | tuple):
        text = ", ".join(map(shown, value))
    elif isinstance(value, bool):
        text = "yes" if value else "no"
    elif isinstance(value, int | float):
        text = str(value) if isinstance(value, int) else f"{value:.7g}"
    else:
        text = "none" if value is None else printable(str(value))
    return f"{text} {unit}" if unit else text


def size(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000.0
    return f"{count:.3g} TB"


def length(um: float, digits: int = 2) -> str:
    """Return a sliding distance, with a number of digits, in the unit that suits it."""
    unit, size = next(((unit, size) for unit, size in (("m", 1e6), ("mm", 1e3)) if um >= size), ("um", 1.0))
    return f"{float(f'{um / size:.{digits}g}'):,.10g} {unit}"


def _part_lines(part: str, rows: Sequence[Row], width: int) -> Iterator[str]:
    """Yield the rows of a part under its name and the heads of what stands beside its values."""
    heads = [name for name in BESIDE if any(getattr(row, name) is not None for row in rows)]
    if part:
        yield ""
        over = "".join(f"{name:>{BESIDE[name][0]}}" for name in heads)
        yield from _above_or_beside(part.replace("_", " "), f"{'value':>{NUMBER}}{over}" if heads else "", width)
    for row in rows:
        yield from _row_lines(row, heads, width)


def _row_lines(row: Row, heads: Sequence[str], width: int) -> Iterator[str]:
    label = f"  {printable(row.name).replace('_', ' ')}"
    if row.value is None:
        yield sentence(f"{label.strip()}: {row.note}", width, "  ")
        return
    if not heads:
        note = f" ({row.note})" if row.note else ""
        yield sentence(f"{label:<{LABEL - 1}} {shown(row.value, row.unit)}{note}", width, "", " " * LABEL)
    else:
        label += f" ({row.unit})" if row.unit else ""
        cells = "".join(f"{_cell(name, getattr(row, name)):>{BESIDE[name][0]}}" for name in heads)
        number = f"{shown(row.value):>{NUMBER}}{cells}{' *' if row.fails else ''}"
        yield from _above_or_beside(label, number, width)
        yield from [sentence(row.note, width, "    ")] if row.note else []


def _above_or_beside(label: str, numbers: str, width: int) -> list[str]:
    """Return a label and its numbers in one line, or the label above them if it is long or the terminal narrow."""
    if len(label) < LABEL and LABEL + len(numbers) <= width:
        return [f"{label:<{LABEL}}{numbers}".rstrip()]
    indent = max(min(LABEL, width - len(numbers)), 0)
    return [label, *([" " * indent + numbers] if numbers else [])]


def _table_lines(table: Table, widest: int | None) -> Iterator[str]:
    words = {name: name.replace("_", " ").replace(".", ". ") for name in table.columns}
    heads = [f"{text} ({table.units[name]})" if table.units.get(name) else text for name, text in words.items()]
    rows = list(zip(*(finite(column) for column in table.columns.values()), strict=True))
    chosen = rows if table.shown is None else [rows[number] for number in table.shown]
    cells = [[shown(cell) for cell in row] for row in chosen]
    yield from (f"  {line}".rstrip() for line in as_text(heads, cells, range(len(heads)), widest and widest - 2))
    if len(chosen) < len(rows):
        yield f"  and {len(rows) - len(chosen):,} more, which --json has"


def _cell(name: str, value: Any) -> str:
    if value is None:
        return ""
    if name == "interval":
        low, high = (format(end, BESIDE[name][1]) for end in value)
        return f"{low} to {high}" if isfinite(value[1]) else f"from {low}"
    if name not in BESIDE or not isinstance(value, float):
        return shown(value)
    text = format(value, BESIDE[name][1])
    return text if len(text) < BESIDE[name][0] else f"{value:+.0e}"


def sentence(text: str, width: int, indent: str, others: str | None = None) -> str:
    """Return a sentence broken between words, with an indent, and a deeper one of all lines but the first."""
    others, text = f"{indent}  " if others is None else others, printable(text)
    return fill(
        text, width, initial_indent=indent, subsequent_indent=others, break_long_words=False, break_on_hyphens=False
    )


def _csv(*cells: Any) -> str:
    texts = ["" if cell is None or (isinstance(cell, float) and not isfinite(cell)) else str(cell) for cell in cells]
    return ",".join('"' + text.replace('"', '""') + '"' if set(text) & set(',"\n') else text for text in texts)
