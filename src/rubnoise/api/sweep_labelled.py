"""A sweep as xarray has it: dimensions named by the swept keys. Imported only where xarray is."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr
from numpy.typing import NDArray

if TYPE_CHECKING:
    from rubnoise.api.sweep_result import SweepResult

REPLICATE: Final = "replicate"
SIDE_BY_SIDE: Final = "side_by_side"
TEXTS: Final = ("run_id", "file", "state")
NUMBERS: Final = ("seed",)


def dataset(sweep: "SweepResult") -> xr.Dataset:
    """Return the runs of a sweep on the grid of its keys and replicates."""
    axes = {key: _axis(sweep.points[key][:]) for key in sweep.grid}
    if sweep.side_by_side:
        axes[SIDE_BY_SIDE] = _rows_of(sweep)
    point = sweep.runs["point"][:]
    places = {name: places[point] for name, (_, places) in axes.items()}
    places[REPLICATE] = sweep.runs[REPLICATE][:]
    shape = {name: len(values) for name, (values, _) in axes.items()} | {
        REPLICATE: int(places[REPLICATE].max(initial=0)) + 1
    }
    variables = {
        name: xr.Variable(tuple(shape), _spread(sweep.runs[name][:], shape, places), sweep.runs[name].attributes)
        for name in (*TEXTS, *NUMBERS, *_figures(sweep))
    }
    return xr.Dataset(variables, coords=_coordinates(sweep, axes), attrs={"title": sweep.title})


def _figures(sweep: "SweepResult") -> list[str]:
    return [name for name in sweep.runs.names if name.startswith(sweep.figures)] if sweep.figures else []


def _axis(values: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the values of a key in the order in which they come, and which of them every point has."""
    _, first, inverse = np.unique(values, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return values[first[order]], np.argsort(order)[inverse]


def _rows_of(sweep: "SweepResult") -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the rows of the keys that go side by side, numbered in the order in which they come."""
    numbers: dict[tuple[Any, ...], int] = {}
    columns = (sweep.points[key][:] for key in sweep.side_by_side)
    places = [numbers.setdefault(row, len(numbers)) for row in zip(*columns, strict=True)]
    return np.arange(len(numbers)), np.array(places, dtype=np.int64)


def _spread(values: NDArray[Any], shape: Mapping[str, int], places: Mapping[str, NDArray[np.int64]]) -> NDArray[Any]:
    """Return values on the grid; where no run is, nan, an empty text, or -1."""
    missing: Any = np.nan if values.dtype.kind == "f" else "" if values.dtype.kind == "U" else -1
    grid: NDArray[Any] = np.full(tuple(shape.values()), missing, dtype=values.dtype)
    grid[tuple(places[name] for name in shape)] = values
    return grid


def _coordinates(sweep: "SweepResult", axes: Mapping[str, tuple[NDArray[Any], NDArray[np.int64]]]) -> dict[str, Any]:
    coordinates: dict[str, Any] = {
        name: xr.Variable((name,), values, sweep.points[name].attributes if name in sweep.keys else {})
        for name, (values, _) in axes.items()
    }
    if sweep.side_by_side:
        _, places = axes[SIDE_BY_SIDE]
        _, first = np.unique(places, return_index=True)
        for key in sweep.side_by_side:
            column = sweep.points[key]
            coordinates[key] = xr.Variable((SIDE_BY_SIDE,), column[:][first], column.attributes)
    return coordinates
