"""How far the area of equal lenses spreads, by theory and in runs.

From regular births (Rabinowicz) over gamma gaps to births at random (the paper) and in clusters.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from parts import table

import rubnoise
from studies.study import Study

RUNS: Final = 40
DISTANCE: Final = 2000.0
ALLOWED: Final = 4.0

BIRTHS: Final[dict[str, dict[str, Any]]] = {
    "regular, triangles (Rabinowicz)": {"birth": {"law": "regular"}, "pulse": {"shape": "triangle"}},
    "regular": {"birth": {"law": "regular"}},
    "jittered, 30 %": {"birth": {"law": "jittered", "jitter": "30 %"}},
    "gamma, shape 16": {"birth": {"law": "gamma", "shape": 16.0}},
    "gamma, shape 4": {"birth": {"law": "gamma", "shape": 4.0}},
    "at random (the paper)": {},
    "gamma, shape 0.5": {"birth": {"law": "gamma", "shape": 0.5}},
    "clustered, 3 in 2 um": {"birth": {"law": "clustered", "cluster_size": 3.0, "cluster_width": "2 um"}},
}
"""From births that keep their distance to births that come together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Standard deviation over mean of the area: exact, and found in runs with its standard error."""

    births: str
    exact: float
    found: float
    error: float


def scenario(tables: dict[str, Any]) -> rubnoise.Scenario:
    """Return 20 equal junctions on 200 um^2 with such births."""
    values: dict[str, Any] = {
        "format": 1,
        "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20, "calibration": "exact"},
        "sliding": {"distance": DISTANCE},
        "run": {"engine": "batch"},
    }
    return rubnoise.build(values | tables)


def measured(births: str, tables: dict[str, Any]) -> Row:
    """Return what runs of some births come to: the second moment about the exact mean, which has no bias."""
    asked = scenario(tables)
    exact = rubnoise.exact(asked).area
    squares = [
        float(np.mean(np.square(rubnoise.simulate(asked, seed=seed).trace["real_contact_area"][:] - exact.mean)))
        for seed in range(1, RUNS + 1)
    ]
    variance, error = float(np.mean(squares)), float(np.std(squares, ddof=1)) / RUNS**0.5
    found = variance**0.5
    slope = 0.5 / found if found > 1e-6 * exact.mean else 0.0
    return Row(births=births, exact=exact.std / exact.mean, found=found / exact.mean, error=error * slope / exact.mean)


def _shown(value: float) -> str:
    return f"{value:.4f}" if value > 1e-6 else "0"


def _told(row: Row) -> str:
    return f"{row.found:.4f} ± {row.error:.4f}" if row.error else _shown(row.found)


def made() -> Iterator[Row]:
    """Yield a row for each law of births."""
    return (measured(births, tables) for births, tables in BIRTHS.items())


def faults(rows: Sequence[Row]) -> list[str]:
    """Return the rows that theory does not accept."""
    return [str(row) for row in rows if abs(row.found - row.exact) > ALLOWED * row.error + 1e-6]


def tables(rows: Sequence[Row]) -> dict[str, str]:
    """Return the table of the page."""
    cells = ((row.births, _shown(row.exact), _told(row)) for row in rows)
    return {"births": table(("births", "std over mean, exact", "in runs"), cells)}


STUDY: Final = Study(
    about=__doc__,
    page="family.md",
    data="family.json",
    row=Row,
    facts={"runs": RUNS, "distance": DISTANCE},
    make=made,
    faults=faults,
    tables=tables,
)
