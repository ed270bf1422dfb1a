"""What a machine has left, read from the files in which its system tells it."""

import os
import resource
from pathlib import Path

import pytest

from rubnoise.storage import forecast
from rubnoise.storage.forecast import free_disk_bytes, free_memory_bytes, memory_in_use

MEMORY = "MemTotal:        8000 kB\nMemFree:         1000 kB\nMemAvailable:    5000 kB\nHugePages_Total:       0\n"
PAGE = os.sysconf("SC_PAGE_SIZE")
NO_LIMIT = "9223372036854771712\n"


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the root of a machine with 5000 kB available and no other limit."""
    _write(tmp_path, "proc/meminfo", MEMORY)
    _write(tmp_path, "proc/self/statm", "3000 700 300 2 0 900 0\n")
    _write(tmp_path, "proc/self/cgroup", "0::/\n")
    _limited(monkeypatch)
    return tmp_path


def _left(machine: Path) -> int | None:
    forecast._limits.cache_clear()  # a process keeps the limits that it finds first
    return free_memory_bytes(machine)


def _write(root: Path, name: str, text: str) -> None:
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text, encoding="utf-8")


def _limited(monkeypatch: pytest.MonkeyPatch, **limits: int) -> None:
    def getrlimit(which: int) -> tuple[int, int]:
        told = {getattr(resource, name): limit for name, limit in limits.items()}
        return told.get(which, resource.RLIM_INFINITY), resource.RLIM_INFINITY

    monkeypatch.setattr(resource, "getrlimit", getrlimit)


def test_without_limits_it_is_what_the_machine_has_available(machine: Path) -> None:
    assert _left(machine) == 5000 * 1024
    assert memory_in_use(machine) == 700 * PAGE


def test_the_address_space_may_be_limited(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _limited(monkeypatch, RLIMIT_AS=3_100 * PAGE)
    assert _left(machine) == 100 * PAGE
    _limited(monkeypatch, RLIMIT_AS=2_000 * PAGE)
    assert _left(machine) == 0


def _second_version(root: Path, group: str, limit: str, used: int, file_pages: int = 0) -> None:
    folder = f"sys/fs/cgroup/{group}"
    _write(root, f"{folder}/memory.max", f"{limit}\n")
    _write(root, f"{folder}/memory.current", f"{used}\n")
    _write(root, f"{folder}/memory.stat", f"anon 5\ninactive_file {file_pages - 100}\nactive_file 100\n")


def test_a_group_of_version_2_leaves_what_its_limit_leaves(machine: Path) -> None:
    _write(machine, "proc/self/cgroup", "0::/user/job\n")
    _second_version(machine, "user/job", "max", 1_000_000)
    assert _left(machine) == 5000 * 1024
    _second_version(machine, "user/job", "3000000", 1_000_000)
    assert _left(machine) == 2_000_000
    _second_version(machine, "user/job", "3000000", 1_000_000, file_pages=400_000)
    assert _left(machine) == 2_400_000


def test_a_group_around_it_counts_too(machine: Path) -> None:
    _write(machine, "proc/self/cgroup", "0::/user/job\n")
    _second_version(machine, "user/job", "3000000", 1_000_000)
    _second_version(machine, "user", "3500000", 3_000_000)
    assert _left(machine) == 500_000


def test_a_group_that_is_over_its_limit_leaves_nothing(machine: Path) -> None:
    _second_version(machine, "", "1000000", 1_500_000)
    assert _left(machine) == 0


@pytest.mark.parametrize("group", ["user/job", "not/there"], ids=["its own", "that of a container, named from outside"])
def test_a_group_of_version_1_leaves_what_its_limit_leaves(machine: Path, group: str) -> None:
    _write(machine, "proc/self/cgroup", f"9:name=systemd:/\n4:cpu,memory:/{group}\n0::/\n")
    folder = "sys/fs/cgroup/memory" + ("/user/job" if group == "user/job" else "")
    _write(machine, f"{folder}/memory.usage_in_bytes", "1000000\n")
    _write(machine, f"{folder}/memory.stat", "inactive_file 1\ntotal_inactive_file 300000\ntotal_active_file 100000\n")
    _write(machine, f"{folder}/memory.limit_in_bytes", NO_LIMIT)
    assert _left(machine) == 5000 * 1024
    _write(machine, f"{folder}/memory.limit_in_bytes", "2000000\n")
    assert _left(machine) == 1_400_000


def test_a_system_without_such_files_has_the_memory_that_is_built_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _limited(monkeypatch)
    here = free_memory_bytes()
    built_in = free_memory_bytes(tmp_path)
    assert here is not None
    assert built_in is not None
    assert built_in >= here
    assert memory_in_use(tmp_path) == 0


def test_a_disk_has_what_is_free_and_what_a_part_gives_back(tmp_path: Path) -> None:
    free = free_disk_bytes(tmp_path / "run.h5")
    assert free > 0
    with (tmp_path / "run.h5.part").open("wb") as part:
        part.write(bytes(40_000_000))
    # Whoever else writes to this disk meanwhile may be let off some of it.
    assert free_disk_bytes(tmp_path / "run.h5") - free_disk_bytes(tmp_path / "other.h5") == pytest.approx(
        40_000_000, rel=0.5
    )


def test_a_file_may_be_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _limited(monkeypatch, RLIMIT_FSIZE=5000)
    assert free_disk_bytes(tmp_path / "run.h5") == 5000


def test_a_folder_that_is_not_there_has_no_room_to_tell_of(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        free_disk_bytes(tmp_path / "nowhere" / "run.h5")
