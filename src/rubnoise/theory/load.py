"""A load that weighs, of first order: the motion of the separation, the friction force under it, and their validity.

Read it from above: the contact's scales and its regime, the response of each quantity to the area at constant
separation, the spreads and covariances that follow, levels in third octaves, and the errors of a finite run.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import erfc, hypot, inf, log10, nan, pi, sqrt
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Complexes, Doubles
from rubnoise.model import Model
from rubnoise.tables import fields_as_text
from rubnoise.theory.drive import drive_of, separation_of
from rubnoise.theory.quadrature import distinct, panels
from rubnoise.theory.regular_births import need_random_births
from rubnoise.theory.response import response, response_edges, response_rules
from rubnoise.theory.sampling import (
    carried_momentum,
    force_std_error,
    mean_force_error,
    mean_square_variances,
    motion_errors,
)
from rubnoise.theory.spectrum import force_spectral_density, mean_spectral_density, spectral_density

Regime = Literal["constant load", "resonance", "constant gap", "bouncing"]

FEWEST_LIVE: Final = 10.0
"""Live junctions in the mean below which a slider leaves its contact and bounces."""

STILL: Final = 1.0 / 3.0
"""Spread of the load over that at constant separation up to which the load counts as constant."""

SAME: Final = 0.1
"""Largest difference from 1 of that ratio with which the separation counts as constant."""

FORCE: Final = "friction_force"

REFERENCE: Final = 0.05
"""The velocity in um/s that is 0 dB in roughness noise: 50 nm/s."""


def level(velocity: float) -> float:
    """Return the level of a root mean square velocity (um/s) in dB re 50 nm/s; -inf of none."""
    return 20.0 * log10(velocity / REFERENCE) if velocity > 0.0 else -inf


def overlap_scale(model: Model) -> float:
    """Return c = sqrt(E[d^2]) = sqrt(4 A_rm / (pi N_jm)) in um, the root mean square diameter of Rayleigh sizes."""
    return sqrt(4.0 * model.mean_real_contact_area / (pi * model.mean_junction_count))


def relative_speed(model: Model) -> float:
    """Return v = V / (c omega_c), omega_c the contact resonance; at a small one the separation follows the contact."""
    drive = drive_of(separation_of(model))
    return 1.0 / (overlap_scale(model) * drive.resonance)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LoadMotion:
    """Stationary motion under a load that weighs, of first order: um, um/s, uN, Hz.

    relative_speed: V/(c omega_c); negative_share: of time in which P would be negative, P taken to be Gaussian;
    suppression: spread of the slider's displacement (without a slider of the friction force, without a strength of the
    load) at constant separation over that under the load; error: bound of the relative error of the spreads of
    separation, normal velocity and load, not of a slider's displacement; covariances: of the ``names`` with one
    another, at one time and in products of their units.
    """

    separation_std: float
    velocity_std: float
    load_std: float
    contact_resonance: float
    damping_ratio: float
    relative_speed: float
    regime: Regime
    suppression: float
    negative_share: float
    error: float
    names: tuple[str, ...]
    covariances: Doubles

    def __repr__(self) -> str:
        return fields_as_text(self)

    @property
    def velocity_level(self) -> float:
        """Level of the normal velocity in dB re 50 nm/s."""
        return level(self.velocity_std)

    def covariance(self, one: str, other: str) -> float:
        """Return the covariance of two quantities at one time, in the product of their units."""
        return float(self.covariances[self.names.index(one), self.names.index(other)])


@lru_cache(maxsize=8)
def load_motion(model: Model) -> LoadMotion:
    """Return the exact stationary spreads and covariances of the linear model.

    m z'' + c z' + (W/s_0) z = W eps, eps = A_r/A_rm - 1 at constant separation; P = W + m z'' + c z'; F = sum of psi A
    less E[psi] A_rm z/s_0. With S the density of the area and o, m the answers of `answers`,
    Cov[u, v] = (1/pi) int_0^inf S(k) Re(Var[psi] o_u o_v* + m_u m_v*) dk. Raises Refused without a load that weighs or
    a sliding speed, and unless births are a Poisson process.
    Source: Crandall and Mark, Random Vibration in Mechanical Systems (1963).
    """
    need_random_births(model, "the motion under a load")
    drive, speed = drive_of(separation_of(model)), relative_speed(model)
    names, covariances = _covariances(model)
    spread = dict(zip(names, np.sqrt(np.diagonal(covariances)).tolist(), strict=True))
    weight, ratio = drive.strengths.mean * model.mean_real_contact_area, drive.slider.damping_ratio
    still = weight * _still_spread(model)
    return LoadMotion(
        separation_std=spread["separation"],
        velocity_std=spread["normal_velocity"],
        load_std=spread["load"],
        contact_resonance=drive.slider.natural_frequency,
        damping_ratio=ratio,
        relative_speed=speed,
        regime=_regime(model.mean_junction_count, speed, spread["load"] / still),
        suppression=_suppression(model, spread, still),
        negative_share=0.5 * erfc(weight / (spread["load"] * sqrt(2.0))),
        error=_error(model.mean_junction_count, speed, ratio),
        names=names,
        covariances=covariances,
    )


def _regime(live: float, speed: float, kept: float) -> Regime:
    """Return the regime for a live count, a relative speed and the share of the load's spread that is kept."""
    if live < FEWEST_LIVE:
        return "bouncing"
    if speed < 1.0 and kept <= STILL:
        return "constant load"
    return "constant gap" if speed > 1.0 and abs(kept - 1.0) <= SAME else "resonance"


