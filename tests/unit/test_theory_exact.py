import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.births import RegularBirths
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.exact import exact
from rubnoise.theory.spectrum import spectral_density
from tests.unit.theory_models import paper_model


def test_everything_at_once() -> None:
    found = exact(paper_model())
    assert found.area.mean == pytest.approx(204.6736, abs=5e-5)
    assert found.area.std == pytest.approx(56.42936, abs=5e-6)
    assert found.count_std**2 == pytest.approx(20.0, rel=1e-12)
    assert found.count_variance == found.count_mean
    assert found.mean_diameter == pytest.approx(5.53, abs=5e-4)
    assert found.length_biased_mean_diameter > 5.53
    assert found.expected_junction_rows > found.expected_births
    assert found.force is not None
    assert found.force.mean == pytest.approx(51_168.4, abs=0.05)
    assert found.slider is not None
    assert found.slider.one_way_validity == pytest.approx(47.24, abs=5e-3)


def test_what_is_asked_at_points_is_that_of_the_theory() -> None:
    model = paper_model()
    found = exact(model)
    points = np.array([[0.0, 0.1], [1.0, 30.0]])
    np.testing.assert_array_equal(found.spectral_density(points), spectral_density(model, points))
    np.testing.assert_array_equal(found.autocovariance(points), autocovariance(model, points))
    assert found.autocovariance(0.0) == pytest.approx(found.area.variance, rel=1e-12)
    law = found.distribution()
    assert law.cdf(found.area.mean) == pytest.approx(0.52, abs=0.02)
    assert law.atom_at_zero == pytest.approx(np.exp(-found.count_mean), rel=1e-9)


def test_regular_births_have_another_count() -> None:
    found = exact(replace(paper_model(slider=None), births=RegularBirths(mean_spacing=0.5530012551)))
    assert found.count_mean == pytest.approx(20.0, rel=1e-7)
    assert found.count_variance < 1.0


def test_no_force_without_a_strength_and_no_motion_without_a_slider() -> None:
    found = exact(replace(paper_model(), strengths=None, slider=None))
    assert found.force is None
    assert found.slider is None


@pytest.mark.parametrize("slow", ["scipy.signal", "scipy.stats", "simpy", "h5py"])
def test_the_theory_imports_nothing_slow_or_foreign(slow: str) -> None:
    code = f"import sys, rubnoise.theory.exact, rubnoise.theory.motion_errors; sys.exit({slow!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
