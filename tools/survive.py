"""Runs tortured: `python tools/survive.py power`, say, by the interpreter of dev.py's .venv.

With --growing nobody counts the rows of /slider beforehand: they grow beside the part, to the same bits.
Prints counts, and a line for each thing that was lost or wrong; exit code 1 where there is any.
"""

import argparse
import sys
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "tools")]

from survival.cost import cost  # noqa: E402
from survival.finding import Outcome  # noqa: E402
from survival.flips import flips  # noqa: E402
from survival.full import full  # noqa: E402
from survival.kills import kills  # noqa: E402
from survival.power import power  # noqa: E402
from survival.signals import signals  # noqa: E402
from survival.stories import growing  # noqa: E402
from survival.sweeps import sweeps  # noqa: E402
from survival.writes import writes  # noqa: E402

Torture = Callable[[int, int], Outcome]
TORTURES: Mapping[str, tuple[Torture, int]] = {
    "kills": (kills, 1000),
    "writes": (writes, 1),
    "power": (power, 1000),
    "sweeps": (sweeps, 1000),
    "full": (full, 100),
    "flips": (flips, 1200),
    "signals": (signals, 200),
    "cost": (cost, 10),
}
"""Each with how often it is done by default."""


def main() -> int:
    """Do what is asked and print what came of it; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=TORTURES, help="what is done to the runs")
    parser.add_argument("--count", type=int, help="how often; as often as docs/survival.md tells by default")
    parser.add_argument("--jobs", type=int, default=1, help="processes (1)")
    parser.add_argument("--seed", type=int, default=1, help="seed of every choice (1)")
    parser.add_argument("--growing", action="store_true", help="let rows of /slider grow, which only its end tells")
    asked = parser.parse_args()
    torture, usual = TORTURES[asked.what]
    began = time.monotonic()
    outcome = _shared(_Grown(torture) if asked.growing else torture, asked.count or usual, asked.jobs, asked.seed)
    print(outcome.told())
    print(f"in {time.monotonic() - began:.0f} s")
    return int(bool(outcome.findings))


@dataclass(frozen=True, slots=True)
class _Grown:
    """A torture of runs whose rows of /slider grow."""

    torture: Torture

    def __call__(self, count: int, seed: int) -> Outcome:
        with growing():
            return self.torture(count, seed)


def _shared(torture: Torture, count: int, jobs: int, seed: int) -> Outcome:
    """Share the work among processes, each with a seed of its own."""
    if jobs == 1:
        return torture(count, seed)
    outcome = Outcome()
    shares = [count // jobs + (job < count % jobs) for job in range(jobs)]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for each in [pool.submit(torture, share, 1000 * seed + job) for job, share in enumerate(shares)]:
            outcome.add(each.result())
    return outcome


if __name__ == "__main__":
    sys.exit(main())