def _error(live: float, speed: float, ratio: float) -> float:
    """Return the bound of the error of first order, relative to a spread of z, z' or P, from runs of 20 live junctions.

    1 % up to v = 0.1, 2 % from a damping ratio of 0.3 on, 10 % from 0.05 on; fewer junctions err more, as 1/N_jm. inf
    if nothing is known: less damping, and contacts that bounce.
    """
    if live < FEWEST_LIVE or ratio < 0.05:
        return inf
    return max(20.0 / live, 1.0) * (0.01 if speed <= 0.1 else 0.02 if ratio >= 0.3 else 0.1)


def _still_spread(model: Model) -> float:
    """Return std over mean of the area at constant separation, which P/W has there; sqrt(2/N_jm) for Rayleigh sizes."""
    variance = model.birth_rate * model.pulse.life_integral(2) * model.sizes.moment(5)
    return sqrt(variance) / model.mean_real_contact_area


def _suppression(model: Model, spread: dict[str, float], still: float) -> float:
    if "displacement" in spread:
        return response(replace(model, separation=None)).displacement_std / spread["displacement"]
    if model.strengths is not None:
        free = sqrt(model.strengths.moment(2)) * model.mean_real_contact_area * _still_spread(model)
        return free / spread[FORCE]
    return still / spread["load"]


def answers(model: Model, wavenumber: Doubles) -> dict[str, tuple[Complexes, Complexes]]:
    """Return the response of each quantity to the transform of the area at wavenumbers in rad/um, by name.

    A pair o, m: a junction of strength psi brings (psi - E[psi]) o + m to it. The separation (um), its velocity (um/s)
    and the load P (uN) take no notice of strengths, whose deviations reach the friction force (uN) whole.
    """
    drive = drive_of(separation_of(model))
    none, turned = np.zeros_like(wavenumber, dtype=np.complex128), 1.0j * drive.speed * wavenumber
    hardness, borne = drive.strengths.mean, drive.borne(wavenumber)
    separation = hardness * drive.compliance(wavenumber)
    found = {
        "separation": (none, separation),
        "normal_velocity": (none, turned * separation),
        "load": (none, hardness * borne),
    }
    if model.strengths is not None:
        found[FORCE] = (none + 1.0, model.strengths.mean * borne)
    if model.slider is not None:
        compliance = drive_of(model).compliance(wavenumber)
        own, mean = (part * compliance for part in found[FORCE])
        found |= {"displacement": (own, mean), "velocity": (turned * own, turned * mean)}
    return found


def _covariances(model: Model) -> tuple[tuple[str, ...], Doubles]:
    psi = model.strengths
    spread = 0.0 if psi is None else max(psi.moment(2) - psi.mean**2, 0.0)
    total: Doubles | float = 0.0
    driven = separation_of(model) if model.slider is None else model
    rules = response_rules(driven, drive_of(driven))
    for (k, weights), density in zip(rules, (spectral_density, mean_spectral_density), strict=True):
        found = answers(model, k)
        own, mean = (np.stack([pair[part] for pair in found.values()]) for part in (0, 1))
        power = weights * density(model, k) / pi
        total = total + (spread * (own * power) @ own.conj().T + (mean * power) @ mean.conj().T).real
    return tuple(found), np.asarray(total)


def load_spectrum(model: Model, angular_frequency: ArrayLike) -> Doubles:
    """Return the two-sided spectral density of the load P in uN^2 per rad/s, w in rad/s of any shape.

    H^2 S(w/V)/V |r|^2, r the part that mass and damping bear. Those of separation and normal velocity are
    `displacement_spectrum` and `velocity_spectrum` of `rubnoise.theory.drive.separation_of`.
    """
    separation = separation_of(model)
    drive = drive_of(separation)
    k = np.abs(np.asarray(angular_frequency, dtype=np.float64)) / drive.speed
    density = force_spectral_density(separation, drive.strengths, k) / drive.speed
    return density * np.square(np.abs(drive.borne(k)))


THIRD: Final = 10.0**0.05
"""Upper edge over middle of a third-octave band, by powers of ten as IEC 61260-1 has them."""

