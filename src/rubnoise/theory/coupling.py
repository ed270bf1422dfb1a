"""How a slider's motion acts back on the contact: weak two-way coupling, and a load that weighs, of first order."""

from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import erfc, hypot, inf, log10, nan, pi, sqrt
from typing import Final, Literal

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import RegularBirths
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.tables import fields_as_text
from rubnoise.theory import motion
from rubnoise.theory.sampling import motion_errors
from rubnoise.theory.second_order import are_at_random, area_noise, autocovariance, is_one_life, need_random_births
from rubnoise.theory.sizes import panels

Regime = Literal["constant load", "resonance", "constant gap", "bouncing"]

_ROUNDING = 1e-12  # of the variance for births at random, below which a variance is none
WEAK = 0.1  # first change of the variance, 3 Pi + q, from which more than the law of weak coupling is at work
WHITE = 0.95  # r^2 / Pi below which the slider feels that junctions live for a while
FEWEST_LIVE: Final = 10.0  # live junctions in the mean below which a slider leaves its contact and bounces
STILL: Final = 1.0 / 3.0  # spread of the load over that at constant separation up to which the load counts as constant
SAME: Final = 0.1  # largest difference from 1 of that ratio with which the separation counts as constant
REFERENCE: Final = 0.05  # the velocity in um/s that is 0 dB in roughness noise: 50 nm/s
THIRD: Final = 10.0**0.05  # upper edge over middle of a third-octave band, by powers of ten as IEC 61260-1 has them


def force_slope_std(model: Model) -> float:
    """Return the standard deviation of F' = dF/ds in uN/um, F the stationary friction force; its mean is 0.

    Var F' = lam E[psi^2] b m_3, b d^3 the integral of A'^2 over a life (Campbell); other births add E[psi]^2 times the
    integral of k^2 of their part of the spectrum, to 1e-4. Raises Refused without a strength.
    """
    psi, noise = motion.strengths_of(model), area_noise(model)
    at_random = model.birth_rate * psi.moment(2) * model.pulse.squared_slope * model.sizes.moment(3)
    if are_at_random(model):
        return sqrt(at_random)
    lines, power = noise.lines
    births = 2.0 * float(power @ lines**2)
    if is_one_life(model) and isinstance(model.births, RegularBirths):
        births -= at_random / psi.moment(2)  # equal lives leave nothing between lines
    else:
        k, weight = panels(np.linspace(0.0, 3000.0 / model.mean_life_distance, 401), 16)
        births += float((weight / pi * noise.parts(k)[1]) @ k**2)
    variance = at_random + psi.mean**2 * births
    return sqrt(variance) if variance > _ROUNDING * at_random else 0.0


@dataclass(frozen=True, slots=True)
class Coupling:
    """Pi, theta, and std x over that in one-way coupling: numbers, nan where unknown, and why that is."""

    strength: float
    stick_number: float
    expected_change: float
    unknown: str | None


@lru_cache(maxsize=8)
def coupling(model: Model) -> Coupling:
    """Return how strongly a slider acts back on its contact, and the change of vibration for weak coupling.

    strength Pi = S_F(0)/(2 m c V^3), Poisson births at constant separation, inf without damping: the square of r = std
    x'/V, one-way, for a force white in s. stick_number theta = std F'/k: beyond about 1 a slow slider sticks.
    expected_change as `weak_coupling_change`, for r^2 >= 0.95 Pi and 3 Pi + q < 0.1, q = c_1 E[psi^3] m_9 / (E[psi^2]
    m_6 m V^2). Raises Refused as `drive_of`, and over a base.
    """
    motion.need_friction(model)
    drive, known = motion.drive_of(model), are_at_random(model) and model.separation is None
    slider, psi, sizes = drive.slider, motion.strengths_of(model), model.sizes
    strength = inf if known else nan  # a force of other births, or under a load, says nothing at low frequency
    if known and slider.damping > 0.0:
        strength = float(area_noise(model, psi).density(0.0)) / (2.0 * slider.mass * slider.damping * drive.speed**3)
    impulse = model.pulse.integral_moment(3) / model.pulse.integral_moment(2) * psi.moment(3) / psi.moment(2)
    kick = impulse * sizes.moment(9) / sizes.moment(6) / (slider.mass * drive.speed**2)
    unknown = _unknown(model, strength, kick)
    change = nan if unknown else weak_coupling_change(strength, kick)
    return Coupling(strength, force_slope_std(model) / slider.stiffness, change, unknown)


def _unknown(model: Model, strength: float, kick: float) -> str | None:
    """Return the reason why the change is unknown, if it is."""
    if strength == inf:
        return "without damping nothing is stationary"
    if not are_at_random(model):
        return "it is known for births at random alone"
    if model.separation is not None:
        return "it is known at constant separation alone"
    if 3.0 * strength + kick >= WEAK:
        return "the coupling is too strong for the law of weak coupling"
    if motion.response(model).one_way_validity ** 2 < WHITE * strength:
        return "a junction lives too long for the slider to take its force for white noise"
    return None


