"""Sentinels: a few long runs that between them notice every statistical fault of `tools/mutants.py` at z = 8 and more.

Each is long enough for that, not for the last word on a figure; the laws themselves are examined in the other files of
this folder. What each sentinel has to reject is tried by `tools/mutants.py`, and once here.
"""

from functools import cache
from math import pi, sqrt

import numpy as np
import pytest

import rubnoise
from rubnoise.scenario import Scenario
from rubnoise.theory.occupancy import mean_count_error
from rubnoise.theory.sampling import standard_errors
from tests.verification.scores import Figures, outside
from tests.verification.seeds import seed_of
from tests.verification.sentinels import (
    AREA,
    COUNT,
    EXACT_DIAMETER,
    PAPER_DIAMETER,
    Doubles,
    Positive,
    correlation,
    judge,
    record,
    scenario,
)

SEEN = 8.0
STARTS = 600
BLOCK = 1000
"""Births of a block."""


# Two million junctions of one size: births, live count and area.


def one_size() -> Scenario:
    return scenario(sliding={"distance": "1.1 m"}, output={"tick": "2.5 um"})


def one_size_scores(rate: float = 1.0) -> Figures:
    """Return the scores of births, count and area; ``rate`` is the factor on the births that are expected."""
    rows, trace = record("one size", one_size)["junctions"], record("one size", one_size)["trace"]
    model = one_size().model()
    errors = standard_errors(model)
    spacing = 2.0 * EXACT_DIAMETER / COUNT / rate
    births = rows["birth_distance"][rows["birth_distance"] >= 0.0]
    gaps = np.diff(births)
    expected = 1.1e6 / spacing
    # Moments of the lens: std over mean is (3/2) sqrt((2 pi/3 - 64/45)/N) for equal sizes.
    std = 1.5 * AREA * sqrt((2.0 * pi / 3.0 - 64.0 / 45.0) / COUNT)
    area = trace["real_contact_area"]
    return {
        "birth count": (births.size - expected) / sqrt(expected),
        "gap mean": (gaps.mean() / spacing - 1.0) * sqrt(gaps.size),
        "gap std": (gaps.std() / spacing - 1.0) * sqrt(gaps.size / 2.0),
        "junction count mean": (trace["junction_count"].mean() - COUNT) / mean_count_error(model),
        "real contact area mean": (area.mean() - AREA) / errors.mean,
        "real contact area std": (area.std() - std) / errors.std,
    }


def test_births_count_and_area_of_one_size() -> None:
    judge(one_size_scores())


def test_one_per_cent_in_the_births_would_be_seen() -> None:
    assert abs(one_size_scores(rate=1.01)["birth count"]) > SEEN


# Sizes as they are born, with a spread that is a length, a part of the mean, and more than the mean.

SPREADS = {
    "0.2 um": Positive(mean=PAPER_DIAMETER, std=0.2),
    "20 %": Positive(mean=PAPER_DIAMETER, std=0.2 * PAPER_DIAMETER),
    "120 %": Positive(mean=PAPER_DIAMETER, std=1.2 * PAPER_DIAMETER),
}


def spread_sizes(spread: str, distance: str = "0.11 m", tick: str = "10 um") -> Scenario:
    """Return sizes with a spread, calibrated as in the paper, with strengths that differ."""
    return scenario(
        interface={"calibration": "paper"},
        diameter={"law": "normal", "spread": spread},
        strength={"mean": "250 MPa", "law": "lognormal", "spread": "60 %"},
        sliding={"distance": distance},
        output={"tick": tick},
    )


def born(spread: str, column: str = "diameter") -> Doubles:
    rows = record(f"sizes/{spread}", SIZES[spread])["junctions"]
    return rows[column][rows["birth_distance"] >= 0.0]


SIZES = {spread: (lambda spread=spread: spread_sizes(spread)) for spread in SPREADS}


@pytest.mark.parametrize("spread", SPREADS)
def test_diameters_of_newborns(spread: str) -> None:
    found = SPREADS[spread].scores(born(spread))
    judge({f"diameter {name}": z for name, z in found.items()})


def test_five_per_cent_in_the_spread_would_be_seen() -> None:
    wider = Positive(mean=PAPER_DIAMETER, std=0.2 * 1.05)
    assert wider.scores(born("0.2 um"))["std"] < -SEEN


# Who is found alive at the start, over many seeds.


@cache
def starts() -> list[tuple[Doubles, Doubles]]:
    """Return diameters and ages over life of those alive at the start, for many seeds."""
    given = spread_sizes("120 %", distance="0.1 um", tick="0.1 um")
    seeds = range(seed_of("sentinels/starts"), seed_of("sentinels/starts") + STARTS)
    runs = (rubnoise.simulate(given, seed)["junctions"] for seed in seeds)
    born_before = ((rows["birth_distance"], rows["diameter"]) for rows in runs)
    return [(d[birth < 0.0], -birth[birth < 0.0] / (2.0 * d[birth < 0.0])) for birth, d in born_before]


def start_scores(law: Positive) -> Figures:
    """Return the scores of number, sizes and ages at the start against those of a law of sizes."""
    numbers = np.array([diameter.size for diameter, _ in starts()], dtype=float)
    first, second, third = (law.moment(n) for n in (1, 2, 3))
    mean = COUNT * first / PAPER_DIAMETER
    found = {
        "number mean": (numbers.mean() - mean) / sqrt(mean / STARTS),
        # Of a Poisson number, the variance of the sample variance over mean^2 is (2 + 1/mean)/n.
        "number variance": (numbers.var(ddof=1) / mean - 1.0) / sqrt((2.0 + 1.0 / mean) / STARTS),
    }
    diameters, ages = (np.concatenate(values) for values in zip(*starts(), strict=True))
    if diameters.size:
        biased = second / first
        found |= {
            "diameter": (diameters.mean() - biased) / sqrt((third / first - biased**2) / diameters.size),
            "age": (ages.mean() - 0.5) * sqrt(12.0 * diameters.size),
        }
    return found


def test_who_is_alive_at_the_start() -> None:
    judge(start_scores(SPREADS["120 %"]))


def test_five_per_cent_in_the_sizes_at_the_start_would_be_seen() -> None:
    law = SPREADS["120 %"]
    larger = Positive(mean=1.05 * law.mean, std=1.05 * law.std)
    assert abs(start_scores(larger)["diameter"]) > SEEN


# What is drawn for one purpose, or for one block, knows nothing of any other.


def stream_scores() -> Figures:
    """Return correlations of neighbouring gaps, sizes and strengths, and of those a block apart."""
    gaps = np.diff(born("20 %", "birth_distance"))
    sizes, strengths = born("20 %"), born("20 %", "shear_strength")
    found = {
        "diameter with gap after": correlation(sizes[:-1], gaps),
        "diameter with gap before": correlation(sizes[1:], gaps),
        "strength with gap after": correlation(strengths[:-1], gaps),
        "strength with diameter": correlation(strengths, sizes),
    }
    for name, values in {"gap": gaps, "diameter": sizes, "strength": strengths}.items():
        found[f"{name} with next"] = correlation(values[:-1], values[1:])
        found[f"{name} a block apart"] = correlation(values[:-BLOCK], values[BLOCK:])
    return found


def test_streams_and_blocks_are_independent() -> None:
    judge(stream_scores())


def test_a_trace_of_dependence_would_be_seen() -> None:
    sizes = born("20 %")
    leaning = sizes[1:] + 0.05 * sizes[:-1]
    assert correlation(sizes[:-1], leaning) > SEEN
    assert outside({"leaning": correlation(sizes[:-1], leaning)})
