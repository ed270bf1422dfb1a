"""Compare free motion with its exact relations: momentum, and the force of each junction."""

from dataclasses import dataclass, field
from math import sqrt
from typing import Final

import numpy as np

from rubnoise.analysis.agreement import Agreement, normal_deviate
from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.comparing.findings import Comparison, Finding, Findings, Identity, comparison, too_short
from rubnoise.analysis.reading import checked_chunks
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.reader import Rows

STRETCHES: Final = 32
"""Stretches of a run, by whose scatter its error of sampling is known."""

_FEWEST_TICKS: Final = 64
_ROUNDING: Final = 2.0**-40

SILENT: Final = "free motion has no theory of its spreads, its shocks and its touches"


@dataclass(slots=True)
class _Stretches:
    """Sums of a column over STRETCHES stretches of equally many ticks, and its values at their begins and ends."""

    length: int
    sums: Doubles = field(default_factory=lambda: np.zeros(STRETCHES))
    ends: Doubles = field(default_factory=lambda: np.zeros(STRETCHES + 1))

    def add(self, first: int, values: Doubles) -> None:
        """Add the ticks from ``first`` on."""
        within = values[: max(STRETCHES * self.length - first, 0)]
        number = np.arange(first, first + within.size) // self.length
        self.sums += np.bincount(number, within, minlength=STRETCHES)
        begun = np.arange(-(-first // self.length), min((first + values.size - 1) // self.length, STRETCHES) + 1)
        self.ends[begun] = values[begun * self.length - first]

    @property
    def means(self) -> Doubles:
        """Means over the stretches, with half of the value at each end."""
        means: Doubles = (self.sums + 0.5 * np.diff(self.ends)) / self.length
        return means

    @property
    def gained(self) -> Doubles:
        """Increase of the column in each stretch, per tick."""
        gained: Doubles = np.diff(self.ends) / self.length
        return gained


@dataclass(slots=True)
class _FreeSums:
    """The result of a pass over /trace and /load: largest deviations of identities, and columns by stretches."""

    load: float = 0.0
    overlap: float = 0.0
    force: float = 0.0
    largest: float = 0.0
    columns: dict[str, _Stretches] = field(default_factory=dict)


def free_comparison(model: Model, free: FreeSeparation, rows: Rows, bound: float | None) -> Comparison:
    """Return the comparison of a free run with its exact relations; raises RunFileRefused for damaged rows.

    e^2 H A <= P <= H A with a restitution e, the same from a restitution of 1 on; live_overlap = s_0 (A/A_rm) (N/n);
    F = psi A for one strength; and the mean of P, less the momentum m [z'] + c [z] that a stretch has gained, is W.
    """
    seen = _sums_of(model, free, rows)
    found: list[Finding] = [*_identities(model, free, seen), *_momentum(model, free, seen)]
    found.append(LeftOut(name="everything else", reason=SILENT))
    return comparison((Findings(heading="load", found=tuple(found)),), bound)


def _sums_of(model: Model, free: FreeSeparation, rows: Rows) -> _FreeSums:
    seen, ticks, held, length = _FreeSums(), 0, free.held, _length(rows)
    psi = model.strengths.mean if isinstance(model.strengths, Fixed) else None
    alone = held.height_scale * model.mean_junction_count / model.mean_real_contact_area
    traces = checked_chunks(rows, "trace", ("real_contact_area", "junction_count", "friction_force"))
    for trace, load in zip(traces, checked_chunks(rows, "load", ("separation", "velocity", "load")), strict=True):
        area, count, bears = trace["real_contact_area"], trace["junction_count"], load["load"]
        elastic = held.hardness * area
        seen.largest = max(seen.largest, float(elastic.max(initial=held.load)))
        if free.restitution is not None:
            least = free.restitution**2 * elastic
            seen.load = max(seen.load, float(np.maximum(bears - elastic, least - bears).max(initial=0.0)))
        alive = count > 0
        overlap = rows.column("load", "live_overlap", ticks, ticks + area.size)
        right = np.isnan(overlap) == ~alive
        off = np.abs(overlap[alive] * count[alive] - alone * area[alive]).max(initial=0.0)
        seen.overlap = max(seen.overlap, float(off)) if right.all() else np.inf
        if psi is not None:
            seen.force = max(seen.force, float(np.abs(trace["friction_force"] - psi * area).max(initial=0.0)))
        for name, values in ({"area": area} | load).items() if length else ():
            seen.columns.setdefault(name, _Stretches(length)).add(ticks, values)
        ticks += area.size
    return seen


def _identities(model: Model, free: FreeSeparation, seen: _FreeSums) -> list[Finding]:
    held, largest = free.held, _ROUNDING * seen.largest
    overlap = held.height_scale * model.mean_junction_count / held.load
    found: list[Finding] = [
        Identity(name="live_overlap", deviation=seen.overlap, allowed=overlap * largest, units="um"),
    ]
    if free.restitution is not None:
        found.insert(0, Identity(name="load", deviation=seen.load, allowed=largest, units="uN"))
    if isinstance(model.strengths, Fixed):
        allowed = largest * model.strengths.mean / held.hardness
        found.append(Identity(name="friction_force", deviation=seen.force, allowed=allowed, units="uN"))
    return found


def _momentum(model: Model, free: FreeSeparation, seen: _FreeSums) -> list[Finding]:
    """Return the mean load, and the mean area of an elastic contact, less the momentum gained meanwhile.

    The sum of P over the ticks of a stretch differs from its integral by an error of mean 0, since events fall anywhere
    between ticks: its score is Student's t from the scatter over stretches.
    """
    held, step = free.held, model.tick_duration or 0.0
    if not seen.columns:
        return [too_short("load_mean", STRETCHES * _FEWEST_TICKS * model.tick)]
    gained = (held.mass * seen.columns["velocity"].gained + held.damping * seen.columns["separation"].gained) / step
    found: list[Finding] = [_judged("load_mean", seen.columns["load"].means - gained, held.load)]
    if free.restitution == 1.0:
        mean = seen.columns["area"].means - gained / held.hardness
        found.append(_judged("real_contact_area_mean", mean, model.mean_real_contact_area))
    return found


def _length(rows: Rows) -> int:
    """Return the ticks of a stretch; 0 if there are too few."""
    length = (rows.rows("load") - 1) // STRETCHES
    return length if length >= _FEWEST_TICKS else 0


def _judged(name: str, means: Doubles, expected: float) -> Agreement:
    from scipy.special import stdtr

    error = float(means.std(ddof=1)) / sqrt(means.size)
    t = (float(means.mean()) - expected) / error if error else 0.0
    deviate = normal_deviate(float(stdtr(means.size - 1, t)), float(stdtr(means.size - 1, -t)))
    return Agreement(name=name, observed=float(means.mean()), expected=expected, standard_error=error, deviate=deviate)
