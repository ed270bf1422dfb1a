"""JSON answers are those that docs/json.md promises: every field with its type, and no other."""

import csv
import json
import re
from collections.abc import Iterator
from contextlib import chdir
from dataclasses import dataclass
from io import StringIO
from math import inf
from pathlib import Path
from shlex import split
from typing import Any, NoReturn

import numpy as np
import pytest

from rubnoise.answer import Answer, Table
from rubnoise.api.surface import Surface
from rubnoise.cli.measure import answer_of
from tests.architecture.sources import ROOT
from tests.shell.terminal import CONTACT, WITH_SLIDER, call
from tests.shell.terminal import ROW as ROW_FIELDS
from tests.unit.tampering import put, tell

PAGE = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
CALLS = Path(__file__).with_name("json_calls.txt")
"""Calls whose answers are looked at, each behind the name of its table on the page."""

ROW = re.compile(r"^\| ((?:`[A-Za-z_.]+\??`(?:, )?)+) \| ([a-z ]+) \|[^|]*\|[^|]+\|$", re.MULTILINE)
NAME = re.compile(r"`([A-Za-z_.]+)(\??)`")
TYPES: dict[str, Any] = {
    "string": lambda value: isinstance(value, str),
    "boolean": lambda value: isinstance(value, bool),
    "integer": lambda value: isinstance(value, int) and not isinstance(value, bool),
    "number": lambda value: isinstance(value, float | int) and not isinstance(value, bool),
    "number or null": lambda value: value is None or TYPES["number"](value),
    "string or null": lambda value: value is None or TYPES["string"](value),
    "integers": lambda value: isinstance(value, list) and all(TYPES["integer"](item) for item in value),
    "numbers": lambda value: isinstance(value, list) and all(TYPES["number"](item) for item in value),
    "numbers or nulls": lambda value: isinstance(value, list) and all(TYPES["number or null"](item) for item in value),
    "objects": lambda value: isinstance(value, list) and all(isinstance(item, dict) for item in value),
    "value": lambda value: value is None or isinstance(value, str | bool | int | float | list),
    "strings": lambda value: isinstance(value, list) and all(isinstance(item, str) for item in value),
}


@dataclass(frozen=True)
class Promise:
    """One field of a table; a row of several names is a promise for each."""

    path: tuple[str, ...]
    kind: str
    optional: bool


def _sections() -> dict[str, list[Promise]]:
    parts = re.split(r"^## (.+)$", PAGE, flags=re.MULTILINE)[1:]
    return {
        name: [
            Promise(tuple(field.split(".")), kind, bool(mark))
            for names, kind in ROW.findall(text)
            for field, mark in NAME.findall(names)
        ]
        for name, text in zip(parts[::2], parts[1::2], strict=True)
    }


SECTIONS = _sections()


