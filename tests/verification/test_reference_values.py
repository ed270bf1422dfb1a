"""The theory against values computed elsewhere with 20 to 30 digits."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rubnoise.contact.overlap import life_integral
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants, force_cumulants
from rubnoise.theory.occupancy import length_biased_mean_diameter, mean_count
from rubnoise.theory.response import response
from rubnoise.theory.spectrum import density_at_zero, spectral_density
from tests.unit.theory_models import paper_model

REFERENCE = Path(__file__).parent.parent / "reference"


def read(name: str) -> dict[str, Any]:
    return json.loads((REFERENCE / name).read_text())


def of(row: dict[str, Any]) -> Model:
    return paper_model(
        row["mean_real_contact_area_input"],
        row["mean_junction_count_input"],
        row["diameter_std"],
        row["calibration"],
        slider=None,
    )


def label(row: dict[str, Any]) -> str:
    keys = ("calibration", "mean_real_contact_area_input", "mean_junction_count_input", "diameter_std")
    return "-".join(f"{row[key]}" for key in keys)


MOMENT_ROWS = read("moments.json")["rows"]
SPECTRUM_ROWS = read("spectrum.json")["rows"]


@pytest.mark.parametrize("row", MOMENT_ROWS, ids=label)
def test_moments_of_area_and_count(row: dict[str, Any]) -> None:
    model = of(row)
    area = area_cumulants(model)
    found = {
        "mean_diameter_calibrated": model.calibrated_diameter,
        "mean_life_distance": model.mean_life_distance,
        "mean_birth_spacing": model.mean_birth_spacing,
        "junction_count_mean": mean_count(model),
        "area_mean": area.mean,
        "area_std": area.std,
        "area_skewness": area.skewness,
        "area_excess_kurtosis": area.excess_kurtosis,
        "length_biased_mean_diameter": length_biased_mean_diameter(model),
    }
    assert found == pytest.approx({key: row[key] for key in found}, rel=1e-12)


def test_every_row_is_there_and_two_of_them_redraw() -> None:
    assert len(MOMENT_ROWS) >= 27
    assert sum(row["diameter_std"] > 0.5 * row["mean_diameter_calibrated"] for row in MOMENT_ROWS) == 2


@pytest.mark.parametrize("power", range(1, 7))
def test_life_integrals(power: int) -> None:
    assert life_integral(power) == pytest.approx(float(read("pulse.json")["c"][str(power)]), rel=1e-15)


@pytest.mark.parametrize("row", SPECTRUM_ROWS, ids=label)
def test_spectral_density(row: dict[str, Any]) -> None:
    found = spectral_density(of(row), row["wavenumber_rad_per_um"])
    np.testing.assert_allclose(found, row["spectral_density_um4_per_rad_per_um"], rtol=1e-12)


@pytest.mark.parametrize(("mean_count_", "density"), [(10, 65_651), (20, 23_438), (50, 6_103)])
def test_spectral_density_at_zero(mean_count_: float, density: float) -> None:
    assert density_at_zero(paper_model(mean_count=mean_count_)) == pytest.approx(density, abs=0.5)


def test_slider_of_figure_5() -> None:
    model = paper_model()
    found = response(model)
    assert force_cumulants(model).mean == pytest.approx(51_168.4, abs=0.05)
    assert force_cumulants(model).std == pytest.approx(14_107.34, abs=0.005)
    assert found.mean_displacement == pytest.approx(170.561, abs=0.0005)
    assert found.displacement_std == pytest.approx(195.3059, abs=0.00005)
    assert found.velocity_std == pytest.approx(47_241.1, abs=0.05)
    assert found.one_way_validity == pytest.approx(47.2411, abs=0.00005)


def test_slider_of_figure_5_at_a_hundred_times_the_speed() -> None:
    assert response(paper_model(speed=100_000.0)).displacement_std == pytest.approx(22.10, abs=0.005)
