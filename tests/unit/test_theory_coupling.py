"""The strength of coupling, and crossing rates."""

from dataclasses import replace
from math import inf, isnan, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Fixed, Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.cumulants import force_cumulants
from rubnoise.theory.coupling import coupling, weak_coupling_change
from rubnoise.theory.motion import drive_of
from rubnoise.theory.motion_cumulants import crossing_rate, gaussian_crossing_rate, junction_response, motion_cumulants
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import density_at_zero
from tests.models import model as scenario_model
from tests.models import recorded
from tests.unit.theory_models import FIG5_SLIDER, model_of, one_size, paper_model, regular
from tests.verification.scores import seed_of

# The strength of coupling and its law against measured motions, a simulation of the law's own picture, and limits.
MEASURED = [
    (paper_model(speed=1e5), 1.0097, 0.0027),
    (paper_model(speed=5e4), 1.038, 0.005),
    (paper_model(speed=5e4, slider=replace(FIG5_SLIDER, damping=0.2)), 1.0086, 0.0022),
    (paper_model(speed=5e4, mean_count=80.0), 1.0058, 0.0019),
]
"""The displacement's std, two-way over one-way on the same junctions, as a prototype of two-way runs measured it."""


def test_figure_5_is_strongly_coupled() -> None:
    found = coupling(paper_model())
    assert found.strength == pytest.approx(2929.741, abs=5e-4)
    assert found.stick_number == pytest.approx(16.8602754, abs=5e-8)
    assert isnan(found.expected_change)
    assert "too strong" in found.unknown


def test_the_strength_is_that_of_the_sixth_moment() -> None:
    """Pi = psi^2 S(0)/(2 m c V^3), here from lam c_1^2 E[d^6]; not the fourth power of V, nor without the damping."""
    model = paper_model(speed=3e4)
    expected = 250.0**2 * density_at_zero(model) / (2.0 * 0.005 * 0.05 * 3e4**3)
    assert coupling(model).strength == pytest.approx(expected, rel=1e-12)


def test_unequal_strengths_count_by_their_mean_square() -> None:
    spread = replace(paper_model(), strengths=Normal(centre=250.0, std=100.0))
    psi = spread.strengths
    ratio = psi.moment(2) / 250.0**2
    assert ratio > 1.1
    assert coupling(spread).strength == pytest.approx(ratio * coupling(paper_model()).strength, rel=1e-12)
    assert coupling(spread).stick_number == pytest.approx(sqrt(ratio) * coupling(paper_model()).stick_number, rel=1e-12)


@pytest.mark.parametrize("damping", [0.005, 0.05, 5.0], ids=["light", "figure 5", "over-damped"])
def test_the_strength_is_the_square_of_validity_for_a_force_white_to_the_slider(damping: float) -> None:
    """From below: no wavenumber has more than S(0)."""
    shares = []
    for speed in (1e3, 1e6, 1e9):
        model = paper_model(speed=speed, slider=replace(FIG5_SLIDER, damping=damping))
        shares.append(response(model).one_way_validity ** 2 / coupling(model).strength)
    assert shares[0] < shares[1] < shares[2] < 1.0
    assert shares[0] < 0.95
    assert shares[2] == pytest.approx(1.0, abs=1e-4)


def test_the_printed_figures_of_weak_coupling() -> None:
    """50 mm/s, where a junction's kick is left out: 1.035 to first order, 1.042 by the next."""
    strength = coupling(paper_model(speed=5e4)).strength
    assert 1.0 + 1.5 * strength == pytest.approx(1.035, abs=5e-4)
    assert weak_coupling_change(strength, 0.0) == pytest.approx(1.042, abs=5e-4)
    u = strength * weak_coupling_change(strength, 0.0) ** 2
    assert u == pytest.approx(strength * (1.0 + 3.0 * u + 15.0 * u**2), rel=1e-14)


def test_the_first_order_is_three_halves_of_the_strength_and_half_the_kick() -> None:
    assert (weak_coupling_change(1e-6, 0.0) - 1.0) / 1e-6 == pytest.approx(1.5, rel=1e-4)
    assert (weak_coupling_change(1e-12, 1e-6) - 1.0) / 1e-6 == pytest.approx(0.5, rel=1e-4)


