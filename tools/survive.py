"""Runs interrupted: `python tools/survive.py kills`, say, by the interpreter of dev.py's .venv.

kills: SIGKILL at random moments; rivals: a second writer; failing: each call of the system that makes a result fails in
turn; filling: a small disk fills up. Prints counts, and a line for each thing that was lost or wrong; exit code 1 where
there is any.
"""

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from survival.full import failing, filling  # noqa: E402
from survival.kills import kills, rivals  # noqa: E402
from survival.stories import Outcome  # noqa: E402

TRIALS = {"kills": (kills, 1000), "rivals": (rivals, 100), "failing": (failing, 1), "filling": (filling, 100)}
"""Each with how often it is done by default."""


def main() -> int:
    """Do what is asked and print what came of it; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=TRIALS, help="what is done to the runs")
    parser.add_argument("--count", type=int, help="how often; as often as docs/survival.md tells by default")
    parser.add_argument("--jobs", type=int, default=1, help="processes (1)")
    parser.add_argument("--seed", type=int, default=1, help="seed of every choice (1)")
    asked = parser.parse_args()
    began, outcome = time.monotonic(), Outcome()
    count = asked.count or TRIALS[asked.what][1]
    with ProcessPoolExecutor(asked.jobs, mp_context=get_context("spawn")) as pool:
        for each in [pool.submit(share, job, asked.what, count, asked.seed, asked.jobs) for job in range(asked.jobs)]:
            outcome.add(each.result())
    print(outcome.told())
    print(f"in {time.monotonic() - began:.0f} s")
    return int(bool(outcome.findings))


def share(job: int, what: str, count: int, seed: int, jobs: int) -> Outcome:
    """Do the share of one process."""
    if what == "failing":
        return failing(every=jobs, first=job)
    trial = {"kills": kills, "rivals": rivals, "filling": filling}[what]
    return trial(count // jobs + (job < count % jobs), 1000 * seed + job)


if __name__ == "__main__":
    sys.exit(main())
