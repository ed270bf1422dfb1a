"""Junctions that miss each other's centre line: lives, spectrum, covariance, distribution and motion, by exact theory.

Kept against reference numbers that another program worked out, against each other by other routes, and against contacts
drawn at random from the model's own words. Each check rejects the lens whose passes go through both centres.
"""

import json
from dataclasses import replace
from math import acos, pi, sqrt
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import rubnoise
from rubnoise.contact.births import GammaBirths, PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Lognormal, Normal
from rubnoise.contact.pulses import LENS, OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA, PARABOLA, Pulse
from rubnoise.model import Model
from rubnoise.theory.coupling import coupling, force_slope_std
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import (
    area_noise,
    autocovariance,
    count_noise,
    half_power_wavenumber,
    spectral_density,
)
from rubnoise.theory.sizes import panels
from rubnoise.theory.unit_pulse import energy, overlaps
from tests.architecture.sources import ROOT
from tests.shell.terminal import call
from tests.unit.test_theory_response import slider_of, stds_in_time
from tests.unit.theory_models import FIG5_SLIDER, model_of, paper_model

Doubles = NDArray[np.float64]

REFERENCE = json.loads((ROOT / "tests" / "reference" / "off_centre.json").read_text(encoding="utf-8"))
DIAMETER, COUNT = 5.0, 20.0


def contact(sizes: Any = None, pulse: Pulse = OFF_CENTRE_LENS, **changes: Any) -> Model:
    """Return a contact of N_jm junctions on average, whose births follow from the pulse's own mean life."""
    sizes = sizes or Fixed(value=DIAMETER)
    model = model_of(sizes, sizes.moment(1), COUNT, pulse=pulse, **changes)
    return replace(model, births=PoissonBirths(mean_spacing=pulse.mean_life * sizes.moment(1) / COUNT))


def scenario(**tables: Any) -> rubnoise.Scenario:
    values: dict[str, Any] = {
        "format": 1,
        "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20.0},
        "pulse": {"offset": "uniform"},
        "sliding": {"distance": 1000.0},
    }
    return rubnoise.build(values | tables)


# The parabola off the centre line: a pass is the parabola of the diameter sqrt(d^2 - b^2), so all is closed.
def test_parabolas_have_the_moments_and_energies_of_their_chords() -> None:
    pulse = OFF_CENTRE_PARABOLA
    angle, weights = panels(np.linspace(0.0, 0.5 * pi, 100), 16)
    chord, weights = np.cos(angle), weights * np.cos(angle)
    found = [pulse.life_integral(n) for n in range(1, 7)]
    assert found == pytest.approx(
        [float(weights @ (PARABOLA.life_integral(n) * chord ** (2 * n + 1))) for n in range(1, 7)], rel=1e-12
    )
    area = area_cumulants(contact(pulse=pulse))
    assert sqrt(COUNT) * area.std / area.mean == pytest.approx(1.1547005384, rel=1e-9)
    integrals = PARABOLA.life_integral(1) * chord**3
    known = (weights @ integrals**2, weights @ integrals**3, PARABOLA.squared_slope * (weights @ chord**3))
    assert (pulse.integral_moment(2), pulse.integral_moment(3), pulse.squared_slope) == pytest.approx(known, rel=1e-12)
    for phase in (0.0, 3.0, 31.99, 32.0, 60.0, 400.0):
        direct = float(weights @ (chord**6 * energy(PARABOLA, phase * chord)))
        # From 256 on there is no swing off the centre line.
        assert float(energy(pulse, np.array([phase]))[0]) == pytest.approx(
            direct, rel=1e-8 if phase < 16.0 else 2e-5 if phase < 256.0 else 0.03
        )
    lag = np.array([0.7, 1.9])
    left = np.maximum(2.0 - lag[:, None] / chord, 0.0)
    shared = (pi / 4.0) ** 2 / 30.0 * chord**5 * left**3 * ((2.0 - left) ** 2 + 6.0 * (2.0 - left) + 4.0)
    assert overlaps(pulse, 1, 1)(lag) == pytest.approx(shared @ weights, rel=1e-5)
    assert energy(PARABOLA, np.full(1, 3.0)) != pytest.approx(energy(pulse, np.full(1, 3.0)), rel=0.05)


