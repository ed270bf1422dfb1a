"""Write the measured parts of docs/two-way.md: `.venv/bin/python tools/studies two_way`.

Needs some minutes: Figure 5 both ways, and pairs of runs that differ in their cells alone. With `--reference DIR`,
a folder of the sweep scenarios/studies/coupling_reference.toml, only the reference values are taken from there and
written, unless another program disagrees with them.
"""

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from math import floor, hypot, inf, log10
from pathlib import Path
from typing import Any, Final

import numpy as np
from parts import fill, table

import rubnoise
from rubnoise.analysis.motion import Sticks
from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.figures.tracks import Stretch
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.theory.coupling import coupling
from rubnoise.theory.motion import response

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
    found = Sticks.of(two, 0.0, inf)
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
    """Return when runs part that differ in their cells alone."""
    head = ("V (mm/s)", f"apart by {APART:g} um after (s), seeds {', '.join(map(str, SEEDS))}", "in runs of (s)")
    rows = []
    for speed, distance in CHAOS.items():
        found = [parted(speed, distance, seed) for seed in SEEDS]
        times = ", ".join("never" if time is None else f"{time:.3g}" for time, _ in found)
        rows.append((str(speed), times, f"{min(duration for _, duration in found):.3g}"))
    return table(head, rows)


def parted(speed: float, distance: str, seed: int) -> tuple[float | None, float]:
    """Return when runs of 50 and 100 cells a diameter are farther apart than APART, in s, and how long they last."""
    records = [_record(speed, distance, seed, cells) for cells in (50, 100)]
    rows = min(record["time"].size for record in records)
    first, second = (record["displacement"][:rows] for record in records)
    away = np.flatnonzero(np.abs(first - second) > APART)
    time = records[0]["time"]
    return (float(time[away[0]]) if away.size else None), float(time[rows - 1])


def _record(speed: float, distance: str, seed: int, cells: int) -> dict[str, np.ndarray]:
    changes = [f'sliding.speed="{speed:g} mm/s"', f'sliding.distance="{distance}"', f"slider.cells={cells}"]
    scenario = rubnoise.load(TWO_WAY, [*changes, 'output.tick="0.5 um"', "run.engine=batch"])
    motion = rubnoise.simulate(scenario, seed=seed)["slider"]
    return {name: motion[name] for name in ("time", "displacement")}


# The reference values: taken from a sweep, held against another program's, and as a table.
STUDY: Final = SCENARIOS / "studies" / "coupling_reference.toml"
FOLDER: Final = ROOT / "tests" / "reference"
KEPT: Final = FOLDER / "coupling.json"
ANOTHER: Final = FOLDER / "two_way.json"
"""What another program found, with an integrator of its own."""

SOURCE: Final = "rubnoise sweep scenarios/studies/coupling_reference.toml: of each figure value and standard error"

FIGURES: Final = {
    "stick_fraction": ("stuck", "stick_fraction"),
    "displacement_mean": ("", "mean_x"),
    "displacement_std": ("std x", "std_x"),
    "velocity_std": ("std x'", "std_v"),
    "sticks_per_s": ("sticks", "sticks_per_s"),
    "slips_longer_than_d_per_s": ("", ""),
}
"""Figures of the reference, what heads their columns on the page if they have one, and the other program's names."""

RATIO: Final = "over_one_way"
"""The standard deviation of the displacement over that of one-way coupling on the same junctions."""

_AGREE: Final = 4.0
"""Joint standard errors by which both programs may differ."""


def reference_of(folder: Path) -> list[dict[str, Any]]:
    """Return the two-way points of a sweep over both couplings, each figure with its standard error."""
    with rubnoise.open_sweep(folder) as sweep:
        told = {name: sweep.estimates(name) for name in FIGURES}
        ratios = sweep.ratios("displacement_std", "slider.coupling", "one-way")
        distance, speed = (sweep.points[f"sliding.{key}"][:] for key in ("distance", "speed"))
        return [
            {
                "speed": float(speed[number]),
                "junctions": values["interface.mean_junction_count"],
                "runs": ratios[number].runs,
                "seconds": float(f"{ratios[number].runs * distance[number] / speed[number]:.6g}"),
                **{name: _kept(each[number]) for name, each in told.items()},
                RATIO: _kept(ratios[number]),
            }
            for number, values in enumerate(sweep.values)
            if values["slider.coupling"] == "two-way"
        ]


