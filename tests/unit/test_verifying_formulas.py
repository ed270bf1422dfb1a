"""The formulas that results are verified by: against quadrature, against the simulation's own, and on their own."""

import ast
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis.verifying import sums
from rubnoise.analysis.verifying.contact import FORMULA
from rubnoise.analysis.verifying.findings import Notes
from rubnoise.analysis.verifying.slider import cell_motion
from rubnoise.analysis.verifying.sums import add_areas, force_moments, lens_fraction
from rubnoise.contact.pulses import LENS, TRIANGLE, Pulse
from rubnoise.model import Slider
from rubnoise.simulation.slider import propagator
from rubnoise.theory.quadrature import panels

FOLDER = Path(sums.__file__).parent
MADE_AGAIN = "regenerating.py"
LIVES = {
    "inside": (1.3, 2.0, 5.3),
    "within a cell": (1.02, 0.04, 1.10),
    "at edges": (1.0, 1.5, 4.0),
    "born before": (-3.3, 2.0, 0.7),
    "dies after": (7.7, 2.5, 12.7),
    "ended early, rising": (2.05, 2.0, 3.333),
    "ended early, falling": (2.05, 2.0, 5.21),
    "over before": (-5.0, 2.0, -1.0),
    "born at the end": (8.0, 2.0, 12.0),
}


WAYS = {"closed forms": np.inf, "quadrature": 0.0}
"""From how many cells a diameter on which way to the moments is taken."""

QUADRATURE = 1e-7
"""What six nodes leave of moments over cells of an eighth of a diameter; they are for narrower ones."""


def rounding(d: float, width: float) -> NDArray[np.float64]:
    """Return what differences of integrals over a whole life lose of moments over a cell, per unit of strength."""
    return 2.0**-48 * d**3 * (d / width) ** np.arange(3.0)[:, None]


def moments_by_quadrature(pulse: Pulse, edges: NDArray[np.float64], life: tuple[float, float, float]):
    birth, d, death = life
    found = np.zeros((3, edges.size - 1))
    for cell, (low, high) in enumerate(pairwise(edges)):
        inside = [each for each in (birth, birth + d, death) if low < each < high]
        s, weights = panels(np.array([low, *inside, high]), 60, rooted=True)
        area = np.where((s >= birth) & (s < death), pulse.area(s - birth, d), 0.0)
        y = 2.0 * (s - low) / (high - low) - 1.0
        found[:, cell] = [(weights * area * shape).sum() for shape in (np.ones_like(y), y, 1.5 * y * y - 0.5)]
    return found


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("pulse", [LENS, TRIANGLE], ids=lambda pulse: pulse.shape)
@pytest.mark.parametrize("name", LIVES)
def test_moments_of_a_life_are_those_of_its_area(
    monkeypatch: pytest.MonkeyPatch, name: str, pulse: Pulse, way: str
) -> None:
    monkeypatch.setattr(sums, "NARROW", WAYS[way])
    birth, d, death = LIVES[name]
    edges = np.linspace(0.0, 8.0, 33)
    shapes = tuple(np.array([value]) for value in (birth, d, death, 250.0))
    found = force_moments(pulse, edges, 0.25, shapes)
    right = 250.0 * moments_by_quadrature(pulse, edges, LIVES[name])
    assert (
        np.abs(found - right)
        < 250.0 * (QUADRATURE if way == "quadrature" and pulse is LENS else rounding(max(d, 1.0), 0.25))
    ).all()
    assert (np.abs(found).max() > 0.0) == (name not in {"over before", "born at the end"})


def test_closed_forms_and_quadrature_agree_on_narrow_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    edges = np.linspace(0.0, 0.5, 101)
    shapes = tuple(np.array(values) for values in ([-9.9, -5.0, 0.1], [5.0] * 3, [0.1, 5.0, 10.1], [1.0, 2.0, 3.0]))
    found = []
    for narrow in WAYS.values():
        monkeypatch.setattr(sums, "NARROW", narrow)
        found.append(force_moments(LENS, edges, 0.005, shapes))
    closed, fine = found
    assert (np.abs(closed - fine) < 6.0 * rounding(5.0, 0.005)).all()
    assert (np.abs(fine).max(axis=1) > 1e3 * rounding(5.0, 0.005)[:, 0]).tolist() == [True, True, False]


