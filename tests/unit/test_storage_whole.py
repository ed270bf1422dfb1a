"""Files that are written whole or not at all."""

import errno
from pathlib import Path

import pytest

from rubnoise.errors import OutputRefused, RubnoiseError
from rubnoise.storage.output import OutputAppearedError, whole_file
from tests.format.runs import names


def test_a_file_gets_its_name_when_it_is_whole(tmp_path: Path) -> None:
    with whole_file(tmp_path / "a", force=False) as part:
        part.write_bytes(b"half")
        assert not (tmp_path / "a").exists()
        part.write_bytes(b"whole")
    assert (tmp_path / "a").read_bytes() == b"whole"
    assert names(tmp_path) == ["a"]


def _fail(path: Path, problem: BaseException) -> None:
    with whole_file(path, force=True) as part:
        part.write_bytes(b"half")
        raise problem


@pytest.mark.parametrize("problem", [KeyboardInterrupt(), ValueError("x")])
def test_what_stops_the_writing_leaves_what_was_there(tmp_path: Path, problem: BaseException) -> None:
    (tmp_path / "a").write_bytes(b"precious")
    with pytest.raises(type(problem)):
        _fail(tmp_path / "a", problem)
    assert (tmp_path / "a").read_bytes() == b"precious"
    assert names(tmp_path) == ["a"]


def test_a_full_disk_is_told(tmp_path: Path) -> None:
    with pytest.raises(RubnoiseError, match="a: writing failed: No space left on device"):
        _fail(tmp_path / "a", OSError(errno.ENOSPC, "No space left on device"))
    assert names(tmp_path) == []


def test_nothing_is_begun_where_a_file_is(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"precious")
    with pytest.raises(OutputRefused, match="exists already"), whole_file(tmp_path / "a", force=False):
        raise AssertionError
    assert (tmp_path / "a").read_bytes() == b"precious"


def _write_beside_another(path: Path) -> None:
    with whole_file(path, force=False) as part:
        part.write_bytes(b"ours")
        path.write_bytes(b"theirs")


def test_a_file_that_appears_meanwhile_stays_beside_the_part(tmp_path: Path) -> None:
    with pytest.raises(OutputAppearedError):
        _write_beside_another(tmp_path / "a")
    assert (tmp_path / "a").read_bytes() == b"theirs"
    assert (tmp_path / "a.part").read_bytes() == b"ours"
