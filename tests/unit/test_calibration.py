"""The three calibrations, and where one of them has no answer."""

import pytest

from rubnoise.contact.calibration import NoMatchingDiameter, calibrated_diameter
from rubnoise.contact.laws import Spread, law_for
from rubnoise.contact.pulses import PULSES

FIG5 = Spread(absolute=0.2)
SPREADING = ("normal", "lognormal", "gamma")


@pytest.mark.parametrize(
    ("calibration", "diameter"), [("paper", 5.53001263609331), ("exact", 5.47722557505166), ("matched", 5.46626015)]
)
def test_diameters_of_fig_5(calibration, diameter):
    assert calibrated_diameter(calibration, 200.0, 20.0, FIG5) == pytest.approx(diameter, rel=2e-9)


@pytest.mark.parametrize("pulse", list(PULSES.values()), ids=PULSES)
@pytest.mark.parametrize(
    "spread",
    [
        Spread(),
        Spread(law="exponential"),
        *(Spread(absolute=std, law=law) for law in SPREADING for std in (0.2, 1.2)),
        *(Spread(relative=ratio, law=law) for law in SPREADING for ratio in (0.0, 0.3, 2.0)),
        Spread(absolute=1.9),
    ],
    ids=str,
)
def test_matched_meets_the_mean_area(spread, pulse):
    diameter = calibrated_diameter("matched", 200.0, 20.0, spread, pulse)
    life_mean = 20.0 * float(pulse.life_mean())
    assert life_mean * law_for(diameter, spread).moment(3) / diameter == pytest.approx(200.0, rel=1e-13)


@pytest.mark.parametrize(
    ("spread", "third"),
    [
        (Spread(law="exponential"), 6.0),
        (Spread(law="gamma", relative=1.0), 6.0),
        (Spread(law="gamma", relative=0.5), 1.25 * 1.5),
        (Spread(law="lognormal", relative=0.5), 1.25**3),
    ],
    ids=str,
)
def test_a_relative_spread_has_a_closed_form(spread, third):
    """E[d^3] / d_m^3 is a number: (1 + v)(1 + 2v) for gamma, (1 + v)^3 for lognormal, v = cv^2."""
    assert calibrated_diameter("matched", 200.0, 20.0, spread) == pytest.approx((30.0 / third) ** 0.5, rel=1e-15)


@pytest.mark.parametrize(
    ("law", "turning", "least"), [("lognormal", 2.0**0.5, 27.0 / 4.0), ("gamma", 2.0**0.25, 3.0 + 2.0 * 2.0**0.5)]
)
def test_the_least_mean_area_of_each_law(law, turning, least):
    """(m^2 + s^2)^3 / m^4 is least at m = sqrt(2) s, (m^2 + s^2)(m^2 + 2 s^2) / m^2 at 2^(1/4) s."""
    spread, area = Spread(absolute=0.2, law=law), least / 3.0 * 20.0 * 0.2**2
    assert calibrated_diameter("matched", area * 1.000001, 20.0, spread) == pytest.approx(turning * 0.2, rel=3e-3)
    with pytest.raises(NoMatchingDiameter) as refusal:
        calibrated_diameter("matched", area * 0.999999, 20.0, spread)
    assert refusal.value.factor == pytest.approx(least / 3.0, rel=1e-14)


@pytest.mark.parametrize("spread", [Spread(law="exponential"), Spread(law="gamma", relative=0.5), FIG5], ids=str)
def test_exact_and_paper_take_no_notice_of_the_sizes(spread):
    assert calibrated_diameter("exact", 200.0, 20.0, spread) == pytest.approx(30.0**0.5, rel=1e-15)
    assert calibrated_diameter("paper", 200.0, 20.0, spread) == pytest.approx((10.0 / 0.327) ** 0.5, rel=1e-15)


def test_matched_takes_the_larger_root():
    diameter = calibrated_diameter("matched", 100.0, 20.0, Spread(absolute=1.5))
    assert diameter > 0.887855 * 1.5


def test_no_match_below_the_least_mean_area():
    least = 1.609247 * 20.0 * 0.2**2
    assert calibrated_diameter("matched", least * 1.0001, 20.0, FIG5) == pytest.approx(0.887855 * 0.2, rel=0.03)
    with pytest.raises(NoMatchingDiameter, match=r"1\.609247 N_jm spread\^2 = 1\.2874") as refusal:
        calibrated_diameter("matched", least * 0.9999, 20.0, FIG5)
    assert refusal.value.minimum == pytest.approx(least, rel=1e-6)
