"""Nothing gets a final name that is not, to the last bit, what was written, or what a part says it is."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.errors import OutputRefused, RubnoiseError, RunFileRefused, RunStopped
from rubnoise.simulation import draws
from rubnoise.storage import disk, writer
from rubnoise.storage.output import OutputPaths, OutputSwappedError, give_final_name, whole_file
from rubnoise.storage.part import open_part
from rubnoise.storage.reader import open_run, open_unfinished
from rubnoise.storage.writer import RunWriter
from tests.format.runs import Compression, attempt, names
from tests.unit.test_storage_resuming import GZIP, WHOLE, datasets, stop_after

KINDS: tuple[Compression, ...] = ("none", "gzip")


@pytest.fixture(autouse=True)
def commit_every_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "COMMIT_SECONDS", 0.0)
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)


def replaced(path: Path, content: bytes | None = None) -> None:
    """Put another file in the place of one, with the same content where none is given."""
    (path.parent / "other").write_bytes(path.read_bytes() if content is None else content)
    (path.parent / "other").replace(path)


@pytest.mark.parametrize("compression", KINDS)
@pytest.mark.parametrize("content", [b"of somebody", None], ids=["foreign", "the same bytes"])
def test_a_part_that_was_swapped_is_not_published(
    tmp_path: Path, compression: Compression, content: bytes | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    part = tmp_path / "run.h5.part"
    (tmp_path / "run.h5").write_bytes(b"older")

    def swapping(*given: Any, **named: Any) -> None:
        replaced(part, content)
        give_final_name(*given, **named)

    monkeypatch.setattr(writer, "give_final_name", swapping)
    with pytest.raises(OutputSwappedError, match=r"run\.h5\.part: another file has taken its place .* is not written"):
        attempt(tmp_path / "run.h5", compression=compression, force=True)
    assert (tmp_path / "run.h5").read_bytes() == b"older"
    assert names(tmp_path) == ["run.h5", "run.h5.part"]
    assert content is None or part.read_bytes() == content


def test_a_part_that_was_swapped_stays_where_a_run_fails(tmp_path: Path) -> None:
    def swap() -> None:
        replaced(tmp_path / "run.h5.part", b"of somebody")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        attempt(tmp_path / "run.h5", meanwhile=swap)
    assert (tmp_path / "run.h5.part").read_bytes() == b"of somebody"
    assert names(tmp_path) == ["run.h5.part"]


def test_of_other_files_what_was_swapped_is_not_published_either(tmp_path: Path) -> None:
    def write() -> None:
        with whole_file(tmp_path / "a.csv", force=False) as part:
            part.write_bytes(b"ours")
            replaced(part, b"theirs")

    with pytest.raises(OutputSwappedError):
        write()
    assert names(tmp_path) == ["a.csv.part"]
    assert (tmp_path / "a.csv.part").read_bytes() == b"theirs"


def turned(path: Path, place: int) -> None:
    """Turn a bit of a file in its place."""
    with path.open("r+b") as file:
        file.seek(place)
        byte = file.read(1)[0]
        file.seek(place)
        file.write(bytes([byte ^ 1]))


def place_in(path: Path, what: str) -> int:
    """Return where a byte of a column lies, or of a text outside of the columns."""
    if "/" in what:
        with h5py.File(path, "r") as file:
            return int(file[what].id.get_offset()) + 3
    return path.read_bytes().index(what.encode())


@contextmanager
def damaging(part: Path, what: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Turn a bit of a part when it is whole and about to be seen onto the disk."""
    sync, done = disk.sync, []

    def damage(descriptor: int) -> None:
        if not done and finished(part):
            done.append(turned(part, place_in(part, what)))
        sync(descriptor)

    with monkeypatch.context() as patch:
        patch.setattr(disk, "sync", damage)
        yield
    assert done


def finished(part: Path) -> bool:
    try:
        with h5py.File(part, "r") as file:
            return bool(file["provenance"].attrs["finished"])
    except OSError:
        return False


@pytest.mark.parametrize(("what", "said"), [("/trace/distance", "/trace/distance"), ("friction of", "its structure")])
def test_what_the_disk_has_changed_is_not_published(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str, said: str
) -> None:
    part = tmp_path / "run.h5.part"
    with (
        damaging(part, what, monkeypatch),
        pytest.raises(RubnoiseError, match=rf"run\.h5: writing failed: {said} on disk differs from what was written$"),
    ):
        attempt(tmp_path / "run.h5")
    assert names(tmp_path) == []


