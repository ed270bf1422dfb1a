"""Gamma deviates against their distribution function at 30 digits, and against finer pieces of themselves."""

import mpmath
import numpy as np
import pytest

from rubnoise.contact import deviates as module
from rubnoise.contact.deviates import density_at_the_mean, gamma_deviates, likely_range, normal_above

UNIFORM = np.concatenate([np.random.default_rng(4).random(60), [0.0, 2.0**-53, 1e-6, 0.5, 1.0 - 2.0**-53]])
SHAPES = ["0.1111111", "0.5", "1", "2", "7.3", "123.25"]


def relative_errors(shape):
    """Return how far deviates are from the quantile, by one Newton step at 30 digits."""
    for z, deviate in zip(normal_above(UNIFORM, 1.0).tolist(), gamma_deviates(UNIFORM, shape).tolist(), strict=True):
        x = shape * mpmath.mpf(deviate)
        if z < 0.0:
            off = mpmath.gammainc(shape, 0, x, regularized=True) - mpmath.ncdf(z)
        else:
            off = mpmath.ncdf(-z) - mpmath.gammainc(shape, x, mpmath.inf, regularized=True)
        height = mpmath.exp(shape * mpmath.log(x) - x - mpmath.loggamma(shape))
        yield float(off / height) / (1.0 + abs(float(mpmath.log(deviate))))


@pytest.mark.parametrize("shape", SHAPES)
def test_deviates_invert_the_distribution_function(shape):
    with mpmath.workdps(30):
        assert max(map(abs, relative_errors(mpmath.mpf(shape)))) < 1e-15


@pytest.mark.parametrize("shape", ["0.1111111", "25", "1e20"])
def test_finer_pieces_and_more_terms_change_nothing_but_rounding(shape, monkeypatch):
    as_is = gamma_deviates(UNIFORM, mpmath.mpf(shape))
    module._table.cache_clear()
    for name, value in {"_PIECES_PER_UNIT": 16, "_REACH": 136, "_TERMS_KEPT": 15, "_TERMS_STEPPED": 44}.items():
        monkeypatch.setattr(module, name, value)
    finer = gamma_deviates(UNIFORM, mpmath.mpf(shape))
    module._table.cache_clear()
    assert np.max(np.abs(finer / as_is - 1.0) / (1.0 + np.abs(np.log(as_is)))) < 5e-16


def test_too_few_terms_would_be_seen(monkeypatch):
    module._table.cache_clear()
    monkeypatch.setattr(module, "_TERMS_STEPPED", 14)
    with mpmath.workdps(30):
        worst = max(map(abs, relative_errors(mpmath.mpf("0.1111111"))))
    module._table.cache_clear()
    assert worst > 1e-15


@pytest.mark.parametrize("shape", [0.2, 1.0, 40.0])
def test_hardly_anything_lies_beyond_the_likely_range(shape):
    low, high = likely_range(mpmath.mpf(shape))
    below = mpmath.gammainc(shape, 0, shape * low, regularized=True)
    above = mpmath.gammainc(shape, shape * high, mpmath.inf, regularized=True)
    assert 1e-20 < below <= 5e-17
    assert 1e-20 < above <= 5e-17


def test_the_density_at_the_mean_of_the_exponential_law_is_one_over_e():
    assert float(density_at_the_mean(mpmath.mpf(1))) == pytest.approx(np.exp(-1.0), rel=1e-15)