def test_there_is_no_balance_where_damping_is_used_up() -> None:
    assert weak_coupling_change(0.09, 0.0) > 1.3
    assert isnan(weak_coupling_change(0.1, 0.0))
    assert isnan(weak_coupling_change(1.0, 0.0))


def test_measured_changes_are_those_of_the_law() -> None:
    expected = [coupling(model).expected_change for model, _, _ in MEASURED]
    assert expected == pytest.approx([1.0048, 1.0437, 1.0104, 1.0049], abs=1e-4)
    scores = [(seen - told) / error for (_, seen, error), told in zip(MEASURED, expected, strict=True)]
    assert np.abs(scores).max() < 4.0
    assert np.square(scores).sum() < 18.5  # one in a thousand, of four degrees of freedom
    unchanged = [(seen - 1.0) / error for _, seen, error in MEASURED]
    assert np.square(unchanged).sum() > 90.0


def _variance_of_velocity(strength: float, kick: float, *, acts_back: bool) -> tuple[float, float]:
    """Return Var x'/V^2 over Pi and its relative error, of oscillators hit by junctions that have no width.

    w_0 = m = V = 1. A junction takes 2 q from w^2, or all of it. The times of those that could come are a Poisson
    process, so that what is seen just before them averages over time. The energy of an oscillator is exponential and
    forgets as exp(-c t), which makes the relative error of its mean over a time T sqrt(2/(c T)).
    """
    generator = np.random.default_rng(20)
    damping, fastest, oscillators, steps, left_out = 0.2, 2.0, 4000, 890, 178
    births = 2.0 * damping * strength / kick**2
    rate, turn = births * fastest, sqrt(1.0 - 0.25 * damping**2)
    mean = births * kick
    x = mean + sqrt(strength) * generator.standard_normal(oscillators)
    v = sqrt(strength) * generator.standard_normal(oscillators)
    total = 0.0
    for step in range(steps):
        time = generator.standard_exponential(oscillators) / rate
        decay, even, odd = np.exp(-0.5 * damping * time), np.cos(turn * time), np.sin(turn * time) / turn
        x, v = (
            decay * (even * x + odd * (v + 0.5 * damping * x)),
            decay * (even * v - odd * (x + 0.5 * damping * v)),
        )
        total += float(v @ v) if step >= left_out else 0.0
        w = 1.0 - v
        hit = generator.random(oscillators) * fastest < (w if acts_back else 1.0)
        v = np.where(hit, 1.0 - np.sqrt(np.maximum(np.square(w) - 2.0 * kick, 0.0)) if acts_back else v + kick, v)
    seen = oscillators * (steps - left_out)
    return total / seen / strength, sqrt(2.0 * rate / (damping * seen))


def test_the_law_is_that_of_oscillators_hit_by_junctions_without_width() -> None:
    strength, kick = 0.008, 0.03
    ratio, error = _variance_of_velocity(strength, kick, acts_back=True)
    assert error < 0.006
    assert abs(ratio / weak_coupling_change(strength, kick) ** 2 - 1.0) < 4.0 * error
    assert abs(ratio / weak_coupling_change(strength, 0.0) ** 2 - 1.0) > 4.0 * error
    assert abs(ratio - 1.0) > 4.0 * error


def test_oscillators_that_do_not_act_back_have_the_variance_of_one_way_coupling() -> None:
    ratio, error = _variance_of_velocity(0.008, 0.03, acts_back=False)
    assert abs(ratio - 1.0) < 4.0 * error


@pytest.mark.parametrize(
    ("model", "why"),
    [
        (paper_model(speed=3e4), "too strong"),
        (paper_model(slider=replace(FIG5_SLIDER, damping=20.0), speed=3e4), "white"),
        (replace(regular(20.0, 0.2, slider=FIG5_SLIDER), sliding_speed=1e5), "random"),
        (paper_model(slider=replace(FIG5_SLIDER, damping=0.0), speed=1e5), "damping"),
    ],
    ids=["strong", "slow", "regular", "undamped"],
)
def test_a_change_that_is_not_known_says_why(model: Model, why: str) -> None:
    found = coupling(model)
    assert isnan(found.expected_change)
    assert why in found.unknown
    assert found.stick_number > 0.0


