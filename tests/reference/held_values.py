"""What the program gave before its rooms moved: exact values of forty contacts, twelve results, three sweeps.

`python -m tests.reference.held_values` writes them anew into tests/reference/held. They are there to judge, so write
them only where a promise has changed, and say so in CHANGELOG.md.
"""

import json
import math
import shutil
import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import h5py
import numpy as np

import rubnoise

HELD = Path(__file__).parent / "held"
LAGS = (0.0, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0, 1.1, 1.5, 2.0, 3.0, 5.0)
"""Lags over the mean life."""
WAVENUMBERS = (0.0, 0.1, 0.3, 1.0, 2.0, 3.0, 4.7, 6.3, 8.0, 11.0, 16.0, 23.0, 31.0)
"""Wavenumbers times the mean life."""
PROBABILITIES = (0.001, 0.02, 0.2, 0.5, 0.8, 0.98, 0.999)
RUNS: dict[str, tuple[str, tuple[str, ...]]] = {
    "one_way": ("contact.toml", ("sliding.distance='600 um'", "output.tick='0.5 um'")),
    "one_way_gzip": (
        "contact.toml",
        ("sliding.distance='600 um'", "output.tick='0.5 um'", "output.compression='gzip'"),
    ),
    "area_alone": ("paper/fig4", ("sliding.distance='600 um'", "output.tick='0.5 um'")),
    "regular": ("contact.toml", ("sliding.distance='400 um'", "output.tick='0.5 um'", "birth.law='regular'")),
    "off_centre": ("contact.toml", ("sliding.distance='400 um'", "output.tick='0.5 um'", "pulse.offset='uniform'")),
    "strengths": (
        "contact.toml",
        (
            "sliding={distance='400 um', start='empty'}",
            "output.tick='0.5 um'",
            "strength={law='lognormal', mean='250 MPa', spread='40 %'}",
        ),
    ),
    "two_way": ("contact.toml", ("sliding.distance='400 um'", "output.tick='1 um'", "slider.coupling='two-way'")),
    "two_way_gzip": (
        "contact.toml",
        ("sliding.distance='300 um'", "output={tick='1 um', compression='gzip'}", "slider.coupling='two-way'"),
    ),
    "first_order_load": ("load/fig5_load", ("sliding.distance='600 um'", "output.tick='0.5 um'")),
    "first_order_load_gzip": (
        "load/fig5_load",
        ("sliding.distance='300 um'", "output={tick='0.5 um', compression='gzip'}"),
    ),
    "free": ("load/bouncing", ("sliding.distance='400 um'", "output.tick='0.5 um'")),
    "base": ("ancestors/rice_moslehy", ("sliding.distance='600 um'",)),
}
"""Results that are kept as files: seven kinds of run, some of them compressed."""
GROUPS = ("junctions", "touches", "trace", "slider", "load")
SWEEPS: dict[str, tuple[str, dict[str, list[Any]], int]] = {
    "counts": ("contact.toml", {"interface.mean_junction_count": [10, 20, 50]}, 2),
    "speeds and sizes": (
        "contact.toml",
        {"sliding.speed": ["1 mm/s", "20 mm/s"], "interface.mean_real_contact_area": ["100 um^2", "200 um^2"]},
        1,
    ),
    "births": ("contact.toml", {"birth.law": ["poisson", "regular"]}, 3),
}
"""Sweeps of 400 um at ticks of 1 um: scenario, grid, replicates."""

Values = dict[str, list[float]]


@cache
def contacts() -> dict[str, Mapping[str, Any]]:
    """Return the contacts whose exact values are held, by their names."""
    return tomllib.loads((HELD / "scenarios.toml").read_text(encoding="utf-8"))


def scenario_of(source: str, changes: Sequence[str] = ()) -> rubnoise.Scenario:
    """Return a scenario beside the held values, or one that comes with rubnoise, with keys changed."""
    return rubnoise.load(HELD / source if source.endswith(".toml") else source, list(changes))


def contact(name: str) -> rubnoise.Scenario:
    """Return one of the contacts."""
    return scenario_of(contacts()[name]["from"], contacts()[name].get("set", ()))


