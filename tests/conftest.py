"""What holds for every test, and which wait for `--all`."""

import gc
import os
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from tests import blas, frozen, times, warm  # noqa: F401  (blas sets what numpy reads, before the others load it)
from tests.frozen import Wishes

ROOT = Path(__file__).parents[1]
TIMES = times.Times()
"""What the cases of this process took."""

# The same examples every time, and no clock: a test that fails on a slow machine says nothing.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


OF_THE_SHELL = (
    *("COLUMNS", "FORCE_COLOR", "NO_COLOR", "PY_COLORS", "GITHUB_ACTIONS", "MPLBACKEND"),
    *("PYTHONWARNINGS", "PYTHONDEVMODE", "CI", "BUILD_NUMBER"),
)
"""Settings of a shell or a service that change the width, colours, pictures and warnings of a program.

In a service pytest compares what differs line by line, which takes hours for the columns of a result.
"""


@pytest.fixture(scope="session", autouse=True)
def plain_shell() -> Iterator[None]:
    """Have every program that a test starts begin in a shell without settings of its own."""
    with pytest.MonkeyPatch.context() as patch:
        for name in OF_THE_SHELL:
            patch.delenv(name, raising=False)
        yield


@pytest.fixture(scope="session", autouse=True)
def one_compiles() -> None:
    """Compile each kernel once."""
    warm.take_turns()


@pytest.fixture(autouse=True)
def own_command_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give every test a command line that is none of ours: a run keeps the one that it was made by."""
    monkeypatch.setattr(sys, "argv", ["pytest"])


CHROMIUMS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Return a browser of playwright's, one for all tests."""
    found = next((path for name in CHROMIUMS if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("NO CHROMIUM FOUND: the page of lessons is not tested; install chromium to test it")
    api = pytest.importorskip("playwright.sync_api", reason="NO PLAYWRIGHT FOUND: the page of lessons is not tested")
    with api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield started
        started.close()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all", action="store_true", help="run slow cases too, and work some frozen values out anew")
    parser.addoption("--slow", action="store_true", help="run slow cases too")
    parser.addoption("--times", type=Path, metavar="FILE", help="write the CPU time of every case to a JSON file")
    parser.addoption("--freeze", action="store_true", help="write the frozen values that are asked for; with -n 0")


def pytest_configure(config: pytest.Config) -> None:
    if hasattr(config, "workerinput"):
        config.option.slow = config.workerinput["slow"]
    else:
        named = config.args_source is pytest.Config.ArgsSource.ARGS
        config.option.slow |= named or config.option.all
    Wishes.everything, Wishes.freeze = config.option.all, config.option.freeze
    config.pluginmanager.register(TIMES)


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tell the workers of pytest-xdist, whose command line does not name the requested files."""
    node.workerinput["slow"] = node.config.option.slow


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Take over what a worker of pytest-xdist has measured; one that was killed tells nothing."""
    TIMES.add(getattr(node, "workeroutput", {}).get("times", times.Times().as_json()))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Start a worker more than there are cores: some tests wait, for a browser or another process."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return cores + 1


def pytest_collection() -> None:
    """Let no garbage be looked for among tests and libraries while they are loaded."""
    gc.disable()


def pytest_sessionfinish(session: pytest.Session) -> None:
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["times"] = TIMES.as_json()
    if Wishes.freeze:
        frozen.write()


def pytest_collection_finish() -> None:
    """Leave tests and libraries out of garbage collection; it would also copy their memory in forked processes."""
    gc.collect()
    gc.freeze()
    gc.enable()


def pytest_report_header(config: pytest.Config) -> list[str]:
    compiled = any(ROOT.joinpath("src").rglob("*.nbi"))
    first = [] if compiled else ["the first run compiles machine code, which takes a minute longer"]
    return first if config.option.slow else ["about 3 minutes on two cores; --all adds slow cases", *first]


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    if config.option.slow or not collection_path.is_relative_to(ROOT):
        return None
    return times.is_slow_file(collection_path) or None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if not config.option.slow:
        left = [item for item in items if times.is_slow(item)]
        config.hook.pytest_deselected(items=left)
        items[:] = [item for item in items if item not in set(left)]


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if config.option.times:
        TIMES.write(config.option.times)
    if not config.option.slow:
        terminalreporter.section("CPU time of the worst cases")
        terminalreporter.write_line("\n".join(TIMES.worst()))


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """End with one line that needs no knowledge of pytest."""
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None or hasattr(config, "workerinput") or config.option.collectonly:
        return
    passed, failed, errors, skipped = (
        len(reporter.stats.get(kind, ())) for kind in ("passed", "failed", "error", "skipped")
    )
    reporter.write_line(f"Tests: {passed} passed, {failed + errors} failed, {skipped} skipped")
