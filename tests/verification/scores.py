"""How far a run is from theory, in standard errors that theory gives it, and seeds that are not chosen."""

import hashlib
import os
from fractions import Fraction
from math import ceil, sqrt
from typing import Any

from rubnoise.contact.laws import Spread
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.simulation.run import simulate
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.occupancy import mean_count, mean_count_error
from rubnoise.theory.sampling import StandardErrors, standard_errors
from tests.models import bare

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
    return errors.mean / row["area_mean"], errors.std / row["area_std"]


def measured(model: Model, seed: int) -> Figures:
    """Run a model without keeping its rows, and return the moments of its area and the mean of its count."""
    tally = Tally()
    simulate(model, seed, tally)
    area, count = tally.moments["real_contact_area"], tally.moments["junction_count"]
    return {
        "area_mean": area.mean,
        "area_std": area.std,
        "area_skewness": area.skewness,
        "area_excess_kurtosis": area.excess_kurtosis,
        "junction_count_mean": count.mean,
    }


def expected(model: Model) -> Figures:
    """Return what theory says about the same figures."""
    area = area_cumulants(model)
    return {
        "area_mean": area.mean,
        "area_std": area.std,
        "area_skewness": area.skewness,
        "area_excess_kurtosis": area.excess_kurtosis,
        "junction_count_mean": mean_count(model),
    }


def errors_of(model: Model) -> Figures:
    """Return the standard errors of the same figures over the model's ticks."""
    area: StandardErrors = standard_errors(model)
    return {
        "area_mean": area.mean,
        "area_std": area.std,
        "area_skewness": area.skewness,
        "area_excess_kurtosis": area.excess_kurtosis,
        "junction_count_mean": mean_count_error(model),
    }


def scores(seen: Figures, values: Figures, errors: Figures) -> Figures:
    """Return the distance of each figure from its value, in standard errors."""
    return {name: (seen[name] - values[name]) / errors[name] for name in values}


def outside(found: Figures, bound: float = BOUND) -> Figures:
    """Return the scores beyond a bound: empty when all is well."""
    return {name: z for name, z in found.items() if abs(z) > bound}


def mean_score(values: list[float], value: float, error: float) -> float:
    """Return the score of the mean of independent values, each with a standard error."""
    return (sum(values) / len(values) - value) / (error / sqrt(len(values)))
