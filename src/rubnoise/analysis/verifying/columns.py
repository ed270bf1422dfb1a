"""Check the columns of a file without its run: hashes, identities of rows, derived tables, textbook areas."""

from collections.abc import Mapping
from math import ceil, isnan
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.agreement import ERROR, EXACT, Agreement
from rubnoise.analysis.reading import Ahead
from rubnoise.analysis.summary import summarise
from rubnoise.analysis.verifying.findings import Check, Difference, Notes
from rubnoise.arrays import Doubles, Integers
from rubnoise.contact.off_centre import area_of, half_life
from rubnoise.errors import RunFileRefused
from rubnoise.model import FreeSeparation, Model
from rubnoise.record.reader import Chunk, HashedReader, Reader, Rows, chunks, column_chunks
from rubnoise.record.rows import JunctionState, junction_columns, junction_states, natural_death
from rubnoise.record.tally import Moments, Tally
from rubnoise.simulation.free.scales import Scales
from rubnoise.simulation.kernel import peak_areas
from rubnoise.storage.format import seal_of
from rubnoise.storage.life_curve import life_tables
from rubnoise.storage.schema import HASH

SEAL: Final = f"/provenance {HASH}"


def hash_check(run: HashedReader) -> Check:
    """Check that every column can be read and has its stored xxh3_128, and that all attributes have theirs."""
    values = sum(run.rows(group) * len(names) for group, names in run.columns.items()) + 1
    damaged = run.damaged()
    wrong = []
    if damaged:
        reason = "unreadable" if damaged[0] in unreadable(run) else "not what its hash was taken of"
        wrong.append(Difference(place=damaged[0], row=None, found=reason, expected="as it was written"))
    wrong += [difference for difference in [_seal_difference(run)] if difference]
    different = len(damaged) + len(wrong) - bool(damaged)
    return Check(name="hashes", values=values, different=different, first=wrong[0] if wrong else None)


def unreadable(run: HashedReader) -> list[str]:
    """Return the groups and columns whose bytes cannot be read, as in a damaged compressed column."""
    found = []
    for group, names in run.columns.items():
        for name in names:
            try:
                for _ in column_chunks(run, group, name):
                    pass
            except RunFileRefused:
                found.append(f"/{group}/{name}")
    return found


def _seal_difference(run: HashedReader) -> Difference | None:
    there, right = run.seal, seal_of(run.attributes, run.summary, run.provenance)
    if there == right:
        return None
    expected = f"{right}, the hash of the attributes of the root, /summary and /provenance"
    return Difference(place=SEAL, row=None, found=there or "missing", expected=expected)


OF_MOTION = ("birth_time", "death_time")
"""Columns of /junctions that only its motion decides if a slider is coupled two ways."""


def identity_check(model: Model, rows: Rows) -> Check:
    """Check that rows are in order of birth, that columns follow from one another, and that ticks are even."""
    notes, before = Notes("identities"), -np.inf if model.free is None else 0.0
    follows = _of_life if model.free is None else _of_touch
    for chunk in chunks(rows, "junctions"):
        birth = chunk["birth_distance"]
        in_order = birth >= np.concatenate([[before], birth[:-1]])
        notes.holds("/junctions/birth_distance", chunk.first, birth, in_order, "at or after the birth before it")
        before = birth[-1] if birth.size else before
        with np.errstate(invalid="ignore", over="ignore"):
            expected = follows(model, chunk)
        for name, values in expected.items():
            if not (model.is_two_way and name in OF_MOTION):
                notes.equal(f"/junctions/{name}", chunk.first, chunk[name], values)
    for chunk in chunks(rows, "trace"):
        distance = np.arange(chunk.first, chunk.end, dtype=np.float64) * model.tick
        notes.equal("/trace/distance", chunk.first, chunk["distance"], distance)
    return notes.check()


