"""Whatever bit of whatever value of a result is turned, with its hash put right, verification finds it."""

from pathlib import Path
from shutil import copy

import h5py
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rubnoise.analysis.verification import verify
from rubnoise.storage.reader import open_run
from tests.unit.tampering import flip, run_of
from tests.wishes import examples

UNEQUAL = {"diameter": {"law": "lognormal", "spread": "70 %"}, "strength": {"law": "lognormal", "spread": "60 %"}}
KINDS = {
    "one way": UNEQUAL,
    "two ways": {**UNEQUAL, "slider": {"coupling": "two-way"}},
    "off": {"pulse": {"offset": "uniform"}},
}


@pytest.fixture(scope="module", params=KINDS)
def result(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    return run_of(tmp_path_factory.mktemp("verification") / "right.h5", **KINDS[request.param])


@settings(max_examples=examples(8, 60), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_bit_of_any_value_counts(result: Path, tmp_path: Path, data: st.DataObject) -> None:
    path = Path(copy(result, tmp_path / "x.h5"))
    with h5py.File(path) as file:
        column = data.draw(st.sampled_from([f"{group}/{name}" for group in file for name in file[group]]))
        size, bits = file[column].size, 8 * file[column].dtype.itemsize
    flip(path, column, data.draw(st.integers(0, size - 1)), data.draw(st.integers(0, bits - 1)))
    with open_run(path) as run:
        assert verify(run).different != []


def test_the_file_is_right_before(result: Path) -> None:
    with open_run(result) as run:
        assert verify(run).different == []
