"""What friction force and load move, one-way and of first order: responses by name, their spectra and covariances.

A junction of strength psi brings (psi - E[psi]) o + m to a quantity, o and m being functions of the wavenumber k. With
S the spectrum of the area, between lines, and S_1 its part of single junctions, quantities u and v have

    Cov[u, v] = (1/pi) int_0^inf Re(Var[psi] S_1 o_u o_v* + S m_u m_v*) dk, plus lines.

A covariance equation in time would lose the digits of a slow slider, whose resonance holds 1e-8 of the force.
Source: Crandall and Mark, Random Vibration in Mechanical Systems (1963).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import inf, nan, pi, sqrt
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.distributions import Fixed, Law
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.second_order import AREA_ITSELF, area_noise
from rubnoise.theory.sizes import COARSE, panels, size_range, sizes_of
from rubnoise.theory.unit_pulse import pass_energies

FORCE: Final = "friction_force"
MOTION: Final = ("displacement", "velocity")


@dataclass(frozen=True, slots=True)
class DrivenOscillator:
    """An oscillator, the speed (um/s) that turns distance into its time, and the force (uN) per um^2 of area."""

    slider: Slider
    speed: float
    gain: float = 1.0

    @property
    def resonance(self) -> float:
        """The natural angular frequency as a wavenumber, sqrt(k/m)/V in rad/um."""
        return self.slider.natural_angular_frequency / self.speed

    def compliance(self, wavenumber: Doubles) -> Complexes:
        """Return 1 / (k - m w^2 + i c w) in um/uN at w = V times the wavenumbers (rad/um), for signs of exp(i w t)."""
        slider, natural = self.slider, self.slider.natural_angular_frequency
        frequency = self.speed * wavenumber
        spring = slider.mass * (natural - frequency) * (natural + frequency)
        return np.asarray(1.0 / (spring + 1.0j * slider.damping * frequency), dtype=np.complex128)


def need_friction(model: Model) -> None:
    """Raise Refused if something else than friction drives the slider."""
    if model.slider is not None and model.slider.excitation != "friction":
        raise Refused(f'the slider is not driven by friction but by slider.excitation = "{model.slider.excitation}"')


def drive_of(model: Model) -> DrivenOscillator:
    """Return the slider that friction, or a base of equal triangles, drives; Refused if something is missing."""
    if model.slider is None or model.sliding_speed is None or model.slider.excitation != "base":
        need_friction(model)
        if model.slider is None or model.strengths is None or model.sliding_speed is None:
            raise Refused("the slider's response needs [slider], a shear strength ([strength]) and sliding.speed")
    elif not isinstance(model.sizes, Fixed):
        raise Refused("excitation by the base is known for equal diameters alone (diameter.law)")
    elif model.pulse != TRIANGLE:
        raise Refused('the slider is driven by a base of triangles, which lives are with pulse.shape = "triangle"')
    return DrivenOscillator(model.slider, model.sliding_speed)


def contact_drive_of(model: Model) -> DrivenOscillator:
    """Return the separation as an oscillator, s_0 + z driven by H A; Refused without a load that weighs or a speed."""
    held = model.separation
    if held is None or model.sliding_speed is None:
        raise Refused("the separation moves under a load that weighs alone ([load])")
    return DrivenOscillator(held.oscillator, model.sliding_speed, held.hardness)


def strengths_of(model: Model) -> Law:
    """Return the law of shear strengths; raises Refused without one."""
    if model.strengths is None:
        raise Refused("the friction force needs a shear strength ([strength])")
    return model.strengths


def spread_of(strengths: Law | None) -> float:
    """Return the variance of strengths in MPa^2, 0 without any."""
    return 0.0 if strengths is None else max(strengths.moment(2) - strengths.mean**2, 0.0)


def is_moved(model: Model) -> bool:
    """Return whether a slider has a stationary motion that is known."""
    try:
        return drive_of(model).slider.damping > 0.0
    except Refused:
        return False


def answers(model: Model, wavenumber: Doubles) -> dict[str, tuple[Complexes, Complexes]]:
    """Return o and m of each quantity that moves by its name, per um^2 of area at wavenumbers in rad/um."""
    none = np.zeros(wavenumber.shape, dtype=np.complex128)
    borne, found = none + 1.0, dict[str, tuple[Complexes, Complexes]]()
    if model.separation is not None:
        drive = contact_drive_of(model)
        turned, separation = 1.0j * drive.speed * wavenumber, drive.gain * drive.compliance(wavenumber)
        # What mass and damping bear of the force, (-m w^2 + i c w) / (k - m w^2 + i c w).
        borne = turned * (drive.slider.mass * turned + drive.slider.damping) * drive.compliance(wavenumber)
        found |= {"separation": (none, separation), "normal_velocity": (none, turned * separation)}
        found["load"] = none, drive.gain * borne
    if model.strengths is not None:
        found[FORCE] = none + 1.0, model.strengths.mean * borne
    if is_moved(model):
        drive = drive_of(model)
        turned, compliance = 1.0j * drive.speed * wavenumber, drive.compliance(wavenumber)
        own, mean = found.get(FORCE, (none, none))
        if drive.slider.excitation == "base":
            own, mean = none, none + model.base_per_area * (drive.slider.stiffness + drive.slider.damping * turned)
        found["displacement"] = own * compliance, mean * compliance
        found["velocity"] = turned * compliance * own, turned * compliance * mean
    return found


_NODES = 12
_SWING = 8.0  # phase k d of a panel that still follows the swing of the spectrum, which has period pi
_RESOLVED = 4000.0  # phase to which every swing is followed; beyond it the swing holds less than 1e-8 of any integral
_SETTLED, _ABOVE = 256.0, 100.0  # the same for a slower slider, and for a faster one so many times its last corner
_AROUND, _SHARP = 2000.0, 30.0  # phases about a far resonance to which it is followed, if narrower than the second


@lru_cache(maxsize=8)
def frequencies(model: Model) -> tuple[Doubles, Doubles, Doubles, Doubles]:
    """Return the rule for all motions of a model: wavenumbers, weights over k/pi, S_1 and S - S_1."""
    drives = [drive_of(model)] if is_moved(model) else []
    if model.separation is not None:
        drives.append(contact_drive_of(model))
    edges = np.unique(np.concatenate([response_edges(model, drive) for drive in drives]))
    k, weight = panels(edges, _NODES)
    follows = np.repeat(np.diff(edges) * size_range(model.sizes)[1] <= 1.001 * _SWING, _NODES)
    return k, weight / pi, *area_noise(model).parts(k, exact=follows)


def response_edges(model: Model, drive: DrivenOscillator) -> Doubles:
    """Return the ends of panels in rad/um: octaves, of the distance from the resonance too, and short in a swing."""
    reach, swinging = size_range(model.sizes)[1], float(sizes_of(model.sizes).followed.max())
    half_width, breadth = drive.slider.damping_ratio * drive.resonance, max(1.0, 2.0 * drive.slider.damping_ratio)
    resolved = min(min(_RESOLVED, max(_SETTLED, _ABOVE * drive.resonance * breadth * reach)) / reach, swinging)
    lowest = 1e-3 * min(1.0 / reach, drive.resonance / breadth)
    apart = np.minimum(_octaves(0.5 * min(half_width, drive.resonance), drive.resonance), drive.resonance)
    around, swings = drive.resonance + np.concatenate([-apart, [0.0], apart]), np.arange(0.0, resolved, _SWING / reach)
    parts = [around, swings, _octaves(lowest, 1e4 * max(resolved, drive.resonance * breadth))]
    if resolved < drive.resonance < swinging and half_width * reach < _SHARP:
        parts.append(drive.resonance + np.arange(-_AROUND, _AROUND, _SWING) / reach)
    return np.unique(np.concatenate(parts))


def _octaves(lowest: float, highest: float) -> Doubles:
    return np.asarray(lowest * 2.0 ** np.arange(0.0, np.ceil(np.log2(highest / lowest)) + 1.0), dtype=np.float64)


@lru_cache(maxsize=8)
def covariances(model: Model) -> dict[tuple[str, str], float]:
    """Return the covariances of all pairs of what `answers` names at one time, in their units, to 1e-8."""
    (k, weight, alone, together), (lines, power) = frequencies(model), area_noise(model).lines
    found = answers(model, np.concatenate([k, lines]))
    own, mean = np.moveaxis(np.array(list(found.values())), 1, 0)
    single = spread_of(model.strengths) * np.append(weight * alone, np.zeros(lines.size))
    whole = np.append(weight * (alone + together), 2.0 * power)
    values = ((own * single) @ own.conj().T + (mean * whole) @ mean.conj().T).real
    return dict(zip(product(found, found), values.ravel().tolist(), strict=True))


def std_of(model: Model, name: str) -> float:
    """Return the stationary standard deviation of a quantity by its name."""
    return sqrt(covariances(model)[name, name])


def motion_spectrum(name: str, model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return the two-sided S_u(w) = |h|^2 S(w/V)/V of a motion or load, in its unit squared per rad/s, w in rad/s.

    ``name`` is displacement or velocity of the slider, or separation, normal_velocity or load; between lines at
    w = V k_n. Refused as `drive_of`, `contact_drive_of`, and without damping. Source: paper Eq. (1), Fig. 5; see above.
    """
    drive = drive_of(model) if name in MOTION else contact_drive_of(model)
    if drive.slider.damping == 0.0:
        raise Refused("without damping the slider's motion is not stationary and has no spectrum")
    return density_of(model, name, np.abs(np.asarray(angular_frequency, dtype=np.float64)) / drive.speed) / drive.speed


