"""How much CPU each case takes with all processes that it starts, and which cases are slow.

The mark `slow` alone means every case of a test, or of a file as `pytestmark`; with words it means the cases that have
one of these words in their name. What makes a fixture that cases share is measured apart, and divided among the cases
that ask for it.
"""

import json
import os
import re
from collections import defaultdict
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

LIMIT = 0.5
"""A case that takes more CPU than this (s) is slow: it is to be marked."""
WORST = 10
"""So many cases are printed after a run."""
SLOW_FILE = re.compile(r"^pytestmark = (\[\n    )?pytest\.mark\.slow,?$", re.MULTILINE)
TICKS = os.sysconf("SC_CLK_TCK")


def is_slow(item: pytest.Item) -> bool:
    """Return whether a case waits for --all: it is marked as slow, or needs a browser."""
    case = item.name.partition("[")[2]
    marked = any(not mark.args or any(word in case for word in mark.args) for mark in item.iter_markers("slow"))
    return marked or "browser" in getattr(item, "fixturenames", ())


def is_slow_file(path: Path) -> bool:
    """Return whether every test of a file is slow, which is seen without loading it."""
    return path.suffix == ".py" and bool(SLOW_FILE.search(path.read_text(encoding="utf-8")))


def cpu_seconds() -> float:
    """Return the CPU time of this process and of every process below it, alive or gone."""
    return _below(os.getpid()) if Path("/proc/self/stat").exists() else sum(os.times()[:4])


def _below(process: int) -> float:
    folder, ticks = Path("/proc", str(process)), 0.0
    with suppress(OSError):  # it may end while it is looked at: its time is then its parent's
        fields = folder.joinpath("stat").read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        ticks = sum(map(int, fields[11:15])) / TICKS
        for thread in folder.joinpath("task").iterdir():
            ticks += sum(_below(int(child)) for child in (thread / "children").read_text().split())
    return ticks


@dataclass(eq=False)
class Times:
    """A plugin of pytest that measures every case of one process."""

    cases: dict[str, float] = field(default_factory=dict)
    slow: set[str] = field(default_factory=set)
    made: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    users: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    shared: float = 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Iterator[None]:
        self.shared, before = 0.0, cpu_seconds()
        try:
            return (yield)
        finally:
            self.cases[item.nodeid] = max(0.0, cpu_seconds() - before - self.shared)
            self.slow |= {item.nodeid} if is_slow(item) else set()
            for name, definitions in item._fixtureinfo.name2fixturedefs.items():
                if definitions[-1].scope != "function":
                    number = getattr(getattr(item, "callspec", None), "indices", {}).get(name, 0)
                    self.users[_key(definitions[-1], number)].add(item.nodeid)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any], request: Any) -> Iterator[Any]:
        if fixturedef.scope == "function":
            return (yield)
        outer, self.shared, before = self.shared, 0.0, cpu_seconds()
        try:
            return (yield)
        finally:
            whole = cpu_seconds() - before
            self.made[_key(fixturedef, request.param_index)].append(max(0.0, whole - self.shared))
            self.shared = outer + whole

    def as_json(self) -> dict[str, Any]:
        """Return what was measured, for a file or for another process."""
        return {
            "cases": self.cases,
            "slow": sorted(self.slow),
            "made": dict(self.made),
            "users": {key: sorted(users) for key, users in self.users.items()},
        }

    def add(self, other: dict[str, Any]) -> None:
        """Take in what another process, or another run of other cases, has measured."""
        self.cases |= other["cases"]
        self.slow |= set(other["slow"])
        for key, costs in other["made"].items():
            self.made[key] += costs
        for key, users in other["users"].items():
            self.users[key] |= set(users)

    @classmethod
    def read(cls, path: Path) -> "Times":
        """Return what a run of tests has written to a file."""
        times = cls()
        times.add(json.loads(path.read_text(encoding="utf-8")))
        return times

    def write(self, path: Path) -> None:
        """Write what was measured to a file."""
        path.write_text(json.dumps(self.as_json()), encoding="utf-8")

    def seconds(self, left: frozenset[str] = frozenset()) -> dict[str, float]:
        """Return the CPU time of each case, with its share of what it shares; cases that are left out share nothing."""
        seconds = {case: cost for case, cost in self.cases.items() if case not in left}
        for key, costs in self.made.items():
            users = self.users[key] & seconds.keys()
            for case in users:
                seconds[case] += sum(costs) / len(costs) / len(users)
        return seconds

    def above(self, limit: float) -> dict[str, float]:
        """Return the cases above a limit, and those that come above it because others no longer share with them."""
        found: dict[str, float] = {}
        while more := {case: cost for case, cost in self.seconds(frozenset(found)).items() if cost > limit}:
            found |= more
        return found

    def worst(self) -> list[str]:
        """Return a line each for the cases that took most."""
        seconds = self.seconds()
        cases = sorted(seconds, key=seconds.__getitem__, reverse=True)
        return [f"{seconds[case]:6.2f} s  {case}" for case in cases[:WORST]]


def _key(definition: pytest.FixtureDef[Any], number: int) -> str:
    return f"{definition.baseid}::{definition.argname}[{number}]"
