"""Which rows are chosen, in which order, and how much is read for it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis import selection
from rubnoise.analysis.selection import gather, select
from rubnoise.analysis.where import condition
from rubnoise.storage.reader import RunFile, open_run
from tests.format.runs import Compression, describe, random_rows, write_run

ROWS = 1000
CHUNK = 64


@pytest.fixture(scope="module", params=["none", "gzip"])
def path(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """A file of many panels, with many equal diameters and a row whose diameter is no number."""
    compression: Compression = request.param
    description = describe(ROWS, 3, compression=compression)
    rows = random_rows(description)
    diameter = np.random.default_rng(7).integers(1, 9, size=ROWS).astype(float)
    diameter[500] = np.nan
    rows["junctions"] |= {"diameter": diameter, "junction": np.arange(ROWS)}
    path = tmp_path_factory.mktemp("selection") / "x.h5"
    write_run(path, description, rows)
    return path


@pytest.fixture
def file(path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RunFile]:
    """That file, opened."""
    monkeypatch.setattr(selection, "CHUNK_ROWS", CHUNK)
    monkeypatch.setattr(selection, "NEAR", 5)
    with open_run(path) as opened:
        yield opened


def _expected(file: RunFile, chosen: NDArray[Any], *, descending: bool) -> NDArray[Any]:
    """Return the chosen rows in order of diameter, those of equal ones in order of birth, NaN last."""
    diameter = file.column("junctions", "diameter")[chosen]
    return chosen[np.lexsort((chosen, -diameter if descending else diameter))]


@pytest.mark.parametrize("descending", [False, True])
@pytest.mark.parametrize("text", [None, "diameter >= 4", "birth_distance > 0", "diameter > 99"])
def test_rows_come_in_a_stable_order(file: RunFile, text: str | None, *, descending: bool) -> None:
    where = None if text is None else condition(text)
    columns = {name: file.column("junctions", name) for name in file.columns["junctions"]}
    chosen = np.arange(ROWS) if where is None else np.flatnonzero(where.chosen(columns))
    expected = _expected(file, chosen, descending=descending).tolist()
    for head in (None, 0, 1, 10, 63, 64, 65, 999, 1000, 5000):
        rows, total = select(file, where, sort="diameter", descending=descending, head=head)
        assert total == chosen.size
        assert rows.tolist() == expected[:head], head


@pytest.mark.parametrize("head", [None, 7, 700])
def test_without_a_column_the_order_is_that_of_birth(file: RunFile, head: int | None) -> None:
    assert select(file, head=head)[0].tolist() == list(range(ROWS))[:head]
    assert select(file, head=head, descending=True)[0].tolist() == list(range(ROWS))[::-1][:head]


@pytest.mark.parametrize("rows", [[], [3], [999, 0, 500, 500], list(range(1000)), list(range(999, -1, -3))])
def test_columns_are_gathered_in_the_order_of_the_rows(file: RunFile, rows: list[int]) -> None:
    panels = list(gather(file, np.array(rows, dtype=np.int64), ["state", "junction", "birth_distance"]))
    assert all(panel["state"].size <= CHUNK for panel in panels)
    for name in ("state", "junction", "birth_distance"):
        told = np.concatenate([np.zeros(0), *(panel[name] for panel in panels)])
        assert told.tolist() == file.column("junctions", name)[rows].tolist()


def test_only_what_is_needed_is_read_a_panel_at_a_time(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    read, asked = RunFile.column, []

    def watched(self: RunFile, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        assert stop is not None
        asked.append((name, stop - start))
        return read(self, group, name, start, stop)

    monkeypatch.setattr(RunFile, "column", watched)
    rows, _ = select(file, condition("diameter > 2 and not ended_early"), sort="max_area", head=4)
    assert {name for name, _ in asked} == {"diameter", "state", "max_area"}
    assert max(count for _, count in asked) == CHUNK
    asked.clear()
    next(gather(file, rows, ["birth_distance"]))
    assert sum(count for _, count in asked) <= 4 * 6


def test_few_rows_are_held_where_few_are_wanted(file: RunFile) -> None:
    best = selection._Best(5, descending=False)
    for first in range(0, ROWS, CHUNK):
        best.add(np.arange(first, first + CHUNK), np.random.default_rng(first).random(CHUNK))
        assert sum(map(len, best._rows)) <= 5


def test_a_run_without_junctions_has_none_to_choose(tmp_path: Path) -> None:
    description = describe(0, 3)
    write_run(tmp_path / "x.h5", description, random_rows(description))
    with open_run(tmp_path / "x.h5") as file:
        rows, total = select(file, condition("diameter > 1"), sort="diameter", head=3)
        assert (rows.size, total) == (0, 0)
        assert list(gather(file, rows, ["diameter"])) == []