def density_of(model: Model, name: str, k: Doubles, *, exact: bool = True) -> Doubles:
    """Return the two-sided density of a quantity per rad/um at wavenumbers k >= 0 in rad/um, between lines."""
    if name == FORCE:
        strengths_of(model)
    own, mean = np.square(np.abs(answers(model, k)[name]))
    alone, together = area_noise(model).parts(k, exact=exact)
    return np.asarray(spread_of(model.strengths) * own * alone + mean * (alone + together), dtype=np.float64)


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Stationary motion of the one-way slider: displacement in um, velocity in um/s."""

    mean_displacement: float
    displacement_std: float
    velocity_std: float
    sliding_speed: float

    @property
    def one_way_validity(self) -> float:
        """Spread of x' over V: one-way coupling assumes that it is small; above 0.1 results get a warning."""
        return self.velocity_std / self.sliding_speed

    @property
    def upcrossing_rate(self) -> float:
        """How often x passes its mean upwards in a second if it is Gaussian, std x'/(2 pi std x) (Rice 1945)."""
        return self.velocity_std / (2.0 * pi * self.displacement_std) if self.displacement_std else nan


def response(model: Model) -> Response:
    """Return the one-way slider's stationary mean and spreads, which are inf without damping; Refused as `drive_of`."""
    drive = drive_of(model)
    if drive.slider.excitation == "base":
        lift = model.base_per_area
    else:
        lift = strengths_of(model).mean / drive.slider.stiffness
    place, speed = (std_of(model, name) if is_moved(model) else inf for name in MOTION)
    return Response(
        mean_displacement=lift * model.stationary_mean_area,
        displacement_std=place,
        velocity_std=speed,
        sliding_speed=drive.speed,
    )


