"""A two-way motion is made again from the rows of a file, and what has been changed in it is named."""

from collections.abc import Callable
from pathlib import Path
from shutil import copy
from typing import Any

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

from rubnoise.analysis.verification import verify
from rubnoise.analysis.verifying import two_way_motion
from rubnoise.analysis.verifying.findings import Verification
from rubnoise.storage.reader import open_run
from tests.cli.terminal import call
from tests.unit.tampering import change, put, run_of

TWO_WAY: dict[str, Any] = {"coupling": "two-way"}
KINDS: dict[str, dict[str, dict[str, Any]]] = {
    "figure 5": {},
    "slow, a slip in a row": {"sliding": {"speed": "10 um/s", "distance": "60 um"}, "output": {"tick": "0.3 um"}},
    "few and slow, slips of many lives in a row": {
        "interface": {"mean_junction_count": 5},
        "sliding": {"speed": "0.1 mm/s", "distance": "3000 um"},
        "output": {"tick": "1 um"},
        "run": {"engine": "batch", "seed": 103},
    },
    "faster": {"sliding": {"speed": "10 mm/s"}},
    "fast": {"sliding": {"speed": "1 m/s"}},
    "few": {"interface": {"mean_junction_count": 0.5}, "sliding": {"distance": "6000 um"}, "output": {"tick": "2 um"}},
    "many": {"interface": {"mean_junction_count": 300}, "sliding": {"distance": "5 um"}, "output": {"tick": "0.05 um"}},
    "coarse": {"output": {"tick": "7 um"}},
    "fine": {"output": {"tick": "0.005 um"}, "sliding": {"distance": "30 um"}},
    "triangles": {"pulse": {"shape": "triangle"}},
    "unequal": {"diameter": {"law": "exponential", "spread": None}, "strength": {"law": "normal", "spread": "80 MPa"}},
    "regular": {"birth": {"law": "regular"}},
    "empty start, slider at rest": {"sliding": {"start": "empty"}, "slider": {"start": "rest"}},
    "tight": {"slider": {"tolerance": 1e-12}},
    "loose": {"slider": {"tolerance": 1e-4}},
    "soft": {"slider": {"stiffness": "3 N/m"}, "sliding": {"distance": "40 um"}},
    "damped": {"slider": {"damping": "50 N*s/m"}},
    "gzip": {"output": {"compression": "gzip"}, "run": {"engine": "batch"}},
    "nobody at all": {"interface": {"mean_junction_count": 0.0001}, "sliding": {"distance": "150 um"}},
}
MADE_AGAIN = {"slider_rows", "landmarks", "phases", "passages", "motion", "passage_times", "summary", "blocks"}


def two_way(path: Path, **changes: dict[str, Any]) -> Path:
    return run_of(path, **changes | {"slider": TWO_WAY | changes.get("slider", {})})


