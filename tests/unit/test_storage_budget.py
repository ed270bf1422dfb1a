"""What a run needs and what the machine has left."""

import os
import resource
import subprocess
import sys
from math import sqrt
from pathlib import Path

import pytest

from rubnoise.api.running import run, simulate
from rubnoise.errors import OutputRefused, Refused
from rubnoise.scenario import Scenario, loads
from rubnoise.simulation.draws import PROGRAM_BYTES
from rubnoise.storage import forecast
from rubnoise.storage.forecast import (
    Budget,
    check_disk_space,
    check_sweep_space,
    counted,
    expected,
    free_memory_bytes,
    memory_in_use,
)
from tests.unit.scenarios import BARE, WHOLE

# The forecast of a run: a run that does not fit on this machine is refused with the keys to change.
DENSE = ("interface.mean_junction_count=300000", "sliding.distance=10 um")
SIZES = {"a slider": WHOLE, "the contact alone": BARE, "hardly any births": BARE.replace("count = 20", "count = 0.01")}
PEAK = """
import sys
from rubnoise import load, run
run(load(sys.argv[1], sys.argv[3:]), sys.argv[2], force=True).close()
status = dict(line.split(":", 1) for line in open("/proc/self/status"))
print(int(status["VmHWM"].split()[0]) * 1024)
"""
"""ru_maxrss would not do: a child begins with its parent's."""
RUNS = {
    "Figure 5": (),
    "thin": ("interface.mean_junction_count=0.01", "diameter.spread=5 %", "sliding.distance=1 m", "output.tick=1 um"),
    "slow": ("sliding.speed=20 um/s", "sliding.distance=1 mm"),
    "compressed": ("output.compression=gzip",),
    "dense": (
        "interface.mean_junction_count=30000",
        "diameter.spread=5 %",
        "sliding.distance=5 um",
        "output.tick=1 nm",
    ),
}


def _with(text: str, *overrides: str) -> Scenario:
    return loads(text, overrides=overrides)


def _with_room(monkeypatch: pytest.MonkeyPatch, *, disk: int = 10**18, memory: int = 10**18) -> None:
    monkeypatch.setattr(forecast, "free_disk_bytes", lambda path: disk)
    monkeypatch.setattr(forecast, "free_memory_bytes", lambda: memory)


def _refusal(scenario: Scenario, told: Budget) -> str:
    with pytest.raises(Refused) as refused:
        check_disk_space(told, "run.h5")
    return str(refused.value)


@pytest.mark.parametrize("text", SIZES.values(), ids=SIZES)
def test_rows_are_those_of_the_run_and_bytes_nearly(tmp_path: Path, text: str) -> None:
    scenario = loads(text)
    told = counted(scenario)
    with run(scenario, tmp_path / "run.h5") as result:
        assert (told.junctions, told.ticks) == (len(result.junctions), len(result.trace))
    assert told.result_bytes == pytest.approx((tmp_path / "run.h5").stat().st_size, abs=16_000)
    assert told.disk_bytes == told.result_bytes


@pytest.mark.parametrize("start", ["stationary", "empty"])
@pytest.mark.parametrize("text", SIZES.values(), ids=SIZES)
def test_what_is_expected_is_what_is_counted_but_for_chance(text: str, start: str) -> None:
    scenario = _with(text, f"sliding.start={start}")
    before, after = expected(scenario), counted(scenario)
    assert before.ticks == after.ticks
    assert abs(before.junctions - after.junctions) <= 4.0 * sqrt(after.junctions + 1.0)
    assert before.result_bytes == pytest.approx(after.result_bytes, rel=0.01)


def test_what_fits_exactly_is_allowed_and_a_byte_less_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = loads(WHOLE)
    told = counted(scenario)
    _with_room(monkeypatch, disk=told.disk_bytes)
    check_disk_space(told, "run.h5")
    _with_room(monkeypatch, disk=told.disk_bytes - 1)
    said = _refusal(scenario, told)
    assert said.startswith(f"run.h5: the result may take {told.disk_bytes:,} bytes")
    assert f"{told.disk_bytes - 1:,}" in said
    assert "sliding.distance" in said
    assert "output.tick" in said


TWO_WAY = ("slider.coupling=two-way", "sliding.distance=2 mm")


@pytest.mark.slow("0.5-10 um/s")
@pytest.mark.parametrize("speed", ["10 um/s", "1 mm/s", "100 mm/s", "1 m/s"])
@pytest.mark.parametrize("count", [0.5, 20.0])
def test_a_two_way_run_has_no_more_rows_than_are_told(speed: str, count: float) -> None:
    """The bound holds whatever the seed, and is not much above what there is where a run is long."""
    changes = (f"sliding.speed={speed}", f"interface.mean_junction_count={count}", "output.tick=1 um")
    for seed in range(4):
        scenario = _with(WHOLE, *TWO_WAY, *changes, f"run.seed={seed}", "run.engine=batch")
        told, record = counted(scenario), simulate(scenario)
        assert told.slider_rows_at_most is not None
        assert record["slider"]["time"].size <= told.slider_rows_at_most
        assert told.result_bytes >= sum(
            column.nbytes for group in ("slider", "landmarks") for column in record[group].values()
        )
    long = counted(_with(WHOLE, *TWO_WAY, *changes, "sliding.distance=1 m"))
    assert long.slider_rows_at_most is not None
    assert long.slider_rows_at_most < 1.02 * 1e6


