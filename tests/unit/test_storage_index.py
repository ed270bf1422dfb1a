"""Files that describe: an index of a sweep, and the attributes of a part."""

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.api import resuming
from rubnoise.api.sweep_result import open_sweep
from rubnoise.errors import OutputRefused, Refused, RunFileRefused
from rubnoise.runs.index import figure, text, whole
from rubnoise.simulation import draws
from rubnoise.storage import writer
from rubnoise.storage.index import Filled, Index, index_bytes, open_index
from rubnoise.storage.journal import Journal, frames
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.reader import open_run
from rubnoise.storage.resume import look
from rubnoise.storage.schema import Dataset
from tests.format.runs import names
from tests.unit.test_storage_resuming import WHOLE, scenario, stop_after

# An index says what it was given; one that is none of ours, or leads elsewhere, is refused with the reason.
COUNT = 5


def _index(*more: Filled) -> Index:
    return Index(
        title="swept \u00b5",
        command="rubnoise sweep s.toml",
        scenario_toml="format = 1\n",
        scenario_resolved={"format": 1},
        grid=("output.tick",),
        side_by_side=(),
        points=[text("values", "", ['{"output.tick": "1 um"}'])],
        runs=[
            text("run_id", "name of the run", [f"{n:016x}" for n in range(COUNT)]),
            whole("point", "number of the point", [0] * COUNT),
            text("reason", "why it failed", ["", "no room: \u00b5", "", "", ""]),
            figure("real_contact_area_std", np.array([1.5, np.nan, 0.1, 0.2, 0.3])),
            *more,
        ],
        arrays_of_runs={"spectrum": np.arange(4.0 * COUNT).reshape(COUNT, 4)},
        arrays_of_points={"spectrum_place": np.arange(4.0)[None]},
    )


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (path := tmp_path / "index.h5").write_bytes(index_bytes(_index()))
    return path


def test_what_was_written_is_read(path: Path) -> None:
    with open_index(path) as index:
        assert index.attributes["title"] == "swept \u00b5"
        assert [about.name for about in index.columns("runs")] == [
            "run", "run_id", "point", "reason", "real_contact_area_std"
        ]  # fmt: skip
        assert index.read("runs", "run").tolist() == list(range(COUNT))
        assert index.read("runs", "reason").tolist() == ["", "no room: \u00b5", "", "", ""]
        assert index.read("runs", "run_id", 1, 3).tolist() == [f"{1:016x}", f"{2:016x}"]
        assert np.array_equal(index.read("runs", "real_contact_area_std"), [1.5, np.nan, 0.1, 0.2, 0.3], equal_nan=True)
        [std] = (about for about in index.columns("runs") if about.name == "real_contact_area_std")
        assert std == Dataset(
            name="real_contact_area_std", units="um^2", long_name="real contact area std", symbol="", dtype="<f8"
        )
        assert index.read("summaries", "spectrum")[1].tolist() == [4.0, 5.0, 6.0, 7.0]
        assert index.read("summaries", "spectrum_place").shape == (1, 4)
        assert index.is_as_written()
    with pytest.raises(ValueError, match="closed"):
        index.read("runs", "run")


def test_an_index_that_was_replaced_gives_no_rows_of_the_other_one(path: Path) -> None:
    with open_index(path) as index:
        path.write_bytes(index_bytes(replace(_index(), title="another")))
        assert index.read("runs", "run").size == COUNT
        with pytest.raises(RunFileRefused, match="was replaced since it was opened"):
            index.read("summaries", "spectrum")


@pytest.mark.parametrize("name", ["runs/point", "points/values", "summaries/spectrum"])
def test_a_value_that_changed_is_noticed(path: Path, name: str) -> None:
    with h5py.File(path, "r+") as file:
        file[name][0] = file[name][0] + 1 if name != "points/values" else b"{}"
    with open_index(path) as index:
        assert index.damaged() == (f"/{name}",)
        assert not index.is_as_written()


def test_an_index_is_no_run_and_a_run_no_index(path: Path, tmp_path: Path) -> None:
    with pytest.raises(RunFileRefused, match="is the index of a sweep, not the result of a run"):
        open_run(path)
    (tmp_path / "text").write_text("no HDF5", encoding="utf-8")
    with pytest.raises(RunFileRefused, match="not an HDF5 file"):
        open_index(tmp_path / "text")
    with pytest.raises(RunFileRefused, match="no folder of a sweep"):
        open_sweep(tmp_path / "nowhere")


def _virtual(file: h5py.File) -> None:
    del file["runs/real_contact_area_std"]
    layout = h5py.VirtualLayout((COUNT,), "<f8")
    layout[:] = h5py.VirtualSource("/etc/passwd.h5", "x", shape=(COUNT,))
    file["runs"].create_virtual_dataset("real_contact_area_std", layout)


def _external(file: h5py.File) -> None:
    del file["runs/point"]
    file["runs"].create_dataset("point", (COUNT,), "<i8", external=[("/etc/passwd", 0, 8 * COUNT)])


