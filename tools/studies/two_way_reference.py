"""The reference values of two-way coupling: taken from a sweep, held against another program's, and as a table."""

import json
from collections.abc import Iterator, Mapping, Sequence
from math import floor, hypot, log10
from pathlib import Path
from typing import Any, Final

from parts import table

import rubnoise
from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.theory.coupling import coupling
from rubnoise.theory.motion import response

ROOT: Final = Path(__file__).resolve().parents[2]
STUDY: Final = ROOT / "scenarios" / "studies" / "coupling_reference.toml"
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
