"""The vectors of eight doubles that compiled code of two-way motion works in."""

from fractions import Fraction

import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray

from rubnoise.simulation.coupled.lanes import fused, larger, load, root, smaller, spread, store, where_above

Doubles = NDArray[np.float64]
SOURCE = np.random.default_rng(3)
ONE, OTHER, THIRD = (SOURCE.normal(size=11) for _ in range(3))


@njit
def worked(one: Doubles, other: Doubles, third: Doubles, results: Doubles) -> None:
    a, b, c = load(one, 1), load(other, 2), load(third, 3)
    store(results, 0, a + b)
    store(results, 8, a - b)
    store(results, 16, a * b)
    store(results, 24, a / b)
    store(results, 32, fused(a, b, c))
    store(results, 40, root(a * a))
    store(results, 48, smaller(a, b))
    store(results, 56, larger(a, b))
    store(results, 64, where_above(a, b, c, spread(7.0)))


def test_every_operation_has_the_bits_of_single_doubles() -> None:
    results = np.full(74, np.nan)
    worked(ONE, OTHER, THIRD, results)
    a, b, c = ONE[1:9], OTHER[2:10], THIRD[3:11]
    exact = [float(Fraction(x) * Fraction(y) + Fraction(z)) for x, y, z in zip(a, b, c, strict=True)]
    expected = [
        a + b,
        a - b,
        a * b,
        a / b,
        np.array(exact),
        np.sqrt(a * a),
        np.minimum(a, b),
        np.maximum(a, b),
        np.where(a < b, c, 7.0),
    ]
    assert np.array_equal(results[:72].reshape(9, 8), expected)
    assert np.isnan(results[72:]).all()


def test_vectors_are_made_of_the_widest_instructions_there_are() -> None:
    results = np.zeros(72)
    worked(ONE, OTHER, THIRD, results)
    (assembly,) = worked.inspect_asm().values()
    if not any(register in assembly for register in ("zmm", "ymm")):
        pytest.skip("this processor has no vectors of four or eight doubles")
    assert "vaddsd" not in assembly
    assert "vmulsd" not in assembly
