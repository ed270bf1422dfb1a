"""Measure exponents of speed and of height under a load that weighs: `python tools/studies load`.

Writes docs/load.json and the table of docs/load.md. n is the slope of the normal velocity over the speed at a fixed
height, m over the height at a fixed speed, each from two runs; no run serves twice. Where a slope is further from
theory, or m from (1 + n)/2, than four standard errors, nothing is written, and the exit code is 1.
"""

import argparse
import json
import re
import sys
from dataclasses import asdict, dataclass
from itertools import pairwise
from math import hypot, log, sqrt
from pathlib import Path
from typing import Final

from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from rubnoise.theory.load import load_errors, load_motion
from tests.models import loaded

ROOT: Final = Path(__file__).resolve().parents[2]
DATA: Final = ROOT / "docs" / "load.json"
PAGE: Final = ROOT / "docs" / "load.md"
TABLE: Final = re.compile(r"(?<=<!-- study: load -->\n).*?(?=<!-- end -->)", re.DOTALL)
RATIO: Final = 0.3
HEIGHT: Final = 0.5
"""Damping ratio, and the height scale in um at which the speed changes."""

SPEEDS: Final = (0.1, 0.3, 1.0, 3.0, 10.0)
"""v = V/(c omega_c). It goes as V sqrt(s_0): where V changes by a factor, s_0 changes by its square."""

DISTANCE: Final = 40_000.0
TICK: Final = 0.05
"""In um, at v up to 1; both grow with v."""

SEED: Final = 371
ALLOWED: Final = 4.0


@dataclass(frozen=True, kw_only=True)
class Slope:
    """A slope of ln std of the normal velocity, from two runs and by theory."""

    exact: float
    found: float
    error: float


@dataclass(frozen=True, kw_only=True)
class Row:
    """Both slopes between two relative speeds."""

    begin: float
    end: float
    speed: Slope
    height: Slope

    @property
    def miss(self) -> tuple[float, float]:
        """What m is above (1 + n)/2 in the runs, and its standard error."""
        return self.height.found - 0.5 * (1.0 + self.speed.found), hypot(self.height.error, 0.5 * self.speed.error)


def measured(model: Model, seed: int) -> tuple[float, float, float]:
    """Return ln std of the normal velocity, its standard error, both of one run, and by theory."""
    tally = Tally.of(model)
    simulate(model, seed, tally, engine="batch")
    std = tally.moments["normal_velocity"].std
    exact = load_motion(model).velocity_std
    return log(std), load_errors(model, model.distance).velocity_std / exact, log(exact)


def slope(models: tuple[Model, Model], step: float, seed: int) -> Slope:
    """Return the slope between two models that are ``step`` apart in the logarithm."""
    (low, a, low_exact), (high, b, high_exact) = (measured(model, seed + n) for n, model in enumerate(models))
    return Slope(exact=(high_exact - low_exact) / step, found=(high - low) / step, error=hypot(a, b) / step)


def contacts(begin: float, end: float) -> tuple[tuple[Model, Model], tuple[Model, Model]]:
    """Return contacts at two relative speeds: by another speed at the height HEIGHT, by another height at one speed."""

    def contact(v: float, height: float) -> Model:
        longer = max(1.0, v)
        return loaded(distance=DISTANCE * longer, tick=TICK * longer, height=height, ratio=RATIO, relative_speed=v)

    middle = sqrt(begin * end)
    low, high = (contact(v, HEIGHT * (v / middle) ** 2) for v in (begin, end))
    return (contact(begin, HEIGHT), contact(end, HEIGHT)), (low, high)


def row(begin: float, end: float, seed: int) -> Row:
    """Return both slopes between two relative speeds, each from runs of its own."""
    speeds, heights = contacts(begin, end)
    step = log(end / begin)
    return Row(begin=begin, end=end, speed=slope(speeds, step, seed), height=slope(heights, 2.0 * step, seed + 2))


def faults(each: Row) -> list[str]:
    """Return what runs and theory, or runs and the identity, disagree in."""
    miss, error = each.miss
    scores = {
        "n": (each.speed.found - each.speed.exact) / each.speed.error,
        "m": (each.height.found - each.height.exact) / each.height.error,
        "m - (1 + n)/2": miss / error,
    }
    return [
        f"{name} from {each.begin:g} to {each.end:g}: z = {z:.2f}" for name, z in scores.items() if abs(z) > ALLOWED
    ]


def table(rows: list[Row]) -> str:
    """Return the rows as a table of Markdown."""
    head = "| V/(c omega_c) | n, runs | n, theory | m, runs | m, theory | m - (1 + n)/2, runs |\n"
    return (
        head
        + "|---" * 6
        + "|\n"
        + "".join(
            f"| {each.begin:g} to {each.end:g} | {_told(each.speed)} | {_told(each.height)}"
            f" | {each.miss[0]:+.3f} ± {each.miss[1]:.3f} |\n"
            for each in rows
        )
    )


def _told(each: Slope) -> str:
    return f"{each.found:.3f} ± {each.error:.3f} | {each.exact:.3f}"


def main() -> int:
    """Make the study and write its data and table, or only the table from the data with --table."""
    parser = argparse.ArgumentParser(prog="studies load", description=__doc__)
    parser.add_argument("--table", action="store_true", help="draw the table from the data")
    if not parser.parse_args().table:
        rows = [row(begin, end, SEED + 4 * n) for n, (begin, end) in enumerate(pairwise(SPEEDS))]
        if wrong := [words for each in rows for words in faults(each)]:
            print(*wrong, sep="\n", file=sys.stderr)
            return 1
        facts = {"damping_ratio": RATIO, "junctions": 20, "seed": SEED}
        DATA.write_text(json.dumps({**facts, "rows": [asdict(each) for each in rows]}, indent=1) + "\n", "utf-8")
    PAGE.write_text(TABLE.sub(lambda _: table(kept()), PAGE.read_text("utf-8")), "utf-8")
    return 0


def kept() -> list[Row]:
    """Return the rows of the data."""
    rows = json.loads(DATA.read_text("utf-8"))["rows"]
    return [Row(**{**each, **{name: Slope(**each[name]) for name in ("speed", "height")}}) for each in rows]
