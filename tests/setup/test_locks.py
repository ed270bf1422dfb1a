"""The locks are complete, hashed, and say nothing about the machine they were made on."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PIN = re.compile(r"([a-z0-9-]+)==([\w.!+-]+)( ; [^\\]+)? \\")
HASH = re.compile(r"    --hash=sha256:[0-9a-f]{64}( \\)?")


def _lines(lock: str) -> list[str]:
    text = (ROOT / "tools" / f"{lock}.lock").read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.lstrip().startswith("#")]


def _pins(lock: str) -> list[tuple[str, str, str]]:
    found = [PIN.fullmatch(line) for line in _lines(lock)]
    return [(pin[1], pin[2], pin[3] or "") for pin in found if pin]


def _names(requirements: list[str]) -> set[str]:
    return {re.split(r"[<>=!~;\[ ]", requirement)[0].lower() for requirement in requirements}


@pytest.mark.parametrize("lock", ["run", "sync", "test", "all", "bench", "docs"])
def test_a_lock_is_pins_and_hashes_and_nothing_else(lock: str) -> None:
    strange = [line for line in _lines(lock) if not (PIN.fullmatch(line) or HASH.fullmatch(line))]
    assert strange == []


@pytest.mark.parametrize("lock", ["run", "sync", "test", "all", "bench", "docs"])
def test_no_lock_names_an_index_or_a_path(lock: str) -> None:
    text = (ROOT / "tools" / f"{lock}.lock").read_text(encoding="utf-8")
    assert not re.search(r"://|file:| /|--index|--find-links|@ ", text)


def test_everything_the_project_asks_for_is_locked() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    groups = project["dependency-groups"]
    run = {name for name, _, _ in _pins("run")}
    test = {name for name, _, _ in _pins("test")}
    assert _names(project["project"]["dependencies"] + groups["build"] + project["build-system"]["requires"]) <= run
    sync = {name for name, _, _ in _pins("sync")}
    assert _names(groups["sync"]) <= run | sync
    assert _names(groups["test"]) <= run | sync | test
    everything = {name for name, _, _ in _pins("all")}
    assert _names(groups["all"]) <= run | sync | test | everything
    assert not sync & test
    assert not (sync | test) & everything
    assert _names(groups["bench"]) <= run | {name for name, _, _ in _pins("bench")}


@pytest.mark.parametrize("lock", ["sync", "test", "all", "bench", "docs"])
def test_the_other_locks_only_add(lock: str) -> None:
    assert not {name for name, _, _ in _pins("run")} & {name for name, _, _ in _pins(lock)}


def test_what_the_benchmark_compares_with_is_in_no_other_lock() -> None:
    peers = {"ciw", "salabim", "superposed-pulses"}
    assert peers <= {name for name, _, _ in _pins("bench")}
    assert not peers & {name for lock in ("run", "sync", "test", "all") for name, _, _ in _pins(lock)}


def test_packages_that_dropped_an_old_python_are_pinned_twice() -> None:
    numpy = [pin for pin in _pins("run") if pin[0] == "numpy"]
    assert [marker for _, _, marker in numpy] == [" ; python_full_version < '3.12'", " ; python_full_version >= '3.12'"]
