"""Powers of bands: what they add up to, and that their errors are the spread of many runs."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from rubnoise.analysis.spectra import Band, WelchSum, band_powers, hann
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.estimated_spectrum import expected_periodogram
from tests.models import bare, recorded
from tests.verification.seeds import seed_of

TICKS = 256
RUNS = 80
LENS = bare(tick=0.4, distance=2000.0)
TRIANGULAR = replace(LENS, pulse=TRIANGLE)


@cache
def bands(run: Model, name: str, runs: int = RUNS) -> list[list[Band]]:
    seeds = range(seed_of(f"bands/{name}"), seed_of(f"bands/{name}") + runs)
    _, expected = expected_periodogram(run, run.tick, hann(TICKS))
    return [_of(run, seed, expected, 6) for seed in seeds]


def _of(run: Model, seed: int, expected: np.ndarray, count: int) -> list[Band]:
    total = WelchSum(TICKS, run.tick)
    total.add(recorded(run, seed)["trace"]["real_contact_area"])
    return band_powers(run, total.spectrum(), expected, run.distance, count)


@pytest.mark.parametrize(("run", "name"), [(TRIANGULAR, "triangle"), (LENS, "lens")], ids=["triangle", "lens"])
def test_errors_are_the_spread_of_many_runs(run: Model, name: str) -> None:
    rows = bands(run, name)
    scores = np.array([[(band.observed - band.expected) / band.standard_error for band in row] for row in rows])
    assert np.abs(scores.mean(axis=0)).max() <= 4.0 / RUNS**0.5
    # A spread of 80 runs is known to 1/sqrt(160), a little worse for laws with a longer tail.
    assert np.abs(scores.std(axis=0) - 1.0).max() <= 4.0 * 1.2 / (2.0 * RUNS) ** 0.5


def test_junctions_count_in_high_bands() -> None:
    """However many its bins, a band is known no better than the number of junctions allows."""
    last = bands(LENS, "lens", runs=1)[0][-1]
    births = LENS.birth_rate * LENS.distance
    assert last.standard_error > 0.9 * last.expected / births**0.5


def test_powers_add_up_to_the_variance_that_lies_within_them() -> None:
    row = bands(LENS, "lens", runs=1)[0]
    assert sum(band.expected for band in row) < area_cumulants(LENS).variance
    assert sum(band.expected for band in row) > 0.5 * area_cumulants(LENS).variance
    assert all(one.highest < other.lowest for one, other in pairwise(row))


def test_more_bands_than_bins_are_as_many_as_there_are() -> None:
    total = WelchSum(16, 0.4)
    total.add(recorded(LENS, 1)["trace"]["real_contact_area"])
    _, expected = expected_periodogram(LENS, LENS.tick, hann(16))
    assert len(band_powers(LENS, total.spectrum(), expected, LENS.distance, 50)) == 4
    tiny = WelchSum(4, 0.4)
    tiny.add(np.ones(100))
    assert band_powers(LENS, tiny.spectrum(), np.ones(3), LENS.distance, 8) == []