def asked(path: Path, regenerate: int = 0) -> Verification:
    with open_run(path) as run:
        return verify(run, regenerate)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a right result, not to be changed."""
    return two_way(tmp_path_factory.mktemp("right") / "x.h5")


@pytest.fixture
def result(kept: Path, tmp_path: Path) -> Path:
    """Return a copy of the right result."""
    return Path(copy(kept, tmp_path))


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_comes_out_again(tmp_path: Path, name: str) -> None:
    found = asked(two_way(tmp_path / "x.h5", **KINDS[name]), regenerate=99)
    assert [str(check.first) for check in found.different] == []
    assert MADE_AGAIN | {"regenerated"} <= {check.name for check in found.checks}
    assert found.left_out == ()


def landmark(path: Path, kind: int) -> int:
    """Return a landmark of a kind in the middle of a file."""
    with h5py.File(path) as file:
        rows = np.flatnonzero(file["landmarks/kind"][:] == kind)
    return int(rows[rows.size // 2])


def times(factor: float, row: int) -> Callable[[NDArray[Any]], NDArray[Any]]:
    def changed(values: NDArray[Any]) -> NDArray[Any]:
        values = values.copy()
        values[row] *= factor
        return values

    return changed


def said(path: Path) -> str:
    """Return what `verify` says of a file that differs."""
    done = call("verify", path)
    assert done.code == 3
    return done.err


@pytest.mark.parametrize("column", ["time", "distance", "displacement", "velocity", "force_before", "force_after"])
@pytest.mark.parametrize("kind", [0, 1])
def test_a_landmark_moved_by_a_millionth_is_named(result: Path, column: str, kind: int) -> None:
    row = landmark(result, kind)
    change(result, f"landmarks/{column}", times(1.0 + 1e-6, row))
    told = said(result)
    assert "/landmarks/" in told
    assert any(f"row {near} is" in told for near in (row, row + 1))


def add(path: Path, column: str, rows: NDArray[Any], amount: float) -> None:
    change(path, column, lambda values: values + amount * rows)


def test_a_stick_that_begins_later_in_agreement_with_all_rows_is_named(result: Path) -> None:
    """Only who integrates the slip before it, and knows G, can tell: V t, s, x and f agree with each other."""
    row, later = landmark(result, 0), 3e-7
    with h5py.File(result) as file:
        numbers, times = file["landmarks/landmark"][:], file["landmarks/time"][:]
        riding = (file["slider/time"][:] > times[row]) & (file["slider/time"][:] < times[row + 1])
    begin, end = numbers == row, numbers == row + 1
    further = 1000.0 * later
    add(result, "landmarks/time", begin, later)
    add(result, "landmarks/distance", begin | end, further)
    add(result, "landmarks/displacement", end, -further)
    for column in ("force_before", "force_after"):
        add(result, f"landmarks/{column}", end, -300.0 * further)
    add(result, "slider/distance", riding, further)
    add(result, "slider/displacement", riding, -further)
    add(result, "slider/friction_force", riding, -300.0 * further)
    checks = {check.name: check for check in asked(result).different}
    assert "motion" in checks
    assert str(checks["motion"].first).startswith(("/landmarks/", "/slider/"))


@pytest.mark.parametrize("row", [1, 300, 690])
def test_a_row_moved_in_agreement_with_itself_is_named(result: Path, row: int) -> None:
    """A row's x is off by less than a ten-millionth, and its s with it."""
    with h5py.File(result) as file:
        row += int(np.argmax(file["slider/phase"][row:] == 0))
        here = np.arange(file["slider/time"].size) == row
    add(result, "slider/displacement", here, 1e-5)
    add(result, "slider/distance", here, -1e-5)
    (check,) = [check for check in asked(result).different if check.name == "motion"]
    assert check.first is not None
    assert check.first.row == row
    assert check.first.place.startswith("/slider/")


def test_one_displacement_is_named(result: Path) -> None:
    change(result, "slider/displacement", times(1.0 + 1e-8, 333))
    told = said(result)
    assert "/slider/" in told
    assert "row 333" in told