def _of_life(model: Model, chunk: Chunk) -> dict[str, NDArray[Any]]:
    """Return the columns that follow from birth, diameter and offset; a life ended early has the death that it had."""
    birth, diameter, offset = chunk["birth_distance"], chunk["diameter"], chunk.get("lateral_offset")
    natural = natural_death(birth, diameter, offset)
    early = (chunk["state"] & JunctionState.ENDED_EARLY) != 0
    departure = np.where(early, chunk["death_distance"], np.inf)
    return junction_columns(
        first_row=chunk.first,
        birth=birth,
        diameter=diameter,
        strength=chunk.get("shear_strength"),
        natural=natural,
        departure=departure,
        state=junction_states(natural, departure, np.signbit(birth), model.distance),
        speed=model.sliding_speed,
        offset=offset,
        peak=None if offset is None else peak_areas(model.pulse.shape, diameter, offset),
    )


def _of_touch(model: Model, chunk: Chunk) -> dict[str, NDArray[Any]]:
    """Return the columns of free motion that follow from where a touch begins and ends."""
    birth, death, speed = chunk["birth_distance"], chunk["death_distance"], model.sliding_speed or 1.0
    follows = {"junction": np.arange(chunk.first, chunk.end), "life_distance": death - birth}
    return follows | {"birth_time": birth / speed, "death_time": death / speed}


MEASURED: Final = 1e-9
"""Relative: measured figures are sums over columns, whose order is left open."""

CLOSE: Final = 1e-6
"""Relative: exact figures come from quadratures, which may be refined from version to version."""

ERRORS: Final = 1e-4
"""Relative: standard errors come from quadratures that need no more digits than errors have."""

_CONSTANT = 2.0**-30
"""Standard deviation over mean below which a column is constant but for rounding, and has no shape."""


def curve_check(model: Model, run: Reader) -> Check:
    """Check that the table of a life is that of the scenario's pulse, bit for bit."""
    notes = Notes("life_curve")
    for group, lives in life_tables(model.pulse).items():
        for name, values in lives.items():
            notes.equal(f"/{group}/{name}", 0, run.column(group, name), values)
    return notes.check()


def summary_check(model: Model, tally: Tally, stored: Mapping[str, object]) -> Check:
    """Check that the summary has every figure of the run, as computed from its rows and the theory of its scenario.

    Standard errors are computed again, too; figures that a run of the scenario does not have are named.
    """
    notes = Notes("summary")
    known: set[str] = set()
    for figure in summarise(model, tally):
        right = figure.as_attributes()
        known.update(right)
        for name, value in right.items():
            beside = {figure.name + EXACT: CLOSE * abs(value), figure.name + ERROR: ERRORS * abs(value)}
            _compare(notes, name, stored.get(name), value, beside.get(name, _allowed(figure, tally)))
    for name in stored.keys() - known:
        notes.say(f"/summary {name}", found=stored[name], expected="no figure of this run")
    return notes.check()


def _compare(notes: Notes, name: str, found: object, right: float, allowed: float) -> None:
    """Compare a figure with its right value; two values that are not numbers are equal."""
    if found is None:
        notes.say(f"/summary {name}", found="missing", expected=right)
        return
    same = isinstance(found, float) and (
        found == right or abs(found - right) <= allowed or (isnan(found) and isnan(right))
    )
    notes.say(f"/summary {name}", found=found, expected=found if same else right)


def _allowed(figure: Agreement, tally: Tally) -> float:
    """Return the allowed deviation of a measured figure; the shape of a column that is constant to rounding is free."""
    quantity = next((name for name in tally.moments if figure.name.startswith(name)), None)
    seen = Moments() if quantity is None else tally.moments[quantity]
    if figure.name.endswith(("_skewness", "_kurtosis")):
        return MEASURED * max(abs(figure.observed), 1.0) if seen.std > _CONSTANT * abs(seen.mean) else np.inf
    if figure.name.endswith("_mean"):
        return MEASURED * (abs(seen.mean) + seen.std)
    return MEASURED * (abs(figure.observed) + 1e-3 * abs(seen.mean))


TICKS: Final = 1000
"""Number of ticks, spread evenly from the first to the last, at which areas are summed."""

FORMULA: Final = 2.0**-48
"""Allowed error of the area over d^2 in either formula, without its arc cosine: ages are right to 2^-51."""

