"""Traces made outside the package have the moments of their closed forms, and `infer` reads their options."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tools import right_traces
from tools.right_traces import Contact, trace

BOUND = 4.0
LONG = Contact(lives=1500, per_life=16, noise=0.0)


def test_the_traces_share_no_code_with_the_package() -> None:
    tree = ast.parse(Path(right_traces.__file__).read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    imported |= {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert imported == {"__future__", "argparse", "dataclasses", "pathlib", "typing", "numpy", "numpy.typing"}


@pytest.mark.parametrize(
    ("contact", "mean", "ratio"),
    [
        (LONG, 20.0 / 3.0 * 5.5**2 * 250.0, 1.2298),
        (replace(LONG, off_centre=True), 20.0 * np.pi / 16.0 * 5.5**2 * 250.0, 1.35591),
        (replace(LONG, strength_spread=0.5), 20.0 / 3.0 * 5.5**2 * 250.0, 1.2298 * np.sqrt(1.25)),
    ],
)
def test_mean_and_spread_are_those_of_campbell(contact: Contact, mean: float, ratio: float) -> None:
    """A mean of T lives has the variance S(0)/T, here at most 1.6 lives' worth of the variance itself."""
    force = trace(contact, np.random.default_rng(2))
    error = ratio / np.sqrt(20.0) * np.sqrt(1.0 / contact.lives)
    assert abs(force.mean() / mean - 1.0) <= BOUND * error
    assert abs(force.mean() / (1.3 * mean) - 1.0) > BOUND * error
    spread = float(force.std()) / float(force.mean()) * np.sqrt(20.0)
    assert abs(spread / ratio - 1.0) <= BOUND * np.sqrt(1.5 / contact.lives)


@pytest.mark.parametrize("poles", [1, 2])
def test_a_pole_takes_half_the_energy_at_its_corner_and_nothing_of_the_mean(poles: int) -> None:
    place = 2.0 * np.pi * 50.0 / 4096.0 * np.arange(4096)
    seen = right_traces.filtered(3.0 + np.sin(place), 2.0 * np.pi * 50.0 / 4096.0, poles)
    assert seen.mean() == pytest.approx(3.0)
    assert seen.std() == pytest.approx(np.sin(0.25 * np.pi) * 0.5 ** (0.5 * poles))
    late = np.sin(place - 0.25 * np.pi * poles)
    assert np.mean(late * seen) == pytest.approx(0.5 * 0.5 ** (0.5 * poles))


def test_strokes_go_to_and_fro_about_the_zero_of_the_sensor() -> None:
    contact = replace(LONG, lives=100, strokes=4, zero=0.3)
    force = trace(contact, np.random.default_rng(4)).reshape(4, -1)
    means = force[:, 200:].mean(axis=1)
    assert np.sign(means).tolist() == [1.0, -1.0, 1.0, -1.0]
    assert (means[0] + means[1]) / (means[0] - means[1]) == pytest.approx(0.3, abs=0.1)
