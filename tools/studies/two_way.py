"""Write the measured parts and the pictures of docs/two-way.md: `.venv/bin/python tools/studies two_way`.

Needs `tools/dev.py sync`, and some minutes: Figure 5 both ways, the sweep scenarios/studies/rise.toml, which
`--sweep DIR` takes from a folder where it was made before, and pairs of runs that differ in their tolerance alone.
With `--reference DIR`, a folder of the sweep scenarios/studies/coupling_reference.toml, only the reference values are
taken from there and written, unless another program disagrees with them.
"""

import argparse
import sys
import tempfile
from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import Final

import numpy as np
from generate_gallery import small
from parts import fill, table

import rubnoise
from rubnoise.analysis.landmarks import StickSlip
from rubnoise.figures.catalogue import picture
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.study import study_of_sweep
from rubnoise.figures.study_picture import study_picture
from rubnoise.storage.reader import RunFile, open_run
from studies import two_way_reference

ROOT: Final = Path(__file__).resolve().parents[2]
PAGE: Final = ROOT / "docs" / "two-way.md"
PICTURES: Final = ROOT / "docs" / "pictures" / "two-way"
SCENARIOS: Final = ROOT / "scenarios"
FIG5, TWO_WAY = SCENARIOS / "paper" / "fig5.toml", SCENARIOS / "paper" / "fig5_two_way.toml"
STUDY: Final = SCENARIOS / "studies" / "rise.toml"

CHAOS: Final = {1: "10 mm", 3: "20 mm", 10: "30 mm", 30: "150 mm", 50: "500 mm", 100: "1000 mm"}
"""How far the pairs of runs slide, by sliding speed in mm/s."""

SEEDS: Final = (11, 12, 13)
APART: Final = 0.1
"""Displacements in um between two runs from which they have parted."""

PARTING: Final = (1500.0, 5000.0)
"""Sliding distances in um between which the runs of the picture part."""

Report = Callable[[str], None]


def figures(one: RunFile, two: RunFile) -> str:
    """Return Figure 5 both ways: what was measured, and its pictures."""
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
    shown = (
        f"\n![{(parts := says.partition('. '))[0]}](pictures/two-way/{name}.png)\n\n{parts[2]}\n"
        for name, says in CAPTIONS.items()
    )
    return table(("of the run with seed 1", "one-way", "two-way"), rows) + "".join(shown)


CAPTIONS: Final = {
    "motion": (
        "Figure 5 both ways, on the same junctions. The one-way slider (pale) swings at its natural frequency. The "
        "two-way slider (dark) sticks while the drive stretches its spring (shaded), and slips when the contact can "
        "bear no more."
    ),
    "phase": (
        "The same motion in the phase plane. A stick is a horizontal line at the speed of the drive. The two-way "
        "slider is faster only when it runs back, the one-way slider in every swing."
    ),
    "landmarks": (
        "How far it slips and how long it sticks. Most values are short or long. Many slips "
        "end within a junction's diameter; long ones pass many junctions."
    ),
    "spectrum": (
        "The spectrum of the velocity. One-way, it has a line at the natural frequency, and follows the exact curve. "
        "Two-way, it is nearly flat from the frequency of long slips up to the natural frequency."
    ),
}


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
    return f"{table(head, rows)}\n![Two runs whose tolerances differ, where they part](pictures/two-way/chaos.png)\n"


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
    """Run everything, draw the pictures, and write the generated parts of the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sweep", type=Path, help="a folder that holds the sweep already")
    parser.add_argument("--reference", type=Path, help="a folder that holds the sweep of reference values")
    wishes = parser.parse_args()
    if wishes.reference is not None:
        return take_reference(wishes.reference)
    PICTURES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        parts = made(Path(folder), wishes.sweep, lambda text: print(text, file=sys.stderr))
    fill(PAGE, parts)
    return 0


def take_reference(folder: Path) -> int:
    """Take reference values from a sweep and write their table; if another program disagrees, say so and return 1."""
    try:
        two_way_reference.keep(two_way_reference.reference_of(folder))
    except ValueError as problem:
        print(f"two_way: {problem}", file=sys.stderr)
        return 1
    fill(PAGE, {"reference": reference()})
    return 0


def reference() -> str:
    """Return the table of the reference values."""
    return f"\n{two_way_reference.shown(two_way_reference.kept())}\n"


def made(folder: Path, sweep: Path | None, tell: Report) -> dict[str, str]:
    """Make the pictures, and return every part by its name."""
    tell("Figure 5")
    runs = {"one-way": (FIG5, []), "two-way": (TWO_WAY, []), "finer": (TWO_WAY, ["slider.tolerance=1e-10"])}
    for name, (path, changes) in runs.items():
        rubnoise.run(rubnoise.load(path, changes), folder / f"{name}.h5").close()
    with (
        open_run(folder / "one-way.h5") as one,
        open_run(folder / "two-way.h5") as two,
        open_run(folder / "finer.h5") as finer,
    ):
        draw(one, two, finer)
        parts = {"figures": figures(one, two)}
    tell("chaos")
    parts["chaos"] = chaos()
    tell("the sweep")
    with rubnoise.sweep(STUDY, folder / "rise") if sweep is None else rubnoise.open_sweep(sweep) as found:
        (PICTURES / "speeds.png").write_bytes(small(study_picture(study_of_sweep(found, "displacement_std"), "png")))
    parts["reference"] = reference()
    return parts


def draw(one: RunFile, two: RunFile, finer: RunFile) -> None:
    """Draw the pictures of Figure 5."""
    both, pushed = Stretch.of(one), Stretch.of(two)
    for name, png in (
        ("motion", picture("slider", both, "png", beside=pushed)),
        ("phase", picture("phase", both, "png", beside=pushed)),
        ("landmarks", picture("landmarks", pushed, "png")),
        ("spectrum", picture("psd", both, "png", heard="velocity", beside=pushed)),
        ("chaos", picture("slider", Stretch.of(two, *PARTING), "png", beside=Stretch.of(finer))),
    ):
        (PICTURES / f"{name}.png").write_bytes(small(png))