def _linked(file: h5py.File) -> None:
    file["runs/other"] = h5py.ExternalLink("/etc/passwd.h5", "/x")


def _variable(file: h5py.File) -> None:
    file["runs"].create_dataset("other", data=["a"] * COUNT, dtype=h5py.string_dtype())


def _short(file: h5py.File) -> None:
    file["runs"].create_dataset("other", data=np.zeros(COUNT - 1))


def _crowded(file: h5py.File) -> None:
    for number in range(300):
        file["runs"].create_dataset(f"other{number}", data=np.zeros(COUNT))


def _newer(file: h5py.File) -> None:
    file.attrs.modify("format_version", 2)


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (_virtual, "/runs/real_contact_area_std is not stored as an index stores it"),
        (_external, "/runs/point is not stored as an index stores it"),
        (_linked, "/runs/other is no column"),
        (_variable, "/runs/other is not stored as an index stores it"),
        (_short, "/runs has columns of several lengths"),
        (_crowded, "/runs holds 305 objects"),
        (lambda file: file.pop("points"), "/points is missing"),
        (lambda file: file.attrs.pop("grid"), "attribute grid is missing"),
    ],
)
def test_what_an_index_is_not_is_refused(path: Path, spoil: Callable[[h5py.File], None], said: str) -> None:
    with h5py.File(path, "r+") as file:
        spoil(file)
    with pytest.raises(RunFileRefused, match=said):
        open_index(path)