def test_memory_is_refused_with_the_count_or_the_engine_named(monkeypatch: pytest.MonkeyPatch) -> None:
    events, batch = (_with(BARE, *DENSE, f"run.engine={engine}") for engine in ("events", "batch"))
    more = expected(batch).peak_bytes - memory_in_use() + 10**7
    _with_room(monkeypatch, memory=more)
    check_disk_space(expected(batch), "run.h5")
    assert 'run.engine = "batch"' in _refusal(events, expected(events))
    _with_room(monkeypatch, memory=1_000_000)
    for scenario in (events, batch):
        said = _refusal(scenario, expected(scenario))
        assert said.endswith("1 MB are left; make interface.mean_junction_count smaller")


def test_a_run_asks_before_it_makes_anything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _with_room(monkeypatch, disk=1000)
    with pytest.raises(OutputRefused, match=r"sliding\.distance"):
        run(loads(WHOLE), tmp_path / "run.h5")
    _with_room(monkeypatch, memory=1000)
    with pytest.raises(Refused, match=r"memory"):
        run(loads(WHOLE), tmp_path / "run.h5")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of a process is read from /proc")
@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("engine", ["events", "batch"])
def test_a_process_needs_the_memory_of_its_forecast(tmp_path: Path, name: str, engine: str) -> None:
    changes = (*RUNS[name], f"run.engine={engine}")
    (tmp_path / "run.toml").write_text(WHOLE, encoding="utf-8")
    told = expected(_with(WHOLE, *changes))
    words = [sys.executable, "-c", PEAK, tmp_path / "run.toml", tmp_path / "run.h5", *changes]
    # To compile takes more memory than to run: the least of two, of which the second finds its machine code.
    peak = min(int(subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout) for _ in range(2))
    forecast_bytes = PROGRAM_BYTES + told.working_bytes
    assert peak <= forecast_bytes <= 1.4 * peak


def test_a_sweep_has_to_fit_as_a_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs, needed = [loads(WHOLE)] * 10, 10 * expected(loads(WHOLE)).disk_bytes
    _with_room(monkeypatch, disk=needed)
    check_sweep_space(runs, tmp_path, jobs=1, keep="runs")
    _with_room(monkeypatch, disk=needed - 1)
    check_sweep_space(runs, tmp_path, jobs=1, keep="summary")
    with pytest.raises(OutputRefused, match=r"sweep\.keep .* sliding\.distance .* sweep\.replicates"):
        check_sweep_space(runs, tmp_path, jobs=1, keep="runs")


def test_as_many_runs_at_once_as_memory_holds_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs, each = [loads(WHOLE)] * 9, PROGRAM_BYTES + expected(loads(WHOLE)).working_bytes
    _with_room(monkeypatch, memory=3 * each)
    check_sweep_space(runs, tmp_path, jobs=3, keep="runs")
    with pytest.raises(Refused, match="jobs=3 fits"):
        check_sweep_space(runs, tmp_path, jobs=4, keep="runs")
    _with_room(monkeypatch, memory=each - 1)
    with pytest.raises(Refused, match=r"interface\.mean_junction_count"):
        check_sweep_space(runs, tmp_path, jobs=1, keep="runs")


# What a machine has left, read from the files in which its system tells it.
MEMORY = "MemTotal:        8000 kB\nMemFree:         1000 kB\nMemAvailable:    5000 kB\nHugePages_Total:       0\n"
PAGE = os.sysconf("SC_PAGE_SIZE")


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the root of a machine with 5000 kB available, of which the process holds 700 pages, and no limit."""
    _write(tmp_path, "proc/meminfo", MEMORY)
    _write(tmp_path, "proc/self/statm", "3000 700 300 2 0 900 0\n")
    monkeypatch.setattr(forecast, "ROOT", tmp_path)
    _limited(monkeypatch)
    return tmp_path


def _write(root: Path, name: str, text: str) -> None:
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text, encoding="utf-8")


def _limited(monkeypatch: pytest.MonkeyPatch, **limits: int) -> None:
    def getrlimit(which: int) -> tuple[int, int]:
        told = {getattr(resource, name): limit for name, limit in limits.items()}
        return told.get(which, resource.RLIM_INFINITY), resource.RLIM_INFINITY

    monkeypatch.setattr(resource, "getrlimit", getrlimit)


def test_without_limits_it_is_what_the_machine_has_available(machine: Path) -> None:
    assert free_memory_bytes() == 5000 * 1024
    assert memory_in_use() == 700 * PAGE


def test_the_address_space_may_be_limited(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _limited(monkeypatch, RLIMIT_AS=3_100 * PAGE)
    assert free_memory_bytes() == 100 * PAGE
    _limited(monkeypatch, RLIMIT_AS=2_000 * PAGE)
    assert free_memory_bytes() == 0


@pytest.mark.parametrize("group", ["/job", "/job/inner", "/named/from/outside"])
def test_the_groups_around_a_process_limit_its_memory(machine: Path, group: str) -> None:
    """A container that is named from outside has its limit at the root."""
    _write(machine, "proc/self/cgroup", f"0::{group}\n")
    folder = "sys/fs/cgroup/" + ("" if "outside" in group else "job/")
    for text, left in (("max", 5000 * 1024), ("3000000", 3_000_000 - 700 * PAGE), ("1000000", 0)):
        _write(machine, f"{folder}memory.max", f"{text}\n")
        assert free_memory_bytes() == left
