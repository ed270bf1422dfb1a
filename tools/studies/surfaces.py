"""Pairs of surfaces that are slid by brute force, beside their exact theory.

A mean of the pairs has to be within four standard errors of theory, and what is known of merging lives.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi, sqrt
from typing import Final

import numpy as np
from parts import table

from rubnoise.arrays import Doubles
from rubnoise.surface.gaussian import GaussianContact
from rubnoise.surface.waves import Waves
from studies.study import Study
from tests.oracle.sliding_surfaces import patch_counts, slid

POINTS, HURST, ROLLOFF, CUTOFF = 512, 0.8, 128.0, 16.0
SHARES: Final = (0.03, 0.01, 0.003)
PAIRS: Final = 24
SEED: Final = 20_261
MERGED: Final = {0.03: 0.25, 0.01: 0.1, 0.003: 0.1}
"""How far births may be from Euler's count, since lives merge and have holes."""

HALF_OF_RAYLEIGH: Final = 1.37866
"""Half-width of the scenario's autocovariance over c, c^2 = 4 A_rm/(pi N_jm): where `theory` has it, tests hold it."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One share of the area: exact values, and means of the pairs with their standard errors."""

    share: float
    exact: dict[str, float]
    found: dict[str, tuple[float, float]]


def power() -> Doubles:
    """Return the spectrum of both surfaces, of variance 1/2."""
    f = np.fft.fftfreq(POINTS)
    q = np.hypot(f[:, None], f[None, :])
    shape = np.where((q > 0) & (q <= 1.0 / CUTOFF), np.maximum(q, 1.0 / ROLLOFF) ** (-2.0 - 2.0 * HURST), 0.0)
    return np.asarray(shape / (2.0 * shape.sum()))


def measured(contact: GaussianContact, pairs: int) -> Row:
    """Return a row from so many pairs of surfaces."""
    rng, spectrum = np.random.default_rng(SEED), power()
    kept: dict[str, list[float]] = {name: [] for name in ("area", "count", "birth_rate", "mean_life", "variance")}
    for _ in range(pairs):
        track, slider = (
            np.fft.ifft2(np.fft.fft2(rng.standard_normal((POINTS, POINTS))) * np.sqrt(spectrum) * POINTS).real
            for _ in (0, 1)
        )
        run = slid(track, slider, contact.level, POINTS)
        kept["area"].append(float(run.total.mean()))
        kept["variance"].append(float(run.total.var()))
        kept["birth_rate"].append(run.births / POINTS)
        kept["mean_life"].append(float(run.count.mean()) * POINTS / max(run.births, 1))
        kept["count"].append(float(patch_counts(track, slider, contact.level, range(0, POINTS, 16)).mean()))
    lags = np.array([contact.ensemble_covariance(s) for s in range(0, POINTS, 8)])  # the map repeats itself
    exact = {
        "area": contact.real_contact_area,
        "count": contact.junction_count,
        "birth_rate": contact.birth_rate,
        "mean_life": contact.mean_life,
        "variance": float(lags[0] - lags.mean()),
        "long": contact.relative_std * sqrt(contact.junction_count),
        "short": contact.relative_std_short * sqrt(contact.junction_count),
        "frozen": contact.frozen_share,
        "length": contact.correlation_length,
        "scenario_length": HALF_OF_RAYLEIGH * sqrt(4.0 * contact.real_contact_area / (pi * contact.junction_count)),
    }
    found = {
        name: (float(np.mean(values)), float(np.std(values, ddof=1) / sqrt(pairs))) for name, values in kept.items()
    }
    return Row(share=contact.share, exact=exact, found=found)


def faults(rows: Sequence[Row]) -> list[str]:
    """Return what theory and brute force disagree in."""
    return [words for row in rows for words in _faults(row)]


def _faults(row: Row) -> Iterator[str]:
    allowed = {"area": 0.0, "count": 0.05, "birth_rate": MERGED[row.share], "variance": 0.0}
    for name, share in allowed.items():
        exact, (found, error) = row.exact[name], row.found[name]
        if abs(found - exact) > 4.0 * error + share * exact:
            yield f"{name} at {100.0 * row.share:g} %: {found:.6g} for {exact:.6g}"


def tables(rows: Sequence[Row]) -> dict[str, str]:
    """Return the table of the page."""
    head = (
        "area",
        "N_jm, slid",
        "births per 100 points, slid",
        "std/mean times sqrt(N_jm): long, short, slid",
        "frozen share",
        "correlation length, scenario's",
    )
    return {"surfaces": table(head, map(_cells, rows))}


def _cells(row: Row) -> tuple[str, ...]:
    exact, found = row.exact, row.found
    spread = sqrt(exact["count"]) / exact["area"]
    middle = sqrt(found["variance"][0]) * spread
    error = 0.5 * middle * found["variance"][1] / found["variance"][0]
    births = [100.0 * each for each in (exact["birth_rate"], *found["birth_rate"])]
    return (
        f"{100.0 * row.share:g} %",
        f"{exact['count']:.3g}, {found['count'][0]:.3g} ± {found['count'][1]:.1g}",
        f"{births[0]:.3g}, {births[1]:.3g} ± {births[2]:.1g}",
        f"{exact['long']:.3f}, {exact['short']:.3f}, {middle:.2f} ± {error:.1g}",
        f"{100.0 * exact['frozen']:.3g} %",
        f"{exact['length']:.3g}, {exact['scenario_length']:.3g} points",
    )


def made() -> Iterator[Row]:
    """Yield a row for each share of the area."""
    waves = Waves(power(), (1.0, 1.0))
    return (measured(GaussianContact(waves, waves, share, float(POINTS**2), 1e9), PAIRS) for share in SHARES)


STUDY: Final = Study(
    about=__doc__,
    page="surfaces.md",
    data="surfaces.json",
    row=Row,
    facts={"pairs": PAIRS, "seed": SEED, "points": POINTS, "hurst": HURST, "rolloff": ROLLOFF, "cutoff": CUTOFF},
    make=made,
    faults=faults,
    tables=tables,
)
