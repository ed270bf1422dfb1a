from dataclasses import replace
from math import isnan, pi, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import Lognormal
from rubnoise.contact.pulses import LENS, PULSES, TRIANGLE, Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory import regular_births
from rubnoise.theory.campbell import Cumulants, area_cumulants, force_cumulants
from rubnoise.theory.regular_births import spectral_lines
from rubnoise.theory.sampling import standard_errors
from tests.unit.regular_models import drawn, regular
from tests.unit.size_laws import Gamma, LogNormal
from tests.verification.seeds import seed_of

Doubles = NDArray[np.float64]

SHAPES = pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)


@pytest.mark.parametrize("count", [2, 4, 10, 20, 50, 500])
def test_rabinowicz_has_a_constant_area(count: int) -> None:
    area = area_cumulants(regular(count, pulse=TRIANGLE))
    assert area.values[1:] == (0.0,) * 5
    assert area.mean == pytest.approx(count * pi / 8.0 * 5.53**2, rel=1e-14)
    assert isnan(area.skewness)
    assert isnan(area.excess_kurtosis)


@pytest.mark.parametrize("count", [1, 3, 5, 21, 501])
def test_an_odd_number_of_triangles_leaves_a_ripple(count: int) -> None:
    """A triangle wave of period one spacing: std/mean = 1/(sqrt(3) N^2), its values uniform."""
    area = area_cumulants(regular(count, pulse=TRIANGLE))
    assert area.std / area.mean == pytest.approx(1.0 / (sqrt(3.0) * count**2), rel=1e-8)
    assert area.skewness == pytest.approx(0.0, abs=1e-8)
    assert area.excess_kurtosis == pytest.approx(-1.2, rel=1e-8)


@pytest.mark.parametrize(
    ("count", "pulse", "ripple"),
    [(2.5, TRIANGLE, 0.052), (2, LENS, 0.074), (10, LENS, 0.0038), (20, LENS, 0.000996)],
    ids=["triangle-2.5", "lens-2", "lens-10", "lens-20"],
)
def test_ripple_of_other_counts_and_of_the_lens(count: float, pulse: Pulse, ripple: float) -> None:
    area = area_cumulants(regular(count, pulse=pulse))
    assert area.std / area.mean == pytest.approx(ripple, rel=0.01)


@SHAPES
@pytest.mark.parametrize("count", [0.5, 2.5, 7.0])
def test_cumulants_of_one_size_are_those_of_a_periodic_function(count: float, pulse: Pulse) -> None:
    model = regular(count, pulse=pulse)
    phase = (np.arange(2_000_000) + 0.5) / 2_000_000 * model.births.mean
    area = sum(pulse.area(phase + j * model.births.mean, 5.53) for j in range(8))
    z = area - area.mean()
    found = area_cumulants(model)
    m = [np.mean(z**n) for n in range(7)]
    assert found.mean == pytest.approx(area.mean(), rel=1e-12)
    assert found.values[1] == pytest.approx(m[2], rel=1e-9)
    assert found.values[2] == pytest.approx(m[3], rel=1e-9, abs=1e-9 * m[2] ** 1.5)
    assert found.values[3] == pytest.approx(m[4] - 3 * m[2] ** 2, rel=1e-9, abs=1e-9 * m[2] ** 2)
    assert found.values[5] == pytest.approx(
        m[6] - 15 * m[4] * m[2] - 10 * m[3] ** 2 + 30 * m[2] ** 3, rel=1e-8, abs=1e-9 * m[2] ** 3
    )


def scores(sample: Doubles, exact: Cumulants) -> list[float]:
    """Return z of mean, variance and third central moment, their errors from the sample's own higher moments."""
    z = sample - exact.mean
    found = [
        (z, 0.0),
        (z**2, exact.variance),
        (z**3, exact.values[2]),
        (z**4, exact.values[3] + 3.0 * exact.variance**2),
    ]
    return [float((x.mean() - value) / (x.std() / np.sqrt(x.size))) for x, value in found]