@pytest.mark.parametrize(("here", "there"), [(0, 1), (0, 2), (1, 0), (1, 2)])
def test_one_phase_is_named(result: Path, here: int, there: int) -> None:
    with h5py.File(result) as file:
        rows = np.flatnonzero(file["slider/phase"][:] == here)
    row = int(rows[rows.size // 2])
    put(result, "slider/phase", row, there)
    told = said(result)
    assert f"row {row} is" in told


@pytest.mark.parametrize("column", ["birth_time", "death_time"])
def test_two_times_swapped_are_named(result: Path, column: str) -> None:
    def swapped(values: NDArray[Any]) -> NDArray[Any]:
        values = values.copy()
        values[[400, 401]] = values[[401, 400]]
        return values

    change(result, f"junctions/{column}", swapped)
    told = said(result)
    assert f"/junctions/{column} row 40" in told


@pytest.mark.parametrize("column", ["birth_time", "death_time"])
def test_a_time_that_is_off_by_little_is_named(result: Path, column: str) -> None:
    """Only who integrates knows when the slider passed a place between two rows."""
    change(result, f"junctions/{column}", times(1.0 + 1e-7, 500))
    (check,) = asked(result).different
    assert check.name == "passage_times"
    assert str(check.first).startswith(f"/junctions/{column} row 500 is")


def test_the_sign_of_friction_at_one_reversal_is_named(tmp_path: Path) -> None:
    path = two_way(
        tmp_path / "x.h5",
        interface={"mean_junction_count": 2},
        sliding={"distance": "12 mm"},
        output={"tick": "2 um"},
    )
    assert asked(path).different == []
    row = landmark(path, 2)
    for column in ("force_before", "force_after"):
        other = Path(copy(path, tmp_path / f"{column}.h5"))
        change(other, f"landmarks/{column}", times(-1.0, row))
        told = said(other)
        assert f"/landmarks/{column} row {row} is" in told


def test_a_turn_that_was_left_out_is_named(result: Path) -> None:
    """A stick and its end are taken out, and the rows in between say slip: w falls below 0 on the way."""
    with h5py.File(result) as file:
        kind, since = file["landmarks/kind"][:], file["landmarks/time"][:]
        length = np.where(kind[:-1] == 0, np.diff(since), np.inf)
        row = int(np.argmin(length))
        begin, end = since[row], since[row + 1]
        columns = {name: np.delete(file["landmarks"][name][:], [row, row + 1]) for name in file["landmarks"]}
        time = file["slider/time"][:]
    columns["landmark"] = np.arange(columns["kind"].size)
    with h5py.File(result, "r+") as file:
        for name, values in columns.items():
            attributes = dict(file["landmarks"][name].attrs)
            del file["landmarks"][name]
            made = file["landmarks"].create_dataset(name, data=values.astype("|u1" if name == "kind" else values.dtype))
            for key, value in attributes.items():
                if key not in {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}:
                    made.attrs[key] = value
    change(result, "slider/phase", lambda values: np.where((time >= begin) & (time <= end), 0, values))
    names = {check.name for check in asked(result).different}
    assert names & {"motion", "slider_rows"}


def test_what_the_rest_of_the_model_says_is_used(kept: Path) -> None:
    """The bound that a right motion passes is missed by one with a thousandth more mass or damping."""
    from dataclasses import replace

    from rubnoise.analysis.stored_model import stored_model

    with open_run(kept) as run:
        right = stored_model(run)
        assert right.slider is not None
        assert two_way_motion.motion_checks(right, run)[0][0].holds
        for key in ("mass", "damping"):
            wrong = replace(right, slider=replace(right.slider, **{key: getattr(right.slider, key) * 1.001}))
            assert not two_way_motion.motion_checks(wrong, run)[0][0].holds


def test_of_a_long_run_stretches_are_taken(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(two_way_motion, "MOST", 20 * 200)
    found = asked(kept)
    assert found.different == []
    assert [(each.name, "stretches spread evenly" in each.reason) for each in found.left_out] == [("motion", True)]
    full = {check.name: check.values for check in asked(kept).checks}
    monkeypatch.undo()
    assert full["motion"] < {check.name: check.values for check in asked(kept).checks}["motion"] / 3


@pytest.mark.parametrize(("rows", "count", "length"), [(1000, 20.0, 1024), (10**9, 20.0, 1024), (10**6, 1e5, 1)])
def test_stretches_are_as_many_as_time_allows(rows: int, count: float, length: int) -> None:
    from tests.models import model

    run = model(count=count)
    size, starts = two_way_motion.chosen_stretches(run, rows)
    assert size == length
    assert starts[0] == 0
    assert rows - size <= starts[-1] < rows
    each = count * (1.0 + 3.0 * run.tick * run.birth_rate)
    assert len(starts) * size * each <= max(two_way_motion.MOST, 2 * size * each)
    assert np.ptp(np.diff(starts)) <= size if len(starts) > 2 else True


def test_behind_a_stationary_start_it_is_left_out(tmp_path: Path) -> None:
    """The dead of before the start are in no row: a slider that is thrown back beyond 0 can't be followed there."""
    path = two_way(
        tmp_path / "x.h5",
        interface={"mean_junction_count": 2},
        slider={"damping": "0.01 N*s/m"},
        sliding={"speed": "10 um/s", "distance": "200 um"},
        output={"tick": "0.5 um"},
        seed=4,
    )
    with h5py.File(path) as file:
        behind = (file["slider/distance"][:] < 0.0).any()
    found = asked(path)
    assert found.different == []
    assert bool([each for each in found.left_out if "behind its start" in each.reason]) == behind


def test_some_blocks_are_made_again_from_the_start(kept: Path, tmp_path: Path) -> None:
    path = two_way(tmp_path / "x.h5", sliding={"distance": "1500 um"}, output={"tick": "2 um"})
    found = asked(path, regenerate=2)
    assert found.different == []
    assert [each.name for each in found.left_out] == ["regenerated"]
    with h5py.File(path) as file:
        assert file["blocks/block"].size == 3
        late = file["slider/time"].size - 5
    put(path, "slider/velocity", late, 1.0)
    names = {regenerate: [c.name for c in asked(path, regenerate).different] for regenerate in (2, 3)}
    assert "regenerated" not in names[2]
    assert "regenerated" in names[3]


@pytest.mark.parametrize("column", ["time", "distance", "phase", "displacement", "velocity"])
def test_how_a_block_was_come_to_is_seen_to_the_bit(tmp_path: Path, column: str) -> None:
    path = two_way(tmp_path / "x.h5", sliding={"distance": "1500 um"}, output={"tick": "2 um"})
    change(path, f"blocks/{column}", lambda values: values + np.array([0, 1, 0]).astype(values.dtype))
    (check,) = asked(path).different
    assert check.name == "blocks"
    assert str(check.first).startswith(f"/blocks/{column} row 1 is")
