"""Junctions that miss each other's centre line: what runs of ours cost beside the same with centred passes."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np

import rubnoise
from bench import checks, ours
from bench.case import AREA, RELATIVE_SPREAD, Case, Doubles, doubles
from bench.clock import Task, Timing, interleaved
from bench.entrants import FASTEST

OFFSETS = ("none", "uniform")
AREA_BOUND = 1e-12
"""Of the largest area: rounding is all that may be left."""

REFINED = 16
"""The motion is compared with that of a run whose ticks, and so the cells of its slider, are so many times shorter."""


@dataclass(frozen=True)
class Contact:
    """A contact of ``mean_count`` junctions, ``ticks_per_life`` of a centred life, with a slider or without one."""

    mean_count: float
    ticks_per_life: float
    slider: bool = False

    @property
    def what(self) -> str:
        """Its name."""
        return "with a slider" if self.slider else "area alone"

    def scenario(self, offset: str, junctions: float, *, seed: int = 1, finer: int = 1) -> rubnoise.Scenario:
        """Return it, for as long as so many centred junctions are born; ticks may be so many times finer."""
        diameter = (AREA / self.mean_count * 3.0) ** 0.5
        tick = float(f"{2.0 * diameter / self.ticks_per_life:.4g}")
        ticks = round(junctions * 2.0 * diameter / self.mean_count / tick)
        values = ours.values(Case(self.mean_count), FASTEST, slider=self.slider, seed=seed)
        values["interface"]["calibration"] = "matched"
        values["diameter"]["spread"] = RELATIVE_SPREAD * diameter
        values["pulse"] = {"offset": offset}
        values["sliding"]["distance"] = ticks * tick
        values["output"]["tick"] = tick / finer
        return rubnoise.build(values)


CONTACTS = (
    *(Contact(20.0, ticks) for ticks in (3.0, 20.0, 110.0, 300.0)),
    *(Contact(20.0, ticks, slider=True) for ticks in (20.0, 110.0, 300.0)),
    *(Contact(200.0, ticks, slider=True) for ticks in (10.0, 17.5, 35.0, 110.0)),
)
CHECKED = 150
"""Junctions of a run that is checked."""


@dataclass(frozen=True)
class OffCentreTimings:
    """Of one contact: timings by offset in units of junctions of the centred run, and errors of passes off the line."""

    timings: dict[str, Timing]
    errors: dict[str, float]

    @property
    def ratio(self) -> float:
        """Return how many times as long a run off the centre line takes as a centred one."""
        centred, off = (self.timings[offset].each for offset in OFFSETS)
        return off / centred

    def faults(self, contact: Contact) -> Iterator[str]:
        """Yield a sentence for each answer that is wrong or unchecked."""
        who = f"off the centre line, {contact.what}, N_jm = {contact.mean_count:g}, {contact.ticks_per_life:g} ticks"
        yield from checks.beyond(who, "area", self.errors.get("area"), AREA_BOUND)
        if contact.slider:
            yield from checks.beyond(who, "displacement", self.errors.get("displacement"), checks.OUR_MOTION_BOUND)


def area_by_formula(birth: Doubles, diameter: Doubles, offset: Doubles, ticks: Doubles) -> Doubles:
    """Return the sum of d^2 (acos r - r sqrt(1 - r^2))/2, r = sqrt(x^2 + b^2)/d, x from mid-life, life by life."""
    total = np.zeros_like(ticks)
    for s, d, b in zip(birth, diameter, offset, strict=True):
        r = np.minimum(np.hypot(ticks - s - np.sqrt(d * d - b * b), b) / d, 1.0)
        total += d * d * (np.arccos(r) - r * np.sqrt(1.0 - r * r)) / 2.0
    return total


def errors(contact: Contact) -> dict[str, float]:
    """Return the error of the area against the formula, and of the motion against one in much shorter ticks."""
    record = rubnoise.simulate(contact.scenario("uniform", CHECKED))
    rows, trace = record["junctions"], record["trace"]
    birth, diameter, offset = (doubles(rows[name]) for name in ("birth_distance", "diameter", "lateral_offset"))
    right = area_by_formula(birth, diameter, offset, doubles(trace["distance"]))
    found = {"area": checks.relative_error(doubles(trace["real_contact_area"]), right)}
    if contact.slider:
        finer = rubnoise.simulate(contact.scenario("uniform", CHECKED, finer=REFINED))
        reference = doubles(finer["slider"]["displacement"])[::REFINED]
        moved = doubles(record["slider"]["displacement"])
        found["displacement"] = checks.relative_error(moved, reference[: moved.size])
    return found


def measured(junctions: int, repeats: int, folder: Path) -> dict[Contact, OffCentreTimings]:
    """Return times and errors of every contact; whole runs into a file, in turns."""
    path = folder / "off_centre.h5"
    found = {contact: _measured(contact, junctions, repeats, path) for contact in CONTACTS}
    path.unlink(missing_ok=True)
    return found


def _measured(contact: Contact, junctions: int, repeats: int, path: Path) -> OffCentreTimings:
    tasks = {offset: _task(contact, offset, junctions, path) for offset in OFFSETS}
    for task in tasks.values():
        task.call()
    return OffCentreTimings(interleaved(tasks, repeats), errors(contact))


def _task(contact: Contact, offset: str, junctions: int, path: Path) -> Task:
    seeds = count(1)

    def call() -> None:
        scenario = contact.scenario(offset, junctions, seed=next(seeds))
        rubnoise.run(scenario, path, force=True, command=["bench"]).close()

    return Task(call, junctions, partial(path.unlink, missing_ok=True))