def _leaves(value: Any, promises: list[Promise], path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield what a table speaks of: every path down to a promise, or to the end of what is there."""
    fits = any(_fits(path, promise) for promise in promises)
    part = len(path) == 1 and isinstance(value, dict) and not set(value) <= ROW_FIELDS  # no row
    if not isinstance(value, dict) or (fits and not part):
        yield path, value
        return
    for name, item in value.items():
        yield from _leaves(item, promises, (*path, name))


def _fits(path: tuple[str, ...], promise: Promise) -> bool:
    return len(path) == len(promise.path) and all(
        wanted.isupper() or wanted == name for name, wanted in zip(path, promise.path, strict=True)
    )


def breaches(answer: Any, section: str, seen: set[tuple[str, ...]] | None = None) -> list[str]:
    """Return where an answer and the table of its section differ; add to ``seen`` which promises were met."""
    promises, found = SECTIONS[section], []
    met: set[tuple[str, ...]] = set()
    for path, value in _leaves(answer, promises):
        kept = next((promise for promise in promises if _fits(path, promise)), None)
        if kept is None:
            found.append(f"{section}: {'.'.join(path)} is promised nowhere")
        elif kept.kind in SECTIONS and not isinstance(value, dict | list):
            found.append(f"{section}: {'.'.join(path)} is no {kept.kind}: {value!r}")
        elif kept.kind in SECTIONS and not (kept.kind == "row" and isinstance(value, list)):  # a column of a table
            found += breaches(value, kept.kind, seen)
        elif kept.kind != "row" and not TYPES[kept.kind](value):
            found.append(f"{section}: {'.'.join(path)} is no {kept.kind}: {value!r}")
        met.update({kept.path} if kept else ())
    if seen is not None:
        seen.update((section, *path) for path in met)
    must = {each.path for each in promises if not each.optional and not each.path[-1].isupper()}
    return found + [f"{section}: {'.'.join(path)} is missing" for path in must - met]


def _refuse(constant: str) -> NoReturn:
    raise AssertionError(f"{constant} is no JSON")


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, Any]]:
    """Return answers of every kind, of a bare contact and of one with everything."""
    here = tmp_path_factory.mktemp("answers")
    with chdir(here):
        return _answers(here)


def _answers(here: Path) -> list[tuple[str, Any]]:
    (here / "full.toml").write_text(WITH_SLIDER, encoding="utf-8")
    (here / "bare.toml").write_text(CONTACT, encoding="utf-8")
    area, weighed = 'mean_real_contact_area = "200 um^2"', 'load = "0.2 N"\nhardness = "1 GPa"'
    (here / "loaded.toml").write_text(WITH_SLIDER.replace(area, weighed), encoding="utf-8")
    carried = '\n[load]\nheight_scale = "0.5 um"\nmass = "5 g"\ndamping_ratio = 0.05\n'
    under = carried + "[interface]\nmean_junction_count = 20\n" + weighed + "\n"
    (here / "carried.toml").write_text(
        "format = 1" + under + '[strength]\nmean = "250 MPa"\n[sliding]\nspeed = "1 mm/s"\ndistance = "1 mm"\n',
        encoding="utf-8",
    )
    bounced = (here / "carried.toml").read_text(encoding="utf-8").replace("[load]", '[load]\nmotion = "free"')
    (here / "elastic.toml").write_text(bounced.replace("[load]", "[load]\nrestitution = 1.0"), encoding="utf-8")
    (here / "damped.toml").write_text(bounced.replace("[load]", '[load]\nimpact_damping = "60 s/m"'), encoding="utf-8")
    one_size = WITH_SLIDER.partition("[diameter]")[0] + WITH_SLIDER[WITH_SLIDER.index("[strength]") :]
    (here / "based.toml").write_text(one_size, encoding="utf-8")
    (here / "wrong.toml").write_text("format = 1\n", encoding="utf-8")
    sweep = "[sweep]\nreplicates = 2\n[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n"
    (here / "sweep.toml").write_text(CONTACT + sweep, encoding="utf-8")
    call("run", "bare.toml", "-o", "traced.h5", "--set", "sliding.distance=4 mm")
    calls = [line.split(": ", 1) for line in CALLS.read_text(encoding="utf-8").splitlines()]
    told = [(section, json.loads(call(*split(words)).out, parse_constant=_refuse)) for section, words in calls]
    put(here / "long.h5", "trace/junction_count", 17, 4)
    tell(here / "long.h5", "provenance", "seed", 99)
    tell(here / "long.h5", "provenance", "environment", "another machine")
    tell(here / "bare.h5", "provenance", "intervention", "__main__.largest_goes")
    told.append(("answer", call("info", "bare.h5", "--json").json()))
    told.append(("answer", call("verify", "long.h5", "--json").json()))
    # A scan needs another library; what the command prints of two surfaces is what these are made into.
    track, slider = (Surface.synthesise(points=64, cutoff="8 um", seed=seed) for seed in (1, 2))
    found = track.slide(slider, cutoff="8 um", load="90 mN", hardness="1 GPa")
    moving = {"speed": 1e4, "mass": 0.01, "damping_ratio": 0.1}
    told.append(("answer", _printed(answer_of(found, moving).to_json())))
    return told


def _printed(answer: Any) -> Any:
    return json.loads(json.dumps(answer, allow_nan=False), parse_constant=_refuse)


def test_no_number_of_an_answer_is_infinite_or_none_in_json() -> None:
    answer = Answer(tables=(Table(name="curve", columns={"area": np.array([1.0, inf])}),))
    assert _printed(answer.to_json())["curve"]["area"] == [1.0, None]


def test_csv_has_every_value_of_an_answer(here: Path) -> None:
    (here / "full.toml").write_text(WITH_SLIDER, encoding="utf-8")
    (here / "sweep.toml").write_text(CONTACT + "[sweep]\nreplicates = 2\n", encoding="utf-8")
    long = ("run", "full.toml", "-o", "long.h5", "--set", "sliding.distance=700 um", "--force")
    made = ("sweep", "sweep.toml", "-o", "swept", "--jobs", "1")
    of_run = (("info", "long.h5"), ("compare", "long.h5"), ("verify", "long.h5"), ("infer", "long.h5"))
    others = ("theory", "full.toml"), ("run", "full.toml", "--dry-run"), ("check", "full.toml")
    for asked in (long, made, ("info", "swept"), *of_run, *others):
        as_csv, as_json = call(*asked, "--csv"), call(*asked, "--json").json()
        as_json = as_json["scenarios"]["full.toml"] if asked[0] == "check" else as_json
        told = {(each["part"], each["name"]): each["value"] for each in csv.DictReader(StringIO(as_csv.out))}
        for part, rows in as_json.items():
            for name, row in rows.items() if isinstance(rows, dict) else ():
                if isinstance(row, dict) and isinstance(row.get("value"), float):
                    assert float(told[part, name]) == row["value"], asked


@pytest.mark.slow
def test_answers_are_as_promised_and_every_promise_is_met(answers: list[tuple[str, Any]]) -> None:
    seen: set[tuple[str, ...]] = set()
    assert [breach for section, answer in answers for breach in breaches(answer, section, seen)] == []
    promised = {(name, *each.path) for name, section in SECTIONS.items() for each in section}
    assert promised == seen


def test_every_row_of_the_page_is_understood() -> None:
    rows = [line for line in PAGE.splitlines() if line.startswith("| `")]
    assert all(ROW.fullmatch(line) for line in rows)
    assert sum(len(NAME.findall(line.split(" | ")[0])) for line in rows) == sum(map(len, SECTIONS.values())) > 10
    assert {each.kind for section in SECTIONS.values() for each in section} <= {*TYPES, *SECTIONS}


# Columns of a result, of a sweep and of `compare` have pages of their own.
ELSEWHERE = "".join(
    (ROOT / "docs" / page).read_text(encoding="utf-8") for page in ("data-format.md", "comparing.md", "theory.md")
)
OLDER = {"velocity_weakening", "white_noise", "base_excitation"}
"""Older models, whose names stand with their equations."""


def names_of(answer: dict[str, Any]) -> set[str]:
    """Return the names of parts and rows, without the endings of statistics."""
    parts = {name: part for name, part in answer.items() if isinstance(part, dict) and name not in {"groups", *OLDER}}
    return {*parts, *(name for part in parts.values() for name, item in part.items() if isinstance(item, dict))}


@pytest.mark.slow
def test_every_part_and_row_is_named_on_a_page(answers: list[tuple[str, Any]]) -> None:
    told = " ".join((PAGE + ELSEWHERE).split())
    for name in {name for section, answer in answers if section == "answer" for name in names_of(answer)}:
        ends = [at for at, letter in enumerate(name) if letter == "_"]
        shared = any(f"`{name[:at]}" in told and f"`{name[at:]}`" in told for at in ends)
        assert f"`{name}`" in told or f".{name}`" in told or shared or "." in name or "*" in name, name


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"title": 1}, "answer: title is no string: 1"),
        ({"passed": 1}, "answer: passed is no boolean: 1"),
        ({"news": 1}, "answer: news is no row: 1"),
        ({"notes": [1]}, "answer: notes is no strings: [1]"),
        ({"summary": {"x": {"value": 1.0, "news": None}}}, "row: news is promised nowhere"),
        ({"summary": {"x": {"z": "large"}}}, "row: z is no number or null: 'large'"),
    ],
)
def test_a_breach_is_noticed(answers: list[tuple[str, Any]], change: dict[str, Any], said: str) -> None:
    answer = next(answer for section, answer in answers if section == "answer")
    assert breaches(answer, "answer") == []
    assert said in breaches(answer | change, "answer")
