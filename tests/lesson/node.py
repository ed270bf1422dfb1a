"""What the lesson is compared with: its model run by node, its contacts, and what a teacher is told of it."""

import json
import re
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from itertools import takewhile
from typing import Any

import pytest

from rubnoise.lesson.page import scripts_by_name
from rubnoise.scenario import Scenario, build
from tests.architecture.sources import ROOT

# The model of the page, run by node without a page around it, and the contacts that it is compared in.
# The model of the page, run by node without a page around it.
WITHOUT_A_PAGE = "\n".join(takewhile(lambda text: "rub.plot = " not in text, scripts_by_name().values()))
FIGURE_5: dict[str, Any] = {
    "meanArea": 200.0,
    "meanCount": 20.0,
    "spread": 0.2,
    "births": "poisson",
    "pulse": "lens",
    "offset": "none",
    "calibration": "paper",
    "speed": 1000.0,
    "strength": 250.0,
    "mass": 0.005,
    "stiffness": 300.0,
    "damping": 0.05,
    "seed": 1,
}


def answer(body: str, **given: Any) -> Any:
    """Return what the body of a JavaScript function returns, with values by name, and the page's model as ``rub``.

    Skips the test where there is no node.
    """
    node = shutil.which("node")
    if node is None:
        pytest.skip("NO NODE FOUND: the model of the page of lessons is not tested without a browser")
    program = (
        f"{WITHOUT_A_PAGE}\nconst ask = ({', '.join(given)}) => {{ {body} }};\n"
        "const plain = (key, value) => ArrayBuffer.isView(value) ? Array.from(value) : value;\n"
        f"process.stdout.write(JSON.stringify(ask(...{json.dumps([*given.values()])}), plain));\n"
    )
    done = subprocess.run([node, "-"], input=program, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


# Settings of the page as scenarios of the Python package, so that both can be asked the same.
def scenario_of(world: dict[str, Any], distance: float = 1000.0, tick: float = 0.1) -> Scenario:
    """Return the scenario of a world of the page; distance and tick in um."""
    spread = {"law": "normal", "spread": f"{world['spread']!r} um"} if world["spread"] else {"law": "fixed"}
    if world.get("sizes") == "rayleigh":
        spread = {"law": "weibull", "spread": "52.2723 %"}
    carried: dict[str, Any] = {"mean_real_contact_area": f"{world['meanArea']!r} um^2"}
    changes: dict[str, Any] = {}
    if world.get("support") in {"load", "free"}:
        carried = {"load": f"{1000.0 * world['meanArea']!r} uN", "hardness": "1 GPa"}
        height = f"{world.get('heights', 0.5)!r} um"
        changes = {"load": {"height_scale": height, "mass": "5 g", "damping_ratio": 0.05}}
    return build(
        changes
        | {
            "format": 1,
            "interface": carried | {"mean_junction_count": world["meanCount"], "calibration": world["calibration"]},
            "diameter": spread,
            "birth": {"law": world["births"]},
            "pulse": {"shape": world["pulse"], "offset": world.get("offset", "none")},
            "strength": {"mean": f"{world['strength']!r} MPa"},
            "sliding": {"speed": f"{world['speed']!r} um/s", "distance": f"{distance!r} um"},
            "slider": {
                "mass": f"{world['mass']!r} kg",
                "stiffness": f"{world['stiffness']!r} N/m",
                "damping": f"{world['damping']!r} N*s/m",
            },
            "output": {"tick": f"{tick!r} um"},
            "run": {"seed": world["seed"]},
        }
    )


def world_with(**changes: Any) -> dict[str, Any]:
    """Return the settings of Figure 5 with changes."""
    return FIGURE_5 | changes


WORLDS = [
    world_with(**changes)
    for changes in (
        {},
        {"spread": 0.0},
        {"spread": 0.0, "meanCount": 3.0},
        {"spread": 1.5, "meanCount": 5.0, "calibration": "matched"},
        {"spread": 0.3, "meanCount": 150.0, "calibration": "exact"},
        {"spread": 3.0, "meanCount": 30.0, "calibration": "exact"},
        {"pulse": "triangle", "calibration": "exact"},
        {"pulse": "triangle", "calibration": "matched", "spread": 0.8, "meanCount": 7.0},
        {"pulse": "parabola", "calibration": "exact"},
        {"pulse": "parabola", "calibration": "matched", "spread": 0.8, "meanCount": 7.0, "births": "regular"},
        {"births": "regular"},
        {"births": "regular", "spread": 0.0},
        {"births": "regular", "spread": 0.0, "meanCount": 2.5},
        {"births": "regular", "spread": 0.01, "meanCount": 7.0},
        {"births": "regular", "spread": 1.5, "meanCount": 5.0, "calibration": "matched"},
        {"births": "regular", "pulse": "triangle", "calibration": "exact"},
        {"speed": 10.0},
        {"speed": 1e5, "damping": 5.0},
        {"stiffness": 1e4, "mass": 1e-4, "speed": 50.0, "damping": 0.001},
        {"births": "regular", "spread": 0.0, "stiffness": 1e4, "mass": 1e-4, "speed": 50.0},
        {"pulse": "parabola", "calibration": "exact"},
        {"pulse": "parabola", "calibration": "matched", "sizes": "rayleigh", "spread": 0.0},
        {
            "pulse": "parabola",
            "calibration": "matched",
            "sizes": "rayleigh",
            "spread": 0.0,
            "speed": 5e4,
            "meanCount": 3.0,
        },
        {"offset": "uniform", "calibration": "exact"},
        {"offset": "uniform", "calibration": "exact", "spread": 0.0, "speed": 10.0},
        {"offset": "uniform", "calibration": "matched", "spread": 1.5, "meanCount": 5.0},
    )
]
"""Small and large spreads, every pulse, passes off the centre line, both laws of birth, light and heavy damping, slow
and fast sliding."""

# What docs/teaching.md has for a teacher: numbers, answers and mistakes, lesson by lesson.
PAGE = ROOT / "docs" / "teaching.md"
SECTION = re.compile(r"^## (\d+)\. (.+?)\n(.*?)(?=^## )", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"\*\*(\d[\d.]*)[^*]*\*\*")
QUESTIONS = tomllib.loads((ROOT / "tests" / "lesson" / "answers.toml").read_text(encoding="utf-8"))["question"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One question of a lesson: what is right and what is not, as a student would write it."""

    right: list[str]
    wrong: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Lesson:
    """One lesson as the page for teachers has it; numbers are those in bold, in order, as they are written."""

    title: str
    numbers: list[str]
    rows: list[Row]


def lessons() -> list[Lesson]:
    """Return the lessons in order."""
    text = PAGE.read_text(encoding="utf-8")
    return [
        Lesson(title=f"{number}. {title}", numbers=NUMBER.findall(body), rows=_rows(number, body))
        for number, title, body in SECTION.findall(text)
    ]


def minutes() -> list[int]:
    """Return the minutes of the plan."""
    plan = PAGE.read_text(encoding="utf-8").partition("## The plan")[2].partition("\n## ")[0]
    return [int(found) for found in re.findall(r"^\| (\d+) \|", plan, re.MULTILINE)]


def _rows(number: str, body: str) -> list[Row]:
    """Return the questions of a lesson, whose first right answers stand on the page."""
    own = [each for each in QUESTIONS if each["lesson"] == int(number)]
    flat = " ".join(body.split())
    assert all(f"- *{each['asks']}* {each['right'][0]}." in flat for each in own), number
    return [Row(right=each["right"], wrong=each["wrong"]) for each in own]
