"""Compare the motion under a load that weighs, and the friction force under it, with linear theory."""

from dataclasses import dataclass, field
from math import ceil, log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.comparing.findings import Finding, Identity, judged, judged_mean, tail_of, too_short
from rubnoise.analysis.comparing.motion import FORGOTTEN
from rubnoise.analysis.moments import first_stationary_tick, needed_for_mean, over_ticks
from rubnoise.analysis.reading import checked_chunks
from rubnoise.analysis.summary import FEWEST_DECAYS, slowest_decay
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model, Separation
from rubnoise.record.reader import Rows
from rubnoise.record.tally import Moments
from rubnoise.theory.cumulants import force_cumulants
from rubnoise.theory.load import load_motion
from rubnoise.theory.motion import contact_drive_of
from rubnoise.theory.sampling import load_errors

_ROUNDING = 2.0**-48
_FAR = 12.0  # standard deviations


def first_still_tick(model: Model) -> int:
    """Return the first tick at which the contact is stationary and the start leaves a thousandth of the load's spread.

    At the start the load lacks the part of the separation: W/s_0 std z, and W after an empty start.
    """
    drive, motion = contact_drive_of(model), load_motion(model)
    lacking = drive.slider.stiffness * motion.separation_std + (model.load or 0.0) * (model.start == "empty")
    decays = log(max(lacking / motion.load_std, 1.0) / FORGOTTEN)
    return first_stationary_tick(model) + ceil(decays * slowest_decay(drive.slider) * drive.speed / model.tick)


def load_findings(model: Model, rows: Rows) -> list[Finding]:
    """Return identities of /load tick by tick, and spreads of separation, normal velocity, load and friction force.

    P = H A - W z/s_0, F = psi P/H for one strength, live_overlap = s_0 (A/A_rm) (N_jm/n). Figures are over the record
    from `first_still_tick` on; none without a load that weighs. Raises Refused if theory has no errors.
    """
    if model.separation is None:
        return []
    first = first_still_tick(model)
    seen = _moments_from(model, model.separation, rows, first)
    drive = contact_drive_of(model)
    needed = first * model.tick + max(FEWEST_DECAYS * slowest_decay(drive.slider) * drive.speed, needed_for_mean(model))
    identities = _identities(model, model.separation, seen)
    if model.distance < needed:
        return [*identities, too_short("load", needed)]
    return [*identities, *_figures(model, seen)]


@dataclass(slots=True)
class _LoadMoments:
    """Moments by column from a first tick on, and the largest deviations of identities over all ticks."""

    moments: dict[str, Moments] = field(default_factory=dict)
    load: float = 0.0
    overlap: float = 0.0
    force: float = 0.0

    def add(self, columns: dict[str, NDArray[Any]], skipped: int) -> None:
        for name, values in columns.items():
            self.moments.setdefault(name, Moments(powers=2)).add(values[skipped:])


def _moments_from(model: Model, held: Separation, rows: Rows, first: int) -> _LoadMoments:
    seen, ticks = _LoadMoments(), 0
    psi = model.strengths.mean if isinstance(model.strengths, Fixed) else None
    alone = held.height_scale * model.mean_junction_count / model.mean_real_contact_area
    traces = checked_chunks(rows, "trace", ("real_contact_area", "junction_count", "friction_force"))
    for trace, load in zip(traces, checked_chunks(rows, "load", ("separation", "velocity", "load")), strict=True):
        area, count, size = trace["real_contact_area"], trace["junction_count"], trace["real_contact_area"].size
        overlap = rows.column("load", "live_overlap", ticks, ticks + size)
        seen.load = max(seen.load, _off(load["load"], held.hardness * area - held.stiffness * load["separation"]))
        alive = count > 0
        nothing = np.isnan(overlap) == ~alive
        seen.overlap = max(seen.overlap, _off(overlap[alive] * count[alive], alone * area[alive]))
        seen.overlap = seen.overlap if nothing.all() else np.inf
        force = {"friction_force": trace["friction_force"]} if "friction_force" in trace else {}
        if psi is not None:
            seen.force = max(seen.force, _off(trace["friction_force"], psi / held.hardness * load["load"]))
        seen.add(load | force, max(first - ticks, 0))
        ticks += size
    return seen


def _off(values: Doubles, right: Doubles) -> float:
    return float(np.abs(values - right).max(initial=0.0))


def _identities(model: Model, held: Separation, seen: _LoadMoments) -> list[Finding]:
    motion = load_motion(model)
    largest = held.load * (1.0 + _FAR * motion.separation_std / held.height_scale)
    overlap = held.height_scale * model.mean_junction_count * largest / held.load
    found: list[Finding] = [
        Identity(name="load", deviation=seen.load, allowed=_ROUNDING * largest, units="uN"),
        Identity(name="live_overlap", deviation=seen.overlap, allowed=_ROUNDING * overlap, units="um"),
    ]
    if isinstance(model.strengths, Fixed):
        allowed = _ROUNDING * largest * model.strengths.mean / held.hardness
        found.append(Identity(name="friction_force", deviation=seen.force, allowed=allowed, units="uN"))
    return found


def _figures(model: Model, seen: _LoadMoments) -> list[Finding]:
    ticks = seen.moments["load"].count
    stretch, length, motion = over_ticks(model, ticks, model.tick), ticks * model.tick, load_motion(model)
    errors = load_errors(stretch, length, from_start=False)
    area, energy = tail_of(model, length, 3), tail_of(model, length, 6)
    known = [
        ("separation", "separation", motion.separation_std, errors.separation_std),
        ("normal_velocity", "velocity", motion.velocity_std, errors.velocity_std),
        ("load", "load", motion.load_std, errors.load_std),
    ]
    means = [
        ("separation", 0.0, errors.separation_mean),
        ("load", model.load or 0.0, errors.load_mean),
    ]
    if model.strengths is not None:
        force = force_cumulants(model)
        known.append(("friction_force", "friction_force", force.std, errors.force_std))
        means.append(("friction_force", force.mean, errors.force_mean))
    return [
        *(
            judged_mean(f"{name}_mean", seen.moments[name].mean, right, error, length=length, tail=area)
            for name, right, error in means
        ),
        *(
            judged(f"{name}_std", seen.moments[column].std, right, error, length=length, tail=energy)
            for name, column, right, error in known
        ),
    ]