def test_no_damping_is_no_end_of_coupling() -> None:
    assert coupling(paper_model(slider=replace(FIG5_SLIDER, damping=0.0))).strength == inf


@pytest.mark.parametrize("missing", ["slider", "strengths", "sliding_speed"])
def test_what_is_missing_is_refused(missing: str) -> None:
    with pytest.raises(Refused, match="needs"):
        coupling(replace(paper_model(), **{missing: None}))


def test_a_change_that_is_known_has_no_reason_not_to_be() -> None:
    found = coupling(paper_model(speed=1e6))
    assert found.unknown is None
    assert found.expected_change == pytest.approx(1.0, abs=3e-4)


# Crossing rates against the exact joint law of displacement and velocity, and against a simulated slider.
Doubles = NDArray[np.float64]


def slider_of(damping_ratio: float) -> Slider:
    return Slider(mass=0.005, stiffness=300.0, damping=2.0 * damping_ratio * sqrt(1.5))


def few(mean_count: float, damping_ratio: float, speed: float) -> Model:
    return model_of(Fixed(value=5.53), 5.53, mean_count, slider=slider_of(damping_ratio), speed=speed)


@pytest.mark.parametrize("damping_ratio", [1e-6, 1e-3, 0.02, 0.5, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 4.0, 1e3])
@pytest.mark.parametrize("speed", [1e3, 1e5, 1e7])
def test_second_cumulants_are_those_of_the_response_spectrum(damping_ratio: float, speed: float) -> None:
    model = one_size(slider=slider_of(damping_ratio), speed=speed)
    found, expected = motion_cumulants(model), response(model)
    assert found.displacement_std == pytest.approx(expected.displacement_std, rel=1e-10)
    assert found.velocity_std == pytest.approx(expected.velocity_std, rel=1e-10)
    assert found.mean == expected.mean_displacement


@pytest.mark.parametrize("law", [Normal(centre=5.53, std=0.2), Normal(centre=2.0, std=3.0)], ids=["narrow", "wide"])
def test_spread_sizes_and_slow_sliding_too(law: Normal) -> None:
    model = model_of(law, law.centre, slider=slider_of(0.02), speed=60.0)
    found, expected = motion_cumulants(model), response(model)
    assert found.displacement_std == pytest.approx(expected.displacement_std, rel=1e-8)
    assert found.velocity_std == pytest.approx(expected.velocity_std, rel=1e-8)


def test_triangles_too() -> None:
    model = replace(one_size(slider=slider_of(0.1)), pulse=TRIANGLE)
    assert motion_cumulants(model).displacement_std == pytest.approx(response(model).displacement_std, rel=1e-10)


@pytest.mark.parametrize("damping_ratio", [0.5, 1.0, 2.0])
def test_a_stiff_slider_has_the_cumulants_of_the_force(damping_ratio: float) -> None:
    """At 5 um/s the slider follows the force; what is left falls with the square of the speed."""
    model = few(20.0, damping_ratio, 5.0)
    motion, force = motion_cumulants(model), force_cumulants(model)
    assert motion.skewness == pytest.approx(force.skewness, rel=1e-3)
    assert motion.excess_kurtosis == pytest.approx(force.excess_kurtosis, rel=2e-3)


def test_cumulants_with_one_velocity_vanish() -> None:
    drive = drive_of(few(20.0, 0.3, 500.0))
    found = junction_response(few(20.0, 0.3, 500.0).pulse, drive, np.array([3.0, 5.53]))
    scale = np.sqrt(found.integrals((2, 0)) * found.integrals((0, 2)))
    assert np.max(np.abs(found.integrals((1, 1)) / scale)) < 1e-10
    assert np.max(np.abs(found.integrals((3, 1)) / found.integrals((4, 0)))) < 1e-10 * 250.0


