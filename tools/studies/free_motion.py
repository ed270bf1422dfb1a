"""A slider that may leave its contact, over speed, height and contacts.

The slider bears its own weight on summits with c = 50 um; at a height scale of 5 um that is V = 70 mm/s times
v = V/(c omega_c). n is the slope of the normal velocity over the speed at that height, m over the height at a fixed
speed, from runs of their own: no seed serves twice. With a restitution m = (1 + n)/2 is exact between the same two v.
No table is drawn if it is off by more than four standard errors in a step of speed or over all contacts together, or
the mean load is, or the level still drifts.
"""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import count
from math import hypot, log, pi, sqrt
from pathlib import Path
from typing import Any, Final

import numpy as np
from parts import fill, table
from scipy.special import stdtr

from rubnoise.analysis.findings import normal_deviate
from rubnoise.model import Model, Separation
from rubnoise.record.rows import ContactKind, MemoryRecord
from rubnoise.simulation.draws import extent
from rubnoise.simulation.run import simulate
from rubnoise.theory.coupling import level as decibels
from tests.models import bouncing

PAGE: Final = Path(__file__).resolve().parents[2] / "docs" / "load.md"
DATA: Final = PAGE.with_name("free_motion.json")
DIAMETER: Final = 50.0
HEIGHT: Final = 5.0
GRAVITY: Final = 9.81e6
"""c, s_0 and the acceleration of weight in um and um/s^2."""

SPEEDS: Final = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
STEPS: Final = (1, 2, 3)
"""Steps between speeds over which m is measured too: v from 0.3 to 10, which is 21 to 700 mm/s."""

CONTACTS: Final = (
    (0.01, "restitution", 0.7, 5000.0),
    (0.1, "restitution", 0.7, 5000.0),
    (0.1, "restitution", 0.3, 5000.0),
    (0.5, "restitution", 0.7, 5000.0),
    (2.0, "restitution", 0.7, 5000.0),
    (10.0, "restitution", 0.7, 3200.0),
    (0.1, "impact_damping", 0.3, 5000.0),
)
"""N, the loss (beta s_0 omega_c at the height 5 um), and how long each run is (1/omega_c)."""

RUNS: Final = 16
SEED: Final = 411
DISCARDED: Final = 0.2
"""Share of each run in which the start is forgotten."""

PEAKS: Final = (1.0, 10.0, 100.0)
"""Multiples of the weight below which peaks of the load are counted."""

ALLOWED: Final = 4.0


