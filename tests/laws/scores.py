"""How far a run is from theory; runs and records whose figures are known; seeds that are not chosen."""

import hashlib
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from math import ceil, sqrt
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rubnoise
from rubnoise.analysis.measured import Measured
from rubnoise.api.running import Record
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.scenario import Scenario
from rubnoise.simulation.run import simulate
from rubnoise.theory.sampling import standard_errors
from rubnoise.theory.second_order import count_noise
from tests.models import bare

# How far a run is from theory, in standard errors; records made by hand; seeds that are not chosen.
# How far a run is from theory, in standard errors that theory gives it, and seeds that are not chosen.
# Seeds that are not chosen: the hash of what is tested, so that a lucky seed cannot be picked by hand.
SALT = os.environ.get("RUBNOISE_TEST_SALT", "")


def seed_of(name: str) -> int:
    """Return the seed that belongs to a name."""
    return int.from_bytes(hashlib.sha256(f"{name}/{SALT}".encode()).digest()[:6], "big")


# How far a run is from what theory says, in standard errors that theory gives it.
PRECISION = 0.005
"""Standard error of mean and std that a reference run is made long enough for, relative to their values."""

TICKS_A_LIFE = 20
BOUND = 4.0
REJECTED = 5.0

Figures = dict[str, float]


def reference_model(row: dict[str, Any], precision: float = PRECISION) -> Model:
    """Return the contact of a row of the reference, over a distance that gives mean and std a standard error."""
    tick = round(row["mean_life_distance"] / TICKS_A_LIFE, 3)
    contact = {
        "area": row["mean_real_contact_area_input"],
        "count": row["mean_junction_count_input"],
        "spread": Spread(absolute=row["diameter_std"]),
        "calibration": row["calibration"],
        "tick": tick,
    }
    trial = bare(distance=20_000 * tick, **contact)
    ticks = ceil(20_000 * _lengthening(trial, row, precision))
    return bare(distance=float(ticks * Fraction(str(tick))), **contact)


def _lengthening(trial: Model, row: dict[str, Any], precision: float) -> float:
    """Return how many times longer a run has to be; 2 % more, since errors fall as 1/sqrt(distance) only in the end."""
    errors = relative_errors(trial, row)
    return 1.02 * (max(errors) / precision) ** 2


def relative_errors(model: Model, row: dict[str, Any]) -> tuple[float, float]:
    """Return the standard errors of mean and std over their values."""
    errors = standard_errors(model)
    return errors["mean"] / row["area_mean"], errors["std"] / row["area_std"]


def measured(model: Model, seed: int) -> Figures:
    """Run a model without keeping its rows, and return the moments of its area and the mean of its count."""
    seen = Measured(model)
    seen.first = {}
    simulate(model, seed, seen)
    area, count = (seen.moments["trace", name] for name in ("real_contact_area", "junction_count"))
    return {
        "area_mean": area.mean,
        "area_std": area.std,
        "area_skewness": area.skewness,
        "area_excess_kurtosis": area.excess_kurtosis,
        "junction_count_mean": count.mean,
    }


def errors_of(model: Model) -> Figures:
    """Return the standard errors of the same figures over the model's ticks."""
    area = standard_errors(model)
    return {
        "area_mean": area["mean"],
        "area_std": area["std"],
        "area_skewness": area["skewness"],
        "area_excess_kurtosis": area["excess_kurtosis"],
        "junction_count_mean": count_noise(model).error_of_mean(),
    }


def scores(seen: Figures, values: Figures, errors: Figures) -> Figures:
    """Return the distance of each figure from its value, in standard errors."""
    return {name: (seen[name] - values[name]) / errors[name] for name in values}


def outside(found: Figures, bound: float = BOUND) -> Figures:
    """Return the scores beyond a bound: empty when all is well."""
    return {name: z for name, z in found.items() if abs(z) > bound}


def z_scores(some: Doubles, others: Doubles) -> Doubles:
    """Return how far the means of two samples of independent runs are apart, in standard errors from their scatter."""
    error = some.var(axis=0, ddof=1) / len(some) + others.var(axis=0, ddof=1) / len(others)
    return np.asarray((some.mean(axis=0) - others.mean(axis=0)) / np.sqrt(error))


# Records made by hand, right or wrong on purpose, with the face of a result file.
Groups = Mapping[str, Mapping[str, NDArray[Any]]]


@dataclass(frozen=True)
class Held:
    """Columns in memory, read as a file's are."""

    groups: Groups
    columns: dict[str, Sequence[str]] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "columns", {name: tuple(group) for name, group in self.groups.items()})

    def rows(self, group: str) -> int:
        return int(next(iter(self.groups[group].values())).size)

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        return self.groups[group][name][start:stop]


@dataclass(frozen=True, kw_only=True)
class Made:
    """How a record is made: everything but what is changed is as in the model.

    ``area`` is that of a life, of the distance since birth and the diameter; ``lives`` its length in diameters, and
    ``told`` what its row says of it; ``births`` the factor on the birth rate; ``together`` how many are born at a
    time, as many in all; ``always`` a count that never changes.
    """

    area: Callable[[Doubles, Doubles], Doubles] = LENS.area
    lives: float = 2.0
    told: float = 2.0
    births: float = 1.0
    empty: bool = False
    together: int = 1
    always: int | None = None