def test_an_area_keeps_its_digits_at_birth_and_death() -> None:
    import mpmath

    def exact(u: float) -> float:
        with mpmath.workdps(40):
            x = 1 - mpmath.mpf(u)
            return float((mpmath.acos(x) - x * mpmath.sqrt(1 - x * x)) / 2)

    worst = max(abs(lens_fraction(u) - exact(u)) for u in (0.0, 1e-16, 1e-12, 1e-7, 1e-3, 0.1, 0.5, 0.9, 1.0))
    assert worst < FORMULA / 8.0


@pytest.mark.parametrize("pulse", [LENS, TRIANGLE], ids=lambda pulse: pulse.shape)
def test_areas_and_forces_are_those_of_the_pulse(pulse: Pulse) -> None:
    ticks, area, force = np.linspace(0.0, 10.0, 1001), np.zeros(1001), np.zeros(1001)
    birth, d, psi = np.array([1.0, 2.5]), np.array([2.0, 3.0]), np.array([10.0, 20.0])
    lives = (np.searchsorted(ticks, birth), np.searchsorted(ticks, birth + 2.0 * d))
    add_areas(pulse, ticks, lives, (birth, d, psi), area, force)
    each = [pulse.area(ticks - b, size) * (ticks >= b) for b, size in zip(birth, d, strict=True)]
    assert np.abs(area - sum(each)).max() < 1e-7
    assert np.abs(force - (10.0 * each[0] + 20.0 * each[1])).max() < 1e-6


@pytest.mark.parametrize("damping", [0.0, 0.05, 2.0 * (0.005 * 300.0) ** 0.5, 50.0, 5e3])
@pytest.mark.parametrize("width", [1e-4, 0.1, 5.0])
def test_a_step_of_the_slider_is_that_of_another_derivation(damping: float, width: float) -> None:
    slider = Slider(mass=0.005, stiffness=300.0, damping=damping)
    found, right = cell_motion(slider, 1000.0, width), propagator(slider, 1000.0, width)
    assert np.abs(found.free - np.eye(2) - right.transition)[0, 0] < 1e-14
    assert np.allclose(found.free - np.eye(2), right.transition, rtol=1e-9, atol=1e-14)
    largest = np.abs(right.gains).max(axis=1, keepdims=True)
    assert (np.abs(found.gains - right.gains) < 1e-13 * largest).all()


def test_all_but_blocks_made_again_share_nothing_with_the_simulation() -> None:
    used = {path.name: simulation_modules(path.read_text(encoding="utf-8")) for path in FOLDER.glob("*.py")}
    assert "rubnoise.simulation.run" in used.pop(MADE_AGAIN)
    # The constants of the slider's step stand in the file as attributes, to the last bit: they are made again as well.
    assert used.pop("attributes.py") == {"rubnoise.simulation.run"}
    assert not set().union(*used.values())


def simulation_modules(text: str) -> set[str]:
    named = {node.module or "" for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)}
    return {name for name in named if name.startswith("rubnoise.simulation")}


def test_notes_keep_the_first_row_that_differs_and_count_all() -> None:
    notes = Notes("ticks")
    notes.equal("/a", 100, np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.5, 3.5]))
    notes.near("/b", 7, np.array([1.0, np.nan]), np.array([1.0, 1.0]), 0.1)
    check = notes.check()
    assert (check.values, check.different, check.holds) == (5, 3, False)
    assert str(check.first) == "/b row 8 is nan, should be 1.0, give or take 0.1"


def test_notes_tell_zeros_of_both_signs_apart() -> None:
    notes = Notes("births")
    notes.equal("/a", 0, np.array([0.0, np.nan]), np.array([-0.0, np.nan]))
    assert str(notes.check().first) == "/a row 0 is 0.0, should be -0.0"
    assert notes.check().different == 1


def test_notes_of_what_has_no_row_come_first() -> None:
    notes = Notes("origin")
    notes.equal("/a", 0, np.array([1]), np.array([2]))
    notes.say("/provenance seed", found=1, expected=2)
    assert str(notes.check().first) == "/provenance seed is 1, should be 2"
