"""Small result files with random rows, for the tests of the format."""

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

import rubnoise
from rubnoise.contact.pulses import LENS, OFF_CENTRE
from rubnoise.storage.layout import RunDescription, row_count, stored_groups
from rubnoise.storage.schema import LIFE_CURVE, LIFE_TABLE, Dataset, Feature
from rubnoise.storage.writer import RunWriter

EVERYTHING: frozenset[Feature] = frozenset(("speed", "strength", "slider"))
TWO_WAY: frozenset[Feature] = EVERYTHING | {"two-way"}
BARE: frozenset[Feature] = frozenset()
FEATURES = (BARE, frozenset({"speed"}), frozenset({"strength"}), frozenset({"speed", "strength"}), EVERYTHING, TWO_WAY)

Compression = Literal["none", "gzip"]
Rows = dict[str, dict[str, NDArray[Any]]]

ORIGIN = {
    "software": '{"rubnoise": "0.1.0"}',
    "environment": '{"platform": "Linux", "machine": "x86_64", "cpu_count": 2}',
    "seed": 2**53 - 1,
    "stream_version": 1,
    "calibrated_diameter": 5.530012641,
    "propagator_constants": json.dumps({"decay_real": 0.99990000123456789}),
    "command": "rubnoise run fig5.toml",
    "started": "2026-01-02T03:04:05Z",
}


def describe(
    junctions: int = 7,
    ticks: int = 11,
    slider: int | None = 13,
    *,
    features: frozenset[Feature] = EVERYTHING,
    compression: Compression = "none",
    scenario_toml: str = 'title = "friction of µm"\n',
) -> RunDescription:
    return RunDescription(
        title="a small run of µm",
        extent={
            "junctions": junctions,
            "trace": ticks,
            "slider": slider if "slider" in features else 0,
            "landmarks": 5 if "two-way" in features else 0,
            "load": 0,
            "balance": 1,
        },
        features=features,
        compression=compression,
        pulse=OFF_CENTRE["lens"] if "offset" in features else LENS,
        provenance={
            "scenario_toml": scenario_toml,
            "scenario_resolved": json.dumps(
                rubnoise.example("paper/fig4").resolved()
                | {"title": "µm"}
                | ({"pulse": {"shape": "lens", "offset": "uniform"}} if "offset" in features else {})
            ),
            **ORIGIN,
        },
    )


def random_rows(description: RunDescription, seed: int = 1) -> Rows:
    generator = np.random.default_rng(seed)
    return {
        group.name: {
            column.name: _values(generator, column, row_count(group, description.extent)) for column in group.columns
        }
        for group in stored_groups(description.features)
        if group.name not in (LIFE_CURVE.name, LIFE_TABLE.name)
    }


def _values(generator: np.random.Generator, column: Dataset, rows: int) -> NDArray[Any]:
    if column.dtype == "<f8":
        return generator.normal(size=rows)
    return generator.integers(0, 200, size=rows).astype(column.dtype)


def cut(columns: Mapping[str, NDArray[Any]], borders: Sequence[int]) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
    """Yield the first row and the columns of each panel between sorted borders."""
    rows = len(next(iter(columns.values())))
    edges = [0, *(border for border in borders if border < rows), rows]
    for first, last in pairwise(edges):
        yield first, {name: values[first:last] for name, values in columns.items()}


def write_run(
    path: str | os.PathLike[str],
    description: RunDescription,
    rows: Rows,
    *,
    borders: Sequence[int] = (),
    summary: Mapping[str, float | int | str] = {"area_mean": 204.6736},
    force: bool = False,
    meanwhile: Callable[[], object] = lambda: None,
) -> None:
    """Write every row of a run, call ``meanwhile``, publish."""
    with RunWriter(path, description, force=force) as writer:
        for group, columns in rows.items():
            for first, panel in cut(columns, borders):
                writer.write(group, first, panel)
        meanwhile()
        writer.publish(summary)


def attempt(
    path: str | os.PathLike[str],
    *,
    force: bool = False,
    compression: Compression = "none",
    meanwhile: Callable[[], object] = lambda: None,
) -> None:
    """Write a small run of random rows."""
    description = describe(compression=compression)
    write_run(path, description, random_rows(description), force=force, meanwhile=meanwhile)


def names(folder: Path) -> list[str]:
    """Return the names of everything in a folder."""
    return sorted(entry.name for entry in folder.iterdir())