def made(model: Model, seed: int, how: Made | None = None) -> Held:
    """Return a record of a contact of one diameter."""
    how = Made() if how is None else how
    generator = np.random.default_rng(seed)
    diameter, life = model.calibrated_diameter, how.lives * model.calibrated_diameter
    if how.always is not None:
        birth = _relay(generator, model.distance, life, how.always)
    else:
        first = 0.0 if how.empty else -life
        count = generator.poisson(how.births * model.birth_rate * (model.distance - first) / how.together)
        birth = np.repeat(np.sort(generator.uniform(first, model.distance, count)), how.together)
    columns = _rows(birth, diameter, how.told)
    return Held(
        {"junctions": columns, "trace": _trace(model, birth, life, lambda age: how.area(age, np.full(1, diameter)))}
    )


def _relay(generator: np.random.Generator, distance: float, life: float, count: int) -> Doubles:
    """Return births of which each follows a death at once: always as many alive."""
    phases = generator.uniform(0.0, life, count)
    births = np.sort((phases - life + life * np.arange(int(distance / life) + 2)[:, None]).ravel())
    return births[births <= distance]


def _rows(birth: Doubles, diameter: float, told: float) -> dict[str, NDArray[Any]]:
    state = np.where(birth < 0.0, np.uint8(JunctionState.ALIVE_AT_START), np.uint8(0))
    life = np.full(birth.size, told * diameter)
    return {
        "birth_distance": birth,
        "death_distance": birth + life,
        "life_distance": life,
        "diameter": np.full(birth.size, diameter),
        "state": state,
    }


def _trace(model: Model, birth: Doubles, life: float, area: Callable[[Doubles], Doubles]) -> dict[str, NDArray[Any]]:
    """Return the sums over the lives at every tick, lives being all equally long."""
    ticks = model.tick_count + 1
    first = np.ceil(birth / model.tick).astype(np.int64)
    total, count = np.zeros(ticks), np.zeros(ticks)
    for step in range(int(life / model.tick) + 2):
        age = (first + step) * model.tick - birth
        there = (age < life) & (first + step >= 0) & (first + step < ticks)
        total += np.bincount(first[there] + step, area(age[there]), ticks)
        count += np.bincount(first[there] + step, minlength=ticks)
    return {
        "distance": np.arange(ticks) * model.tick,
        "real_contact_area": total,
        "junction_count": count.astype(np.uint32),
    }


# Runs of scenarios whose figures are known as plain numbers, and the record of how far off each figure is.
AREA, COUNT = 200.0, 20
EXACT_DIAMETER = sqrt(3.0 * AREA / COUNT)
"""In um: that of the mean life area d^2/3."""

PAPER_DIAMETER = sqrt(AREA / COUNT / 0.327)
"""In um: that of the paper's Eq. (6)."""


def scenario(**tables: Mapping[str, Any]) -> Scenario:
    """Return a contact of 200 um^2 and 20 junctions, played by the batch engine where nothing else is said."""
    interface = {"mean_real_contact_area": "200 um^2", "mean_junction_count": COUNT}
    run = {"engine": "batch"}
    return rubnoise.build(
        {"interface": interface | dict(tables.pop("interface", {})), "run": run | dict(tables.pop("run", {}))} | tables
    )


@cache
def record(name: str, given: Callable[[], Scenario]) -> Record:
    """Return a run of a scenario, with the seed that belongs to a name."""
    return rubnoise.simulate(given(), seed_of(f"sentinels/{name}"))


def judge(found: Figures) -> None:
    """Report every score to the caller, and refuse those beyond four standard errors."""
    if asked := os.environ.get("RUBNOISE_SCORES"):
        with Path(asked).open("a", encoding="utf-8") as file:
            file.writelines(f"{z:.2f}\t{name}\n" for name, z in found.items())
    assert not outside(found, BOUND)


@dataclass(frozen=True, slots=True, kw_only=True)
class Positive:
    """A normal law of a positive quantity, drawn again while it is not: its moments by a sum over its density."""

    mean: float
    std: float

    def moment(self, power: int) -> float:
        """Return E[d^n]."""
        low = max(0.0, self.mean - 12.0 * self.std)
        step = (self.mean + 12.0 * self.std - low) / 400_000
        d = low + step * (np.arange(400_000) + 0.5)
        weight = np.exp(-0.5 * ((d - self.mean) / self.std) ** 2)
        return float(weight @ d**power / weight.sum())

    def scores(self, values: Doubles) -> Figures:
        """Return how far mean and standard deviation of independent values are from the law's."""
        first, second, third, fourth = (self.moment(n) for n in range(1, 5))
        variance = second - first**2
        kurtosis = (fourth - 4.0 * first * third + 6.0 * first**2 * second - 3.0 * first**4) / variance**2
        return {
            "mean": (values.mean() - first) / sqrt(variance / values.size),
            "std": (values.std() / sqrt(variance) - 1.0) / sqrt((kurtosis - 1.0) / (4.0 * values.size)),
        }


def correlation(one: Doubles, other: Doubles) -> float:
    """Return the correlation coefficient times sqrt(n), a unit normal for independent values; 0 of a constant."""
    if one.std() == 0.0 or other.std() == 0.0:
        return 0.0
    return float(np.corrcoef(one, other)[0, 1] * np.sqrt(one.size))