def test_life_integrals_are_those_of_the_reference() -> None:
    assert OFF_CENTRE_LENS.mean_life == pytest.approx(REFERENCE["life_integrals"][0], rel=1e-14)
    found = [OFF_CENTRE_LENS.life_integral(n) for n in range(1, 7)]
    assert found == pytest.approx(REFERENCE["life_integrals"][1:], rel=1e-13)
    assert found[0] == pytest.approx(pi**2 / 32.0, rel=1e-14)
    assert [LENS.life_integral(n) for n in range(1, 7)] != pytest.approx(found, rel=0.1)


def test_the_energy_spectrum_is_that_of_the_reference() -> None:
    phases, values = zip(*REFERENCE["mean_square_transform_over_d6_by_kd"].items(), strict=True)
    found = energy(OFF_CENTRE_LENS, np.array([float(phase) for phase in phases]))
    assert found == pytest.approx(list(values), rel=1e-6)
    through = energy(LENS, np.array([float(phase) for phase in phases]))
    assert not np.allclose(through, values, rtol=0.05)


@pytest.mark.parametrize("phase", [0.0, 3.0, 15.999, 16.0, 31.99, 32.0, 33.7, 60.0, 150.0, 400.0])
def test_the_energy_spectrum_is_its_integral_over_the_plane(phase: float) -> None:
    """By panels of one rule out to 20 000, and the level's leading term beyond."""
    from scipy.special import j1

    p, weights = panels(np.arange(1e-9, 20_001.0, 4.0), 16)
    q = np.hypot(phase, p)
    direct = float(weights @ (np.pi * j1(0.5 * q) / q) ** 4) / (2.0 * pi) + 3.0 * pi / (5.0 * 20_000.0**5)
    assert energy(OFF_CENTRE_LENS, phase) == pytest.approx(direct, rel=1e-8 if phase < 16.0 else 1e-5)


@pytest.mark.parametrize("sizes", [Fixed(value=5.0), Normal(centre=5.0, std=1.0), Lognormal(mean=5.0, std=2.5)])
def test_spectrum_and_autocovariance_are_transforms_of_each_other(sizes: Any) -> None:
    model = contact(sizes)
    longest = 2.0 * sizes.support[1]
    lags, weights = panels(longest * np.linspace(0.0, 1.0, 60) ** 2, 20)
    covariance = autocovariance(model, lags)
    assert float(autocovariance(model, 0.0)) == pytest.approx(area_cumulants(model).variance, rel=1e-8)
    for k in (0.0, 0.3, 1.0, 2.0):
        back = 2.0 * float(weights @ (covariance * np.cos(k * lags)))
        assert float(spectral_density(model, k)) == pytest.approx(
            back, rel=1e-6, abs=1e-9 * float(spectral_density(model, 0.0))
        )
    power = model.birth_rate * model.pulse.integral_moment(2) * model.sizes.moment(6)
    assert float(spectral_density(model, 0.0)) == pytest.approx(power, rel=1e-8)


@pytest.mark.parametrize(("damping_ratio", "speed"), [(0.02, 1e3), (1e-3, 1e4), (0.5, 10.0), (3.0, 1e5)])
def test_the_motion_is_that_of_the_time_domain(damping_ratio: float, speed: float) -> None:
    model = contact(Normal(centre=5.53, std=0.2), slider=slider_of(damping_ratio), speed=speed)
    found = response(model)
    assert (found.displacement_std, found.velocity_std) == pytest.approx(stds_in_time(model), rel=1e-6)


def test_figure_5_vibrates_more_off_the_centre_line() -> None:
    """Junctions of the mean area of Figure 5: its std x of 195 um becomes 226."""
    diameter = sqrt(204.6736 / 20.0 / (pi / 16.0) - 3.0 * 0.2**2)
    model = contact(Normal(centre=diameter, std=0.2), slider=FIG5_SLIDER)
    assert area_cumulants(model).mean == pytest.approx(204.6736, rel=1e-9)
    assert response(model).displacement_std == pytest.approx(226.0, rel=2e-3)
    assert response(paper_model()).displacement_std == pytest.approx(195.3, rel=1e-3)


