"""Statistics of a whole run in its page: spectra and histograms, and the time spent in each part of the phase plane."""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from rubnoise.analysis.spectra import WelchSum
from rubnoise.record.reader import Rows, column_chunks
from rubnoise.web_page import packed

QUANTITIES: Final = {
    "area": ("trace", "real_contact_area"),
    "velocity": ("slider", "velocity"),
    "normal": ("load", "velocity"),
    "load": ("load", "load"),
}
"""Group and column of each quantity of `exact_curves`."""

BARS: Final = 60
CELLS: Final = (96, 72)
"""Bars of a histogram; cells of the phase plane across and up."""


def whole_run(file: Rows, curves: Mapping[str, Any], *, leaves: bool) -> dict[str, Any]:
    """Return the statistics of each quantity that has a curve, and of the phase plane, read in chunks.

    ``leaves`` says that the slider leaves the contact: zeros of area and load are then counted, and not drawn.
    """
    found = {
        name: _statistics(file, name, curves[name]["ticks"], curves[name]["step"], leaves=leaves and name != "normal")
        for name in QUANTITIES
        if curves[name] is not None
    }
    return {**found, "phase": _phase(file) if "slider" in file.columns else None}


def _statistics(file: Rows, name: str, ticks: int, step: float, *, leaves: bool) -> dict[str, Any]:
    """Return two-sided spectrum and histogram of a column: ``ends`` and ``counts`` of its bars, and all ``rows``."""
    group, column = QUANTITIES[name]
    welch = WelchSum(ticks, step)
    for values in column_chunks(file, group, column):
        welch.add(values)
    spectrum, ends, counts = welch.spectrum(), _ends(file, group, column), np.zeros(BARS, dtype=np.uint32)
    for values in column_chunks(file, group, column):
        counts += np.histogram(values[values > 0.0] if leaves else values, BARS, ends)[0].astype(np.uint32)
    return {
        "density": packed(spectrum.density),
        "segments": spectrum.segments,
        "ends": ends,
        "counts": packed(counts),
        "rows": file.rows(group),
    }


def _ends(file: Rows, group: str, column: str) -> tuple[float, float]:
    """Return the lowest and the highest value of a column, which are never equal."""
    ends = np.array([(values.min(), values.max()) for values in column_chunks(file, group, column)])
    low, high = float(ends[:, 0].min()), float(ends[:, 1].max())
    return (low, high) if low < high else (low - 0.5, low + 0.5)


def _phase(file: Rows) -> dict[str, Any]:
    """Return how many ticks are in each cell of displacement (across) and velocity (up), row by row from below."""
    place, velocity = (_ends(file, "slider", name) for name in ("displacement", "velocity"))
    counts = np.zeros(CELLS)
    for x, v in zip(
        column_chunks(file, "slider", "displacement"), column_chunks(file, "slider", "velocity"), strict=True
    ):
        counts += np.histogram2d(x, v, CELLS, (place, velocity))[0]
    return {"across": CELLS[0], "place": place, "velocity": velocity, "counts": packed(counts.T.astype(np.uint32))}
