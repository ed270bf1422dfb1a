"""What holds for every test, and which wait for `--all`."""

import gc
import os
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from tests import frozen, warm
from tests.browser import browser
from tests.wishes import Wishes

__all__ = ["browser"]

TORTURES = {Path(__file__).parent / name for name in ("survival", "fuzz", "setup", "bench")}
"""Folders all of whose tests are tortures."""

# The same examples every time, and no clock: a test that fails on a slow machine says nothing.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


@pytest.fixture(scope="session", autouse=True)
def warm_workers() -> Iterator[None]:
    """Fork the processes of sweeps from one that has loaded the program, and compile each kernel once."""
    from tests.turns import take_turns  # it loads numba, which the process that distributes tests does not need

    take_turns()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rubnoise.sweep.pool.subprocess", warm.warm_workers())
        yield


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="run the tortures too, and work frozen values out anew")
    parser.addoption("--tortures", action="store_true", help="run the tortures too")
    parser.addoption("--freeze", action="store_true", help="write the frozen values that are asked for; with -n 0")


def pytest_configure(config: pytest.Config) -> None:
    if hasattr(config, "workerinput"):
        config.option.tortures = config.workerinput["tortures"]
    else:
        named = config.args_source is pytest.Config.ArgsSource.ARGS
        config.option.tortures |= named or bool(config.option.markexpr) or config.option.all
    Wishes.everything, Wishes.freeze = config.option.all, config.option.freeze


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tell the workers of pytest-xdist, whose command line does not name the requested files."""
    node.workerinput["tortures"] = node.config.option.tortures


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Start a worker more than there are cores: some tests wait, for a browser or another process."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return cores + 1


def pytest_collection() -> None:
    """Let no garbage be looked for among tests and libraries while they are loaded."""
    gc.disable()


def pytest_sessionfinish(session: pytest.Session) -> None:
    del session
    if Wishes.freeze:
        frozen.write()


def pytest_collection_finish() -> None:
    """Leave tests and libraries out of garbage collection; it would also copy their memory in forked processes."""
    gc.collect()
    gc.freeze()
    gc.enable()


def pytest_report_header(config: pytest.Config) -> str:
    return "" if config.option.tortures else "tortures are left out; --all runs them too"


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    return True if collection_path in TORTURES and not config.option.tortures else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        if TORTURES.intersection(item.path.parents):
            item.add_marker("torture")
    _leave_cases(items)
    if not config.option.tortures:
        left = [item for item in items if item.get_closest_marker("torture")]
        config.hook.pytest_deselected(items=left)
        items[:] = [item for item in items if not item.get_closest_marker("torture")]


def _leave_cases(items: list[pytest.Item]) -> None:
    """Let the cases of a test that is marked `daily(N)` wait for `--all`, but for N of them, spread over their list."""
    cases = defaultdict[str, list[pytest.Item]](list)
    for item in items:
        if item.get_closest_marker("daily") and not item.get_closest_marker("torture"):
            cases[item.nodeid.partition("[")[0]].append(item)
    for found in cases.values():
        count = found[0].get_closest_marker("daily").args[0]
        kept = {number * len(found) // count for number in range(count)}
        for number, item in enumerate(found):
            if number not in kept:
                item.add_marker("torture")
