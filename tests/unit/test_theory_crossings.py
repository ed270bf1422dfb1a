"""Crossing rates against the exact joint law of displacement and velocity, and against a simulated slider."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import Fixed, Normal
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.campbell import force_cumulants
from rubnoise.theory.crossings import crossing_rate, gaussian_crossing_rate
from rubnoise.theory.drive import drive_of
from rubnoise.theory.motion_cumulants import junction_response, motion_cumulants
from rubnoise.theory.response import response
from tests.models import model as scenario_model
from tests.models import recorded
from tests.unit.theory_models import model_of, one_size, paper_model
from tests.verification.seeds import seed_of

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
