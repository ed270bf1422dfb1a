"""Write the generated parts of the documentation: `python tools/generate_docs.py [--check]`, with rubnoise installed.

A part stands between `<!-- generated: NAME -->` and `<!-- end -->`; everything else on a page is written by hand.
With `--reference DIR`, the folder of a sweep of scenarios/studies/coupling_reference.toml, reference values of two-way
coupling are taken from there first, unless they disagree with those of another program: then nothing is written.
"""

import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import floor, hypot, log10
from pathlib import Path
from typing import Any

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from rubnoise.scenario.document import Document
from rubnoise.scenario.fields import Choice, Field, Line, Measure, Number
from rubnoise.scenario.keys import SECTIONS
from rubnoise.scenario.limits import TITLE_CHARACTERS
from rubnoise.scenario.sweep_settings import Sweeping
from rubnoise.storage.schema import GROUPS, Column, Feature, Group

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PAGES = ("data-format.md", "scenarios.md", "two-way.md")
REFERENCE = ROOT / "tests" / "reference" / "coupling.json"
ANOTHER = ROOT / "tests" / "reference" / "two_way.json"
"""What another program found, with an integrator of its own."""
PART = re.compile(r"(?<=<!-- generated: )(\w+)( -->\n).*?(?=<!-- end -->)", re.DOTALL)

TYPES = {"<f8": "float64", "<i8": "int64", "<u4": "uint32", "|u1": "uint8"}
ROWS = {
    "junctions": "one per junction",
    "ticks": "one per tick",
    "slider": "one per tick; with two-way coupling, one per time of a tick",
    "landmarks": "one per landmark",
    "balance": "one, for the end of the run",
    "blocks": "one per block",
    "curve": "one per point of the curve",
}
NEEDS: dict[Feature | None, str] = {
    None: "always",
    "speed": "with `sliding.speed`",
    "strength": "with `[strength]`",
    "slider": "with `[slider]`",
    "two-way": 'with `slider.coupling = "two-way"`',
}


FIGURES = {
    "stick_fraction": ("stuck", "stick_fraction"),
    "displacement_mean": ("mean x (um)", "mean_x"),
    "displacement_std": ("std x (um)", "std_x"),
    "velocity_std": ("std x' (um/s)", "std_v"),
    "sticks_per_s": ("sticks per s", "sticks_per_s"),
    "slips_longer_than_d_per_s": ("slips > d per s", ""),
}
"""Figures of the reference, what heads their columns, and what the other program calls them."""

AGREE = 4.0
"""Joint standard errors by which both programs may differ."""


def main(arguments: Sequence[str]) -> int:
    """Write the pages, or with --check only name those that are out of date; 1 where there are any."""
    if "--reference" in arguments:
        points = reference_of(Path(arguments[arguments.index("--reference") + 1]))
        if wrong := list(disagreements(points)):
            print("generate_docs: two programs disagree", *wrong, sep="\n  ", file=sys.stderr)
            return 1
        source = (
            "rubnoise sweep scenarios/studies/coupling_reference.toml; of each figure the value and its standard error"
        )
        REFERENCE.write_text(json.dumps({"_source": source, "points": points}, indent=1) + "\n", encoding="utf-8")
    stale = [page for page in PAGES if (text := read(page)) != generated(text)]
    for page in stale:
        if "--check" not in arguments:
            (DOCS / page).write_text(generated(read(page)), encoding="utf-8")
        print(f"docs/{page}", "is out of date" if "--check" in arguments else "written")
    return int(bool(stale) and "--check" in arguments)


def read(page: str) -> str:
    """Return the text of a page as it stands."""
    return (DOCS / page).read_text(encoding="utf-8")


def generated(text: str) -> str:
    """Return the text of a page with every generated part made anew; raises KeyError for a part that nothing makes."""
    return PART.sub(lambda found: found[1] + found[2] + "\n" + "\n".join(PARTS[found[1]]()).rstrip() + "\n\n", text)


def columns() -> Iterator[str]:
    """Yield a section for each group of a result file."""
    for group in GROUPS:
        yield from _group(group)


def _group(group: Group) -> Iterator[str]:
    scale = group.columns[0].name
    yield f"### /{group.name}"
    yield ""
    yield f"{_sentence(group.long_name)} Rows: {ROWS[group.length]}. Present: {NEEDS[group.needs]}."
    yield f"Dimension scale: `{scale}`. Drawn by viewers: `{group.plotted}` against it."
    yield ""
    yield from _table(("column", "type", "unit", "symbol", "meaning", "present"), map(_column, group.columns))
    yield ""


def _column(column: Column) -> tuple[str, ...]:
    _, codes = column.coded
    meaning = "; ".join([column.long_name, *(f"{number} {name}" for number, name in codes)])
    name, kind = f"`{column.name}`", TYPES[column.dtype]
    present = NEEDS[column.needs]
    return name, kind, column.units, f"`{column.symbol}`", meaning, present