def _kept(estimate: PooledEstimate) -> list[float]:
    return [float(f"{estimate.value:.10g}"), float(f"{estimate.standard_error:.4g}")]


def keep(points: Sequence[Mapping[str, Any]]) -> None:
    """Write the reference; raises ValueError with every figure in which the other program disagrees."""
    if wrong := list(disagreements(points)):
        raise ValueError("two programs disagree: " + "; ".join(wrong))
    KEPT.write_text(json.dumps({"_source": SOURCE, "points": points}, indent=1) + "\n", encoding="utf-8")


def kept() -> list[dict[str, Any]]:
    """Return the points of the reference: speed in um/s, junctions, and each figure with its standard error."""
    return list(json.loads(KEPT.read_text(encoding="utf-8"))["points"])


def disagreements(points: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield every figure in which the other program differs by more than its and our standard errors allow."""
    others = [other for name, other in json.loads(ANOTHER.read_text(encoding="utf-8")).items() if name[0] != "_"]
    for point in points:
        where = (point["speed"], point["junctions"])
        for other in (other for other in others if (other["V_um_s"], other["N_jm"]) == where):
            for name, (_, theirs) in FIGURES.items():
                if theirs:
                    value, error = point[name]
                    joint = hypot(error, other[f"{theirs}_se"])
                    if abs(value - other[theirs]) > _AGREE * joint:
                        yield f"{name} at {where}: {value:g} and {other[theirs]:g}, joint standard error {joint:.2g}"


def shown(points: Sequence[Mapping[str, Any]]) -> str:
    """Return the reference as a table, standard errors in the last digits; r and Pi are exact."""
    columns = {name: words for name, (words, _) in FIGURES.items() if words} | {RATIO: "change"}
    heads = ("V", "N_jm", "r", "Pi", *columns.values())
    models = [point.scenario.model() for point in rubnoise.expand(rubnoise.load_sweep(STUDY))]
    exact = {(model.sliding_speed, model.mean_junction_count): model for model in models if model.is_two_way}

    def cells(point: Mapping[str, Any]) -> tuple[str, ...]:
        model = exact[point["speed"], point["junctions"]]
        told = f"{response(model).one_way_validity:.3g}", f"{coupling(model).strength:.3g}"
        figures = (in_digits(*point[name]) for name in columns)
        return (f"{1e-3 * point['speed']:g}", f"{point['junctions']:g}", *told, *figures)

    return table(heads, map(cells, points))


def in_digits(value: float, error: float) -> str:
    """Return a value with its standard error in its last two digits, as 0.7413(15)."""
    if error <= 0.0:
        return f"{value:g}"
    places = max(1 - floor(log10(error)), 0)
    return f"{value:.{places}f}({round(error * 10.0**places)})"


def main() -> int:
    """Take a new reference, or run everything, and write the measured parts of the page; 1 if programs disagree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--reference", type=Path, help="a folder that holds the sweep of reference values")
    folder = parser.parse_args().reference
    if folder is not None:
        try:
            keep(reference_of(folder))
        except ValueError as problem:
            print(f"two_way: {problem}", file=sys.stderr)
            return 1
    fill(PAGE, {"reference": f"\n{shown(kept())}\n"})
    if folder is None:
        with tempfile.TemporaryDirectory() as place:
            paths = {path: Path(place) / f"{path.stem}.h5" for path in (FIG5, TWO_WAY)}
            for scenario, result in paths.items():
                rubnoise.run(rubnoise.load(scenario), result).close()
            with open_run(paths[FIG5]) as one, open_run(paths[TWO_WAY]) as two:
                fill(PAGE, {"figures": figures(one, two), "chaos": chaos()})
    return 0