def spread_errors(model: Model, names: Sequence[str], distance: float) -> list[float]:
    """Return the standard errors of the stds of some quantities over a run of many lives and decay times.

    The variance of the mean of u^2 is (2/T)(1/2 pi) int S_u^2 dw + (lam V/T) E[(int y^2 dt)^2], y the response to one
    junction; the error is the root of that over 2 std u. Source: cumulants of filtered shot noise (Rice 1944).
    """
    k, weight, alone, _ = frequencies(model)
    sizes, psi = sizes_of(model.sizes, COARSE), sizes_of(model.strengths or AREA_ITSELF, COARSE)
    found = answers(model, k)
    own, mean = np.moveaxis(np.array([found[name] for name in names]), 1, 0)
    deviation = psi.diameter - float(psi.probability @ psi.diameter)
    brought = weight * np.square(np.abs(deviation[:, None] * own[:, None] + mean[:, None]))
    gaussian = 2.0 * np.square(alone * (psi.probability @ brought)) @ (1.0 / weight)
    fourth = np.zeros(len(names))
    for diameter, probability in zip(sizes.diameter.tolist(), sizes.probability.tolist(), strict=True):
        lives, shares = pass_energies(model.pulse, k * diameter)
        energies = diameter**6 * np.einsum("vpk,lk->vpl", brought, lives)
        fourth += probability * psi.probability @ np.square(energies) @ shares
    errors = 0.5 * np.sqrt((gaussian + model.birth_rate * fourth) / distance)
    return [error / std_of(model, name) for name, error in zip(names, errors.tolist(), strict=True)]