def keys() -> Iterator[str]:
    """Yield the keys of a scenario file: those at the top, then a section for each table."""
    top = {name: about for name, about in Document.model_fields.items() if name not in SECTIONS}
    yield from _keys(top)
    for name, section in SECTIONS.items():
        yield f"### [{name}]"
        yield ""
        yield " ".join((section.__doc__ or "").split())
        yield _need(Document.model_fields[name])
        yield ""
        yield from _keys(section.model_fields)


def sweep() -> Iterator[str]:
    """Yield the keys of a sweep beside its lists."""
    yield from _keys(Sweeping.model_fields)


def reference_of(folder: Path) -> list[dict[str, Any]]:
    """Return the two-way points of a sweep over both couplings, each figure with its standard error."""
    from rubnoise import open_sweep

    with open_sweep(folder) as sweep:
        told = {name: sweep.estimates(name) for name in FIGURES}
        ratios = sweep.ratios("displacement_std", "slider.coupling", "one-way")
        distance, speed = (sweep.points[f"sliding.{key}"][:] for key in ("distance", "speed"))
        return [
            {
                "speed": float(speed[number]),
                "junctions": values["interface.mean_junction_count"],
                "runs": ratios[number].runs,
                "seconds": float(f"{ratios[number].runs * distance[number] / speed[number]:.6g}"),
                **{name: _kept(each[number]) for name, each in told.items()},
                "over_one_way": _kept(ratios[number]),
            }
            for number, values in enumerate(sweep.values)
            if values["slider.coupling"] == "two-way"
        ]


def _kept(estimate: Any) -> list[float]:
    return [float(f"{estimate.value:.10g}"), float(f"{estimate.standard_error:.4g}")]


def disagreements(points: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield every figure in which the other program differs by more than its and our standard errors allow."""
    others = [other for name, other in json.loads(ANOTHER.read_text(encoding="utf-8")).items() if name[0] != "_"]
    for point in points:
        where = (point["speed"], point["junctions"])
        for other in (other for other in others if (other["V_um_s"], other["N_jm"]) == where):
            for name, (_, theirs) in FIGURES.items():
                if theirs:
                    value, error = point[name]
                    joint = hypot(error, other[f"{theirs}_se"])
                    if abs(value - other[theirs]) > AGREE * joint:
                        yield f"{name} at {where}: {value:g} and {other[theirs]:g}, joint standard error {joint:.2g}"


def coupling() -> Iterator[str]:
    """Yield the reference values of two-way coupling, standard errors in the last digits."""
    head = ("V (mm/s)", "N_jm", "time (s)", *(words for words, _ in FIGURES.values()), "std x over one-way")
    points = json.loads(REFERENCE.read_text(encoding="utf-8"))["points"]
    rows = (
        (
            f"{1e-3 * point['speed']:g}",
            f"{point['junctions']:g}",
            f"{point['seconds']:g}",
            *(in_digits(*point[name]) for name in (*FIGURES, "over_one_way")),
        )
        for point in points
    )
    yield from _table(head, rows)
    yield ""


def in_digits(value: float, error: float) -> str:
    """Return a value with its standard error in its last two digits, as 0.7413(15)."""
    if error <= 0.0:
        return f"{value:g}"
    places = max(1 - floor(log10(error)), 0)
    return f"{value:.{places}f}({round(error * 10.0**places)})"


def _need(table: FieldInfo) -> str:
    if table.is_required():
        return "This table is required."
    return "This table is optional." if table.default is None else "This table is optional; its keys have defaults."


def _keys(fields: dict[str, FieldInfo]) -> Iterator[str]:
    rows = ((f"`{key}`", _values(about), _default(about), about.description or "") for key, about in fields.items())
    yield from _table(("key", "value", "default", "meaning"), rows)
    yield ""


def _values(about: FieldInfo) -> str:
    """Return what a key may hold, as far as one line can say it."""
    match next(each for each in about.metadata if isinstance(each, Field)):
        case Measure(kinds=kinds, possible=possible):
            low, high = (kinds[0].number(bound) for bound in (possible.low, possible.high))
            examples = " or ".join(f'{kind.name}, `"{kind.example}"`' for kind in kinds)
            return f"{examples}; {'0 or ' if possible.zero else ''}{low} to {high}"
        case Number(possible=possible, whole=True):
            same = possible.low == possible.high
            return f"`{possible.low}`" if same else f"whole number, {possible.low} to {possible.high}"
        case Number(possible=possible):
            return f"number, {possible.low:g} to {possible.high:g}"
        case Choice(available=available):
            return ", ".join(f'`"{word}"`' for word in available)
        case Line():
            return f"text of at most {TITLE_CHARACTERS} characters"
        case other:
            raise TypeError(f"no words for {type(other).__name__}")


def _default(about: FieldInfo) -> str:
    if about.default is PydanticUndefined:
        return "required"
    return "-" if about.default in (None, "") else f"`{json.dumps(about.default)}`"


def _table(head: Sequence[str], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    yield "| " + " | ".join(head) + " |"
    yield "|" + "---|" * len(head)
    for row in rows:
        yield "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |"


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


PARTS: dict[str, Callable[[], Iterator[str]]] = {"columns": columns, "keys": keys, "sweep": sweep, "coupling": coupling}

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
