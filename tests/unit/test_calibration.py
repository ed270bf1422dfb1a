"""The three calibrations, and where one of them has no answer."""

import pytest

from rubnoise.contact.calibration import NoMatchingDiameter, Spread, calibrated_diameter, sizes_for

FIG5 = Spread(absolute=0.2)


@pytest.mark.parametrize(
    ("calibration", "diameter"), [("paper", 5.53001263609331), ("exact", 5.47722557505166), ("matched", 5.46626015)]
)
def test_diameters_of_fig_5(calibration, diameter):
    assert calibrated_diameter(calibration, 200.0, 20.0, FIG5) == pytest.approx(diameter, rel=2e-9)


@pytest.mark.parametrize("spread", [FIG5, Spread(relative=0.3), Spread(relative=2.0), Spread(), Spread(absolute=2.4)])
def test_matched_meets_the_mean_area(spread):
    diameter = calibrated_diameter("matched", 200.0, 20.0, spread)
    assert 20.0 / 3.0 * sizes_for(diameter, spread).moment(3) / diameter == pytest.approx(200.0, rel=1e-13)


def test_matched_takes_the_larger_root():
    diameter = calibrated_diameter("matched", 100.0, 20.0, Spread(absolute=1.5))
    assert diameter > 0.887855 * 1.5


def test_no_match_below_the_least_mean_area():
    least = 1.609247 * 20.0 * 0.2**2
    assert calibrated_diameter("matched", least * 1.0001, 20.0, FIG5) == pytest.approx(0.887855 * 0.2, rel=0.03)
    with pytest.raises(NoMatchingDiameter, match=r"1\.609247 N_jm spread\^2 = 1\.2874") as refusal:
        calibrated_diameter("matched", least * 0.9999, 20.0, FIG5)
    assert refusal.value.minimum == pytest.approx(least, rel=1e-6)
