"""Deviates by inversion against a library's special functions, and their moments against theory."""

import sys

import mpmath
import numpy as np
import pytest
from scipy import special

from rubnoise.contact import deviates, plain_deviates
from rubnoise.contact.deviates import antilogarithm, exponential, logarithm, normal_above, normal_quantile

COUNT = 200_000
UNIFORM = np.random.default_rng(20).random(COUNT)


def test_logarithm_is_right_to_the_last_bits():
    x = np.concatenate([UNIFORM[UNIFORM > 0], 1.0 - 2.0**-53 * np.arange(1, 100), 2.0 ** -np.arange(1.0, 1000.0)])
    assert np.abs(logarithm(x) / np.log(x) - 1.0).max() < 5e-16


def test_numpy_has_the_bits_of_the_compiled_functions():
    """What counts the births of a run need not load the compiler for it."""
    tails = [10.0 ** -np.linspace(0.5, 300, 5000), 1.0 - 2.0**-53 * np.arange(1, 100)]
    numbers = np.concatenate([UNIFORM[UNIFORM > 0.0], *tails, 0.5 + 2.0 ** -np.arange(2.0, 50.0)])
    assert plain_deviates.logarithms(numbers).tobytes() == logarithm(numbers).tobytes()
    assert plain_deviates.normal_quantiles(numbers).tobytes() == normal_quantile(numbers).tobytes()
    assert plain_deviates.logarithms(numbers[:0]).size == plain_deviates.normal_quantiles(numbers[:0]).size == 0


@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_without_the_compiler_arrays_of_any_shape_come_back(shape: tuple[int, ...], monkeypatch: pytest.MonkeyPatch):
    numbers = UNIFORM[: np.prod(shape, dtype=int)].reshape(shape)
    compiled = logarithm(numbers), normal_quantile(numbers), exponential(numbers)
    monkeypatch.setattr(deviates, "_has_compiler", lambda: False)
    monkeypatch.setitem(sys.modules, "rubnoise.contact.compiled_deviates", None)  # not to be imported
    plain = logarithm(numbers), normal_quantile(numbers), exponential(numbers)
    assert [(each.shape, each.tobytes()) for each in plain] == [(each.shape, each.tobytes()) for each in compiled]


def test_antilogarithm_is_right_to_the_last_bit():
    x = np.concatenate([np.linspace(-708.0, 709.0, 3001), UNIFORM[:3000] - 0.5, 1e-9 * UNIFORM[:100]])
    with mpmath.workdps(30):
        errors = [
            float(mpmath.mpf(y) / mpmath.exp(v) - 1) for v, y in zip(x.tolist(), antilogarithm(x).tolist(), strict=True)
        ]
    assert max(map(abs, errors)) < 2.0**-52


def test_antilogarithm_undoes_the_logarithm_and_ends_where_doubles_do():
    x = np.array([1e-300, 0.3, 1.0, 7.0, 1e300])
    assert antilogarithm(logarithm(x)) == pytest.approx(x, rel=2e-13)
    assert antilogarithm(np.array([0.0])).tolist() == [1.0]
    tiny = antilogarithm(np.array([-708.0, -1e4]))
    assert tiny[0] == tiny[1] > 0.0


def test_normal_quantile_follows_the_library_into_both_tails():
    p = np.concatenate([UNIFORM, 10.0 ** -np.linspace(0.5, 300, 5000), 1.0 - 10.0 ** -np.linspace(0.5, 15.9, 5000)])
    expected = special.ndtri(p)
    assert np.abs(normal_quantile(p) - expected).max() < 1e-13
    assert np.abs(normal_quantile(p) / expected - 1.0)[np.abs(expected) > 1e-3].max() < 1e-14


@pytest.mark.parametrize(("power", "moment", "variance"), [(1, 1.0, 1.0), (2, 2.0, 20.0), (3, 6.0, 684.0)])
def test_exponential_moments(power, moment, variance):
    z = (np.mean(exponential(UNIFORM) ** power) - moment) / np.sqrt(variance / COUNT)
    assert abs(z) <= 4


def test_a_one_percent_longer_gap_would_be_seen():
    z = (np.mean(1.01 * exponential(UNIFORM)) - 1.0) / np.sqrt(1.0 / COUNT)
    assert abs(z) > 4


def test_uniform_ends_give_finite_deviates():
    ends = np.array([0.0, 1.0 - 2.0**-53])
    assert np.all(np.isfinite(exponential(ends)))
    assert np.all(np.isfinite(normal_above(ends, 1.0)))


def test_normal_above_lies_above_its_bound():
    bound = -0.5
    assert normal_above(UNIFORM, float(special.ndtr(-bound))).min() >= bound - 1e-12
