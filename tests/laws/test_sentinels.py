"""Sentinels: a few long runs that between them notice every statistical fault."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import pi, sqrt

import numpy as np
import pytest
from scipy.special import ndtri

import rubnoise
from rubnoise.api.running import Record
from rubnoise.scenario import Scenario
from rubnoise.simulation import draws
from rubnoise.theory.sampling import standard_errors
from rubnoise.theory.second_order import count_noise
from tests.laws.scores import (
    AREA,
    COUNT,
    EXACT_DIAMETER,
    PAPER_DIAMETER,
    Doubles,
    Figures,
    Positive,
    correlation,
    judge,
    outside,
    record,
    scenario,
    seed_of,
)
from tests.oracle.sliders import Oscillator, theta_motion
from tests.oracle.slow_contact import Rows, lens_area, traces, triangle_area

# Sentinels: a few long runs that between them notice every statistical fault of `tools/mutants.py` at z = 8 and more.
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
        "junction count mean": (trace["junction_count"].mean() - COUNT) / count_noise(model).error_of_mean(),
        "real contact area mean": (area.mean() - AREA) / errors["mean"],
        "real contact area std": (area.std() - std) / errors["std"],
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


@pytest.mark.slow
def test_who_is_alive_at_the_start() -> None:
    judge(start_scores(SPREADS["120 %"]))


@pytest.mark.slow
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
        found[f"{name} a block apart"] = correlation(values[: -draws.BLOCK], values[draws.BLOCK :])
    return found


def test_streams_and_blocks_are_independent() -> None:
    judge(stream_scores())


def test_a_trace_of_dependence_would_be_seen() -> None:
    sizes = born("20 %")
    leaning = sizes[1:] + 0.05 * sizes[:-1]
    assert correlation(sizes[:-1], leaning) > SEEN
    assert outside({"leaning": correlation(sizes[:-1], leaning)})


# Sentinels without a tolerance to speak of: what a seed draws, and everything that follows from the rows, done again.
ENGINES = ("events", "batch")
SPEED, STRENGTH, STIFFNESS = 1000.0, 250.0, 300.0
DISTANCE, TICK = 2000.0, 0.1

SPREAD = 0.2
"""Standard deviation over mean of the diameters."""

FIRST_BIRTH, GAPS, DIAMETERS = 1, 2, 3
"""The second words of the keys of three streams."""

LAWS = {
    "lenses": (lens_area, {"strength": {"mean": "250 MPa"}}),
    "lenses, fine ticks": (lens_area, {"strength": {"mean": "250 MPa"}, "output": {"tick": "0.03 um"}}),
    "triangles": (triangle_area, {"strength": {"mean": "250 MPa"}, "pulse": {"shape": "triangle"}}),
    "unequal strengths": (lens_area, {"strength": {"mean": "250 MPa", "law": "lognormal", "spread": "60 %"}}),
}
SLIDER = {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"}


@cache
def run(law: str, engine: str) -> Record:
    """Return 2 mm of sliding with diameters that spread by a fifth."""
    given = scenario(
        interface={"calibration": "exact"},
        diameter={"law": "normal", "spread": "20 %"},
        sliding={"distance": "2 mm", "speed": "1 mm/s"},
        run={"engine": engine},
        **({"output": {"tick": "0.1 um"}} | LAWS[law][1]),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(draws, "BLOCK", BLOCK)
        return rubnoise.simulate(given, SEED)


SEED = seed_of("sentinels/rows")


def numbers(stream: int, block: int, count: int) -> Doubles:
    """Return the uniform numbers of a stream in a block, by numpy alone."""
    key, counter = np.array([SEED, stream], dtype=np.uint64), np.array([0, 0, block, 0], dtype=np.uint64)
    return ((np.random.Philox(key=key, counter=counter).random_raw(count) >> np.uint64(12)) + 0.5) * 2.0**-52


def newborn(record: Record, column: str) -> Doubles:
    rows = record["junctions"]
    return rows[column][~np.signbit(rows["birth_distance"])]


@pytest.mark.parametrize("engine", ENGINES)
def test_births_are_those_that_the_streams_hold(engine: str) -> None:
    birth = newborn(run("lenses", engine), "birth_distance")
    uniform = np.concatenate([numbers(FIRST_BIRTH, 0, 1), *(numbers(GAPS, block, BLOCK) for block in range(5))])
    expected = np.cumsum(-2.0 * EXACT_DIAMETER / COUNT * np.log1p(-uniform))
    assert birth.size == np.count_nonzero(expected <= DISTANCE) > 3 * BLOCK
    assert np.abs(birth - expected[: birth.size]).max() < 1e-10


@pytest.mark.parametrize("engine", ENGINES)
def test_diameters_are_those_that_the_streams_hold(engine: str) -> None:
    diameter = newborn(run("lenses", engine), "diameter")
    uniform = np.concatenate([numbers(DIAMETERS, block, BLOCK) for block in range(5)])[: diameter.size]
    # The rest of the normal law below zero, 3e-7, has moved above it.
    above = (1.0 - uniform) * (1.0 - 2.866515718791939e-07)
    expected = EXACT_DIAMETER * (1.0 - SPREAD * ndtri(above))
    assert np.abs(diameter / expected - 1.0).max() < 1e-13


@pytest.mark.parametrize("engine", ENGINES)
def test_every_life_lasts_two_diameters(engine: str) -> None:
    rows = run("lenses", engine)["junctions"]
    assert np.array_equal(rows["death_distance"], rows["birth_distance"] + 2.0 * rows["diameter"])
    assert np.array_equal(rows["life_distance"], 2.0 * rows["diameter"])
    assert np.array_equal(rows["junction"], np.arange(rows["diameter"].size))


@pytest.mark.parametrize("engine", ENGINES)
def test_every_strength_is_the_one_that_was_given(engine: str) -> None:
    assert np.all(run("lenses", engine)["junctions"]["shear_strength"] == STRENGTH)
    assert np.unique(run("unequal strengths", engine)["junctions"]["shear_strength"]).size > BLOCK


@pytest.mark.parametrize("engine", ENGINES)
def test_ticks_lie_at_multiples_of_the_tick(engine: str) -> None:
    trace = run("lenses", engine)["trace"]
    assert np.array_equal(trace["distance"], np.arange(round(DISTANCE / TICK) + 1) * TICK)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("law", LAWS)
def test_area_count_and_force_follow_from_the_rows(law: str, engine: str) -> None:
    record, area_of = run(law, engine), LAWS[law][0]
    trace = {name: column[3::97] for name, column in record["trace"].items()}
    area, count, force = rebuilt(record, trace["distance"], area_of)
    assert np.abs(trace["real_contact_area"] - area).max() < 1e-9
    assert np.array_equal(trace["junction_count"], count)
    assert np.abs(trace["friction_force"] - force).max() < 1e-6


def rebuilt(
    record: Record, distance: Doubles, area_of: Callable[[float, float], float]
) -> tuple[Doubles, Doubles, Doubles]:
    """Return area, count and force at distances from births, diameters and strengths, one junction at a time."""
    rows = lives(record)
    parts = [traces(alive_at(rows, place), [place], area_of) for place in distance.tolist()]
    area, count, force = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return area, count, force


def lives(record: Record) -> Rows:
    rows = record["junctions"]
    birth, diameter, strength = (rows[name] for name in ("birth_distance", "diameter", "shear_strength"))
    return Rows(birth=birth, diameter=diameter, strength=strength, death=birth + 2.0 * diameter)


def alive_at(rows: Rows, place: float) -> Rows:
    """Return the junctions that may be alive at a place: those near it, for a plain loop over all takes its time."""
    near = (rows.birth <= place + 1.0) & (rows.death >= place - 1.0)
    return Rows(
        birth=rows.birth[near], diameter=rows.diameter[near], strength=rows.strength[near], death=rows.death[near]
    )


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("tick", ["0.1 um", "0.03 um"])
def test_the_motion_follows_from_the_rows(tick: str, engine: str) -> None:
    """By the theta substitution, which shares no line with the slider, from where the mean force would hold it."""
    given = scenario(
        strength={"mean": "250 MPa"},
        sliding={"distance": "100 um", "speed": "1 mm/s"},
        output={"tick": tick},
        slider=SLIDER,
        run={"engine": engine},
    )
    record = rubnoise.simulate(given, SEED)
    slider = Oscillator(mass=0.005, stiffness=STIFFNESS, damping=0.05)
    start = (STRENGTH * AREA / STIFFNESS, 0.0)
    motion = theta_motion(slider, SPEED, record["slider"]["distance"], lives(record), start)
    moved = record["slider"]
    assert np.array_equal(moved["time"], moved["distance"] / SPEED)
    assert np.abs(moved["displacement"] - motion.displacement).max() < 1e-9 * np.abs(motion.displacement).max()
    assert np.abs(moved["velocity"] - motion.velocity).max() < 1e-9 * np.abs(motion.velocity).max()


def test_a_nanometre_in_one_birth_would_be_seen() -> None:
    record = run("lenses", "batch")
    rows = lives(record)
    place = float(record["trace"]["distance"][5000])
    area = traces(alive_at(rows, place), [place], lens_area)[0]
    alive = np.flatnonzero((rows.birth < place) & (rows.death > place))[3]
    birth = rows.birth.copy()  # other tests share the record
    birth[alive] += 1e-3
    moved = replace(rows, birth=birth)
    assert abs(traces(alive_at(moved, place), [place], lens_area)[0] - area) > 1e-6
