"""An opened folder of a sweep: its points, runs and figures as columns, and as a labelled array of xarray."""

import os
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.api.columns import Column, Table
from rubnoise.api.notebook import DataFrame, Dataset, Displayed, Overview
from rubnoise.api.run import Run
from rubnoise.api.run import open as open_result
from rubnoise.arrays import number_in
from rubnoise.errors import Refused, RunFileRefused, needing
from rubnoise.figure_names import FAILED, STATES
from rubnoise.figures import Figure, Style
from rubnoise.regular_file import INDEX
from rubnoise.runs.folder import ABOUT, file_of, name_in, scenario_in
from rubnoise.storage.index import Index, read_index
from rubnoise.storage.reader import refusing
from rubnoise.units import KINDS, RATIO

if TYPE_CHECKING:
    from rubnoise.analysis.replicates import PooledEstimate
    from rubnoise.scenario import Scenario

_ROUNDING: Final = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """A run of a sweep that failed, and the reason."""

    run_id: str
    values: Mapping[str, Any]
    replicate: int
    reason: str


class SweepResult(Displayed):
    """The folder of a sweep, opened; a context manager. Its index is read, its runs are opened when they are needed.

    ``runs`` has one row a run, point after point: `run_id`, `point`, `replicate`, the swept keys by their names,
    `seed`, `file`, `state` and `reason`, and every figure of /summary of the runs that are done. ``points`` has one row
    a point. ``keys`` are the swept keys: of them those of ``grid`` are combined with all values of the others, those
    ``side_by_side`` are not; ``values`` are theirs at every point, as written. ``figures`` are the names of measured
    figures, without exact values and standard errors, ``summaries`` those of arrays beyond single figures.
    ``attributes`` hold the sweep's file as read, the command, and when and by what the index was written. ``path`` is
    the folder, as it was opened, ``name`` its name, ``title`` that of the sweep.

    >>> import rubnoise
    >>> with rubnoise.sweep("scenarios/paper/fig9.toml", "fig9", jobs=1) as sweep:
    ...     sweep.keys, sweep.count("done")
    (('interface.mean_junction_count',), 5)
    """

    def __init__(self, path: Path, index: Index) -> None:
        self.path, self.index, self.attributes = path, index, index.texts
        self.name, self.title = path.resolve().name, index.texts["title"]
        self.runs, self.points = (
            Table(name, [Column(each.values, each.about) for each in columns.values()], f"the {name} of a sweep")
            for name, columns in {"runs": index.runs, "points": index.points}.items()
        )
        self.grid, self.side_by_side = index.swept("grid"), index.swept("side_by_side")
        self.keys: tuple[str, ...] = index.keys
        self.values = tuple({key: values[key] for key in self.keys} for values in index.values)
        self.summaries = tuple(index.summaries)
        about, ends = {*ABOUT, *self.keys}, ("_exact", "_standard_error")
        self.figures = tuple(each for each in self.runs.names if each not in about and not each.endswith(ends))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Do nothing, since everything has been read; here so that a result of a sweep is used as one of a run is."""

    @property
    def failures(self) -> list[Failure]:
        """The runs that failed."""
        columns = [self.runs[name].tolist() for name in ("state", "run_id", "point", "replicate", "reason")]
        return [
            Failure(run_id=run_id, values=self.values[point], replicate=replicate, reason=reason)
            for state, run_id, point, replicate, reason in zip(*columns, strict=True)
            if state == FAILED
        ]

    def count(self, state: str) -> int:
        """Return how many runs are "planned", "done" or "failed"."""
        return int(np.count_nonzero(self.runs["state"][:] == state))

    def estimates(self, figure: str) -> "list[PooledEstimate]":
        """Return a figure of every point, pooled over its replicates: a mean, of standard deviations that of squares.

        Raises KeyError for a figure that no run has, Refused for a column of texts.
        """
        from rubnoise.analysis.replicates import pooled

        values, point = self._numbers(figure), self.runs["point"][:]
        return [pooled(figure, values[point == number].tolist()) for number in range(len(self.points))]

    def ratios(self, figure: str, key: str, value: Any) -> "list[PooledEstimate]":
        """Return a figure of every point over that of the point which differs from it in having a value of a swept key.

        A key goes by its last word too, if no other swept key ends with it. A value is a text with a unit, a number in
        working units or a quantity of pint. Runs on the same seed are compared pair by pair, since what they have in
        common cancels. Raises KeyError for a figure or a key that is not there, ValueError if there is no such point.
        """
        from rubnoise.analysis.replicates import pooled, ratio, ratio_of_pairs

        key = {word: whole for whole, word in short_names(self.keys).items()}.get(key, key)
        if key not in self.keys:
            raise KeyError(f"{key} is not swept; swept: {', '.join(self.keys)}")
        figures, seeds, point = self._numbers(figure), self.runs["seed"][:], self.runs["point"][:]
        chosen, found = self._points_with(key, value), []
        for number, values in enumerate(self.values):
            alike = [other for other in chosen if {**self.values[other], key: None} == {**values, key: None}]
            if not alike:
                raise ValueError(f"no point has {key} = {value}")
            rows, others = (np.flatnonzero(point == n) for n in (number, alike[0]))
            count = min(rows.size, others.size)
            if np.array_equal(seeds[rows[:count]], seeds[others[:count]]):
                found.append(ratio_of_pairs(figure, figures[rows[:count]].tolist(), figures[others[:count]].tolist()))
            else:
                found.append(ratio(*(pooled(figure, figures[some].tolist()) for some in (rows, others))))
        return found

    def _numbers(self, figure: str) -> NDArray[Any]:
        if self.runs[figure].dtype.kind == "U":
            raise Refused(f"{figure}: holds texts; figures are {', '.join(self.figures) or 'none yet'}")
        return self.runs[figure][:]

    def run(self, run_id: str) -> Run:
        """Open the result of a run by its name; raises KeyError for an unknown one, RunFileRefused without its file."""
        rows = np.flatnonzero(self.runs["run_id"][:] == run_id)
        if not rows.size:
            raise KeyError(f"{self.path}: no run is named {run_id}")
        if self.runs["file"][int(rows[0])] != (file := file_of(Path(), run_id, "runs").as_posix()):
            raise RunFileRefused(f"{self.path}: the run {run_id} has no file")
        run = open_result(self.path / file)
        if (name := name_in(scenario_in(run.reader()))) != run_id:
            run.close()
            raise RunFileRefused(f"{run.path}: is the result of another run, {name}")
        return run

    def scenario(self, point: int) -> "Scenario":
        """Return the scenario of a point by its number, with a seed of the first point; raises RunFileRefused."""
        with refusing(self.path / INDEX):
            return self.index.scenario(point)

    def summary(self, name: str) -> NDArray[Any]:
        """Read one of ``summaries``: one row a run, or a point; raises KeyError for an unknown name."""
        return self.index.summaries[name].copy()

    def to_xarray(self) -> "Dataset":
        """Return the figures as an xarray Dataset whose dimensions are the swept keys and `replicate`.

        A key goes by its last word too, if no other key ends with it. Keys of [sweep.zip] share the dimension
        `side_by_side`; what has not been measured is nan. Raises ExtraMissing without xarray.
        """
        with needing("analysis", "to_xarray"):
            return labelled(self)

    def to_pandas(self) -> "DataFrame":
        """Return `runs` as a pandas DataFrame; raises ExtraMissing without pandas."""
        return self.runs.to_pandas()

    def _overview(self) -> Overview:
        """Return each key with its values, and how many runs are done."""
        rows = [(key, ", ".join(dict.fromkeys(str(point[key]) for point in self.values))) for key in self.keys]
        counts = f"{len(self.points):,} points, {', '.join(f'{self.count(state):,} {state}' for state in STATES)}"
        return f"{self.path}: {self.title}", ("key", "values"), rows, [counts]

    def plot(
        self,
        quantity: str | None = None,
        *,
        size: str | None = None,
        title: bool = True,
        style: "Style | None" = None,
    ) -> "Figure":
        """Draw a quantity, such as "displacement_std", against what is swept, with intervals and the exact curve.

        Without a name it is "displacement_std", or "real_contact_area_std" for a sweep without a slider. ``size``,
        ``title`` and ``style`` are as in `Run.plot`. Raises Refused for a quantity that the sweep does not have,
        ExtraMissing without matplotlib.
        """
        from rubnoise.api.pictures import appearance
        from rubnoise.figures.catalogue import sweep_drawing

        if quantity is not None and not isinstance(quantity, str):
            raise Refused(f'{quantity!r}: is no quantity of a sweep; right form: sweep.plot("real_contact_area_std")')
        look = appearance(size=size, title=title, style=style)
        return sweep_drawing(self.index, self.name, quantity, look=look)

    def _points_with(self, key: str, value: Any) -> list[int]:
        """Return the points at which a swept key has a value; raises Refused for one of another kind."""
        column = self.points[key]
        if column.dtype.kind != "f":
            texts = [str(text) for text in column[:]]
            return [n for n, text in enumerate(texts) if value in (text, self.values[n][key])]
        number = number_in(value, key, next((kind for kind in KINDS if kind.unit == column.units), RATIO))
        return np.flatnonzero(np.isclose(column[:], number, rtol=_ROUNDING, atol=0.0)).tolist()


def open_sweep(folder: str | os.PathLike[str]) -> SweepResult:
    """Open the folder of a sweep, finished or not; raises RunFileRefused if it has no index of ours.

    >>> import rubnoise
    >>> rubnoise.sweep("paper/fig9", "fig9", jobs=1).close()
    >>> with rubnoise.open_sweep("fig9") as sweep:
    ...     sweep.count("done"), sweep.failures
    (5, [])
    """
    try:
        return SweepResult(Path(folder), read_index(Path(folder) / INDEX))
    except RunFileRefused as refused:
        if isinstance(refused.__cause__, FileNotFoundError | NotADirectoryError):
            raise RunFileRefused(f"{folder}: no folder of a sweep: it has no {INDEX}") from refused
        raise


REPLICATE: Final = "replicate"
SIDE_BY_SIDE: Final = "side_by_side"


def labelled(sweep: "SweepResult") -> "Dataset":
    """Return the runs of a sweep as an xarray Dataset on the grid of its keys and replicates.

    Points lie on the grid row by row. Where a point has fewer runs there is nan, an empty text, or -1.
    """
    import xarray as xr

    swept: dict[str, tuple[str, ...]] = {key: (key,) for key in sweep.grid}
    sizes, coordinates = [len(set(sweep.points[key].tolist())) for key in sweep.grid], {}
    if sweep.side_by_side:
        swept[SIDE_BY_SIDE] = sweep.side_by_side
        sizes.append(len(sweep.points) // prod(sizes))
        coordinates[SIDE_BY_SIDE] = xr.Variable((SIDE_BY_SIDE,), np.arange(sizes[-1]))
    for axis, (dimension, keys) in enumerate(swept.items()):
        along = np.arange(sizes[axis]) * prod(sizes[axis + 1 :])
        for key in keys:
            coordinates[key] = xr.Variable((dimension,), sweep.points[key].values[along], sweep.points[key].attributes)
    replicates = sweep.runs[REPLICATE].values
    places = (*np.unravel_index(sweep.runs["point"].values, sizes), replicates)
    figures = [name for name in sweep.runs.names if sweep.figures and name.startswith(sweep.figures)]
    variables = {}
    for name in ("run_id", "file", "state", "seed", *figures):
        column = sweep.runs[name]
        missing: Any = np.nan if column.dtype.kind == "f" else "" if column.dtype.kind == "U" else -1
        grid: NDArray[Any] = np.full((*sizes, int(replicates.max()) + 1), missing, dtype=column.dtype)
        grid[places] = column
        variables[name] = xr.Variable((*swept, REPLICATE), grid, column.attributes)
    words = short_names(sweep.keys, {*coordinates, *sweep.runs.names})
    coordinates |= {word: coordinates[key].copy() for key, word in words.items()}
    found = xr.Dataset(variables, coords=coordinates, attrs={"title": sweep.title})
    for word in words.values():  # without an index .sel would not find values by the short names
        found = found.set_xindex(word)
    return found


def short_names(keys: Sequence[str], taken: Collection[str] = ()) -> dict[str, str]:
    """Return the last words of keys, without their tables, if no two are the same and none is taken."""
    words = {key: key.rpartition(".")[2] for key in keys}
    alone = [word for word, count in Counter(words.values()).items() if count == 1]
    return {key: word for key, word in words.items() if word in alone and word not in taken}