def test_one_of_a_later_format_is_told_from_a_damaged_one(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        _newer(file)
    with pytest.raises(RunFileRefused, match="has format version 2"):
        open_index(path)


# Whatever the attributes of a part say, it is resumed or refused in a sentence that names the part.
RESOLVED = WHOLE.resolved()


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the part of a run that was stopped after two commits."""
    folder = tmp_path_factory.mktemp("stopped")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writer, "COMMIT_SECONDS", 0.0)
        patch.setattr(draws, "_DRAWN_AT_ONCE", 1)
        stop_after(folder / "x.h5", WHOLE, 2)
    return folder / "x.h5.part"


@pytest.fixture
def part(tmp_path: Path, stopped: Path) -> Path:
    """Return a copy of it, with its journal."""
    for path in stopped.parent.iterdir():
        shutil.copy(path, tmp_path)
    return tmp_path / "x.h5.part"


def told(part: Path, **attributes: object) -> None:
    """Let a part say something else of its origin."""
    with h5py.File(part, "r+") as file:
        for name, value in attributes.items():
            owner = file["provenance"].attrs
            if name in owner:
                del owner[name]
            kind = h5py.string_dtype("utf-8", max(2, len(value.encode()))) if isinstance(value, str) else None
            owner.create(name, value, dtype=kind)


def with_key(section: str, **keys: object) -> str:
    return json.dumps(RESOLVED | {section: RESOLVED[section] | keys})


NOT_A_TABLE = ("null", "[]", '"text"', "1", "true", "NaN")
SCENARIOS = {
    **{text: f"/provenance scenario_resolved is {text}, not a table of values by name" for text in NOT_A_TABLE},
    "": "/provenance scenario_resolved is no JSON that can be read",
    "{": "/provenance scenario_resolved is no JSON that can be read",
    '{"a":' * 2000 + "1" + "}" * 2000: "/provenance scenario_resolved is no JSON that can be read",
    '{"format": ' + "9" * 5000 + "}": "/provenance scenario_resolved is no JSON that can be read",
    json.dumps(RESOLVED | {"output": None}): "/provenance scenario_resolved has null for output, not a table",
    json.dumps(RESOLVED | {"output": ["gzip"]}): '/provenance scenario_resolved has ["gzip"] for output, not a table',
    json.dumps(RESOLVED | {"pulse": None}): "the scenario in the file has the pulse shape 'None', which is not known",
    "{}": "the scenario in the file is not valid",
    json.dumps(RESOLVED | {"interface": None}): "the scenario in the file is not valid",
    json.dumps(RESOLVED | {"sliding": [1]}): "the scenario in the file is not valid",
    json.dumps(RESOLVED | {"diameter": "wide"}): "the scenario in the file is not valid",
    with_key("interface", mean_junction_count=[]): "the scenario in the file is not valid",
    with_key("run", seed=2): "has seed 1, and its scenario has 2",
    with_key("sliding", distance="1e12 km"): "the scenario in the file is not valid",
    with_key("interface", mean_junction_count=30): "has calibrated diameter",
    with_key("sliding", distance="2500 um"): "has another number of rows than here",
}  # fmt: skip


@pytest.mark.parametrize("text", SCENARIOS, ids=range(len(SCENARIOS)))
def test_a_scenario_that_is_none_of_the_part_is_refused(part: Path, text: str) -> None:
    told(part, scenario_resolved=text)
    before = part.read_bytes()
    with pytest.raises(Refused, match=re.escape(SCENARIOS[text])) as refused:
        rubnoise.resume(part)
    assert str(refused.value).startswith(f"{part}: ")
    assert str(refused.value).count(str(part)) == 1
    assert refused.value.exit_code == 2
    with pytest.raises(OutputRefused, match=r"\(force=True starts over"):
        rubnoise.run(WHOLE, part.with_suffix(""))
    assert part.read_bytes() == before
    assert names(part.parent) == ["x.h5.part", "x.h5.part.journal"]


def test_births_beyond_all_bounds_are_not_counted(part: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A part may claim a run of which counting alone takes hours."""

    def count(*_: object) -> None:
        raise AssertionError("births were counted")

    description = look(part).description
    assert resuming._has_its_rows(WHOLE, description)
    monkeypatch.setattr("rubnoise.storage.forecast.extent", count)
    many = scenario(interface={"mean_real_contact_area": "200000 um^2", "mean_junction_count": 20_000})
    for other in (many, scenario(sliding={"distance": "3 mm", "speed": "1 mm/s"})):
        assert not resuming._has_its_rows(other, description)


ORIGINS: list[tuple[dict[str, Any], str]] = [
    ({"software": "null"}, "/provenance software is null, not a table of values by name"),
    ({"environment": "[1, 2]"}, "/provenance environment is [1, 2], not a table of values by name"),
    ({"propagator_constants": "7"}, "/provenance propagator_constants is 7, not a table of values by name"),
    ({"propagator_constants": '{"cells_per_tick": "' + "x" * 100}, "/provenance propagator_constants is no JSON"),
    ({"propagator_constants": '{"a": null}'}, "has other constants of the slider's step than here"),
    ({"seed": "one"}, '/provenance seed is "one", not a whole number'),
    ({"seed": float("nan")}, "/provenance seed is NaN, not a whole number"),
    ({"seed": -1}, "has seed -1, and its scenario has 1"),
    ({"stream_version": 0.5}, "/provenance stream_version is 0.5, not a whole number"),
    ({"calibrated_diameter": "wide"}, '/provenance calibrated_diameter is "wide", not a number'),
    ({"calibrated_diameter": float("inf")}, "has calibrated diameter inf um"),
    ({"started": np.zeros(3)}, "attribute started is not a plain number or text"),
]


@pytest.mark.parametrize(("attributes", "said"), ORIGINS, ids=lambda each: str(each)[:40])
def test_an_origin_that_is_none_is_refused(part: Path, attributes: dict[str, Any], said: str) -> None:
    told(part, **attributes)
    before = part.read_bytes()
    with pytest.raises(Refused, match=re.escape(said)) as refused:
        rubnoise.resume(part)
    assert str(refused.value).startswith(f"{part}: ")
    assert refused.value.exit_code == 2
    assert part.read_bytes() == before


@pytest.mark.parametrize("text", NOT_A_TABLE)
def test_a_look_refuses_it_too(part: Path, text: str) -> None:
    told(part, scenario_resolved=text)
    with pytest.raises(RunFileRefused, match="not a table of values by name"):
        look(part)


def test_a_part_without_rows_is_looked_at(part: Path) -> None:
    with h5py.File(part, "r+") as file:
        for name in ("trace", "slider"):
            for column in list(file[name]):
                dtype = file[name][column].dtype
                del file[name][column]
                file[name].create_dataset(column, (0,), dtype)
    assert look(part).share == 0.0
    with pytest.raises(RunFileRefused, match="damaged"):
        rubnoise.resume(part)


def other_columns(path: Path) -> None:
    """Give a journal columns that the run does not have."""
    (first, *_) = frames(path)
    run = json.loads(first.content)
    run["columns"][0] = ["junctions", "temperature"]
    path.unlink()
    rewritten(path, first=json.dumps(run).encode())


def no_ending(path: Path) -> None:
    """Let a journal hold last changes that are none."""
    (first, *_) = frames(path)
    path.unlink()
    rewritten(path, first=first.content, kind="end", content=b"\xff" * 15)


def far_moment(path: Path) -> None:
    """Let a commit be of a time that never comes."""
    (first, second, *_) = frames(path)
    path.unlink()
    rewritten(path, first=first.content, content=np.float64("inf").tobytes() + second.content[8:])


def rewritten(path: Path, *, first: bytes, kind: str = "rows", content: bytes = b"") -> None:
    journal = Journal(path, first)
    journal.append(kind, content, durable=False)  # type: ignore[arg-type]
    journal.close()


@pytest.mark.parametrize("forge", [other_columns, no_ending, far_moment])
def test_a_journal_that_makes_no_sense_is_refused(part: Path, forge: Callable[[Path], None]) -> None:
    journal = OutputPaths.of(part.with_suffix("")).journal
    forge(journal)
    for door in (lambda: rubnoise.resume(part), lambda: look(part)):
        with pytest.raises(RunFileRefused, match=r"x\.h5\.part\.journal: is no journal of rubnoise"):
            door()
