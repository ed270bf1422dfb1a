"""What an `Exact` says of empty starts and of estimated spectra, beside runs that are made through the public door."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import welch

import rubnoise
from tests.verification.seeds import seed_of

Doubles = NDArray[np.float64]

RUNS = 300
BOUND = 4.0
PLACES = np.array([2.0, 5.0, 9.0])


def contact(**sliding: object) -> rubnoise.Scenario:
    return rubnoise.build(
        {
            "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
            "diameter": {"law": "normal", "spread": "20 %"},
            "sliding": {"distance": 10.0} | sliding,
            "output": {"tick": 0.25},
            "run": {"engine": "batch"},
        }
    )


@pytest.fixture(scope="module")
def empty() -> tuple[Doubles, Doubles]:
    """Return the area and the count of many runs that begin empty, a row a run."""
    scenario, seed = contact(start="empty"), seed_of("empty starts") % 2**50
    traces = [rubnoise.simulate(scenario, seed + n).trace for n in range(RUNS)]
    area, count = (np.stack([trace[name] for trace in traces]) for name in ("real_contact_area", "junction_count"))
    return area, count.astype(np.float64)


def scores(values: Doubles, expected: Doubles | float) -> Doubles:
    error = values.std(axis=0, ddof=1) / np.sqrt(values.shape[0])
    return np.asarray((values.mean(axis=0) - expected) / error)


def test_means_after_an_empty_start(empty: tuple[Doubles, Doubles]) -> None:
    theory, at = rubnoise.exact(contact(start="empty")), (PLACES / 0.25).astype(int)
    for values, grown, settled in (
        (empty[0], theory.area_from_empty(PLACES), theory.area.mean),
        (empty[1], theory.count_from_empty(PLACES), theory.count_mean),
    ):
        assert np.max(np.abs(scores(values[:, at], grown))) <= BOUND
        assert np.max(np.abs(scores(values[:, at], settled))) > 4.0 * BOUND


def test_the_mean_of_a_run_that_begins_empty(empty: tuple[Doubles, Doubles]) -> None:
    theory = rubnoise.exact(contact(start="empty"))
    area, count = (np.trapezoid(values, dx=0.25, axis=1) / 10.0 for values in empty)
    assert abs(scores(area, theory.expected_mean_area())) <= BOUND
    assert abs(scores(area, theory.area.mean)) > 4.0 * BOUND
    # The count steps at births and deaths: half a tick of growth is what the trapezoid may miss at the ends.
    assert abs(scores(count, theory.expected_mean_count())) <= BOUND
    assert theory.expected_mean_area(20.0) > theory.expected_mean_area()
    stationary = rubnoise.exact(contact())
    assert stationary.expected_mean_area() == stationary.area.mean
    assert stationary.expected_mean_count(3.0) == stationary.count_mean


@pytest.mark.parametrize("distance", [0.0, -1.0, float("nan"), float("inf")])
def test_a_mean_over_no_distance_is_refused(distance: float) -> None:
    with pytest.raises(rubnoise.Refused, match="the distance is a number above 0"):
        rubnoise.exact(contact()).expected_mean_area(distance)


TICKS = 64
LONG = contact(distance="10 mm", start="stationary")


@pytest.fixture(scope="module")
def estimate() -> tuple[Doubles, Doubles]:
    """Return scipy's estimate from one run, at wavenumbers in rad/um and two-sided."""
    area = rubnoise.simulate(LONG, seed_of("an estimated spectrum") % 2**50).trace["real_contact_area"][:]
    cycles, density = welch(area, fs=4.0, window="hann", nperseg=TICKS, detrend="constant")
    return 2.0 * np.pi * cycles, 0.5 * density


def test_an_estimate_is_as_expected_in_every_bin(estimate: tuple[Doubles, Doubles]) -> None:
    theory = rubnoise.exact(LONG)
    seen = theory.estimated_spectrum(TICKS)
    inner = slice(1, TICKS // 2)  # at the ends of the axis a one-sided density is not twice the two-sided one
    np.testing.assert_allclose(seen.wavenumber, estimate[0], rtol=1e-12)
    z = (estimate[1] - seen.density) / seen.standard_error
    assert seen.segments == (40_001 - TICKS) // 32 + 1
    assert np.max(np.abs(z[inner])) <= BOUND
    plain = (estimate[1] - theory.spectral_density(seen.wavenumber)) / seen.standard_error
    assert np.max(np.abs(plain[inner])) > 4.0 * BOUND


def test_a_band_of_an_estimate_is_as_expected(estimate: tuple[Doubles, Doubles]) -> None:
    seen = rubnoise.exact(LONG).estimated_spectrum(TICKS)
    for lowest, highest in ((2.0, 5.0), (6.0, 11.0)):
        bins = (seen.wavenumber >= lowest) & (seen.wavenumber <= highest)
        mean, error = seen.band(lowest, highest)
        assert mean == pytest.approx(seen.density[bins].mean(), rel=1e-12)
        assert abs(estimate[1][bins].mean() - mean) <= BOUND * error
        assert error > 1.1 * np.sqrt(np.square(seen.standard_error[bins]).sum()) / bins.sum()  # neighbours go together


def test_what_an_estimate_cannot_be_asked() -> None:
    theory = rubnoise.exact(LONG)
    seen = theory.estimated_spectrum()
    assert (seen.ticks, seen.segments) == (1230, 64)
    with pytest.raises(rubnoise.Refused, match="0 bins lie from 50 to 60 rad/um"):
        seen.band(50.0, 60.0)
    for ticks in (1, 40_002):
        with pytest.raises(rubnoise.Refused, match=f"a segment of {ticks} ticks: it has 2 to 40001"):
            theory.estimated_spectrum(ticks)
    regular = rubnoise.exact(rubnoise.build(LONG.resolved() | {"birth": {"law": "regular"}})).estimated_spectrum(TICKS)
    assert np.isnan(regular.standard_error).all()
    with pytest.raises(rubnoise.Refused, match="known for Poisson births alone"):
        regular.band(0.5, 1.5)
    huge = rubnoise.exact(rubnoise.build(LONG.resolved() | {"output": {"tick": "0.0001 um"}}))
    with pytest.raises(rubnoise.Refused, match="it has 2 to 262144, of a record of 100000001"):
        huge.estimated_spectrum(300_000)


def test_passages_of_a_level() -> None:
    values = {"strength": {"mean": 250.0}, "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping_ratio": 0.2}}
    sliding = {"sliding": {"distance": "1 mm", "speed": "1 mm/s"}}
    theory = rubnoise.exact(rubnoise.build(contact().resolved() | values | sliding))
    assert theory.slider is not None
    motion = theory.motion_cumulants()
    assert motion.displacement_std == pytest.approx(theory.slider.displacement_std, rel=1e-8)
    assert motion.skewness > 0.05
    levels = motion.mean + motion.displacement_std * np.array([[0.0, 2.0], [-2.0, 1e9]])
    rate, gaussian = theory.crossing_rate(levels), theory.gaussian_crossing_rate(levels)
    assert gaussian[0, 0] == pytest.approx(motion.velocity_std / motion.displacement_std / (2.0 * np.pi), rel=1e-12)
    assert gaussian[0, 1] == pytest.approx(gaussian[1, 0], rel=1e-12)
    assert rate[0, 1] > gaussian[0, 1] > rate[1, 0]  # a right skew: more passages above the mean than below
    assert rate[1, 1] == gaussian[1, 1] == 0.0
    with pytest.raises(rubnoise.Refused, match="needs \\[slider\\]"):
        rubnoise.exact(contact()).crossing_rate(0.0)