_PART_LEFT_OUT: Final = 1e-6
_BAND_NODES: Final = 16


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ThirdOctaves:
    """Root mean square velocities (um/s) in third-octave bands about frequencies in Hz."""

    frequency: Doubles
    velocity: Doubles

    @property
    def level(self) -> Doubles:
        """Levels in dB re 50 nm/s."""
        return np.array([level(each) for each in self.velocity.tolist()])


def band_numbers(lowest: float, highest: float) -> range:
    """Return the numbers n of the bands about 10^(n/10) Hz whose middles lie between two frequencies in Hz."""
    return range(int(np.ceil(10.0 * log10(lowest))), int(np.floor(10.0 * log10(highest))) + 1)


def third_octaves(model: Model) -> ThirdOctaves:
    """Return the normal velocity in third octaves, if a band holds more than 1e-6 of its power (60 dB).

    The integral of `velocity_spectrum` over the band, by the panels of `response_edges`.
    """
    separation = separation_of(model)
    drive = drive_of(separation)
    natural = drive.slider.natural_frequency
    numbers = band_numbers(1e-4 * natural, 1e4 * natural)
    middles = 10.0 ** (0.1 * np.array(numbers))
    edges = response_edges(separation, drive)
    power = np.zeros(middles.size)
    for band, middle in enumerate(middles.tolist()):
        ends = 2.0 * pi / drive.speed * middle * np.array([1.0 / THIRD, THIRD])
        inside = edges[(edges > ends[0]) & (edges < ends[1])]
        k, weights = panels(distinct(np.append(ends, inside)), _BAND_NODES)
        density = force_spectral_density(separation, drive.strengths, k, exact=False)
        power[band] = float(weights @ (density * drive.gain(k) * np.square(drive.speed * k))) / pi
    kept = power > _PART_LEFT_OUT * response(separation).velocity_std ** 2
    return ThirdOctaves(frequency=middles[kept], velocity=np.sqrt(power[kept]))


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadErrors:
    """Standard errors over one run: um, um/s and uN; those of the friction force are nan without a strength."""

    separation_mean: float
    separation_std: float
    velocity_std: float
    load_mean: float
    load_std: float
    force_mean: float
    force_std: float


def start_excess(model: Model, distance: float) -> tuple[float, float]:
    """Return the part of the start at z = z' = 0 in the mean squares of z' (um^2/s^2) and P - W (uN^2) over a run.

    It is the free decay y from the values of a stationary separation, over ``distance`` um or T: E[int y'^2 dt]/T
    and K^2 E[int y^2 dt]/T, with int y'^2 dt = e/c, e = (m y'_0^2 + K y_0^2)/2, and
    int y^2 dt = (c y_0^2/2 + m y_0 y'_0 + m e/c)/K, from m y'' + c y' + K y = 0.
    """
    drive, motion = drive_of(separation_of(model)), load_motion(model)
    slider, square = drive.slider, motion.separation_std**2
    energy = 0.5 * (slider.mass * motion.velocity_std**2 + slider.stiffness * square)
    decay = (0.5 * slider.damping * square + slider.mass / slider.damping * energy) / slider.stiffness
    rate = drive.speed / distance
    return energy / slider.damping * rate, slider.stiffness**2 * decay * rate


def load_errors(model: Model, distance: float, *, from_start: bool = True) -> LoadErrors:
    """Return standard errors of the motion under a load over a run of ``distance`` um.

    Those of `motion_errors` for the separation, which bounds the mean's. The mean of P - W is what momentum and damping
    carry from start to end, (m dz' + c dz)/T. A run ``from_start`` has `start_excess` in the squares of z' and P - W,
    which is as uncertain as it is large: for Gaussian z and z' its root mean square is at most sqrt(3) times as much.
    """
    separation = separation_of(model)
    drive, motion = drive_of(separation), load_motion(model)
    errors = motion_errors(separation, distance)
    fast, excess = (sqrt(3.0) * each * from_start for each in start_excess(model, distance))
    square = mean_square_variances(separation, drive, lambda k: np.square(np.abs(drive.borne(k)))[None])[0]
    force_mean, force_std = nan, nan
    if model.strengths is not None:
        friction, std = model.strengths.mean / drive.strengths.mean, motion.covariance(FORCE, FORCE) ** 0.5
        force_mean = mean_force_error(model, distance)
        force_std = hypot(force_std_error(model, distance), friction**2 * excess / (2.0 * std))
    return LoadErrors(
        separation_mean=errors.mean_displacement,
        separation_std=errors.displacement_std,
        velocity_std=hypot(errors.velocity_std, fast / (2.0 * motion.velocity_std)),
        load_mean=carried_momentum(separation) * drive.speed / distance,
        load_std=hypot(sqrt(float(square) * drive.speed / distance), excess) / (2.0 * motion.load_std),
        force_mean=force_mean,
        force_std=force_std,
    )