@pytest.mark.parametrize("damping_ratio", [0.1, 1.0, 3.0])
def test_response_of_one_junction_solves_the_equation_of_motion(damping_ratio: float) -> None:
    """Over all time c int y'^2 dt = int A y' dt, the work of the junction, and k int y dt = int A dt."""
    model = few(20.0, damping_ratio, 500.0)
    drive = drive_of(model)
    diameters = np.array([5.53])
    found = junction_response(model.pulse, drive, diameters)
    weights, _, velocity = found.life
    time = _node_times(5.53 / 500.0, weights.shape[0])
    area = model.pulse.area(500.0 * time[:, None], diameters)
    work = np.sum(weights * area * velocity, axis=0)
    np.testing.assert_allclose(model.slider.damping * found.integrals((0, 2)), work, rtol=1e-9)
    momentum = 2.0 / 3.0 * diameters**3 / 500.0
    np.testing.assert_allclose(model.slider.stiffness * found.integrals((1, 0)), momentum, rtol=1e-10)


def _node_times(scale: float, count: int) -> Doubles:
    x, _ = np.polynomial.legendre.leggauss(16)
    panel = np.pi / (count // 16)
    phi = (panel * np.arange(count // 16)[:, None] + 0.5 * panel * (x + 1.0)).ravel()
    return scale * (1.0 - np.cos(phi))


def exact_rate(model: Model, level: Doubles) -> Doubles:
    """Return int_0^inf v p(a, v) dv by inverting the characteristic function of x and x', one size.

    E|v| with x = a: |v| = (2/pi) int_0^inf (1 - cos(v eta))/eta^2 d eta, so that only p(a) and the transform in eta of
    p(a, v) are asked for; log E[exp(i xi x + i eta x')] = lam V int (exp(i psi (xi y + eta y')) - 1) dt.
    """
    motion, drive = motion_cumulants(model), drive_of(model)
    psi, rate = drive.strengths.moment(1), model.birth_rate * drive.speed
    response_of = junction_response(model.pulse, drive, np.array([model.sizes.support[0]]))
    weights, y, v = response_over_time(response_of)
    y, v = psi * y / motion.displacement_std, psi * v / motion.velocity_std
    step, reach = 2.0 * np.pi / 22.0, 9.0
    xi = step * np.arange(int(reach / step) + 1)
    x, w = np.polynomial.legendre.leggauss(48)
    eta, eta_weights = 0.5 * reach * (x + 1.0), 0.5 * reach * w

    def transform(eta: float) -> NDArray[np.complex128]:
        phase = xi[:, None] * y + eta * v
        return np.exp(rate * ((np.expm1(1j * phase) - 1j * phase) @ weights))

    z = (level - motion.mean) / motion.displacement_std
    kernel = np.exp(-1j * np.outer(z, xi)) * np.where(xi == 0.0, 0.5, 1.0) * step / np.pi
    density = np.real(kernel @ transform(0.0))
    even = np.stack([0.5 * (transform(e) + transform(-e)) for e in eta], axis=-1)
    mean_speed = ((density[:, None] - np.real(kernel @ even)) / eta**2) @ eta_weights + density / reach
    return mean_speed / np.pi * motion.velocity_std / motion.displacement_std


def response_over_time(response_of: object) -> tuple[Doubles, Doubles, Doubles]:
    """Return weights, displacement and velocity over the life and as much of the decay as counts."""
    parts, factor = [response_of.life], 1.0
    while abs(factor) > 1e-6:
        weights, y, v = response_of.rest
        parts.append((weights, factor * y, factor * v))
        factor *= response_of.repeats
    return tuple(np.concatenate([part[n].ravel() for part in parts]) for n in range(3))


PLACES = np.array([-2.0, -1.0, 0.0, 0.5, 1.0, 2.0, 3.0])


def levels(model: Model) -> Doubles:
    motion = motion_cumulants(model)
    return motion.mean + PLACES * motion.displacement_std


@pytest.mark.parametrize(
    ("model", "skewness", "error"),
    [
        (few(20.0, 0.05, 1e3), 0.02, 3e-5),
        (few(20.0, 0.5, 1e3), 0.22, 5e-4),
        (few(20.0, 0.2, 300.0), 0.296, 1e-3),
        (few(5.0, 0.5, 1e3), 0.44, 5e-3),
    ],
    ids=["nearly Gaussian", "damped", "slow", "few junctions"],
)
def test_against_the_exact_joint_law(model: Model, skewness: float, error: float) -> None:
    expected = exact_rate(model, levels(model))
    assert motion_cumulants(model).skewness == pytest.approx(skewness, rel=0.15)
    np.testing.assert_allclose(crossing_rate(model, levels(model)), expected, atol=error * expected.max())
    gaussian = gaussian_crossing_rate(model, levels(model))
    assert np.max(np.abs(gaussian - expected)) > 8.0 * error * expected.max()


def test_at_the_paper_s_numbers_it_is_nearly_rice_s_rate() -> None:
    model = paper_model()
    motion = response(model)
    at_mean = float(crossing_rate(model, motion.mean_displacement))
    assert at_mean == pytest.approx(motion.velocity_std / motion.displacement_std / (2.0 * np.pi), rel=1e-3)
    assert at_mean == pytest.approx(38.5, abs=0.05)
    np.testing.assert_allclose(
        crossing_rate(model, levels(model))[1:5], gaussian_crossing_rate(model, levels(model))[1:5], rtol=5e-3
    )


SEGMENTS = 40
TICKS_A_SEGMENT = 30_000


@pytest.fixture(scope="module")
def slid() -> tuple[Model, Doubles]:
    """Return a model of skewness 0.3 and its displacement after the first second, a row for each 10 s of sliding."""
    tick, speed = 0.1, 300.0
    spare = int(speed / tick)
    distance = tick * (spare + SEGMENTS * TICKS_A_SEGMENT)
    model = scenario_model(distance=distance, tick=tick, speed=speed, slider=slider_of(0.2))
    record = recorded(model, seed_of("crossings of a simulated slider"))
    displacement = record.groups["slider"]["displacement"][spare : spare + SEGMENTS * TICKS_A_SEGMENT]
    return model, displacement.reshape(SEGMENTS, TICKS_A_SEGMENT)


def crossing_scores(rows: Doubles, tick_duration: float, at: Doubles, expected: Doubles) -> Doubles:
    """Return z of the passages counted upwards, the error of their mean from segments that are independent."""
    counts = np.stack([np.sum((rows[:, :-1] < a) & (rows[:, 1:] >= a), axis=1) for a in at], axis=-1)
    rates = counts / ((rows.shape[1] - 1) * tick_duration)
    return (rates.mean(axis=0) - expected) / (rates.std(axis=0, ddof=1) / np.sqrt(rows.shape[0]))


def test_passages_of_a_simulated_slider(slid: tuple[Model, Doubles]) -> None:
    model, rows = slid
    z = crossing_scores(rows, model.tick_duration, levels(model), crossing_rate(model, levels(model)))
    assert np.max(np.abs(z)) <= 4.0


def test_rice_s_rate_alone_is_rejected_there(slid: tuple[Model, Doubles]) -> None:
    model, rows = slid
    z = crossing_scores(rows, model.tick_duration, levels(model), gaussian_crossing_rate(model, levels(model)))
    assert z[0] < -5.0
    assert z[5] > 5.0


def test_far_out_there_are_none_and_shape_is_kept() -> None:
    model = few(5.0, 0.5, 1e3)
    far = (
        motion_cumulants(model).mean + np.array([[-60.0, 60.0], [-6.0, 0.0]]) * motion_cumulants(model).displacement_std
    )
    found = crossing_rate(model, far)
    assert found.shape == (2, 2)
    np.testing.assert_array_equal(found[0], 0.0)
    assert (found >= 0.0).all()


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"births": RegularBirths(mean_spacing=0.5)}, "known for Poisson births alone"),
        ({"slider": Slider(mass=0.005, stiffness=300.0, damping=0.0)}, "without damping"),
        ({"slider": None}, "needs \\[slider\\]"),
        ({"sliding_speed": 1e-2}, "swings too often"),
    ],
    ids=["regular births", "undamped", "no slider", "creeping"],
)
def test_what_has_no_rate_is_refused(changes: dict[str, object], reason: str) -> None:
    with pytest.raises(Refused, match=reason):
        crossing_rate(replace(paper_model(), **changes), 0.0)
