"""Rows of a two-way slider compared with each other: places, times, phases, landmarks, first passages."""

from typing import Final

import numpy as np

from rubnoise.analysis.reading import Ahead, chunks
from rubnoise.analysis.stick_slip import first_landmark
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.analysis.verifying.lives import AT_END
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Rows
from rubnoise.record.rows import LandmarkKind, Phase

FOLLOWS: Final = {
    LandmarkKind.STICK: (LandmarkKind.SLIP,),
    LandmarkKind.SLIP: (LandmarkKind.STICK, LandmarkKind.REVERSAL),
    LandmarkKind.REVERSAL: (LandmarkKind.STICK, LandmarkKind.FORWARD),
    LandmarkKind.FORWARD: (LandmarkKind.STICK, LandmarkKind.REVERSAL),
}
"""What may come after a landmark: a stick ends in a breakaway alone, and a reversal in a stick or forward."""

PHASES: Final = np.array([Phase.STICK, Phase.SLIP, Phase.REVERSAL, Phase.SLIP])
"""The phase that begins at a landmark, by its kind."""

SHARE: Final = 1e-9
"""Of the largest modulus in the rows read together: what sums over many steps may have rounded."""


def two_way_checks(model: Model, rows: Rows) -> list[Check]:
    """Return whether rows of a two-way slider obey what needs no force: s = V t - (x - x_0), and what a stick is."""
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None:
        return []
    checks = [_rows_check(model, slider, speed, rows), _landmarks_check(model, slider, speed, rows)]
    return [*checks, _phases_check(rows), _passages_check(rows)]


def _rows_check(model: Model, slider: Slider, speed: float, rows: Rows) -> Check:
    notes, loose = Notes("slider_rows"), _loose(model, slider)
    for chunk in chunks(rows, "slider"):
        time, place, velocity, phase = (chunk[name] for name in ("time", "displacement", "velocity", "phase"))
        notes.equal("/slider/time", chunk.first, time, np.arange(chunk.first, chunk.end) * model.tick / speed)
        travelled = speed * time - (place - model.equilibrium_displacement)
        allowed = SHARE * _largest(place) + 8.0 * np.spacing(speed * np.abs(time))
        notes.near("/slider/distance", chunk.first, chunk["distance"], travelled, allowed)
        notes.holds("/slider/phase", chunk.first, phase, phase <= Phase.REVERSAL, "0, 1 or 2")
        stuck, off = phase == Phase.STICK, SHARE * max(_largest(velocity), speed) + loose
        of_phase = [velocity == speed, velocity <= speed + off]
        right = np.select([stuck, phase == Phase.SLIP], of_phase, velocity >= speed - off)
        notes.holds("/slider/velocity", chunk.first, velocity, right, "what the phase says beside the drive's speed")
        force = chunk["friction_force"]
        held = np.where(stuck, slider.stiffness * place + slider.damping * speed, force)
        notes.near("/slider/friction_force", chunk.first, force, held, SHARE * _largest(force))
        signs = stuck | np.where(phase == Phase.REVERSAL, force <= 0.0, force >= 0.0)
        notes.holds("/slider/friction_force", chunk.first, force, signs, "against the motion over the surface")
    return notes.check()


