"""Write the measured parts of docs/two-way.md: `.venv/bin/python tools/studies two_way`.

Needs some minutes: Figure 5 both ways, and pairs of runs that differ in their tolerance alone. With `--reference DIR`,
a folder of the sweep scenarios/studies/coupling_reference.toml, only the reference values are taken from there and
written, unless another program disagrees with them.
"""

import argparse
import sys
import tempfile
from math import inf
from pathlib import Path
from typing import Final

import numpy as np
from parts import fill, table

import rubnoise
from rubnoise.analysis.landmarks import StickSlip
from rubnoise.figures.stretch import Stretch
from rubnoise.storage.reader import RunFile, open_run
from studies import two_way_reference

ROOT: Final = Path(__file__).resolve().parents[2]
PAGE: Final = ROOT / "docs" / "two-way.md"
SCENARIOS: Final = ROOT / "scenarios"
FIG5, TWO_WAY = SCENARIOS / "paper" / "fig5.toml", SCENARIOS / "paper" / "fig5_two_way.toml"

CHAOS: Final = {1: "10 mm", 3: "20 mm", 10: "30 mm", 30: "150 mm", 50: "500 mm", 100: "1000 mm"}
"""How far the pairs of runs slide, by sliding speed in mm/s."""

SEEDS: Final = (11, 12, 13)
APART: Final = 0.1
"""Displacements in um between two runs from which they have parted."""


def figures(one: RunFile, two: RunFile) -> str:
    """Return Figure 5 both ways: what was measured."""
    found = StickSlip.of(two, 0.0, inf)
    longer = int((found.slip_lengths > Stretch.of(two).model.calibrated_diameter).sum())
    ends = (run.column("slider", "time", run.rows("slider") - 1)[0] for run in (one, two))
    rows = [
        (f"`{name}` ({unit})", *(f"{float(run.summary[name]):.4g}" for run in (one, two)))
        for name, unit in (("displacement_mean", "um"), ("displacement_std", "um"), ("velocity_std", "um/s"))
    ]
    rows += [
        ("sticks, slips, reversals", "none", _counts(two)),
        ("slips longer than a mean diameter", "", f"{longer} of {found.slip_lengths.size}"),
        ("duration (s)", *(f"{end:.4g}" for end in ends)),
    ]
    return table(("of the run with seed 1", "one-way", "two-way"), rows)


def _counts(run: RunFile) -> str:
    kinds = np.bincount(run.column("landmarks", "kind"), minlength=4)
    return ", ".join(str(count) for count in kinds[:3].tolist())


def chaos() -> str:
    """Return when runs part that differ in their tolerance alone."""
    head = ("V (mm/s)", f"apart by {APART:g} um after (s), seeds {', '.join(map(str, SEEDS))}", "in runs of (s)")
    rows = []
    for speed, distance in CHAOS.items():
        found = [parted(speed, distance, seed) for seed in SEEDS]
        times = ", ".join("never" if time is None else f"{time:.3g}" for time, _ in found)
        rows.append((str(speed), times, f"{min(duration for _, duration in found):.3g}"))
    return table(head, rows)


def parted(speed: float, distance: str, seed: int) -> tuple[float | None, float]:
    """Return when two runs of tolerances 1e-9 and 1e-10 are farther apart than APART, in s, and how long they last."""
    records = [_record(speed, distance, seed, tolerance) for tolerance in ("1e-9", "1e-10")]
    rows = min(record["time"].size for record in records)
    first, second = (record["displacement"][:rows] for record in records)
    away = np.flatnonzero(np.abs(first - second) > APART)
    time = records[0]["time"]
    return (float(time[away[0]]) if away.size else None), float(time[rows - 1])


def _record(speed: float, distance: str, seed: int, tolerance: str) -> dict[str, np.ndarray]:
    changes = [f'sliding.speed="{speed:g} mm/s"', f'sliding.distance="{distance}"', f"slider.tolerance={tolerance}"]
    scenario = rubnoise.load(TWO_WAY, [*changes, 'output.tick="0.5 um"', "run.engine=batch"])
    motion = rubnoise.simulate(scenario, seed=seed)["slider"]
    return {name: motion[name] for name in ("time", "displacement")}


def main() -> int:
    """Take a new reference, or run everything, and write the measured parts of the page; 1 if programs disagree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reference", type=Path, help="a folder that holds the sweep of reference values")
    folder = parser.parse_args().reference
    if folder is not None:
        try:
            two_way_reference.keep(two_way_reference.reference_of(folder))
        except ValueError as problem:
            print(f"two_way: {problem}", file=sys.stderr)
            return 1
    fill(PAGE, {"reference": f"\n{two_way_reference.shown(two_way_reference.kept())}\n"})
    if folder is None:
        with tempfile.TemporaryDirectory() as place:
            paths = {path: Path(place) / f"{path.stem}.h5" for path in (FIG5, TWO_WAY)}
            for scenario, result in paths.items():
                rubnoise.run(rubnoise.load(scenario), result).close()
            with open_run(paths[FIG5]) as one, open_run(paths[TWO_WAY]) as two:
                fill(PAGE, {"figures": figures(one, two), "chaos": chaos()})
    return 0
