"""The data of a sweep in its page: every figure of every run, and the beginnings of some hundred runs."""

from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import welch
from rubnoise.answer import finite
from rubnoise.api.sweep_result import SweepResult
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.figure_names import STATES
from rubnoise.figures.tracks import lowest_and_highest
from rubnoise.pages.page import page
from rubnoise.pages.statistics import LIVES

MOST_RUNS: Final = 20_000
MOST_BEGINNINGS: Final = 200
"""Runs of a sweep that a page can hold, and runs whose beginning it shows too."""

ROWS: Final = 6000
CELLS: Final = 300
"""Rows of a run's beginning, and cells of which it shows the lowest and the highest value."""

MOST_SPECTRA: Final = 10
MOST_ROWS: Final = 262_144
SPECTRUM_POINTS: Final = 150
FEWEST_SEGMENTS, FEWEST_TICKS = 4, 16
"""Points whose spectra are drawn over each other, rows and wavenumbers of each, and what a run must have."""

CURVES: Final = {"trace": ("distance", "real_contact_area"), "slider": ("time", "displacement")}
STYLES: Final = ("uPlot.min.css", "view.css", "sweep.css")
SCRIPTS: Final = ("rows", "plot", "sweep")


def sweep_page(sweep: SweepResult, name: str) -> str:
    """Return the page of an open sweep; ``name`` is that of its folder in the page.

    Raises Refused for a sweep without a finished run, or of more than 20 000 runs.
    """
    rows = np.flatnonzero(sweep.runs["state"][:] == "done")
    if not rows.size:
        raise Refused("no run of this sweep is done yet; there is nothing to look at")
    if rows.size > MOST_RUNS:
        raise Refused(f"{rows.size:,} runs are done; a page holds {MOST_RUNS:,} at most")
    return page("sweep.html", title=sweep.title or name, styles=STYLES, scripts=SCRIPTS, data=_data(sweep, name, rows))


def _data(sweep: SweepResult, name: str, rows: NDArray[np.int64]) -> dict[str, Any]:
    figures = [figure for figure in sweep.figures if np.issubdtype(sweep.runs[figure].dtype, np.number)]
    names = [*sweep.keys, "replicate", "seed", *figures, *(f"{each}_exact" for each in figures)]
    kept = [each for each in names if each in sweep.runs]
    return {
        "name": name,
        "keys": list(sweep.keys),
        "figures": figures,
        "states": {state: sweep.count(state) for state in STATES},
        "failures": [{"run": each.run_id, "reason": each.reason} for each in sweep.failures[:MOST_BEGINNINGS]],
        "runs": [str(each) for each in sweep.runs["run_id"][:][rows]],
        "columns": {
            each: {"units": sweep.runs[each].units, "values": _as_json(sweep.runs[each][:][rows])} for each in kept
        },
        "beginnings": _beginnings(sweep, rows),
        "points": [int(each) for each in sweep.runs["point"][:][rows]],
        "spectra": _spectra(sweep, rows),
    }


def _as_json(values: NDArray[Any]) -> list[Any]:
    """Return values for JSON; those not measured are null."""
    exact = 2**53  # a larger whole number is no number of the page's language
    return [str(value) if isinstance(value, int) and abs(value) >= exact else value for value in finite(values)]


def _beginnings(sweep: SweepResult, rows: NDArray[np.int64]) -> dict[str, Any]:
    """Return the first rows of all runs, or of the first run of each point, by name of the run."""
    point, names = sweep.runs["point"][:], sweep.runs["run_id"][:]
    chosen = rows if rows.size <= MOST_BEGINNINGS else rows[np.unique(point[rows], return_index=True)[1]]
    found: dict[str, Any] = {}
    for row in chosen[:: ceil(chosen.size / MOST_BEGINNINGS)]:
        try:
            with sweep.run(str(names[row])) as run:
                groups = run.groups()
                columns: dict[str, Any] = {
                    name: {"units": [groups[name][each].units for each in both], "points": _thinned(groups[name], both)}
                    for name, both in CURVES.items()
                    if name in groups
                }
        except RunFileRefused as refused:
            columns = {"refused": str(refused)}
        found[str(names[row])] = columns or {"refused": "This sweep keeps no rows of its runs."}
    return found


def _spectra(sweep: SweepResult, rows: NDArray[np.int64]) -> dict[str, Any]:
    """Return wavenumbers in rad/um and Welch's spectrum in um^4 per rad/um of the area, by name of a point's first run.

    A segment is eight mean lives long, or a quarter of a short run. Runs without rows are left out.
    """
    names, firsts = sweep.runs["run_id"][:], np.unique(sweep.runs["point"][:][rows], return_index=True)[1]
    found: dict[str, Any] = {}
    for row in rows[firsts][:MOST_SPECTRA]:
        try:
            with sweep.run(str(names[row])) as run:
                area = np.asarray(run.trace["real_contact_area"][:MOST_ROWS], dtype=np.float64)
                model = run.model()
                step, life = model.tick, model.mean_life_distance
        except (RunFileRefused, KeyError):
            continue
        ticks = 2 * int(0.5 * min(LIVES * life / step, area.size / FEWEST_SEGMENTS))
        if ticks < FEWEST_TICKS:
            continue
        seen = welch([area], ticks, step)
        chosen = np.unique(np.geomspace(2, seen.density.size - 1, SPECTRUM_POINTS).astype(int))
        found[str(names[row])] = [seen.wavenumber[chosen].tolist(), seen.density[chosen].tolist()]
    return found


def _thinned(columns: Any, names: tuple[str, str]) -> list[list[float]]:
    """Return places and values of the beginning of a run: the lowest and highest of each cell."""
    rows = min(len(columns), ROWS)
    places, values = (np.asarray(columns[name][:rows], dtype=np.float64) for name in names)
    step = max(1, ceil(rows / CELLS))
    both = np.stack(lowest_and_highest(values, step), axis=-1).ravel() if step > 1 else values
    return [np.repeat(places[::step], 2 if step > 1 else 1).tolist(), both.tolist()]
