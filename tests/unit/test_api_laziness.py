"""Opening a result reads its structure, however long the run; asking for rows reads those rows."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.storage.structure import LIBRARY_VERSIONS, complete, compose
from tests.format.runs import describe

IO = Path("/proc/self/io")
LAST_TICK = 150_000_000
JUNCTIONS = 20_000_000

pytestmark = pytest.mark.skipif(not IO.exists(), reason="only Linux counts the bytes that a process reads")


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
        compose(file, describe(JUNCTIONS, LAST_TICK + 1, slider=LAST_TICK + 1), compressed=False)
        complete(file, {}, {}, "2026-01-02T03:04:06Z")
    assert path.stat().st_size > 11e9
    if path.stat().st_blocks * 512 > 1e8:
        pytest.skip("the file system has no sparse files")
    with rubnoise.open(path) as run:  # whatever is imported late is imported now
        run.to_xarray(index=False)
    return path


def test_opening_eleven_gigabytes_reads_their_structure(huge: Path) -> None:
    def look() -> None:
        with rubnoise.open(huge) as run:
            assert len(run.trace) == LAST_TICK + 1
            assert run.trace["real_contact_area"].units == "um^2"

    assert _read(look) < 500_000


def test_rows_are_read_as_asked_for(huge: Path) -> None:
    with rubnoise.open(huge) as run:
        area = run.trace["real_contact_area"]
        assert _read(lambda: area[:100]) < 100_000
        assert _read(lambda: area[-1]) < 100_000
        assert _read(lambda: area[:: LAST_TICK // 10]) < 1_000_000
        assert _read(lambda: repr(run)) < 100_000
        assert _read(lambda: run.junction(JUNCTIONS - 17)) < 1_000_000
        assert 8_000_000 <= _read(lambda: area[:1_000_000]) < 9_000_000


def test_xarray_reads_nothing_before_it_is_asked_to(huge: Path) -> None:
    with rubnoise.open(huge) as run:
        # xarray loads libraries of its own when it is first asked for something.
        float(run.trace.to_xarray(index=False)["friction_force"][:9].mean())
        run.to_xarray(index=False)
        run.junctions.to_xarray()["diameter"].sel(junction=0).item()
        assert _read(lambda: run.to_xarray(index=False)) < 100_000
        assert _read(run.junctions.to_xarray) < 100_000
        junctions = run.junctions.to_xarray()
        assert _read(lambda: junctions["diameter"].sel(junction=JUNCTIONS - 1).item()) < 100_000
        trace = run.trace.to_xarray(index=False)
        assert _read(lambda: float(trace["friction_force"][1000:2000].mean())) < 200_000


def test_a_whole_column_in_memory_would_be_noticed(huge: Path) -> None:
    with rubnoise.open(huge) as run:
        assert _read(lambda: np.asarray(run.junctions["state"])) >= JUNCTIONS
