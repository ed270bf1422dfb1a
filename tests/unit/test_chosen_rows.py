"""Rows of a result that are asked for: conditions, order, and how much of the file is read."""

import operator
import tomllib
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import rubnoise
from rubnoise import arrays
from rubnoise.analysis.junctions import gather, select
from rubnoise.analysis.where import LONGEST, Condition, ConditionRefused
from rubnoise.storage.format import LIBRARY_VERSIONS, complete, compose
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.schema import JUNCTIONS, Dataset
from tests.files.runs import Compression, describe, random_rows, write_run

# Which rows are chosen, in which order, and how much is read for it.
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
    monkeypatch.setattr(arrays, "CHUNK_ROWS", CHUNK)
    with open_run(path) as opened:
        yield opened


def _expected(file: RunFile, chosen: NDArray[Any], *, descending: bool) -> NDArray[Any]:
    """Return the chosen rows in order of diameter, those of equal ones in order of birth, NaN last."""
    diameter = file.column("junctions", "diameter")[chosen]
    return chosen[np.lexsort((chosen, -diameter if descending else diameter))]


@pytest.mark.parametrize("descending", [False, True])
@pytest.mark.parametrize("text", [None, "diameter >= 4", "birth_distance > 0", "diameter > 99"])
def test_rows_come_in_a_stable_order(file: RunFile, text: str | None, *, descending: bool) -> None:
    where = None if text is None else Condition(text)
    columns = {name: file.column("junctions", name) for name in file.columns["junctions"]}
    chosen = np.arange(ROWS) if where is None else np.flatnonzero(where.chosen(columns))
    expected = _expected(file, chosen, descending=descending).tolist()
    meets = None if where is None else where.chosen
    rows = select(file, meets, sort="diameter", descending=descending)
    assert rows.tolist() == expected


@pytest.mark.parametrize("rows", [[], [3], [999, 0, 500, 500], list(range(1000)), list(range(999, -1, -3))])
def test_columns_are_gathered_in_the_order_of_the_rows(file: RunFile, rows: list[int]) -> None:
    for name, told in gather(file, np.array(rows, dtype=np.int64), ["state", "junction", "birth_distance"]).items():
        column = file.column("junctions", name)
        assert (told.dtype, told.tolist()) == (column.dtype, column[rows].tolist())


# Conditions on junctions: what they choose, and what is said where they cannot be read.
SIX_ROWS: dict[str, Any] = {
    "junction": np.arange(6),
    "birth_distance": np.array([-1.0, 0.5, 999.0, 1000.0, 1500.0, 2500.0]),
    "diameter": np.array([4.0, 5.0, 6.0, 6.5, 7.0, 8.0]),
    "life_distance": np.array([8.0, 10.0, 12.0, 6.0, 14.0, 16.0]),
    "max_area": np.array([12.0, 19.0, 28.0, 33.0, 38.0, 50.0]),
    "shear_strength": np.array([250.0, 250.0, 249.0, 251.0, 250.0, 250.0]),
    "birth_time": np.array([-0.001, 0.0005, 0.999, 1.0, 1.5, 2.5]),
    "state": np.array([1, 0, 0, 4, 0, 2], dtype=np.uint8),
}