@dataclass(frozen=True, kw_only=True)
class Level:
    """What runs at one speed and height say: relative and absolute speed (mm/s), height (um), normal velocity (um/s).

    drift: ln of the velocity in the second half over that in the first; apart: share of time without contact; shocks:
    contacts made anew per 1/omega_c; load: its mean over the weight, without the momentum gained.
    peaks: shares of the largest loads between two flights that are below 1, 10 and 100 weights, None without flights.
    """

    relative_speed: float
    speed: float
    height: float
    velocity: float
    error: float
    drift: float
    drift_error: float
    apart: float
    shocks: float
    load: float
    load_error: float
    peaks: Sequence[float] | None

    @property
    def decibels(self) -> float:
        """Level of the normal velocity."""
        return decibels(self.velocity)


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Runs of one contact: over the speed, and for each step of STEPS at both ends over the height."""

    live: float
    loss: str
    value: float
    levels: tuple[Level, ...]
    heights: tuple[tuple[Level, Level], ...]

    @property
    def exact(self) -> bool:
        """Whether its loss has no scale of its own, so that m = (1 + n)/2."""
        return self.loss == "restitution"

    def speed_exponent(self, first: int, last: int) -> tuple[float, float]:
        """Return n between two of SPEEDS, and its standard error."""
        return _slope([(self.levels[first], self.levels[last])], "speed")

    def height_exponent(self, first: int, last: int) -> tuple[float, float]:
        """Return m between two of SPEEDS, from the steps between them, and its standard error."""
        return _slope([self.heights[STEPS.index(n)] for n in range(first, last)], "height")

    def miss(self, first: int, last: int) -> tuple[float, float]:
        """Return what m is above (1 + n)/2, and its standard error."""
        (n, n_error), (m, m_error) = self.speed_exponent(first, last), self.height_exponent(first, last)
        return m - 0.5 * (1.0 + n), hypot(m_error, 0.5 * n_error)


def _slope(pairs: Sequence[tuple[Level, Level]], over: str) -> tuple[float, float]:
    """Return the slope of ln velocity over that of a quantity, from pairs one after another, and its error."""
    rise = sum(log(high.velocity / low.velocity) for low, high in pairs)
    step = sum(log(getattr(high, over) / getattr(low, over)) for low, high in pairs)
    square = sum((each.error / each.velocity) ** 2 for pair in pairs for each in pair)
    return rise / step, sqrt(square) / step


def slider(live: float, loss: str, value: float, v: float, height: float, duration: float) -> Model:
    """Return a slider under its own weight that goes on for so many 1/omega_c; beta is that of the height 5 um."""
    area = 0.25 * pi * live * DIAMETER**2
    tick = min(0.05, v * min(0.05, 0.1 * sqrt(live))) * DIAMETER
    scaled = value * sqrt(height / HEIGHT)  # beta s_0 omega_c
    return bouncing(
        count=live,
        height=height,
        weight=1000.0 * area,
        mass=1000.0 * area / GRAVITY,
        relative_speed=v,
        distance=tick * round(duration * v * DIAMETER / tick),
        tick=tick,
        slider=None,
        strength=None,
        **({"restitution": value} if loss == "restitution" else {"growth": scaled}),
    )


def level(
    live: float, loss: str, value: float, v: float, height: float, duration: float, seeds: Sequence[int]
) -> Level:
    """Return what runs with these seeds say together."""
    model = slider(live, loss, value, v, height, duration)
    runs = [heard(model, seed) for seed in seeds]
    early, late, apart, shocks, load = np.array([run[:5] for run in runs]).T
    peaks = np.concatenate([run[5] for run in runs])
    square, drift = 0.5 * (early + late), 0.5 * (late - early) / (late + early).mean()
    velocity = sqrt(square.mean())
    return Level(
        relative_speed=v,
        speed=1e-3 * (model.sliding_speed or 0.0),
        height=height,
        velocity=velocity,
        error=float(square.std(ddof=1)) / (2.0 * velocity * sqrt(len(runs))),
        drift=float(2.0 * drift.mean()),
        drift_error=2.0 * float(drift.std(ddof=1)) / sqrt(len(runs)),
        apart=float(apart.mean()),
        shocks=float(shocks.mean()),
        load=float(load.mean()),
        load_error=float(load.std(ddof=1)) / sqrt(len(runs)),
        peaks=tuple(float((peaks < most).mean()) for most in PEAKS) if peaks.size else None,
    )


def heard(model: Model, seed: int) -> tuple[float, float, float, float, float, Any]:
    """Return the mean square velocity in both halves, apart, shocks, load and peaks of a run after its start."""
    record = MemoryRecord(extent(model, seed))
    simulate(model, seed, record, engine="batch")
    held = _held(model)
    first, weight = int(DISCARDED * model.tick_count), held.load
    velocity, load = (record["load"][name][first:] for name in ("velocity", "load"))
    touching = record["trace"]["junction_count"][first:] > 0
    marks = record["landmarks"]
    made = (marks["kind"] == ContactKind.CONTACT_MADE) & (marks["distance"] > first * model.tick)
    duration = (model.tick_count - first) * (model.tick_duration or 0.0)
    begun = np.flatnonzero(~touching[:-1] & touching[1:]) + 1
    peaks = np.maximum.reduceat(load, begun)[:-1] / weight if begun.size else np.empty(0)
    shocks = int(made.sum()) / (duration * held.oscillator.natural_angular_frequency)
    early, late = (float(np.mean(half**2)) for half in np.array_split(velocity, 2))
    pushed = float(velocity[-1] - velocity[0]) * held.mass / duration
    return early, late, float((~touching).mean()), shocks, (float(load.mean()) - pushed) / weight, peaks


def _held(model: Model) -> Separation:
    if model.free is None:
        raise ValueError("the slider of the model is not free")
    return model.free.held


def measured(number: int) -> Contact:
    """Return what runs of one of CONTACTS say."""
    live, loss, value, duration = CONTACTS[number]
    fresh = count(SEED + 100_000 * number, RUNS)

    def at(v: float, height: float) -> Level:
        begin = next(fresh)
        length = duration if v <= 10.0 else 0.5 * duration
        return level(live, loss, value, v, height, length, range(begin, begin + RUNS))

    levels = tuple(at(v, HEIGHT) for v in SPEEDS)
    heights = []
    for step in STEPS:
        begin, end = SPEEDS[step : step + 2]
        middle = sqrt(begin * end)
        heights.append((at(begin, HEIGHT * (begin / middle) ** 2), at(end, HEIGHT * (end / middle) ** 2)))
    return Contact(live=live, loss=loss, value=value, levels=levels, heights=tuple(heights))


def faults(contacts: Sequence[Contact]) -> list[str]:
    """Return where runs miss m = (1 + n)/2, have a mean load that is not the weight, or still drift."""
    wrong, together = [], []
    for each in contacts:
        name = f"N {each.live:g}, {each.loss} {each.value:g}: "
        for level in [*each.levels, *(level for pair in each.heights for level in pair)]:
            if abs(deviate(level.load - 1.0, level.load_error)) > ALLOWED:
                wrong.append(f"{name}mean load {level.load:.4f} at v = {level.relative_speed:g}")
            if abs(deviate(level.drift, level.drift_error)) > ALLOWED:
                wrong.append(f"{name}the level drifts by {level.drift:.4f} at v = {level.relative_speed:g}")
        if each.exact:
            for step in STEPS:
                miss, error = each.miss(step, step + 1)
                if abs(deviate(miss, error)) > ALLOWED:
                    wrong.append(f"{name}m - (1 + n)/2 = {miss:.3f}, error {error:.3f}, from v = {SPEEDS[step]:g}")
            together.append(deviate(*each.miss(STEPS[0], STEPS[-1] + 1)))
    if abs(sum(together)) > ALLOWED * sqrt(len(together)):
        wrong.append(f"m - (1 + n)/2 over all contacts: {sum(together) / sqrt(len(together)):.1f} standard errors")
    return wrong


def deviate(value: float, error: float) -> float:
    """Return how far from 0 a mean over RUNS is, on the scale of a normal law; for more runs it errs towards 0."""
    t = value / error
    return normal_deviate(float(stdtr(RUNS - 1, t)), float(stdtr(RUNS - 1, -t)))


def tables(contacts: Sequence[Contact]) -> dict[str, str]:
    """Return the tables of the page by name."""
    speeds = [f"{each.speed:.0f} mm/s" for each in contacts[0].levels]
    first, last = STEPS[0], STEPS[-1] + 1
    return {
        "free levels": table(
            ("N", "loss", *speeds),
            (_row(each, (_decibels(level) for level in each.levels)) for each in contacts),
        ),
        "free slopes": table(
            ("N", "loss", "n", "m", "m - (1 + n)/2"),
            (
                _row(
                    each,
                    (
                        "{:.3f} ± {:.3f}".format(*each.speed_exponent(first, last)),
                        "{:.3f} ± {:.3f}".format(*each.height_exponent(first, last)),
                        "{:+.3f} ± {:.3f}".format(*each.miss(first, last)),
                    ),
                )
                for each in contacts
            ),
        ),
    }


def _row(each: Contact, cells: Iterator[str] | Sequence[str]) -> Sequence[str]:
    name = f"e = {each.value:g}" if each.exact else f"beta s0 omega_c = {each.value:g}"
    return (f"{each.live:g}", name, *cells)


def _decibels(level: Level) -> str:
    return f"{level.decibels:.1f}"


def made() -> Iterator[Contact]:
    """Yield what is found of each contact, and print it, since all of them take long."""
    for number in range(len(CONTACTS)):
        found = measured(number)
        print("\n".join(tables([found]).values()), flush=True)
        yield found


def kept() -> list[Contact]:
    """Return what was found, as docs/free_motion.json has it."""
    return [_contact(**row) for row in json.loads(DATA.read_text("utf-8"))["rows"]]


def _contact(*, levels: list[dict[str, Any]], heights: list[list[dict[str, Any]]], **about: Any) -> Contact:
    pairs = tuple((Level(**low), Level(**high)) for low, high in heights)
    return Contact(levels=tuple(Level(**each) for each in levels), heights=pairs, **about)


def main() -> int:
    """Make the rows and keep them, or take those of before with --table; draw the tables unless a row is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true", help="draw the tables from docs/free_motion.json")
    if not parser.parse_args().table:
        facts = {"seed": SEED, "runs": RUNS, "diameter": DIAMETER, "height": HEIGHT, "discarded": DISCARDED}
        DATA.write_text(json.dumps({**facts, "rows": [asdict(each) for each in made()]}, indent=1) + "\n", "utf-8")
    rows = kept()
    if wrong := faults(rows):
        print(*wrong, sep="\n", file=sys.stderr)
        return 1
    fill(PAGE, tables(rows))
    return 0