def test_power_at_zero_is_more_by_58_per_cent() -> None:
    through, off = (
        contact(Fixed(value=sqrt(10.0 / float(pulse.life_mean()))), pulse=pulse) for pulse in (LENS, OFF_CENTRE_LENS)
    )
    assert [area_cumulants(model).mean for model in (through, off)] == pytest.approx([200.0, 200.0], rel=1e-12)
    assert float(spectral_density(off, 0.0)) / float(spectral_density(through, 0.0)) == pytest.approx(1.58, abs=0.005)
    assert half_power_wavenumber(off) < half_power_wavenumber(through)


def drawn(contacts: int, distance: float, centred: bool = False) -> tuple[Doubles, NDArray[np.int64]]:  # noqa: FBT001, FBT002
    """Return area and count of independent contacts ``distance`` um after an empty start, from births and offsets."""
    random = np.random.default_rng(20_26)
    rate = COUNT / ((2.0 if centred else 0.5 * pi) * DIAMETER)
    area, count = np.zeros(contacts), np.zeros(contacts, dtype=np.int64)
    for row, births in enumerate(random.poisson(rate * distance, contacts)):
        age = random.uniform(0.0, distance, births)
        offset = np.zeros(births) if centred else random.uniform(-DIAMETER, DIAMETER, births)
        half_life = np.sqrt(DIAMETER**2 - offset**2)
        alive = age < 2.0 * half_life
        apart = np.hypot(age - half_life, offset)[alive] / DIAMETER
        area[row] = DIAMETER**2 * sum(0.5 * (acos(r) - r * sqrt(1.0 - r * r)) for r in apart.tolist())
        count[row] = alive.sum()
    return area, count


def scores(model: Model, area: Doubles, count: NDArray[np.int64], distance: float) -> list[float]:
    """Return deviations over their standard errors: mean and variance of the area, and mean and variance of N."""
    exact, size = area_cumulants(model), area.size
    kurtosis = exact.values[3] / exact.variance**2 + 2.0
    mean, alive = float(area_noise(model).from_empty(distance)), float(count_noise(model).from_empty(distance))
    found = [
        (area.mean() - mean) / sqrt(exact.variance / size),
        (count.mean() - alive) / sqrt(alive / size),
    ]
    if distance >= 2.0 * DIAMETER:
        found.append((area.var() / exact.variance - 1.0) / sqrt(kurtosis / size))
        found.append((count.var() / alive - 1.0) / sqrt((2.0 + 1.0 / alive) / size))
    return found


@pytest.mark.parametrize("distance", [2.0, 5.0, 10.0])
def test_contacts_drawn_by_births_and_offsets_have_the_moments(distance: float) -> None:
    found = scores(contact(), *drawn(4000, distance), distance)
    assert np.abs(found).max() < 4.0
    wrong = scores(contact(), *drawn(4000, distance, centred=True), distance)
    assert np.abs(wrong).max() > 4.0


def test_contacts_drawn_by_births_and_offsets_have_the_distribution() -> None:
    law, (area, _) = distribution(contact()), drawn(4000, 10.0)
    for share in (0.05, 0.3, 0.5, 0.8, 0.98):
        place = float(np.quantile(area, share))
        assert abs(share - float(law.cdf(place))) < 4.0 * sqrt(share * (1.0 - share) / area.size)
    through = distribution(contact(Fixed(value=sqrt(area.mean() * 3.0 / COUNT)), pulse=LENS))
    place = float(np.quantile(area, 0.05))
    assert abs(0.05 - float(through.cdf(place))) > 4.0 * sqrt(0.05 * 0.95 / area.size)


def test_the_slope_of_the_force_follows_from_the_autocovariance() -> None:
    """Var F' = -R''(0), from R at a small lag."""
    model = contact(slider=FIG5_SLIDER)
    step = 0.02
    curvature = 2.0 * (area_cumulants(model).variance - float(autocovariance(model, step))) / step**2
    assert force_slope_std(model) == pytest.approx(250.0 * sqrt(curvature), rel=1e-3)
    assert coupling(model).stick_number == pytest.approx(force_slope_std(model) / 300.0, rel=1e-12)