CHOSEN = tomllib.loads(Path(__file__).with_name("conditions.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("text", CHOSEN)
def test_a_condition_chooses_its_rows(text: str) -> None:
    assert np.flatnonzero(Condition(text).chosen(SIX_ROWS)).tolist() == CHOSEN[text]


def test_length_and_depth_are_bounded() -> None:
    longest = "diameter > 1" + " " * (LONGEST - 12)
    deepest = "(" * 100 + "not " * 100 + "complete" + ")" * 100
    assert Condition(longest).columns == {"diameter"}
    assert Condition(deepest).columns == {"state"}
    for text in (f"{longest} ", "(" * 400 + "complete" + ")" * 400, "(" * LONGEST):
        with pytest.raises(ConditionRefused):
            Condition(text)


OPERATORS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq}
COLUMNS = ("birth_distance", "diameter", "life_distance", "max_area")
comparisons = st.tuples(
    st.sampled_from(COLUMNS), st.sampled_from(list(OPERATORS)), st.sampled_from([-1.0, 0.5, 6.0, 12.0, 1000.0])
)
trees = st.recursive(
    comparisons,
    lambda parts: st.one_of(
        st.tuples(st.just("not"), parts),
        st.tuples(st.sampled_from(["and", "or"]), parts, parts),
    ),
    max_leaves=8,
)


def _text(tree: Any) -> str:
    """Write a tree with no more parentheses than the rules of precedence ask for."""
    if tree[0] == "not":
        inner = _text(tree[1])
        return f"not ({inner})" if tree[1][0] in {"and", "or"} else f"not {inner}"
    if tree[0] == "or":
        return f"{_text(tree[1])} or {_text(tree[2])}"
    if tree[0] == "and":
        sides = (f"({_text(side)})" if side[0] == "or" else _text(side) for side in tree[1:])
        return " and ".join(sides)
    column, sign, value = tree
    return f"{column} {sign} {value!r}"


def _truth(tree: Any, row: int) -> bool:
    if tree[0] == "not":
        return not _truth(tree[1], row)
    if tree[0] in {"and", "or"}:
        first, second = _truth(tree[1], row), _truth(tree[2], row)
        return first and second if tree[0] == "and" else first or second
    column, sign, value = tree
    return bool(OPERATORS[sign](SIX_ROWS[column][row], value))


@given(trees)
def test_and_or_not_mean_what_they_mean_in_python(tree: Any) -> None:
    chosen = Condition(_text(tree)).chosen(SIX_ROWS)
    assert chosen.tolist() == [_truth(tree, row) for row in range(6)]


@pytest.mark.slow
@given(st.text(max_size=60) | st.text(alphabet="()<>=! 0123456789.eandorntdiameterum*/^", max_size=60))
def test_whatever_is_written_is_read_or_refused(text: str) -> None:
    with suppress(ConditionRefused):
        assert Condition(text).columns <= {column.name for column in JUNCTIONS.columns}


IN_A_SWEEP = (
    Dataset(name="run_id", units="", long_name="", symbol="", dtype="<U16"),
    Dataset(name="state", units="", long_name="", symbol="", dtype="<U8"),
    Dataset(name="sliding.speed", units="um/s", long_name="", symbol=""),
)


def test_a_key_of_a_sweep_is_compared_by_its_name() -> None:
    speeds = {"sliding.speed": np.array([500.0, 2000.0])}
    for text in ("sliding.speed > 1 mm/s", "sliding.speed > 1000", "not 1 mm/s >= sliding.speed"):
        assert Condition(text, IN_A_SWEEP).chosen(speeds).tolist() == [False, True], text


# Opening a result reads its structure, however long the run; asking for rows reads those rows.
IO = Path("/proc/self/io")
LAST_TICK = 150_000_000
LONG_RUN = 20_000_000

COUNTED_BY_LINUX = pytest.mark.skipif(not IO.exists(), reason="only Linux counts the bytes that a process reads")


def _read(what: Callable[[], object]) -> int:
    """Return the number of bytes that this process reads while doing something."""

    def so_far() -> int:
        return int(IO.read_text().split()[1])

    cost_of_asking = -(so_far() - so_far())
    before = so_far()
    what()
    return so_far() - before - cost_of_asking


@pytest.fixture(scope="module")
def huge(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole result of 11 GB as its size says; no row was ever written, so that it takes no room on the disk."""
    path = tmp_path_factory.mktemp("huge") / "huge.h5"
    with h5py.File(path, "w", libver=LIBRARY_VERSIONS) as file:
        description = describe(LONG_RUN, LAST_TICK + 1, slider=LAST_TICK + 1)
        compose(file, description)
        complete(file, description, {}, {}, "2026-01-02T03:04:06Z")
    assert path.stat().st_size > 11e9
    if path.stat().st_blocks * 512 > 1e8:
        pytest.skip("the file system has no sparse files")
    with rubnoise.open(path) as run:  # whatever is imported late is imported now
        run.to_xarray(index=False)
    return path


@COUNTED_BY_LINUX
def test_opening_eleven_gigabytes_reads_their_structure(huge: Path) -> None:
    def look() -> None:
        with rubnoise.open(huge) as run:
            assert len(run.trace) == LAST_TICK + 1
            assert run.trace["real_contact_area"].units == "um^2"

    assert _read(look) < 500_000


@COUNTED_BY_LINUX
def test_rows_are_read_as_asked_for(huge: Path) -> None:
    with rubnoise.open(huge) as run:
        area = run.trace["real_contact_area"]
        assert _read(lambda: area[:100]) < 100_000
        assert _read(lambda: area[-1]) < 100_000
        assert _read(lambda: area[:: LAST_TICK // 10]) < 1_000_000
        assert _read(lambda: repr(run)) < 100_000
        assert _read(lambda: run.junction(LONG_RUN - 17)) < 1_000_000


@COUNTED_BY_LINUX
def test_a_whole_column_in_memory_would_be_noticed(huge: Path) -> None:
    with rubnoise.open(huge) as run:
        assert _read(lambda: np.asarray(run.junctions["state"])) >= LONG_RUN
