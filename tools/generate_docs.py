"""Write the generated parts of the documentation: `python tools/generate_docs.py [--check]`, with rubnoise installed.

A part stands between `<!-- generated: NAME -->` and `<!-- end -->`; everything else on a page is written by hand.
"""

import json
import re
import sys
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from parts import filled, parts_of

from rubnoise.scenario.document import SECTIONS, TOP, Sweeping, presence
from rubnoise.scenario.fields import Choice, Key, Measure, Number, Parts, Sizes, about_of, keys_of
from rubnoise.storage.schema import GROUPS, INSTEAD, Dataset, Group

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGES = ("data-format.md", "design.md", "scenarios.md")
TYPES = {"<f8": "", "<i8": " int64", "<u4": " uint32", "|u1": " uint8"}
"""What a column's name is followed by; most are float64."""
ROWS = {
    "junctions": "one per junction",
    "trace": "one per tick",
    "slider": "one per tick; with two-way coupling, one per time of a tick",
    "load": "one per tick",
    "balance": "one, for the end of the run",
}
NEEDS: dict[str | None, str] = {
    None: "",
    "speed": "with `sliding.speed`",
    "strength": "with `[strength]`",
    "slider": "with `[slider]`",
    "two-way": 'with `slider.coupling = "two-way"`',
    "offset": 'with `pulse.offset = "uniform"`',
    "load": "with `[load]`",
    "free": 'with `load.motion = "free"`',
    "base": 'with `slider.excitation = "base"`',
}


def main(arguments: Sequence[str]) -> int:
    """Write the pages, or with --check only name those that are out of date; 1 where there are any."""
    pages = sorted(path.name for path in DOCS.glob("*.md"))
    stale = [page for page in pages if (text := read(page)) != generated(text)]
    for page in stale:
        if "--check" not in arguments:
            (DOCS / page).write_text(generated(read(page)), encoding="utf-8")
        print(f"docs/{page}", "is out of date" if "--check" in arguments else "written")
    return int(bool(stale) and "--check" in arguments)


def read(page: str) -> str:
    """Return the text of a page as it stands."""
    return (DOCS / page).read_text(encoding="utf-8")


def generated(text: str) -> str:
    """Return the text of a page with new generated parts; a part that another tool makes stays."""
    made = {name: "\n".join(PARTS[name]()).rstrip() for name in parts_of(text) if name in PARTS}
    return filled(text, {name: f"\n{part}\n\n" for name, part in made.items()})


def columns() -> Iterator[str]:
    """Yield a section for each group of a result file."""
    for group in GROUPS:
        yield from _group(group)


def _group(group: Group) -> Iterator[str]:
    yield f"### /{group.name}"
    yield ""
    rows, present = ROWS.get(group.name), _present(group)
    about = [group.long_name, rows and f"rows: {rows}", present and f"present {present}"]
    yield " ".join(_sentence(each) for each in about if each)
    others = ((feature, about["long_name"]) for (path, feature), about in INSTEAD.items() if path == group.name)
    yield from (f"{_sentence(f'{NEEDS[feature]}: {name}')}" for feature, name in others)
    yield from ("", *map(_column, group.columns), "")


def _present(group: Group) -> str:
    lacking = " and ".join(NEEDS[each].replace("with ", "without ", 1) for each in group.lacks)
    return lacking or " or ".join(NEEDS[each] for each in group.needs) or NEEDS[None]


def _column(column: Dataset) -> str:
    present = [NEEDS[column.needs]] if column.needs else []
    meaning = "; ".join([column.long_name, *(f"{number} {name}" for number, name in column.codes), *present])
    return f"- `{column.name}`{TYPES[column.dtype]} (`{column.symbol}`, {column.units}): {meaning}"


def keys() -> Iterator[str]:
    """Yield the keys of a scenario file: those at the top, then a section for each table; a law is explained once."""
    explained: set[str] = set()
    yield from _keys(TOP, explained)
    for name, section in SECTIONS.items():
        yield f"### [{name}]\n"
        yield " ".join(about_of(section).split())
        yield f"{_NEEDS[presence(name)]}\n"
        yield from _keys(keys_of(section), explained)


def sweep() -> Iterator[str]:
    """Yield the keys of a sweep beside its lists."""
    yield from _keys(keys_of(Sweeping), set())


_NEEDS = {"needed": "Required.", "optional": "Optional.", "defaults": "Optional, with defaults."}


def _keys(fields: Mapping[str, Key], explained: set[str]) -> Iterator[str]:
    for key, about in fields.items():
        value = _default(about, _values(about))
        yield f"- `{key}`{f' ({value})' if value else ''}: {_meaning(about, explained)}"
    yield ""


def _meaning(about: Key, explained: set[str]) -> str:
    """Return the meaning of a key without the words that it may hold and that were explained before."""
    parts = about.about.removesuffix(".").split("; ")
    new, known = [each for each in parts if each not in explained], [each for each in parts if each in explained]
    explained.update(each for each in parts if re.match(r"[\w-]+: ", each))
    old = ", ".join(each.partition(":")[0] for each in known)
    return f"{'; '.join(new)}; {old}: as above." if known else about.about


def _values(about: Key) -> str:
    """Return what a key may hold, as far as one line can say it."""
    match about.kind:
        case Measure(kinds=kinds, possible=possible):
            return " or ".join(
                [*(f'`"{kind.example}"`' for kind in kinds), *[f'`"0 {kinds[0].unit}"`'] * possible.zero]
            )
        case Number(possible=possible, whole=whole):
            low, high = (f"{bound}" if whole else f"{bound:g}" for bound in (possible.low, possible.high))
            return f"`{low}`" if low == high else f"{'whole ' * whole}number, {low} to {high}"
        case Choice(available=available):
            explained = all(f"{word}: " in about.about for word in available)
            return "" if explained else ", ".join(f'`"{word}"`' for word in available)
        case Sizes(what=what):
            return f"list of {what}, each a positive number or a length"
        case Parts():
            return "list of tables with `law`, `mean` and `spread`"
        case _:
            return "text"


def _default(about: Key, values: str) -> str:
    default = "" if about.default in (None, "") else f"default `{json.dumps(about.default)}`"
    return "; ".join(filter(None, (values, "required" if about.is_needed else default)))


def layers() -> Iterator[str]:
    """Yield the layers of the package, the highest first, as the contract that import-linter keeps has them."""
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))
    contract = project["tool"]["importlinter"]["contracts"][0]
    yield "    " + " > ".join(re.sub(r"[()]", "", layer).replace(" | ", ", ") for layer in contract["layers"])


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


PARTS: dict[str, Callable[[], Iterator[str]]] = {
    "columns": columns,
    "keys": keys,
    "sweep": sweep,
    "layers": layers,
}

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
