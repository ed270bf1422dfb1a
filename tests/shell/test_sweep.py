"""`rubnoise sweep`: the same files with any workers, one index of all files, and what a terminal shows of it."""

import os
import re
import signal
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.cli.terminal import SIGNALS
from rubnoise.scenario.sweep import expand, load_sweep
from tests.shell.tampered import SLOW, TABLE, begin_sweep, runs_of
from tests.shell.terminal import CONTACT, call, columns, spawn, spawn_program


# A sweep gives the same files with any workers, also if workers die, and one index of all files.
@pytest.fixture
def file(here: Path) -> Path:
    """Write a sweep of six short runs."""
    (path := here / "s.toml").write_text(CONTACT + TABLE, encoding="utf-8")
    return path


def _alone(file: Path, folder: Path, *changes: str) -> dict[str, dict[str, bytes]]:
    """Return what every point gives as a run of its own in this process."""
    found = {}
    for point in expand(load_sweep(file, changes)):
        rubnoise.run(point.scenario, path := folder / f"{point.run_id}.h5").close()
        found[point.run_id] = columns(path)
    return found


@pytest.mark.slow
def test_workers_and_shards_give_the_bits_of_runs_alone(file: Path, tmp_path: Path) -> None:
    alone = _alone(file, tmp_path)
    assert call("sweep", file, "-o", "pool", "--jobs", "2").out == "pool: 2 points, 6 runs: 6 done\n"
    for number in (2, 1):
        assert call("sweep", file, "-o", "shards", "--jobs", "1", "--shard", f"{number}/2", "-q").out == ""
    assert runs_of(Path("pool")) == runs_of(Path("shards")) == alone
    tables = [h5py.File(Path(folder) / "index.h5") for folder in ("pool", "shards")]
    first, second = ({name: table["runs"][name][:].tobytes() for name in table["runs"]} for table in tables)
    assert first == second


@pytest.mark.slow
def test_what_is_done_is_not_done_again_and_more_points_and_replicates_join_it(file: Path) -> None:
    assert call("sweep", file, "-o", "d", "--jobs", "1").code == 0
    before = {path: path.stat().st_mtime_ns for path in Path("d/runs").iterdir()}
    more = ("--set", "sweep.replicates=4", "--set", "sweep.grid.interface.mean_junction_count=[40, 10, 20]")
    answer = call("sweep", file, "-o", "d", "--jobs", "1", *more, "--json").values()
    assert (answer["points"], answer["runs"], answer["done"]) == (3, 12, 12)
    assert {path: path.stat().st_mtime_ns for path in before} == before
    with rubnoise.open_sweep("d") as sweep:
        assert [values["interface.mean_junction_count"] for values in sweep.values] == [40, 10, 20]


def test_a_run_that_fails_is_told_and_the_others_are_made(file: Path) -> None:
    spoilt, other, *_ = expand(load_sweep(file))
    (place := Path("d/runs") / f"{spoilt.run_id}.h5").parent.mkdir(parents=True)
    rubnoise.run(other.scenario, place).close()
    kept = place.read_bytes()
    answer = call("sweep", file, "-o", "d", "--jobs", "1")
    assert (answer.code, answer.out) == (1, "d: 2 points, 6 runs: 5 done, 1 failed\n")
    heading, *_, why = answer.err.splitlines()
    assert heading == "1 run failed; the same command tries again"
    assert why.split()[:3] == [spoilt.run_id, "10", "0"]
    assert why.endswith(f"{place}: is not the result of this run; move it away, and the same command makes it")
    assert place.read_bytes() == kept
    with rubnoise.open_sweep("d") as sweep:
        assert [failure.run_id for failure in sweep.failures] == [spoilt.run_id]
        assert np.isnan(sweep.runs["real_contact_area_mean"][0])
        with pytest.raises(rubnoise.Refused, match="has no file"):
            sweep.run(spoilt.run_id)
    told = call("info", "d")
    assert told.code == 0
    assert re.search(r"^  done +5\n  failed +1\n", told.out, re.MULTILINE)
    place.unlink()
    assert call("sweep", file, "-o", "d", "--jobs", "1", "--json").values()["failed"] == 0


@pytest.mark.slow
def test_the_index_is_read_by_plain_tools_wherever_the_folder_goes(file: Path, tmp_path: Path) -> None:
    import xarray as xr

    call("sweep", file, "-o", "d", "--jobs", "1", "-q")
    Path("d").rename(moved := tmp_path / "elsewhere")
    with h5py.File(moved / "index.h5") as index:
        assert [name.decode() for name in index["runs/file"][:]] == [
            f"runs/{name.decode()}.h5" for name in index["runs/run_id"][:]
        ]
        assert index["runs/interface.mean_junction_count"].attrs["units"] == b"1"
    with xr.open_dataset(moved / "index.h5", group="runs", engine="h5netcdf") as opened:
        assert opened["state"].values.tolist() == [b"done"] * 6
        assert opened["real_contact_area_std"].attrs["units"] == "um^2"
    assert call("verify", moved).code == 0
    with rubnoise.open_sweep(moved) as sweep, sweep.run(str(sweep.runs["run_id"][0])) as run:
        assert len(run.trace) > 0