def _landmarks_check(model: Model, slider: Slider, speed: float, rows: Rows) -> Check:
    """Compare each landmark with the one before it: later, of a kind that may follow, and sticks in closed form."""
    notes, before = Notes("landmarks"), None
    last = rows.rows("slider") * model.tick / speed
    for chunk in chunks(rows, "landmarks"):
        names = ("time", "distance", "kind", "displacement")
        now = np.array([chunk[name].astype(np.float64) for name in names])
        earlier = np.concatenate([now[:, :1] if before is None else before, now[:, :-1]], axis=1)
        time, distance, kind, place = now
        since, there, what, begin = earlier
        notes.equal("/landmarks/landmark", chunk.first, chunk["landmark"], np.arange(chunk.first, chunk.end))
        notes.equal("/landmarks/velocity", chunk.first, chunk["velocity"], speed)
        notes.holds("/landmarks/time", chunk.first, time, time >= since, "at or after the landmark before it")
        notes.holds("/landmarks/time", chunk.first, time, (time >= 0.0) & (time <= last), "within the time of /slider")
        travelled = speed * time - (place - model.equilibrium_displacement)
        allowed = SHARE * _largest(place) + 8.0 * np.spacing(speed * np.abs(time))
        notes.near("/landmarks/distance", chunk.first, distance, travelled, allowed)
        turns = np.zeros(kind.size, dtype=bool)
        for each, after in FOLLOWS.items():
            turns |= (what == each) & np.isin(kind, after)
        if before is None:
            turns[:1] = np.isin(kind[:1], FOLLOWS[LandmarkKind.SLIP])
        notes.holds("/landmarks/kind", chunk.first, chunk["kind"], turns, "a kind that may follow the one before it")
        ends = kind == LandmarkKind.SLIP
        notes.near("/landmarks/distance", chunk.first, distance, np.where(ends, there, distance), 0.0)
        ridden = np.where(ends, begin + speed * (time - since), place)
        notes.near("/landmarks/displacement", chunk.first, place, ridden, allowed)
        force = chunk["force_after"]
        held = np.where((kind == LandmarkKind.STICK) | ends, slider.stiffness * place + slider.damping * speed, force)
        # Where w and w' are 0 at once, which of two equal forces acts is decided within the tolerance.
        allowed = max(SHARE, 10.0 * slider.tolerance) * _largest(force)
        notes.near("/landmarks/force_after", chunk.first, force, held, allowed)
        before = now[:, -1:]
    return notes.check()


def _phases_check(rows: Rows) -> Check:
    """Each row has the phase that the landmark before it began; at a landmark itself it may have either."""
    notes, ahead = Notes("phases"), Ahead(rows)
    for chunk in chunks(rows, "slider"):
        time = chunk["time"]
        if not time.size:
            continue
        first = max(first_landmark(ahead, float(time[0])) - 1, 0)
        end = first_landmark(ahead, float(np.nextafter(time[-1], np.inf)))
        marks, kinds = (ahead.column("landmarks", name, first, end) for name in ("time", "kind"))
        phases = np.concatenate([[Phase.SLIP], PHASES[np.minimum(kinds, len(PHASES) - 1)]])
        near, right = 8.0 * np.spacing(time), np.zeros(time.size, dtype=bool)
        for at in (time - near, time, time + near):
            right |= phases[np.searchsorted(marks, at, side="right")] == chunk["phase"]
        notes.holds("/slider/phase", chunk.first, chunk["phase"], right, "what the landmark before it began")
    return notes.check()


def _passages_check(rows: Rows) -> Check:
    """Births are passed in their order, deaths after births; what lies outside of the run is never passed."""
    notes, latest = Notes("passages"), 0.0
    for chunk in chunks(rows, "junctions"):
        birth, death = chunk["birth_time"], chunk["death_time"]
        never, beyond = np.signbit(chunk["birth_distance"]), (chunk["state"] & AT_END) != 0
        notes.holds("/junctions/birth_time", chunk.first, birth, np.isnan(birth) == never, "nan before the start alone")
        notes.holds("/junctions/death_time", chunk.first, death, np.isnan(death) == beyond, "nan beyond the end alone")
        passed = np.maximum.accumulate(np.concatenate([[latest], np.where(never, 0.0, np.nan_to_num(birth))]))
        notes.holds(
            "/junctions/birth_time", chunk.first, birth, never | (birth >= passed[:-1]), "at or after those before"
        )
        after = beyond | (death >= np.where(never, 0.0, birth))
        notes.holds("/junctions/death_time", chunk.first, death, after, "at or after the birth")
        latest = float(passed[-1])
    return notes.check()


def _loose(model: Model, slider: Slider) -> float:
    """Return by how much (um/s) the tolerance lets a slider that stands have another speed than the drive."""
    if model.strengths is None:
        return 0.0
    deflection = model.strengths.moment(1) * model.stationary_mean_area / slider.stiffness
    return slider.tolerance * deflection * slider.natural_angular_frequency


def _largest(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(np.abs(finite).max(initial=0.0))