def test_a_damaged_copy_in_chunks_is_not_published(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    making = tmp_path / ".run.h5.making"
    for what, damaged in (("a text", "friction of"), ("a chunk", None)):
        sync = disk.sync

        def damage(descriptor: int, damaged: str | None = damaged, sync: Callable[[int], None] = sync) -> None:
            if making.exists() and finished(making):
                if damaged is None:
                    with h5py.File(making, "r") as file:
                        place = int(file["trace/distance"].id.get_chunk_info(0).byte_offset) + 9
                else:
                    place = place_in(making, damaged)
                turned(making, place)
            sync(descriptor)

        with monkeypatch.context() as patch:
            patch.setattr(disk, "sync", damage)
            with pytest.raises(RubnoiseError, match="its compressed copy on disk differs from what was written"):
                attempt(tmp_path / "run.h5", compression="gzip")
        assert names(tmp_path) == [], what


def test_a_structure_that_is_damaged_during_a_run_does_no_harm(tmp_path: Path) -> None:
    """What is no row is kept in memory, and written once more at the end."""
    part = tmp_path / "run.h5.part"
    attempt(tmp_path / "run.h5", meanwhile=lambda: [turned(part, place) for place in (3, 700, 20_000, 40_000)])
    with open_run(tmp_path / "run.h5") as run:
        assert run.damaged() == ()


def whole_part(folder: Path, run: rubnoise.Scenario = WHOLE) -> Path:
    """Make a part that is whole and lacks nothing but its name, as a kill may leave it."""
    rubnoise.run(run, folder / "x.h5").close()
    return (folder / "x.h5").rename(folder / "x.h5.part")


def other_unit(file: h5py.File) -> None:
    file["trace/distance"].attrs["units"] = np.bytes_(b"mm")


def other_meaning(file: h5py.File) -> None:
    file["junctions/state"].attrs["flag_meanings"] = np.bytes_(b"alive_at_end alive_at_start ended_early")


def other_formula(file: h5py.File) -> None:
    file.attrs["junction_area_formula"] = np.bytes_(b"A(s) = d^2")


def no_name(file: h5py.File) -> None:
    del file["slider/velocity"].attrs["long_name"]


def one_more_attribute(file: h5py.File) -> None:
    file["slider"].attrs["colour"] = 1.0


def one_more_column(file: h5py.File) -> None:
    file["trace"].create_dataset("temperature", data=np.arange(3.0))


def one_more_group(file: h5py.File) -> None:
    file.create_group("notes")


def no_name_of_a_group(file: h5py.File) -> None:
    del file["blocks"].attrs["long_name"]


def other_scale(file: h5py.File) -> None:
    del file["trace/friction_force"].attrs["DIMENSION_LIST"]


def other_figure(file: h5py.File) -> None:
    file["summary"].attrs["real_contact_area_mean"] = 7.0


def other_seed(file: h5py.File) -> None:
    file["provenance"].attrs["seed"] = 7


CHANGES: dict[Callable[[h5py.File], None], str] = {
    other_unit: "/trace/distance attribute units is not that of a run",
    other_meaning: "/junctions/state attribute flag_meanings is not that of a run",
    other_formula: "/ attribute junction_area_formula is not that of a run",
    no_name: "/slider/velocity attribute long_name is missing",
    one_more_attribute: "/slider attribute colour belongs to no run",
    one_more_column: "/trace/temperature belongs to no run",
    one_more_group: "/notes belongs to no run",
    no_name_of_a_group: "/blocks attribute long_name is missing",
    other_scale: "/trace/friction_force attribute DIMENSION_LIST is missing",
    other_figure: "/provenance xxh3_128 is ",
    other_seed: "/provenance xxh3_128 is ",
}
"""Changes of a complete part, and the message for each."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return whole_part(tmp_path_factory.mktemp("whole"))


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
def test_a_whole_part_that_somebody_changed_is_refused(
    tmp_path: Path, whole: Path, change: Callable[[h5py.File], None]
) -> None:
    part = Path(shutil.copy(whole, tmp_path))
    with h5py.File(part, "r+") as file:
        change(file)
    before = part.read_bytes()
    with pytest.raises(RunFileRefused) as refused:
        rubnoise.resume(part)
    assert str(refused.value).startswith(f"{part}: damaged: {CHANGES[change]}")
    with pytest.raises((RunFileRefused, OutputRefused), match=r"force=True\)? starts over"):
        rubnoise.run(WHOLE, tmp_path / "x.h5")
    assert names(tmp_path) == ["x.h5.part"]
    assert part.read_bytes() == before


@pytest.mark.parametrize("kind", [WHOLE, GZIP], ids=["none", "gzip"])
def test_a_whole_part_gets_its_name_as_it_is(tmp_path: Path, kind: rubnoise.Scenario) -> None:
    """The control of the test above."""
    part = whole_part(tmp_path, kind)
    before = part.read_bytes()
    rubnoise.resume(part).close()
    assert (tmp_path / "x.h5").read_bytes() == before
    assert names(tmp_path) == ["x.h5"]


def test_rows_that_are_damaged_in_a_whole_part_are_computed_again(tmp_path: Path, whole: Path) -> None:
    expected, part = datasets(whole), Path(shutil.copy(whole, tmp_path))
    turned(part, place_in(part, "/slider/velocity"))
    with h5py.File(part, "r+") as file:
        file["summary"].attrs["invented"] = 1.0
    rubnoise.resume(part).close()
    assert datasets(tmp_path / "x.h5") == expected
    with rubnoise.open(tmp_path / "x.h5") as run, open_run(tmp_path / "x.h5"):
        assert "invented" not in run._file.summary


def test_the_last_changes_in_the_journal_mend_all_that_is_no_row(
    tmp_path: Path, whole: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = datasets(whole)

    def stop(*_: object, **__: object) -> None:
        raise RunStopped(15)

    with monkeypatch.context() as patch:
        patch.setattr(RunWriter, "_name", stop)
        with pytest.raises(RunStopped):
            rubnoise.run(WHOLE, tmp_path / "x.h5")
    part = OutputPaths.of(tmp_path / "x.h5").part
    for place in (0, 9, 700, place_in(part, "uniform in time"), place_in(part, "what cut the life short")):
        turned(part, place)
    rubnoise.resume(part).close()
    assert datasets(tmp_path / "x.h5") == expected
    assert names(tmp_path) == ["x.h5"]


def test_a_part_is_resumed_only_as_it_was_read(tmp_path: Path) -> None:
    stop_after(tmp_path / "x.h5", WHOLE, 2)
    paths = OutputPaths.of(tmp_path / "x.h5")
    with open_unfinished(paths.part) as run:
        open_part(paths, run).__exit__(None, None, None)
        turned(paths.part, 9)
        with pytest.raises(RunFileRefused, match=r"x\.h5\.part: was changed just now"):
            open_part(paths, run)
        turned(paths.part, 9)
        replaced(paths.part)
        with pytest.raises(RunFileRefused, match=r"x\.h5\.part: another file has taken its place just now"):
            open_part(paths, run)


def test_a_compressed_part_that_is_damaged_cannot_be_resumed(tmp_path: Path) -> None:
    part = whole_part(tmp_path, GZIP)
    with h5py.File(part, "r") as file:
        place = int(file["trace/distance"].id.get_chunk_info(0).byte_offset) + 9
    turned(part, place)
    with pytest.raises(RunFileRefused, match="is compressed: nothing can be written to it any more"):
        rubnoise.resume(part)


def test_a_copy_of_the_result_that_is_damaged_does_not_cost_the_part(tmp_path: Path, whole: Path) -> None:
    part = Path(shutil.copy(whole, tmp_path))
    final = Path(shutil.copy(whole, tmp_path / "x.h5"))
    turned(final, place_in(final, "/slider/velocity"))
    with pytest.raises(OutputRefused, match="exists already"):
        rubnoise.resume(part)
    rubnoise.resume(part, force=True).close()
    assert datasets(final) == datasets(whole)
    assert names(tmp_path) == ["x.h5"]


def test_a_second_name_that_cannot_be_removed_is_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    part, remove = tmp_path / "x.h5.part", disk.remove

    def failing(path: Path) -> None:
        if path == part and (tmp_path / "x.h5").exists():
            raise PermissionError(1, "Operation not permitted")
        remove(path)

    with monkeypatch.context() as patch:
        patch.setattr(disk, "remove", failing)
        rubnoise.run(WHOLE, tmp_path / "x.h5").close()
    assert names(tmp_path) == ["x.h5", "x.h5.part"]
    rubnoise.resume(part).close()
    assert names(tmp_path) == ["x.h5"]
