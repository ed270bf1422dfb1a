"""What the program gave before its rooms moved is what it gives: exact values, rows and motions, sweeps."""

import json
import math
from collections.abc import Mapping, Sequence
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from tests.reference.held_values import (
    HELD,
    RUNS,
    SWEEPS,
    columns_of,
    contact,
    contacts,
    exact_values,
    run_into,
    summary_of,
    sweep_values,
)

pytestmark = pytest.mark.slow

THEORY: dict[str, dict[str, list[float | None]]] = json.loads((HELD / "theory.json").read_text(encoding="utf-8"))
# Relative to the largest value of its row, as the docstrings of theory promise; moments each of its own value.
TOLERANCES = {
    "spectral_density": 1e-6,
    "distribution": 2e-5,
    "estimated_densities": 1e-5,
    "estimated_errors": 5e-3,
    "slider": 2e-8,
    "free": 1e-8,
}
BY_LARGEST = {"autocovariance", "area_from_empty", "count_from_empty", "estimated_densities"}
NOT_AT_RANDOM = {"coupling": 1e-4, "count": 1e-6}
"""Of births that are not at random, whose cumulants from the third on are not known either."""
FEW = {"bouncing": {"distribution": 3e-4, "estimated_errors": 2e-2}}
"""Of less than one live junction."""
LINES_ALONE = {"regular_fixed"}
"""What has lines alone, and between them nothing but rounding."""
ERRORS = 1e-4
"""Of figures of a run that are standard errors."""
FEEDBACK = 1e-5
"""Of the motion of a slider that pushes back, whose path depends on its steps."""
STEADY = 1e-6
"""Of a motion under a force that hardly varies: nine digits of the force leave less of the motion."""
RESIDUAL = "energy_residual"
"""What is nothing but rounding."""
OF_LATER_ROWS = {
    "two_way": ("displacement", "velocity"),
    "first_order_load": ("separation", "normal", "load", "friction"),
}
"""Figures that are of rows now, from where the start is forgotten; `compare` has them so."""


def tolerance(contact_name: str, key: str) -> float:
    """Return what a row of a contact may be off by."""
    own = FEW.get(contact_name, {}) | (NOT_AT_RANDOM if not is_at_random(contact_name) else {})
    return own.get(key, TOLERANCES.get(key, 1e-8))


def is_at_random(name: str) -> bool:
    """Return whether the births of a contact are a Poisson process, which alone has a distribution that is known."""
    return "distribution" in THEORY[name] or name == "empirical"


def rows_of(values: Mapping[str, Sequence[float | None]]) -> dict[str, list[float | None]]:
    """Return rows by what is promised of them: what Welch's method shows, and its errors."""
    rows = {key: list(row) for key, row in values.items()}
    seen = rows.pop("estimated_spectrum", [])
    return rows | {"estimated_densities": seen[:7], "estimated_errors": seen[7:]}


def differences(found: Sequence[float | None], held: Sequence[float | None], name: str, allowed: float = 1e-8) -> float:
    """Return the largest difference over what the row's tolerance allows; of what is nan in one alone, infinity."""
    assert len(found) == len(held), name
    pairs = [(nan if a is None else a, b) for a, b in zip(found, held, strict=True) if b is not None]
    if any(math.isnan(a) for a, _ in pairs):
        return math.inf
    scale = max((abs(b) for _, b in pairs), default=1.0)
    bounds = [allowed * (scale if name in BY_LARGEST else abs(b)) + 1e-12 * scale for _, b in pairs]
    return max(
        (abs(a - b) / bound if bound else math.inf * (a != b) for (a, b), bound in zip(pairs, bounds, strict=True)),
        default=0.0,
    )


@pytest.mark.parametrize("name", contacts())
def test_theory_says_what_it_said(name: str) -> None:
    found, held = rows_of(exact_values(contact(name))), rows_of(THEORY[name])
    for key in ("area", "force"):
        if key in held and not is_at_random(name):
            assert np.isnan(np.asarray(found[key][2:], dtype=float)).all()
            held[key][2:] = [None] * 4
    if name in LINES_ALONE:
        held["estimated_densities"] = [None] * 7
    worst = {key: differences(found.get(key, []), row, key, tolerance(name, key)) for key, row in held.items()}
    assert not {key: ratio for key, ratio in worst.items() if ratio > 1.0}


def test_a_difference_would_be_noticed() -> None:
    row = THEORY["paper_fig5"]["area"]
    assert differences([each * (1.0 + 2e-8) for each in row if each is not None], row, "area") > 1.0
    assert differences([nan, *row[1:]], row, "area") == math.inf
    assert differences([each for each in row if each is not None], row, "area") == 0.0


def farthest(found: np.ndarray[Any, Any], held: np.ndarray[Any, Any]) -> float:
    """Return the largest difference over the largest value; infinity where whole numbers or lengths differ."""
    if found.shape != held.shape:
        return math.inf
    if held.dtype.kind in "iu":
        return math.inf * bool(np.any(found != held)) if np.any(found != held) else 0.0
    scale = float(np.max(np.abs(held), initial=0.0)) or 1.0
    return float(np.max(np.abs(found - held), initial=0.0)) / scale


def assert_like(
    found: Mapping[str, float], held: Mapping[str, float], allowed: float, later: Sequence[str] = ()
) -> None:
    """Check that figures are those that were; errors are less sharp, and of regular births no shape is known now."""
    gone = held.keys() - found.keys()
    assert gone <= {"real_contact_area_skewness_exact", "real_contact_area_excess_kurtosis_exact"}
    assert found.keys() <= held.keys()
    for name, value in held.items():
        if name == RESIDUAL:
            assert abs(found[name]) < 1e-9
        elif name not in gone and not name.startswith(tuple(later)) and not math.isnan(found[name]):
            assert found[name] == pytest.approx(value, rel=ERRORS if name.endswith("_error") else allowed), name


@pytest.mark.parametrize("name", RUNS)
def test_runs_give_what_they_gave(name: str, tmp_path: Path) -> None:
    path = run_into(tmp_path / "x.h5", name)
    found, held = columns_of(path), columns_of(HELD / f"{name}.h5")
    assert found.keys() == held.keys()
    moves = FEEDBACK if "slider/distance" in held else STEADY if name == "regular" else 1e-10
    allowed = {column: moves if column.startswith("slider/") else 1e-10 for column in held}
    assert {column: far for column in held if (far := farthest(found[column], held[column])) > allowed[column]} == {}
    figures, before = summary_of(path), summary_of(HELD / f"{name}.h5")
    assert_like(figures, before, max(moves, 1e-8), OF_LATER_ROWS.get(name.removesuffix("_gzip"), ()))


def test_another_seed_would_be_noticed(tmp_path: Path) -> None:
    run_into(path := tmp_path / "x.h5", "regular")
    rubnoise.run(rubnoise.open(path).scenario, other := tmp_path / "y.h5", seed=2).close()
    found, held = columns_of(other), columns_of(HELD / "regular.h5")
    assert farthest(found["trace/real_contact_area"], held["trace/real_contact_area"]) > 1e-3


@pytest.mark.parametrize("name", SWEEPS)
def test_sweeps_have_the_ids_seeds_and_figures_they_had(name: str, tmp_path: Path) -> None:
    found, held = sweep_values(name, tmp_path / "sweep"), json.loads((HELD / "sweeps.json").read_text())[name]
    assert {run: seed for run, (seed, _) in found.items()} == {run: seed for run, (seed, _) in held.items()}
    for run, (_, figures) in held.items():
        assert_like(found[run][1], figures, STEADY if name == "births" else 1e-8)
