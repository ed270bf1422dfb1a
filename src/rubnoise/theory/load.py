"""A load that weighs, of first order: the motion of the separation, the friction force under it, and their validity."""

from dataclasses import dataclass, field, replace
from math import erfc, inf, log10, nan, pi, sqrt
from typing import Final, Literal

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.tables import fields_as_text
from rubnoise.theory.motion import (
    FORCE,
    contact_drive_of,
    covariances,
    density_of,
    is_moved,
    response,
    response_edges,
    std_of,
)
from rubnoise.theory.second_order import autocovariance, need_random_births
from rubnoise.theory.sizes import panels

Regime = Literal["constant load", "resonance", "constant gap", "bouncing"]

FEWEST_LIVE: Final = 10.0  # live junctions in the mean below which a slider leaves its contact and bounces
STILL: Final = 1.0 / 3.0  # spread of the load over that at constant separation up to which the load counts as constant
SAME: Final = 0.1  # largest difference from 1 of that ratio with which the separation counts as constant
REFERENCE: Final = 0.05  # the velocity in um/s that is 0 dB in roughness noise: 50 nm/s
THIRD: Final = 10.0**0.05  # upper edge over middle of a third-octave band, by powers of ten as IEC 61260-1 has them
_PART_LEFT_OUT: Final = 1e-6


def level(velocity: float) -> float:
    """Return the level of a root mean square velocity (um/s) in dB re 50 nm/s; -inf of none."""
    return 20.0 * log10(velocity / REFERENCE) if velocity > 0.0 else -inf


def overlap_scale(model: Model) -> float:
    """Return c = sqrt(E[d^2]) = sqrt(4 A_rm / (pi N_jm)) in um, the root mean square diameter of Rayleigh sizes."""
    return sqrt(4.0 * model.mean_real_contact_area / (pi * model.mean_junction_count))


def relative_speed(model: Model) -> float:
    """Return v = V / (c omega_c), omega_c the contact resonance; at a small one the separation follows the contact."""
    return 1.0 / (overlap_scale(model) * contact_drive_of(model).resonance)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LoadMotion:
    """Stationary motion under a load that weighs, of first order: um, um/s, uN, Hz.

    negative_share: of time with P < 0, P Gaussian; suppression: spread of the slider's displacement (else of friction
    force, else of load) at constant separation over that here; error: bound of the relative error of spreads, not of
    the slider's.
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
    drive, speed = contact_drive_of(model), relative_speed(model)
    place, velocity, load = (std_of(model, name) for name in ("separation", "normal_velocity", "load"))
    slider, held = drive.slider, drive.gain * sqrt(float(autocovariance(model, 0.0)))
    return LoadMotion(
        separation_std=place,
        velocity_std=velocity,
        load_std=load,
        contact_resonance=slider.natural_frequency,
        damping_ratio=slider.damping_ratio,
        relative_speed=speed,
        regime=_regime(model.mean_junction_count, speed, load / held),
        suppression=_suppression(model, held),
        negative_share=0.5 * erfc(drive.gain * model.mean_real_contact_area / (load * sqrt(2.0))),
        error=_error(model.mean_junction_count, speed, slider.damping_ratio),
        covariances=covariances(model),
    )


def _regime(live: float, speed: float, kept: float) -> Regime:
    """Return the regime for a live count, a relative speed and the share of the load's spread that is kept."""
    if live < FEWEST_LIVE:
        return "bouncing"
    if speed < 1.0:
        return "constant load" if kept <= STILL else "resonance"
    return "constant gap" if speed > 1.0 and abs(kept - 1.0) <= SAME else "resonance"


def _error(live: float, speed: float, ratio: float) -> float:
    """Return the error of first order of a spread, from runs of 20 live junctions; fewer err more, as 1/N_jm."""
    if live < FEWEST_LIVE or ratio < 0.05:
        return inf  # nothing is known of little damping, and of contacts that bounce
    return max(20.0 / live, 1.0) * (0.01 if speed <= 0.1 else 0.02 if ratio >= 0.3 else 0.1)


def _suppression(model: Model, held: float) -> float:
    """Return a spread at constant separation over that under the load, ``held`` being that of H A."""
    if model.slider is not None:
        free = response(replace(model, separation=None)).displacement_std
        return free / std_of(model, "displacement") if is_moved(model) else nan
    if model.strengths is not None:
        return held / contact_drive_of(model).gain * sqrt(model.strengths.moment(2)) / std_of(model, FORCE)
    return held / std_of(model, "load")


def band_numbers(lowest: float, highest: float) -> range:
    """Return the numbers n of the bands about 10^(n/10) Hz whose middles lie between two frequencies in Hz."""
    return range(int(np.ceil(10.0 * log10(lowest))), int(np.floor(10.0 * log10(highest))) + 1)


def third_octaves(model: Model) -> dict[str, Doubles]:
    """Return the velocity (um/s) in third octaves about each frequency (Hz) and its level (dB re 50 nm/s).

    It is that along the normal; bands hold more than 1e-6 of its power (60 dB).
    """
    drive = contact_drive_of(model)
    natural = drive.slider.natural_frequency
    middles = 10.0 ** (0.1 * np.array(band_numbers(1e-4 * natural, 1e4 * natural)))
    ends = 2.0 * pi / drive.speed * np.append(middles / THIRD, middles[-1] * THIRD)
    edges = response_edges(model, drive)
    k, weight = panels(np.unique(np.concatenate([ends, edges[(edges > ends[0]) & (edges < ends[-1])]])), 16)
    density = density_of(model, "normal_velocity", k, exact=False)
    power = np.histogram(k, ends, weights=weight * density / pi)[0]
    kept = power > _PART_LEFT_OUT * covariances(model)["normal_velocity", "normal_velocity"]
    velocity = np.sqrt(power[kept])
    return {"frequency": middles[kept], "velocity": velocity, "level": 20.0 * np.log10(velocity / REFERENCE)}


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeMotion:
    """Scales of free motion (Hz; the rest without units), its exact means (uN, um^2), and its limit.

    live: N; restitution, or impact_damping as beta s_0 omega_c; means: nan where unknown; fast_area_mean: what the mean
    area tends to at high speeds; first_order: the limit of small v and large N, of an elastic contact with a dashpot.
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


def free_motion(model: Model) -> FreeMotion:
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
    return FreeMotion(
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
