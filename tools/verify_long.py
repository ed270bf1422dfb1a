"""Long runs against exact theory, by hand: `python tools/verify_long.py --longer 10 --seeds 3 --jobs 2`.

The test suite runs every contact of the paper once, long enough for half a percent. This runs them longer and with more
seeds, and prints how many standard errors each figure is off; with as many as these, z has to be spread like a unit
normal, neither wider nor narrower. Exit code 1 when it is not.
"""

import argparse
import json
import sys
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from math import erfc, sqrt
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "src")]

from rubnoise.record.tally import Tally  # noqa: E402
from rubnoise.scenario import load  # noqa: E402
from rubnoise.simulation.run import simulate  # noqa: E402
from rubnoise.theory.exact import exact  # noqa: E402
from rubnoise.theory.motion_errors import motion_errors  # noqa: E402
from tests.verification.scores import PRECISION, errors_of, expected, measured, reference_model, scores  # noqa: E402

FIGURE_5 = ROOT / "scenarios" / "paper" / "fig5.toml"
MOMENTS = ROOT / "tests" / "reference" / "moments.json"
METRES = 0.2
CHANCE = 1e-4
"""How improbable the whole table may be before it is called wrong."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One run: a row of the reference, or Fig. 5 with its slider where there is none."""

    row: dict[str, Any] | None
    seed: int
    longer: float


def jobs(longer: float, seeds: int) -> Iterator[Job]:
    """Yield every contact of the paper and Fig. 5, with so many seeds each."""
    rows = [row for row in json.loads(MOMENTS.read_text(encoding="utf-8"))["rows"] if row["calibration"] == "paper"]
    for n in range(seeds):
        # Runs of one seed share their uniforms whatever the contact: each needs a seed of its own.
        for place, row in enumerate([*rows, None]):
            yield Job(row=row, seed=1_000_003 * (n + 1) + place, longer=longer)


def scored(job: Job) -> tuple[str, dict[str, float]]:
    """Return what was run, and the z of its figures."""
    if job.row is None:
        return "Fig. 5, slider", slider_scores(job)
    model = reference_model(job.row, PRECISION / sqrt(job.longer))
    area, count, spread = (
        job.row[key] for key in ("mean_real_contact_area_input", "mean_junction_count_input", "diameter_std")
    )
    name = f"A_rm {area} N_jm {count} sigma {spread}"
    return name, scores(measured(model, job.seed), expected(model), errors_of(model))


def slider_scores(job: Job) -> dict[str, float]:
    """Return z of the motion in Fig. 5; its mean displacement is left out, since its error is a bound."""
    overrides = (f'sliding.distance="{METRES * job.longer:.6g} m"', 'output.tick="0.4 um"')
    model = load(FIGURE_5, overrides=overrides).model()
    tally, values, errors = Tally(), exact(model).slider, motion_errors(model, model.distance)
    simulate(model, job.seed, tally)
    if values is None:
        raise SystemExit(f"{FIGURE_5} has no slider")
    place, speed = tally.moments["displacement"], tally.moments["velocity"]
    return {
        "displacement_std": (place.std - values.displacement_std) / errors.displacement_std,
        "velocity_std": (speed.std - values.velocity_std) / errors.velocity_std,
    }


def verdicts(found: Iterable[dict[str, float]]) -> list[tuple[str, int, float, float, float]]:
    """Return, by figure: number, mean and mean square of z, largest |z|."""
    by_name: dict[str, list[float]] = {}
    for figures in found:
        for name, z in figures.items():
            by_name.setdefault(name, []).append(z)
    return [
        (name, len(z), sum(z) / len(z), sum(v * v for v in z) / len(z), max(map(abs, z))) for name, z in by_name.items()
    ]


def is_likely(count: int, mean: float, square: float, largest: float) -> bool:
    """Whether so many unit normals would have such a mean, mean square (to first order) and largest value."""
    deviations = (mean * sqrt(count), (square - 1.0) * sqrt(count / 2.0))
    chances = [erfc(abs(z) / sqrt(2.0)) for z in deviations] + [count * erfc(largest / sqrt(2.0))]
    return min(chances) > CHANCE


def main() -> int:
    """Run everything, print a table, and tell whether it is what chance makes."""
    parser = argparse.ArgumentParser(description="Long runs of the paper's contacts against exact theory.")
    parser.add_argument("--longer", type=float, default=10.0, help="how many times longer than in the tests")
    parser.add_argument("--seeds", type=int, default=1, help="seeds for each contact")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    asked = parser.parse_args()
    found = []
    with ProcessPoolExecutor(asked.jobs) as pool:
        for name, figures in pool.map(scored, jobs(asked.longer, asked.seeds)):
            print(f"{name:30}", *(f"{key} {z:+.2f}" for key, z in figures.items()), sep="  ", flush=True)
            found.append(figures)
    likely = True
    print(f"\n{'figure':24}{'runs':>6}{'mean z':>9}{'mean z^2':>10}{'max |z|':>9}")
    for name, count, mean, square, largest in verdicts(found):
        well = is_likely(count, mean, square, largest)
        likely &= well
        print(f"{name:24}{count:6}{mean:9.2f}{square:10.2f}{largest:9.2f}  {'' if well else 'unlikely'}")
    return 0 if likely else 1


if __name__ == "__main__":
    sys.exit(main())
