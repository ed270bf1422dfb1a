"""What a file derives from its own rows for its readers: the life curve and the summary."""

from collections.abc import Mapping
from math import isnan
from typing import Final

import numpy as np

from rubnoise.analysis.agreement import ERROR, EXACT, Agreement
from rubnoise.analysis.summary import summarise
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.model import Model
from rubnoise.record.reader import Reader
from rubnoise.record.tally import Moments, Tally
from rubnoise.storage.life_curve import life_tables

MEASURED: Final = 1e-9
"""Relative: measured figures are sums over columns, whose order is left open."""

CLOSE: Final = 1e-6
"""Relative: exact figures come from quadratures, which may be refined from version to version."""

ERRORS: Final = 1e-4
"""Relative: standard errors come from quadratures that need no more digits than errors have."""

_CONSTANT = 2.0**-30
"""Standard deviation over mean below which a column is constant but for rounding, and has no shape."""


def curve_check(model: Model, run: Reader) -> Check:
    """Return whether the table of a life is that of the scenario's pulse, bit for bit."""
    notes = Notes("life_curve")
    for group, lives in life_tables(model.pulse).items():
        for name, values in lives.items():
            notes.equal(f"/{group}/{name}", 0, run.column(group, name), values)
    return notes.check()


def summary_check(model: Model, tally: Tally, stored: Mapping[str, object]) -> Check:
    """Return whether the summary has every figure of the run, as its rows and the theory of its scenario have it.

    Standard errors are worked out again, too; a figure that a run of the scenario does not have is named.
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
    """Compare a figure with what it should be; where neither is a number, both are the same."""
    if found is None:
        notes.say(f"/summary {name}", found="missing", expected=right)
        return
    same = isinstance(found, float) and (
        found == right or abs(found - right) <= allowed or (isnan(found) and isnan(right))
    )
    notes.say(f"/summary {name}", found=found, expected=found if same else right)


def _allowed(figure: Agreement, tally: Tally) -> float:
    """Return how far a measured figure may be off; the shape of a column that is constant but for rounding is free."""
    quantity = next((name for name in tally.moments if figure.name.startswith(name)), None)
    seen = Moments() if quantity is None else tally.moments[quantity]
    if figure.name.endswith(("_skewness", "_kurtosis")):
        return MEASURED * max(abs(figure.observed), 1.0) if seen.std > _CONSTANT * abs(seen.mean) else np.inf
    if figure.name.endswith("_mean"):
        return MEASURED * (abs(seen.mean) + seen.std)
    return MEASURED * (abs(figure.observed) + 1e-3 * abs(seen.mean))
