"""Runs interrupted and damaged: `python tools/survive.py power`, say, by the interpreter of dev.py's .venv.

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
from multiprocessing import get_context
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from survival.full import full  # noqa: E402
from survival.kills import kills, signals  # noqa: E402
from survival.moments import flips, power, writes  # noqa: E402
from survival.stories import LONG, SHORT, SMALL, Outcome, Story, growing, of_kind  # noqa: E402

KINDS = ("two-way", "off-centre", "family", "under-load", "free", "growing")
TRIALS: Mapping[str, tuple[Callable[..., Outcome], int, tuple[Story, ...]]] = {
    "kills": (kills, 1000, LONG),
    "writes": (writes, 1, SMALL),
    "power": (power, 1000, SMALL),
    "full": (full, 100, SMALL),
    "flips": (flips, 1200, SMALL),
    "signals": (signals, 200, SHORT),
}
"""Each with how often it is done by default, and to which runs."""


def main() -> int:
    """Do what is asked and print what came of it; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=TRIALS, help="what is done to the runs")
    parser.add_argument("--count", type=int, help="how often; as often as docs/survival.md tells by default")
    parser.add_argument("--jobs", type=int, default=1, help="processes (1)")
    parser.add_argument("--seed", type=int, default=1, help="seed of every choice (1)")
    kinds = parser.add_mutually_exclusive_group()
    for kind in KINDS:
        kinds.add_argument(f"--{kind}", dest="kind", action="store_const", const=kind, help="runs of this kind")
    asked = parser.parse_args()
    _, usual, _ = TRIALS[asked.what]
    began, outcome = time.monotonic(), Outcome()
    with ProcessPoolExecutor(asked.jobs, mp_context=get_context("spawn")) as pool:
        given = (asked.what, asked.kind, asked.count or usual, asked.seed, asked.jobs)
        for each in [pool.submit(share, job, *given) for job in range(asked.jobs)]:
            outcome.add(each.result())
    print(outcome.told())
    print(f"in {time.monotonic() - began:.0f} s")
    return int(bool(outcome.findings))


def share(job: int, what: str, kind: str | None, count: int, seed: int, jobs: int) -> Outcome:
    """Do the share of one process. Each of several has a seed of its own; a single one has the given seed."""
    trial, _, stories = TRIALS[what]
    grown = kind == "growing"
    chosen = of_kind(kind, stories) if kind and not grown else stories
    part, own = count // jobs + (job < count % jobs), 1000 * seed + job if jobs > 1 else seed
    with growing() if grown else nullcontext():
        if trial is full:
            return full(part, own, chosen, first=job, every=jobs)
        return trial(part, own, chosen)


if __name__ == "__main__":
    sys.exit(main())
