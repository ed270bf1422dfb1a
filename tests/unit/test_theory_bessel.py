"""Bessel functions far out, against 30 digits."""

import mpmath
import numpy as np
import pytest

from rubnoise.theory.quadrature import complementary_error
from rubnoise.theory.transform_lens import hankel_modulus, hankel_without_swing, y1

PLACES = np.array([32.0, 33.3, 40.0, 77.7, 160.0, 1e3, 12345.6, 1e6])


def exact(z: float) -> tuple[mpmath.mpf, mpmath.mpf]:
    with mpmath.workdps(30):
        return mpmath.besselj(1, mpmath.mpf(z)), mpmath.bessely(1, mpmath.mpf(z))


@pytest.mark.parametrize("z", PLACES.tolist())
def test_they_are_right_to_rounding(z: float) -> None:
    first, second = exact(z)
    with mpmath.workdps(30):
        modulus = mpmath.sqrt(first**2 + second**2)
        turned = mpmath.expj(mpmath.mpf(z)) * (second + 1j * first)
    place = np.array([z])
    assert abs(y1(place)[0] - second) < 1e-15 * modulus
    assert abs(hankel_modulus(place)[0] / modulus**2 - 1) < 1e-15
    assert abs(complex(hankel_without_swing(place)[0]) - complex(turned)) < 1e-15 * modulus


def test_shapes_are_kept() -> None:
    assert y1(PLACES.reshape(2, 4)).shape == (2, 4)
    assert hankel_without_swing(np.empty((0, 3))).shape == (0, 3)


def test_the_error_function_is_that_of_the_library() -> None:
    x = np.array([[-6.0, -0.5, 0.0], [0.1, 2.5, 27.0]])
    expected = [[float(mpmath.erfc(value)) for value in row] for row in x.tolist()]
    np.testing.assert_allclose(complementary_error(x), expected, rtol=1e-15)
    assert complementary_error(np.empty((2, 0))).shape == (2, 0)