def weak_coupling_change(strength: float, kick: float) -> float:
    """Return sqrt(u/Pi), u the smaller root of u = Pi (1 + q + (3 + 10 q) u + 15 u^2); nan if there is none.

    u = Var x'/V^2 by the balance of energy: a junction with J = int psi A ds takes 2 J/m from w^2, w = V - x', and
    brings V (w - sqrt(w^2 - 2 J/m)) - J/m of energy per mass, lam w a second; c Var x' is lost, x' nearly Gaussian:
    <V^2/w^2> = 1 + 3 u + 15 u^2, <V^4/w^4> = 1 + 10 u. The kick q = E[J^3]/(E[J^2] m V^2).
    """
    lost = 1.0 - (3.0 + 10.0 * kick) * strength
    under_root = lost * lost - 60.0 * strength**2 * (1.0 + kick)
    if lost <= 0.0 or under_root < 0.0:
        return nan
    return sqrt(2.0 * (1.0 + kick) / (lost + sqrt(under_root)))


def weak_motion(model: Model) -> motion.Response:
    """Return the stationary motion of a two-way slider with weak coupling; Refused if the law does not hold."""
    found = coupling(model)
    if found.unknown is not None:
        raise Refused(f"no theory has the motion here, since this slider pushes back: {found.unknown}")
    drive, one_way, change = motion.drive_of(model), motion.response(model), found.expected_change
    # The mean force exceeds that of one-way coupling by c Var x'/V.
    excess = drive.slider.damping * (one_way.velocity_std * change) ** 2 / drive.speed
    return replace(
        one_way,
        mean_displacement=one_way.mean_displacement + excess / drive.slider.stiffness,
        displacement_std=one_way.displacement_std * change,
        velocity_std=one_way.velocity_std * change,
    )


def weak_motion_errors(model: Model, distance: float) -> dict[str, float]:
    """Return standard errors of the figures of `weak_motion` over a run of ``distance`` um; Refused as both."""
    # Those of one-way coupling grow with the spread. The law itself errs by its next term, 105 u^3 in <V^2/w^2>, and by
    # the share 1 - r^2/Pi of the feedback that a force loses which is not quite white.
    moves, found = weak_motion(model), coupling(model)
    change, u = found.expected_change, found.strength * found.expected_change**2
    coloured = max(1.0 - motion.response(model).one_way_validity ** 2 / found.strength, 0.0)
    unknown = hypot(52.5 * u**3, coloured * (change - 1.0))
    errors = {name: change * error for name, error in motion_errors(model, distance).items()}
    for name, spread in (("displacement_std", moves.displacement_std), ("velocity_std", moves.velocity_std)):
        errors[name] = hypot(errors[name], unknown * spread)
    return errors


def level(velocity: float) -> float:
    """Return the level of a root mean square velocity (um/s) in dB re 50 nm/s; -inf of none."""
    return 20.0 * log10(velocity / REFERENCE) if velocity > 0.0 else -inf


def overlap_scale(model: Model) -> float:
    """Return c = sqrt(E[d^2]) = sqrt(4 A_rm / (pi N_jm)) in um, the root mean square diameter of Rayleigh sizes."""
    return sqrt(4.0 * model.mean_real_contact_area / (pi * model.mean_junction_count))


def relative_speed(model: Model) -> float:
    """Return v = V / (c omega_c), omega_c the contact resonance; at a small one the separation follows the contact."""
    return 1.0 / (overlap_scale(model) * motion.contact_drive_of(model).resonance)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LoadMotion:
    """Stationary motion under a load that weighs, of first order: um, um/s, uN, Hz.

    negative_share: of time with P < 0, P Gaussian; suppression: spread of the slider's displacement (else of friction
    force, else of load) at constant separation over that here; error: relative bound of spreads but the slider's.
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
    covariances: dict[tuple[str, str], float] = field(repr=False)

    __repr__ = fields_as_text

    @property
    def velocity_level(self) -> float:
        """Level of the normal velocity in dB re 50 nm/s."""
        return level(self.velocity_std)


def load_motion(model: Model) -> LoadMotion:
    """Return the exact stationary spreads and covariances of the linear model.

    m z'' + c z' + (W/s_0) z = W eps, eps = A_r/A_rm - 1 at constant separation; P = W + m z'' + c z'; F = sum of psi A
    less E[psi] A_rm z/s_0. Raises Refused as `contact_drive_of`, and unless births are a Poisson process.
    """
    need_random_births(model, "the motion under a load")
    drive, speed = motion.contact_drive_of(model), relative_speed(model)
    place, velocity, load = (motion.std_of(model, name) for name in ("separation", "normal_velocity", "load"))
    slider, held = drive.slider, drive.gain * sqrt(float(autocovariance(model, 0.0)))
    regime, error = _validity(model.mean_junction_count, speed, load / held, slider.damping_ratio)
    return LoadMotion(
        separation_std=place,
        velocity_std=velocity,
        load_std=load,
        contact_resonance=slider.natural_frequency,
        damping_ratio=slider.damping_ratio,
        relative_speed=speed,
        regime=regime,
        suppression=_suppression(model, held),
        negative_share=0.5 * erfc(drive.gain * model.mean_real_contact_area / (load * sqrt(2.0))),
        error=error,
        covariances=motion.covariances(model),
    )


def _validity(live: float, speed: float, kept: float, ratio: float) -> tuple[Regime, float]:
    """Return the regime, ``kept`` being the share of the load's spread, and the relative error of first order."""
    # From runs of 20 live junctions; fewer err more, as 1/N_jm, and nothing is known of little damping.
    error = max(20.0 / live, 1.0) * (0.01 if speed <= 0.1 else 0.02 if ratio >= 0.3 else 0.1)
    if live < FEWEST_LIVE:
        return "bouncing", inf
    still, same = speed < 1.0 and kept <= STILL, speed > 1.0 and abs(kept - 1.0) <= SAME
    return "constant load" if still else "constant gap" if same else "resonance", error if ratio >= 0.05 else inf


