"""The data of a sweep in its page: every figure of every run, and the beginnings of some hundred runs."""

from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import welch
from rubnoise.answer import finite
from rubnoise.api.run import Run
from rubnoise.api.sweep_result import SweepResult
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.figure_names import STATES
from rubnoise.figures.tracks import lowest_and_highest
from rubnoise.pages.page import page
from rubnoise.pages.run_view import LIVES

_MOST_RUNS: Final = 20_000  # that a page can hold
_MOST_BEGINNINGS: Final = 200  # runs whose beginning it shows too
_ROWS: Final = 6000  # of a run's beginning
_CELLS: Final = 300  # of a beginning, of which the lowest and the highest value are shown
_MOST_SPECTRA: Final = 10  # points whose spectra are drawn over each other
_MOST_ROWS: Final = 262_144  # for a spectrum
_SPECTRUM_POINTS: Final = 150  # wavenumbers of a spectrum
_FEWEST_SEGMENTS, _FEWEST_TICKS = 4, 16  # what a run must have for a spectrum

_CURVES: Final = {"trace": ("distance", "real_contact_area"), "slider": ("time", "displacement")}
_STYLES: Final = ("uPlot.min.css", "view.css", "sweep.css")
_SCRIPTS: Final = ("rows", "plot", "sweep")


def sweep_page(sweep: SweepResult, name: str) -> str:
    """Return the page of an open sweep; ``name`` is that of its folder in the page.

    Raises Refused for a sweep without a finished run, or of more than 20 000 runs.
    """
    rows = np.flatnonzero(sweep.runs["state"][:] == "done")
    if not rows.size:
        raise Refused("no run of this sweep is done yet; there is nothing to look at")
    if rows.size > _MOST_RUNS:
        raise Refused(f"{rows.size:,} runs are done; a page holds {_MOST_RUNS:,} at most")
    return page(
        "sweep.html", title=sweep.title or name, styles=_STYLES, scripts=_SCRIPTS, data=_data(sweep, name, rows)
    )


def _data(sweep: SweepResult, name: str, rows: NDArray[np.int64]) -> dict[str, Any]:
    figures = [figure for figure in sweep.figures if np.issubdtype(sweep.runs[figure].dtype, np.number)]
    names = [*sweep.keys, "replicate", "seed", *figures, *(f"{each}_exact" for each in figures)]
    kept = [each for each in names if each in sweep.runs]
    beginnings, spectra = _looks(sweep, rows)
    return {
        "name": name,
        "keys": list(sweep.keys),
        "figures": figures,
        "states": {state: sweep.count(state) for state in STATES},
        "failures": [{"run": each.run_id, "reason": each.reason} for each in sweep.failures[:_MOST_BEGINNINGS]],
        "runs": [str(each) for each in sweep.runs["run_id"][:][rows]],
        "columns": {
            each: {"units": sweep.runs[each].units, "values": _as_json(sweep.runs[each][:][rows])} for each in kept
        },
        "beginnings": beginnings,
        "points": [int(each) for each in sweep.runs["point"][:][rows]],
        "spectra": spectra,
    }


def _as_json(values: NDArray[Any]) -> list[Any]:
    """Return values for JSON; those not measured are null."""
    exact = 2**53  # a larger whole number is no number of the page's language
    return [str(value) if isinstance(value, int) and abs(value) >= exact else value for value in finite(values)]


def _looks(sweep: SweepResult, rows: NDArray[np.int64]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return beginnings of all runs, or of the first run of each point, and spectra of some first runs, by name."""
    names, firsts = sweep.runs["run_id"][:], rows[np.unique(sweep.runs["point"][:][rows], return_index=True)[1]]
    chosen = rows if rows.size <= _MOST_BEGINNINGS else firsts[:: ceil(firsts.size / _MOST_BEGINNINGS)]
    beginnings: dict[str, Any] = {}
    spectra: dict[str, Any] = {}
    for row in chosen:
        name = str(names[row])
        try:
            with sweep.run(name) as run:
                found = _beginning(run)
                if found and row in firsts[:_MOST_SPECTRA] and (seen := _spectrum(run)) is not None:
                    spectra[name] = seen
        except RunFileRefused as refused:
            found = {"refused": str(refused)}
        beginnings[name] = found or {"refused": "This sweep keeps no rows of its runs."}
    return beginnings, spectra


def _beginning(run: Run) -> dict[str, Any]:
    """Return the units and the first values of each curve that a run has."""
    there = {group: columns for group, columns in run.groups().items() if group in _CURVES}
    return {
        group: {"units": [columns[each].units for each in _CURVES[group]], "points": _thinned(columns, _CURVES[group])}
        for group, columns in there.items()
    }


def _spectrum(run: Run) -> list[list[float]] | None:
    """Return wavenumbers in rad/um and Welch's spectrum of the area in um^4 per rad/um; None of a run too short for it.

    A segment is eight mean lives long, or a quarter of a short run.
    """
    area, model = np.asarray(run.trace["real_contact_area"][:_MOST_ROWS], dtype=np.float64), run.model()
    ticks = 2 * int(0.5 * min(LIVES * model.mean_life_distance / model.tick, area.size / _FEWEST_SEGMENTS))
    if ticks < _FEWEST_TICKS:
        return None
    seen = welch([area], ticks, model.tick)
    chosen = np.unique(np.geomspace(2, seen.density.size - 1, _SPECTRUM_POINTS).astype(int))
    return [seen.wavenumber[chosen].tolist(), seen.density[chosen].tolist()]


def _thinned(columns: Any, names: tuple[str, str]) -> list[list[float]]:
    """Return places and values of the beginning of a run: the lowest and highest of each cell."""
    rows = min(len(columns), _ROWS)
    places, values = (np.asarray(columns[name][:rows], dtype=np.float64) for name in names)
    step = max(1, ceil(rows / _CELLS))
    both = np.stack(lowest_and_highest(values, step), axis=-1).ravel() if step > 1 else values
    return [np.repeat(places[::step], 2 if step > 1 else 1).tolist(), both.tolist()]
