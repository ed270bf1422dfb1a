"""Runs tortured: `python tools/survive.py power`, say, by the interpreter of dev.py's .venv.

Other runs, one kind at a time: --two-way, whose rows and landmarks grow beside the part; --off-centre, whose junctions
miss each other's centre line; --family, with other births, lives and sizes, one after another; --under-load; --free,
whose slider may leave its contact; --growing, whose rows of /slider are not counted beforehand and grow beside the
part, to the same bits.
Prints counts, and a line for each thing that was lost or wrong; exit code 1 where there is any.
"""

import argparse
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from survival.cost import cost  # noqa: E402
from survival.full import full  # noqa: E402
from survival.kills import kills, signals  # noqa: E402
from survival.moments import flips, power, sweeps, writes  # noqa: E402
from survival.stories import (  # noqa: E402
    LONG,
    SHORT,
    SMALL,
    Outcome,
    Story,
    growing,
    of_kind,
)

KINDS = ("two-way", "off-centre", "family", "under-load", "free", "growing")

Torture = Callable[..., Outcome]
TORTURES: Mapping[str, tuple[Torture, int, tuple[Story, ...]]] = {
    "kills": (kills, 1000, LONG),
    "writes": (writes, 1, SMALL),
    "power": (power, 1000, SMALL),
    "sweeps": (sweeps, 1000, SMALL),
    "full": (full, 100, SMALL),
    "flips": (flips, 1200, SMALL),
    "signals": (signals, 200, SHORT),
    "cost": (cost, 10, ()),
}
"""Each with how often it is done by default, and to which runs; the cost is that of runs of its own."""

BY_CALL = (full,)
"""Tortures that go through every call of the disk, each process through a share of them."""


def main() -> int:
    """Do what is asked and print what came of it; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=TORTURES, help="what is done to the runs")
    parser.add_argument("--count", type=int, help="how often; as often as docs/survival.md tells by default")
    parser.add_argument("--jobs", type=int, default=1, help="processes (1)")
    parser.add_argument("--seed", type=int, default=1, help="seed of every choice (1)")
    kinds = parser.add_mutually_exclusive_group()
    for kind in KINDS:
        kinds.add_argument(f"--{kind}", dest="kind", action="store_const", const=kind, help="runs of this kind")
    asked = parser.parse_args()
    torture, usual, stories = TORTURES[asked.what]
    if asked.kind and not stories:
        parser.error(f"--{asked.kind} is not for {asked.what}, which has runs of its own")
    grown = asked.kind == "growing"
    task = _Task(torture, of_kind(asked.kind, stories) if asked.kind and not grown else stories, grown=grown)
    began = time.monotonic()
    outcome = _shared(task, asked.count or usual, asked.jobs, asked.seed)
    print(outcome.told())
    print(f"in {time.monotonic() - began:.0f} s")
    return int(bool(outcome.findings))


@dataclass(frozen=True, slots=True)
class _Task:
    """A torture and the runs that it is for; ``grown``: their rows of /slider are not counted beforehand.

    ``part``: which of how many processes does it. A torture that goes through every call takes its share of the calls.
    """

    torture: Torture
    stories: tuple[Story, ...]
    grown: bool
    part: tuple[int, int] = (0, 1)

    def __call__(self, count: int, seed: int) -> Outcome:
        how: dict[str, Any] = {"stories": self.stories} if self.stories else {}
        if self.torture in BY_CALL:
            how["first"], how["every"] = self.part
        with growing() if self.grown else nullcontext():
            return self.torture(count, seed, **how)


def _shared(task: _Task, count: int, jobs: int, seed: int) -> Outcome:
    """Share the work among processes, each with a seed of its own."""
    if jobs == 1:
        return task(count, seed)
    outcome = Outcome()
    shares = [count // jobs + (job < count % jobs) for job in range(jobs)]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        parts = [replace(task, part=(job, jobs)) for job in range(jobs)]
        for each in [
            pool.submit(part, share, 1000 * seed + part.part[0]) for part, share in zip(parts, shares, strict=True)
        ]:
            outcome.add(each.result())
    return outcome


if __name__ == "__main__":
    sys.exit(main())