def _suppression(model: Model, held: float) -> float:
    """Return a spread at constant separation over that under the load, ``held`` being that of H A."""
    if model.slider is not None:
        free = motion.response(replace(model, separation=None)).displacement_std
        return free / motion.std_of(model, "displacement") if motion.is_moved(model) else nan
    if model.strengths is not None:
        force = held / motion.contact_drive_of(model).gain * sqrt(model.strengths.moment(2))
        return force / motion.std_of(model, motion.FORCE)
    return held / motion.std_of(model, "load")


def band_numbers(lowest: float, highest: float) -> range:
    """Return the numbers n of the bands about 10^(n/10) Hz whose middles lie between two frequencies in Hz."""
    return range(int(np.ceil(10.0 * log10(lowest))), int(np.floor(10.0 * log10(highest))) + 1)


def third_octaves(model: Model) -> dict[str, Doubles]:
    """Return the normal velocity (um/s) in third octaves with over 1e-6 of its power, frequency (Hz) and level (dB)."""
    drive = motion.contact_drive_of(model)
    natural = drive.slider.natural_frequency
    middles = 10.0 ** (0.1 * np.array(band_numbers(1e-4 * natural, 1e4 * natural)))
    ends = 2.0 * pi / drive.speed * np.append(middles / THIRD, middles[-1] * THIRD)
    edges = motion.response_edges(model, drive)
    k, weight = panels(np.unique(np.concatenate([ends, edges[(edges > ends[0]) & (edges < ends[-1])]])), 8)
    density = motion.density_of(model, "normal_velocity", k, exact=False)
    power = np.histogram(k, ends, weights=weight * density / pi)[0]
    kept = power > 1e-6 * motion.covariances(model)["normal_velocity", "normal_velocity"]
    velocity = np.sqrt(power[kept])
    return {"frequency": middles[kept], "velocity": velocity, "level": 20.0 * np.log10(velocity / REFERENCE)}


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeLimits:
    """Scales of free motion (Hz; the rest without units), its exact means (uN, um^2), and its limit.

    Of live N; impact_damping: beta s_0 omega_c; nan where unknown; fast_area_mean: the limit of the mean area at high
    speeds; first_order: that of small v and large N, of an elastic contact with a dashpot.
    """

    contact_resonance: float
    relative_speed: float
    live: float
    damping_ratio: float
    restitution: float
    impact_damping: float
    load_mean: float
    area_mean: float
    force_mean: float
    fast_area_mean: float
    first_order: LoadMotion | None


def free_motion(model: Model) -> FreeLimits:
    """Return the exact results for a slider that is free to leave its contact; for the rest there is no theory.

    The mean of P is W. Of an elastic contact P = H sum A_i, so the mean area is A_rm and the mean friction force E[psi]
    A_rm. At high speeds half of the area shrinks, which bears e^2 as much: the mean area tends to 2 A_rm/(1 + e^2).
    Raises Refused without free motion.
    """
    if model.free is None:
        raise Refused('the slider leaves its contact with load.motion = "free" alone')
    free, held = model.free, model.free.held
    linear, resonance = replace(model, free=None, separation=held), held.oscillator
    elastic, e = free.restitution == 1.0, nan if free.restitution is None else free.restitution
    beta = nan if free.impact_damping is None else free.impact_damping
    area, psi = model.mean_real_contact_area if elastic else nan, model.strengths
    return FreeLimits(
        contact_resonance=resonance.natural_frequency,
        relative_speed=relative_speed(linear),
        live=model.mean_junction_count,
        damping_ratio=resonance.damping_ratio,
        restitution=e,
        impact_damping=beta * held.height_scale * resonance.natural_angular_frequency,
        load_mean=held.load,
        area_mean=area,
        force_mean=nan if psi is None else psi.mean * area,
        fast_area_mean=2.0 * model.mean_real_contact_area / (1.0 + e**2),
        first_order=load_motion(linear) if elastic and held.damping > 0.0 else None,
    )
