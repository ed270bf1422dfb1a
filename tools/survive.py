"""Runs tortured: `python tools/survive.py power`, say, by the interpreter of dev.py's .venv.

With --two-way the runs are those with a slider, and it pushes back: its rows and landmarks grow beside the part.
With --off-centre the junctions of the runs miss each other's centre line.
With --family the runs have other births, lives and sizes, one after another.
With --growing the rows of /slider are not counted beforehand: they grow beside the part, to the same bits.
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
    free,
    growing,
    of_family,
    off_centre,
    two_way,
    under_load,
)

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
    parser.add_argument("--two-way", action="store_true", help="torture runs with two-way coupling")
    parser.add_argument("--off-centre", action="store_true", help="torture runs with pulse.offset = uniform")
    parser.add_argument("--family", action="store_true", help="torture runs of other births, lives and sizes")
    parser.add_argument("--under-load", action="store_true", help="torture runs under a load that weighs")
    parser.add_argument("--free", action="store_true", help="torture runs whose slider may leave its contact")
    parser.add_argument("--growing", action="store_true", help="let rows of /slider grow, which only its end tells")
    asked = parser.parse_args()
    torture, usual, stories = TORTURES[asked.what]
    if asked.two_way and not stories:
        parser.error(f"--two-way is not for {asked.what}, which has runs of its own")
    if asked.two_way and asked.growing:
        parser.error("rows of a two-way slider always grow: leave out --growing")
    if asked.off_centre and (asked.two_way or asked.growing or not stories):
        parser.error("--off-centre is for runs with one-way coupling, and of a torture without runs of its own")
    if asked.under_load and (asked.two_way or asked.off_centre or not stories):
        parser.error("--under-load is for runs with one-way coupling, and of a torture without runs of its own")
    if asked.family and (asked.two_way or asked.off_centre or asked.under_load or not stories):
        parser.error("--family is for runs with one-way coupling, and of a torture without runs of its own")
    alone = asked.two_way or asked.off_centre or asked.growing or asked.under_load or asked.family
    if asked.free and (alone or not stories):
        parser.error("--free goes with no other kind of run, and not with a torture that has runs of its own")
    asking = (
        (asked.two_way, two_way),
        (asked.off_centre, off_centre),
        (asked.under_load, under_load),
        (asked.family, of_family),
        (asked.free, free),
    )
    chosen = next((kind(stories) for wanted, kind in asking if wanted), stories)
    task = _Task(torture, chosen, grown=asked.growing)
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
