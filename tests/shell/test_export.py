"""`rubnoise export`: the rows of a result, to the last bit, for tools that read no HDF5."""

import csv
import signal
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import rubnoise
from rubnoise.errors import how_to_install
from rubnoise.storage import export as exporting
from tests.files.runs import BARE, EVERYTHING, describe, random_rows, write_run
from tests.shell.terminal import begin, call, names, spawn, spawn_program, stop

TABLES = ("junctions", "trace", "slider")
KINDS = {"csv": ".csv", "parquet": ".parquet", "netcdf": ".nc"}
THESE = [kind for kind in KINDS if kind != "parquet" or find_spec("pyarrow")]
"""The kinds that can be written here; pyarrow comes with --all."""

JUNCTIONS, TICKS = 57, 203


@pytest.fixture
def rows(here: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the rows of `run.h5`, of which every export takes several panels."""
    monkeypatch.setattr("rubnoise.arrays.CHUNK_ROWS", 50)
    monkeypatch.setattr(exporting, "ROW_GROUP", 50)
    description = describe(JUNCTIONS, TICKS)
    made = random_rows(description)
    made["trace"]["friction_force"][:3] = [1e300, 5e-324, -0.1 - 0.2]
    write_run(here / "run.h5", description, made)
    return made


def _equal(found: Any, wanted: Any) -> None:
    found, wanted = np.asarray(found), np.asarray(wanted)
    assert found.dtype == wanted.dtype
    assert found.tobytes() == wanted.tobytes()


def test_csv_is_read_back_to_the_last_bit(here: Path, rows: Any) -> None:
    answer = call("export", "run.h5", "--to", "csv")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines()[1].startswith("run_trace.csv: 203 rows of trace, ")
    assert names(here) == ["run.h5", "run_junctions.csv", "run_slider.csv", "run_trace.csv"]
    for group in TABLES:
        text = (here / f"run_{group}.csv").read_bytes().decode("ascii")
        assert text.endswith("\n")
        assert "\r" not in text
        columns = zip(*csv.reader(text.splitlines()), strict=True)
        for (name, wanted), (found, *values) in zip(rows[group].items(), columns, strict=True):
            assert found.startswith(name)
            _equal(np.array(list(map(wanted.dtype.type, values))), wanted)
        assert pd.read_csv(here / f"run_{group}.csv").shape == (len(wanted), len(rows[group]))


def test_parquet_is_read_back_with_units_at_its_fields(here: Path, rows: Any) -> None:
    pq = pytest.importorskip("pyarrow.parquet")
    assert call("export", "run.h5", "--to", "parquet").code == 0
    for group in TABLES:
        path = here / f"run_{group}.parquet"
        table = pq.read_table(path)
        assert table.column_names == list(rows[group])
        for name, wanted in rows[group].items():
            _equal(table[name].to_numpy(), wanted)
            assert table.schema.field(name).metadata[b"units"]
        assert pq.ParquetFile(path).num_row_groups == -(-len(wanted) // 50)
        assert table.schema.metadata[b"group"] == group.encode()
        assert table.schema.metadata[b"title"] == "a small run of µm".encode()
    junctions = pq.read_schema(here / "run_junctions.parquet")
    assert junctions.field("max_area").metadata[b"units"] == b"um^2"
    assert junctions.field("state").metadata[b"flags"] == b"1:alive_at_start 2:alive_at_end 4:ended_early"


def test_netcdf_holds_all_groups_or_one_at_its_root(here: Path, rows: Any) -> None:
    assert call("export", "run.h5", "--to", "netcdf").code == 0
    assert call("export", "run.h5", "--to", "netcdf", "--group", "slider").code == 0
    assert names(here) == ["run.h5", "run.nc", "run_slider.nc"]
    for path, group, inside in [("run.nc", name, name) for name in TABLES] + [("run_slider.nc", "slider", None)]:
        with xr.open_dataset(here / path, group=inside, engine="h5netcdf") as found:
            assert set(found.variables) == set(rows[group])
            assert list(found.dims) == [next(iter(rows[group]))]
            for name, wanted in rows[group].items():
                _equal(found[name].values, wanted)
                assert found[name].attrs["units"]
    with xr.open_dataset(here / "run.nc", engine="h5netcdf") as root:
        assert root.attrs["Conventions"] == "CF-1.11"
        assert root.attrs["title"] == "a small run of µm"
        assert root.attrs["history"].endswith("rubnoise run fig5.toml")
        assert 'title = "friction of µm"' in root.attrs["scenario_toml"]
    with xr.open_datatree(here / "run.nc", engine="h5netcdf") as tree:
        assert set(tree.children) == set(TABLES)
        assert tree["junctions"]["state"].attrs["flag_meanings"] == "alive_at_start alive_at_end ended_early"


@pytest.mark.parametrize("kind", THESE)
def test_a_run_without_junctions_or_slider_is_exported(here: Path, kind: str) -> None:
    description = describe(0, 5, features=BARE)
    write_run(here / "run.h5", description, random_rows(description))
    assert call("export", "run.h5", "--to", kind).code == 0
    if kind == "netcdf":
        with xr.open_dataset(here / "run.nc", group="junctions", engine="h5netcdf") as found:
            assert found["diameter"].shape == (0,)
    else:
        reader = pd.read_csv if kind == "csv" else pd.read_parquet
        assert reader(here / f"run_junctions{KINDS[kind]}").shape == (0, 7)
    answer = call("export", "run.h5", "--to", kind, "--group", "slider", "-o", "x")
    assert (answer.code, answer.err) == (2, "run.h5: the run has no slider; it has junctions, trace\n")
    assert not (here / "x").exists()


@pytest.mark.parametrize("kind", THESE)
def test_offsets_of_passes_off_the_centre_line_are_exported_in_um(here: Path, kind: str) -> None:
    description = describe(JUNCTIONS, TICKS, features=EVERYTHING | {"offset"})
    made = random_rows(description)
    write_run(here / "run.h5", description, made)
    assert call("export", "run.h5", "--to", kind, "--group", "junctions").code == 0
    wanted, path = made["junctions"]["lateral_offset"], here / f"run_junctions{KINDS[kind]}"
    if kind == "csv":
        found = np.genfromtxt(path, delimiter=",", names=True)["lateral_offset_um"]
    elif kind == "parquet":
        pq = pytest.importorskip("pyarrow.parquet")
        assert pq.read_schema(path).field("lateral_offset").metadata[b"units"] == b"um"
        found = pq.read_table(path)["lateral_offset"]
    else:
        with xr.open_dataset(path, engine="h5netcdf") as dataset:
            assert dataset["lateral_offset"].attrs["units"] == "um"
            found = dataset["lateral_offset"].values
    _equal(found, wanted)


@pytest.mark.slow
@pytest.mark.parametrize("group", TABLES)
def test_csv_on_standard_output_is_what_a_file_holds(here: Path, rows: Any, group: str) -> None:
    answer = spawn("export", "run.h5", "--to", "csv", "--group", group, "-o", "-")
    assert (answer.code, answer.err) == (0, "")
    assert names(here) == ["run.h5"]
    assert call("export", "run.h5", "--to", "csv", "--group", group).code == 0
    assert answer.out == (here / f"run_{group}.csv").read_text(encoding="ascii")


@pytest.mark.parametrize("kind", THESE)
def test_an_existing_file_is_refused_before_any_is_written(here: Path, rows: Any, kind: str) -> None:
    last = here / ("run.nc" if kind == "netcdf" else f"run_slider{KINDS[kind]}")
    last.write_bytes(b"precious")
    answer = call("export", "run.h5", "--to", kind)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith(f"{last.name}: exists already (--force replaces it)\n")
    assert last.read_bytes() == b"precious"
    assert names(here) == ["run.h5", last.name]
    assert call("export", "run.h5", "--to", kind, "--force").code == 0
    assert last.stat().st_size > 100


@pytest.mark.parametrize(
    ("kind", "library", "extra"), [("parquet", "pyarrow", "tables"), ("netcdf", "h5netcdf", "analysis")]
)
def test_a_missing_library_is_named_with_its_extra(
    here: Path, rows: Any, kind: str, library: str, extra: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    answer = call("export", "run.h5", "--to", kind)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == f"export --to {kind} needs {library}: {how_to_install(extra)}\n"
    assert names(here) == ["run.h5"]


LIMITED = """
import resource
from rubnoise.cli.app import main
resource.setrlimit(resource.RLIMIT_FSIZE, (11_000, 11_000))
main()
"""
"""The command line where no file takes more than 11 kB: the junctions do, and a trace or slider does not."""


@pytest.mark.parametrize("kind", THESE)
def test_where_one_file_cannot_be_written_none_is(here: Path, kind: str) -> None:
    description = describe(JUNCTIONS, 400)
    write_run(here / "run.h5", description, random_rows(description))
    answer = spawn_program(LIMITED, "export", "run.h5", "--to", kind)
    assert (answer.code, answer.out) == (1, "")
    assert ": writing failed: " in answer.err
    assert answer.err.lower().endswith("file too large\n")
    assert answer.err.count("\n") == 1
    assert names(here) == ["run.h5"]


@pytest.mark.slow
def test_a_signal_leaves_nothing_behind(here: Path) -> None:
    rubnoise.run(rubnoise.load("../given/contact.toml", ["sliding.distance=1 m", "output.tick=0.5 um"]), "x.h5")
    export_of_it: subprocess.Popen[str] = begin(
        "export", "x.h5", "--to", "csv", "--group", "trace", part=here / "x_trace.csv.part"
    )
    answer = stop(export_of_it, signal.SIGTERM)
    assert (answer.code, answer.err) == (
        143,
        "stopped by a signal; nothing was kept, and the same command begins again\n",
    )
    assert names(here) == ["x.h5"]