def test_a_scenario_has_its_exact_theory_by_python_and_by_the_command(tmp_path: Any) -> None:
    theory = rubnoise.exact(scenario())
    assert theory.area.std / theory.area.mean * sqrt(20.0) == pytest.approx(1.3559061, rel=1e-6)
    assert theory.count_mean == pytest.approx(20.0, rel=1e-12)
    assert theory.estimated_spectrum(64).density.size == 33
    assert np.isnan(theory.estimated_spectrum(64).standard_error).all()
    file = tmp_path / "off.toml"
    file.write_text(
        'format = 1\n[interface]\nmean_real_contact_area = "200 um^2"\nmean_junction_count = 20\n'
        '[pulse]\noffset = "uniform"\n[sliding]\ndistance = "1 mm"\n',
        encoding="utf-8",
    )
    answer = call("theory", str(file), "--at-area", "200", "--json").values()
    assert answer["area"]["std"] == pytest.approx(theory.area.std, rel=1e-12)
    assert answer["distribution"]["cdf"][0] == pytest.approx(float(theory.distribution().cdf(200.0)), rel=1e-9)
    checked = call("check", str(file), "--json").values()["scenarios"][str(file)]["contact"]
    assert checked["mean_life_distance"] == pytest.approx(0.5 * pi * checked["calibrated_diameter"], rel=1e-12)
    assert checked["expected_junctions"] > 1000


@pytest.mark.parametrize("pulse", [OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA], ids=["lens", "parabola"])
def test_gamma_births_of_shape_1_are_at_random_off_the_centre_line(pulse: Pulse) -> None:
    at_random = contact(Normal(centre=5.0, std=0.5), pulse=pulse, slider=FIG5_SLIDER)
    spacing = at_random.births.mean_spacing
    gamma = replace(at_random, births=GammaBirths(mean_spacing=spacing, shape=1.0))
    lags, k = np.array([0.0, 0.3, 2.0, 5.0, 9.0]), np.array([0.0, 0.1, 0.5, 2.0, 6.0])
    variance, most = area_cumulants(at_random).variance, float(spectral_density(at_random, 0.0))
    assert autocovariance(gamma, lags) == pytest.approx(autocovariance(at_random, lags), abs=1e-8 * variance)
    assert spectral_density(gamma, k) == pytest.approx(spectral_density(at_random, k), rel=1e-6, abs=1e-8 * most)
    assert count_noise(gamma).covariance(lags) == pytest.approx(
        count_noise(at_random).covariance(lags), abs=1e-6 * COUNT
    )
    assert response(gamma).displacement_std == pytest.approx(response(at_random).displacement_std, rel=2e-8)
    even = replace(at_random, births=GammaBirths(mean_spacing=spacing, shape=4.0))
    assert float(spectral_density(even, 0.0)) < 0.7 * most


@pytest.mark.parametrize("pulse", [OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA], ids=["lens", "parabola"])
def test_regular_births_off_the_centre_line_are_those_drawn(pulse: Pulse) -> None:
    """Many phases of births at even places, each with an offset of its own."""
    model = replace(contact(pulse=pulse), births=RegularBirths(mean_spacing=1.7), strengths=None)
    generator, draws = np.random.default_rng(2027), 100_000
    area, alive, phase = np.zeros((2, draws)), np.zeros((2, draws)), generator.uniform(0.0, 1.7, draws)
    for number in range(-2, 7):
        offset = generator.uniform(-DIAMETER, DIAMETER, draws)
        half = np.sqrt(DIAMETER**2 - offset**2)
        for row, lag in enumerate((0.0, 1.3)):
            age = phase + 1.7 * number + lag
            inside = (age >= 0.0) & (age < 2.0 * half)
            apart = np.hypot(age - half, offset) / DIAMETER
            area[row] += np.where(inside, DIAMETER**2 * pulse.overlap(apart), 0.0)
            alive[row] += inside
    for seen, mean, covariance in (
        (area, area_cumulants(model).mean, autocovariance(model, [0.0, 1.3])),
        (alive, model.mean_live_junctions, count_noise(model).covariance([0.0, 1.3])),
    ):
        for row in range(2):
            products = (seen[0] - mean) * (seen[row] - mean)
            assert abs(products.mean() - covariance[row]) < 4.0 * products.std() / sqrt(draws)
    at_random = replace(model, births=PoissonBirths(mean_spacing=1.7))
    products = np.square(area[0] - area_cumulants(model).mean)
    assert abs(products.mean() - float(autocovariance(at_random, 0.0))) > 10.0 * products.std() / sqrt(draws)