@pytest.mark.slow
def test_a_sweep_opened_in_python_has_its_keys_for_dimensions(file: Path) -> None:
    with rubnoise.sweep(file, "d", jobs=1) as sweep:
        labelled = sweep.to_xarray()
        assert labelled["real_contact_area_std"].dims == ("interface.mean_junction_count", "replicate")
        picked = labelled["run_id"].sel({"interface.mean_junction_count": 40.0}).values
        assert picked.tolist() == sweep.runs["run_id"][:][3:].tolist()
        with sweep.run(str(picked[1])) as run:
            assert run.scenario.interface.mean_junction_count == 40.0
            mean = next(figure for figure in run.summary if figure.name == "real_contact_area_mean")
        assert sweep.runs["real_contact_area_mean"][4] == mean.value
        assert sweep.runs["real_contact_area_mean_exact"][4] == mean.exact
        assert sweep.scenario(1).interface.mean_junction_count == 40.0
        assert sweep.figures[:2] == ("real_contact_area_mean", "real_contact_area_std")
        with pytest.raises(KeyError, match="no run is named"):
            sweep.run("unknown")


def test_keys_side_by_side_share_a_dimension(here: Path) -> None:
    table = '[sweep.zip]\ninterface.mean_junction_count = [10, 40]\ndiameter.law = ["fixed", "exponential"]\n'
    (here / "z.toml").write_text(CONTACT + table, encoding="utf-8")
    with rubnoise.sweep("z.toml", "d", jobs=1) as sweep:
        labelled = sweep.to_xarray()
    assert labelled["real_contact_area_mean"].dims == ("side_by_side", "replicate")
    assert labelled["diameter.law"].values.tolist() == ["fixed", "exponential"]
    assert labelled["interface.mean_junction_count"].values.tolist() == [10.0, 40.0]


def _workers(process: int) -> list[int]:
    """Return the processes of loky that make runs for a process, which starts others, too."""
    told = Path(f"/proc/{process}/task").glob("*/children")
    children = [int(number) for each in told for number in each.read_text(encoding="ascii").split()]
    return [number for number in children if b"LokyProcess" in Path(f"/proc/{number}/cmdline").read_bytes()]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="children are found in /proc")
def test_a_worker_that_is_killed_changes_nothing(file: Path, tmp_path: Path) -> None:
    begun = begin_sweep(Path("d"), "sweep", file, "-o", "d", "--jobs", "2", *SLOW, cold=True)
    os.kill(_workers(begun.pid)[0], signal.SIGKILL)
    out, err = begun.communicate(timeout=300)
    assert (begun.returncode, out, err) == (0, "d: 2 points, 8 runs: 8 done\n", "")
    assert runs_of(Path("d")) == _alone(file, tmp_path, *SLOW[1::2])


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="children are found in /proc")
def test_a_sweep_that_is_killed_is_resumed(file: Path, tmp_path: Path) -> None:
    begun = begin_sweep(Path("d"), "sweep", file, "-o", "d", "--jobs", "2", *SLOW, cold=True)
    workers = _workers(begun.pid)
    assert len(workers) == 2
    begun.kill()
    begun.communicate(timeout=60)
    answer = spawn("sweep", file, "-o", "d", "--jobs", "2", *SLOW)
    assert (answer.code, answer.out, answer.err) == (0, "d: 2 points, 8 runs: 8 done\n", "")
    assert runs_of(Path("d")) == _alone(file, tmp_path, *SLOW[1::2])
    for _ in range(3000):
        if not any(Path(f"/proc/{worker}").exists() for worker in workers):
            break
        time.sleep(0.01)  # each looks for its parent when a panel ends
    else:
        pytest.fail("a worker outlives its parent")


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_stops_a_sweep_that_can_be_resumed(file: Path, number: signal.Signals, code: int) -> None:
    begun = begin_sweep(Path("d"), "sweep", file, "-o", "d", "--jobs", "2", *SLOW)
    begun.send_signal(number)
    out, err = begun.communicate(timeout=60)
    assert (begun.returncode, out) == (code, "")
    assert err == "stopped by a signal; finished runs are kept, and the same command resumes the sweep\n"
    done = set(Path("d/runs").glob("*.h5"))
    assert len(done) < 8
    assert call("sweep", file, "-o", "d", "--jobs", "2", *SLOW).out == "d: 2 points, 8 runs: 8 done\n"


BEFORE = """
import signal
from rubnoise.cli.terminal import bar
signal.signal(signal.SIGINT, signal.SIG_DFL)
with bar(shown=False):
    signal.raise_signal(signal.{name})
print("still there")
"""


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_before_the_start_is_obeyed_at_once(number: signal.Signals) -> None:
    done = spawn_program(BEFORE.format(name=number.name))
    assert (done.code, done.out) == (-number, ""), done.err
