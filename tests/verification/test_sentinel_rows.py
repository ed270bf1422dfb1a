"""Sentinels without a tolerance to speak of: what a seed draws, and everything that follows from the rows, done again.

From birth, diameter and strength alone, by the slow references of tests/oracle and by one line of numpy for each
stream. A change of a law, a kernel, a place or a unit breaks one of these to many digits.
"""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from scipy.special import ndtri

import rubnoise
from rubnoise.api.record import Record
from tests.oracle import theta_slider
from tests.oracle.oscillator import Oscillator
from tests.oracle.slow_contact import Rows, lens_area, traces, triangle_area
from tests.verification.seeds import seed_of
from tests.verification.sentinels import AREA, COUNT, EXACT_DIAMETER, Doubles, scenario

ENGINES = ("events", "batch")
SPEED, STRENGTH, STIFFNESS = 1000.0, 250.0, 300.0
DISTANCE, TICK = 2000.0, 0.1
BLOCK = 1000
"""Births of a block."""

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
        diameter={"law": "normal", "spread": "20 %"},
        sliding={"distance": "2 mm", "speed": "1 mm/s"},
        run={"engine": engine},
        **({"output": {"tick": "0.1 um"}} | LAWS[law][1]),
    )
    return rubnoise.simulate(given, SEED)


SEED = seed_of("sentinels/rows")


def numbers(stream: int, block: int, count: int) -> Doubles:
    """Return the uniform numbers of a stream in a block, by numpy alone."""
    key, counter = np.array([SEED, stream], dtype=np.uint64), np.array([0, 0, block, 0], dtype=np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter)).random(count)


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
    motion = theta_slider.motion(slider, SPEED, record["slider"]["distance"], lives(record), start)
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
    rows.birth[alive] += 1e-3
    assert abs(traces(alive_at(rows, place), [place], lens_area)[0] - area) > 1e-6