ROUNDED: Final = 2.0**-53
"""Allowed error of the argument r of the arc cosine: the error of its value is that over sqrt(1 - r^2)."""

STEEPEST: Final = 2.0**-27
"""sqrt(1 - r^2) of the largest r below 1, about: nearer to birth and death the textbook's area is 0."""

SUM: Final = 2.0**-52
"""Allowed difference of two sums in another order: 2^-53 of the whole at each addition of either."""


def area_check(model: Model, rows: Rows) -> Check:
    """Check that /trace has, at TICKS ticks, the sum of the areas (um^2) of the junctions in the file.

    By d^2 (acos r - r sqrt(1 - r^2))/2, the textbook's formula (`rubnoise.contact.overlap`, and `off_centre` beside
    it), which the engine does not use. It loses digits near birth and death; the bound grows with this loss.
    """
    notes, ticks, ahead = Notes("areas"), chosen_ticks(rows.rows("trace")), Ahead(rows)
    area, allowed = _summed(model, rows, ticks.astype(np.float64) * model.tick)
    for n, tick in enumerate(ticks.tolist()):
        found = ahead.column("trace", "real_contact_area", tick, tick + 1)
        notes.near("/trace/real_contact_area", tick, found, area[n : n + 1], allowed[n : n + 1])
    return notes.check()


def chosen_ticks(rows: int) -> Integers:
    """Return TICKS numbers of ticks (or all, if there are fewer), spread evenly from the first to the last."""
    return np.unique(np.rint(np.linspace(0, rows - 1, min(TICKS, rows))).astype(np.int64))


def _summed(model: Model, rows: Rows, distance: Doubles) -> tuple[Doubles, Doubles]:
    """Return areas at distances (um), and the allowed deviation of each (um^2)."""
    area, allowed, count = (np.zeros(distance.size) for _ in range(3))
    for chunk in chunks(rows, "junctions"):
        birth, diameter, death = (chunk[name] for name in ("birth_distance", "diameter", "death_distance"))
        offset = chunk.get("lateral_offset")
        # No junction before the first of these rows lives to a distance, and from the last on none is born yet.
        first = np.searchsorted(np.maximum.accumulate(death), distance, side="right")
        last = np.searchsorted(birth, distance, side="right")
        for n in np.flatnonzero(first < last).tolist():
            near = slice(int(first[n]), int(last[n]))
            alive = np.flatnonzero(death[near] > distance[n]) + near.start
            age, d, b = distance[n] - birth[alive], diameter[alive], None if offset is None else offset[alive]
            with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
                area[n] += area_of(model.pulse, age, d, b).sum()
                root = np.sqrt(np.maximum(age * (2.0 * half_life(d, b) - age), 0.0)) / d
                allowed[n] += (d * d * (FORMULA + ROUNDED / np.maximum(root, STEEPEST))).sum()
            count[n] += alive.size
    return area, allowed + count * SUM * area


_ROUNDING: Final = 2.0**-42


def summit_check(model: Model, free: FreeSeparation, seed: int, rows: Rows) -> Check:
    """Check that /trace has, at some ticks, the areas of the seed's summits at the separation in /load.

    A sum over all summits near a tick of (A_rm/N) max(h - (s - x)^2 - z, 0), which does not use events.
    """
    notes, ahead, scales = Notes("areas"), Ahead(rows), Scales.of(model, free)
    surface, unit = scales.surface(seed), model.mean_real_contact_area / scales.live
    for tick in chosen_ticks(rows.rows("trace")).tolist():
        z = float(ahead.column("load", "separation", tick, tick + 1)[0]) / scales.height
        block, beyond = divmod(tick, surface.ticks)
        around = surface.around(block, max(ceil(-z) - surface.base + 2, 1))
        away = float(beyond) * scales.tick - around.place
        overlap = np.maximum(around.height - away * away - z, 0.0)
        found = ahead.column("trace", "real_contact_area", tick, tick + 1)
        allowed = unit * _ROUNDING * (1.0 + np.count_nonzero(overlap)) * (1.0 + abs(z))
        notes.near("/trace/real_contact_area", tick, found, np.array([unit * overlap.sum()]), np.array([allowed]))
    return notes.check()
