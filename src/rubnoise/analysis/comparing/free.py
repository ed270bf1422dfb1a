"""Free motion beside what is exact of it: momentum, what each junction bears, and nothing else."""

from dataclasses import dataclass, field
from math import sqrt
from typing import Final

import numpy as np
from numpy.typing import NDArray

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
class _Seen:
    """What a pass over /trace and /load leaves: by how much identities are off at most, and columns thinned out."""

    load: float = 0.0
    overlap: float = 0.0
    force: float = 0.0
    largest: float = 0.0
    kept: dict[str, list[Doubles]] = field(default_factory=dict)

    def column(self, name: str) -> Doubles:
        return np.concatenate(self.kept[name])


def free_comparison(model: Model, free: FreeSeparation, rows: Rows, bound: float | None) -> Comparison:
    """Return a free run compared with what is exact of it; raises RunFileRefused for damaged rows.

    e^2 H A <= P <= H A with a restitution e, the same from a restitution of 1 on; live_overlap = s_0 (A/A_rm) (N/n);
    F = psi A for one strength; and the mean of P, less the momentum m [z'] + c [z] that a stretch has gained, is W.
    """
    seen = _read(model, free, rows)
    found: list[Finding] = [*_identities(model, free, seen), *_momentum(model, free, seen)]
    found.append(LeftOut(name="everything else", reason=SILENT))
    return comparison((Findings(heading="load", found=tuple(found)),), bound)


def _read(model: Model, free: FreeSeparation, rows: Rows) -> _Seen:
    seen, ticks, held = _Seen(), 0, free.held
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
        for name, values in ({"area": area} | dict(load)).items():
            seen.kept.setdefault(name, []).append(values)
        ticks += area.size
    return seen


def _identities(model: Model, free: FreeSeparation, seen: _Seen) -> list[Finding]:
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


def _momentum(model: Model, free: FreeSeparation, seen: _Seen) -> list[Finding]:
    """Return the mean load, and of an elastic contact the mean area, less the momentum that was gained meanwhile.

    Of the integral of P over a stretch the ticks give a sum whose error has the mean 0, since events fall anywhere
    between ticks: it is judged by its scatter over stretches, as Student's t.
    """
    held, step = free.held, model.tick_duration or 0.0
    z, w, load, area = (seen.column(name) for name in ("separation", "velocity", "load", "area"))
    length = (load.size - 1) // STRETCHES
    if length < _FEWEST_TICKS:
        return [too_short("load_mean", STRETCHES * _FEWEST_TICKS * model.tick)]
    ends = length * np.arange(STRETCHES + 1)
    gained = (held.mass * np.diff(w[ends]) + held.damping * np.diff(z[ends])) / (length * step)
    found: list[Finding] = [_judged("load_mean", _means(load, ends) - gained, held.load)]
    if free.restitution == 1.0:
        mean = _means(area, ends) - gained / held.hardness
        found.append(_judged("real_contact_area_mean", mean, model.mean_real_contact_area))
    return found


def _means(values: Doubles, ends: NDArray[np.int64]) -> Doubles:
    """Return means over stretches, half of each value at an end."""
    total = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))])
    means: Doubles = np.diff(total[ends]) / np.diff(ends)
    return means


def _judged(name: str, means: Doubles, expected: float) -> Agreement:
    from scipy.special import stdtr

    error = float(means.std(ddof=1)) / sqrt(means.size)
    t = (float(means.mean()) - expected) / error if error else 0.0
    deviate = normal_deviate(float(stdtr(means.size - 1, t)), float(stdtr(means.size - 1, -t)))
    return Agreement(name=name, observed=float(means.mean()), expected=expected, standard_error=error, deviate=deviate)