def exact_values(scenario: rubnoise.Scenario) -> Values:
    """Return all that theory says of a contact, each quantity as a list of numbers; nan where it says nothing."""
    exact = rubnoise.exact(scenario)
    life = 2.0 * exact.mean_diameter
    values = {
        "area": list(exact.area.values),
        "count": [exact.count_mean, exact.count_variance],
        "sizes": [exact.mean_diameter, exact.length_biased_mean_diameter],
        "rows": [exact.expected_births, exact.expected_junction_rows],
        "autocovariance": _list(exact.autocovariance(np.multiply(LAGS, life))),
        "spectral_density": _list(exact.spectral_density(np.divide(WAVENUMBERS, life))),
        "area_from_empty": _list(exact.area_from_empty(np.multiply(LAGS, life))),
        "count_from_empty": _list(exact.count_from_empty(np.multiply(LAGS, life))),
        "expected_means": [exact.expected_mean_area(), exact.expected_mean_count()],
    }
    for name in ("slider", "load", "free"):
        if (part := getattr(exact, name)) is not None:
            values[name] = _numbers(part)
    if exact.force is not None:
        values["force"] = list(exact.force.values)
    for name, later in _later(exact).items():
        try:
            values[name] = later()
        except rubnoise.Refused:
            continue
    return values


def _later(exact: rubnoise.Exact) -> dict[str, Callable[[], list[float]]]:
    """Return quantities that only some contacts have."""

    def areas() -> list[float]:
        law = exact.distribution()
        return [law.atom_at_zero, *_list(law.quantile(PROBABILITIES))]

    def spectrum() -> list[float]:
        found = exact.estimated_spectrum()
        rows = [1, 2, 3, 5, 10, 20, 50]
        return [*_list(found.density[rows]), *_list(found.standard_error[rows])]

    return {
        "distribution": areas,
        "estimated_spectrum": spectrum,
        "coupling": lambda: [exact.coupling().strength, exact.coupling().stick_number],
    }


def _numbers(part: Any) -> list[float]:
    names = getattr(type(part), "__dataclass_fields__", {})
    return [float(each) for name in names for each in [getattr(part, name)] if isinstance(each, float)]


def _list(values: Any) -> list[float]:
    return [float(each) for each in np.asarray(values).ravel()]


def run_into(path: Path, name: str) -> Path:
    """Run one of the held runs again."""
    source, changes = RUNS[name]
    rubnoise.run(scenario_of(source, changes), path).close()
    return path


def columns_of(path: Path) -> dict[str, Any]:
    """Return the columns of a result by their paths, read by h5py alone."""
    with h5py.File(path) as file:
        return {
            f"{group}/{name}": np.asarray(dataset)
            for group in GROUPS
            if group in file
            for name, dataset in file[group].items()
        }


def summary_of(path: Path) -> dict[str, float]:
    """Return the figures of a result with their exact values and errors, read by h5py alone."""
    with h5py.File(path) as file:
        return {name: float(value) for name, value in file["summary"].attrs.items() if isinstance(value, float)}


def sweep_values(name: str, folder: Path) -> dict[str, Any]:
    """Return the seeds and figures of a sweep's runs by their ids, run again into a folder."""
    source, grid, replicates = SWEEPS[name]
    scenario = scenario_of(source, ("sliding.distance='400 um'", "output.tick='1 um'"))
    rubnoise.run_sweep(scenario, folder, grid=grid, replicates=replicates)
    return {path.stem: [_seed(path), summary_of(path)] for path in sorted((folder / "runs").glob("*.h5"))}


def _seed(path: Path) -> int:
    with h5py.File(path) as file:
        return int(file["provenance"].attrs["seed"])


def main() -> None:
    """Write everything that is held."""
    theory = {name: exact_values(contact(name)) for name in contacts()}
    lines = [
        f'"{name}": {{\n' + ",\n".join(f' "{key}": {json.dumps(_safe(row))}' for key, row in values.items()) + "}"
        for name, values in theory.items()
    ]
    (HELD / "theory.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    with TemporaryDirectory() as folder:
        sweeps = {name: sweep_values(name, Path(folder) / name) for name in SWEEPS}
        (HELD / "sweeps.json").write_text(json.dumps(sweeps, indent=1) + "\n", encoding="utf-8")
        for name in RUNS:
            shutil.copy(run_into(Path(folder) / f"{name}.h5", name), HELD)


def _safe(row: list[float]) -> list[float | None]:
    return [None if math.isnan(each) else each for each in row]


if __name__ == "__main__":
    main()