@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(0.5, 0.2), (2.5, 0.2), (20.0, 0.2), (3.0, 1.5), (6.0, 6.0)])
def test_cumulants_of_many_sizes(count: float, spread: float, pulse: Pulse) -> None:
    model = replace(regular(count, spread, pulse), strengths=None)
    generator = np.random.default_rng(seed_of(f"regular cumulants {count} {spread} {pulse.shape}"))
    sample = drawn(model, [0.0], 200_000, generator)[0][0]
    assert np.abs(scores(sample, area_cumulants(model))).max() <= 4.0
    poisson = replace(model, births=PoissonBirths(mean_spacing=model.births.mean))
    assert abs(scores(sample, area_cumulants(poisson))[1]) > 20.0


@pytest.mark.parametrize("spread", [0.0, 0.2, 3.0])
def test_cumulants_of_unequal_strengths(spread: float) -> None:
    """With one strength only the mean strength would count; the lives differ by strength even where sizes do not."""
    psi = Lognormal(mean=250.0, std=75.0)
    model = replace(regular(4.0, spread, TRIANGLE), strengths=psi)
    generator = np.random.default_rng(seed_of(f"regular strengths {spread}"))
    sample = drawn(model, [0.0], 200_000, generator)[0][0]
    assert np.abs(scores(sample, force_cumulants(model))).max() <= 4.0
    scaled = Cumulants(values=tuple(250.0**n * k for n, k in enumerate(area_cumulants(model).values, start=1)))
    assert abs(scores(sample, scaled)[1]) > 20.0


def test_equal_strengths_scale_the_area() -> None:
    model = regular(3.0, 0.2)
    expected = [250.0**n * k for n, k in enumerate(area_cumulants(model).values, start=1)]
    np.testing.assert_allclose(force_cumulants(model).values, expected, rtol=1e-12)


@SHAPES
def test_a_hairline_of_spread_is_one_size(pulse: Pulse) -> None:
    equal, hairline = (area_cumulants(regular(2.5, spread, pulse)) for spread in (0.0, 5e-9))
    np.testing.assert_allclose(hairline.values, equal.values, rtol=1e-7)


@pytest.mark.parametrize("count", [1_000, 1_000_000])
@pytest.mark.parametrize("law", [LogNormal(5.53, 0.036), LogNormal(5.53, 1.0), Gamma(5.53, 1.0)], ids=repr)
def test_cumulants_grow_with_the_number_of_lives(law: LogNormal, count: int) -> None:
    """Lives that outlast many spacings leave no ripple, and given the phase they are independent."""
    few, many = (area_cumulants(regular(n, sizes=law)) for n in (count, 4 * count))
    np.testing.assert_allclose(many.values, 4.0 * np.array(few.values), rtol=1e-6)


def ripple(model: Model) -> tuple[Doubles, Doubles]:
    """Return the mean area given the phase, about its mean, and the probabilities of the phases."""
    places, probabilities = regular_births.phase_rule(model)
    found = regular_births.cumulant_ripple(model, places, (1.0,) * 7)[0]
    return found - found @ probabilities, probabilities


@pytest.mark.parametrize("count", [150.0, 160.0, 170.0])
@pytest.mark.parametrize("spread", [0.05, 0.4])
def test_old_lives_may_be_left_out_of_the_ripple(count: float, spread: float, monkeypatch: pytest.MonkeyPatch) -> None:
    model = regular(count, spread)
    windowed = ripple(model)[0]
    monkeypatch.setattr(regular_births, "_sharp_until", lambda model: 1e9)
    np.testing.assert_allclose(windowed, ripple(model)[0], atol=1e-12 * area_cumulants(model).mean)


@SHAPES
@pytest.mark.parametrize(("count", "spread"), [(0.5, 0.0), (2.5, 0.0), (20.0, 0.0), (2.5, 0.2), (20.0, 1.5)])
def test_lines_hold_what_the_phase_tells(count: float, spread: float, pulse: Pulse) -> None:
    model = regular(count, spread, pulse)
    found, probabilities = ripple(model)
    told, nothing = float(probabilities @ np.square(found)), 1e-24 * area_cumulants(model).mean ** 2
    assert 2.0 * spectral_lines(model)[1].sum() == pytest.approx(told, rel=1e-9, abs=nothing)


def test_moments_have_no_errors_here() -> None:
    with pytest.raises(Refused, match="Poisson births"):
        standard_errors(regular(2.5))


def test_poisson_births_have_no_lines() -> None:
    model = regular(2.5)
    wavenumbers, power = spectral_lines(replace(model, births=PoissonBirths(mean_spacing=model.births.mean)))
    assert wavenumbers.size == power.size == 0
