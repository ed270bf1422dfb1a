"""Write the table of births in docs/family.md: `.venv/bin/python tools/studies family`, or with --table from its data.

Runs from regular births (Rabinowicz) over gamma gaps to births at random (the paper) and in clusters: how far the area
of equal lenses spreads, by theory and in runs of each. The data are docs/family.json; a run that theory does not accept
ends the study.
"""

import argparse
import json
import re
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

import rubnoise

DOCS: Final = Path(__file__).resolve().parents[2] / "docs"
PAGE, DATA = DOCS / "family.md", DOCS / "family.json"
TABLE: Final = re.compile(r"(?<=<!-- study: births -->\n).*?(?=<!-- end -->)", re.DOTALL)
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


def table(rows: list[Row]) -> str:
    """Return the rows as a table of Markdown."""
    head = "| births | std over mean, exact | in runs |\n|---|---|---|\n"
    return head + "".join(f"| {row.births} | {_shown(row.exact)} | {_told(row)} |\n" for row in rows)


def _shown(value: float) -> str:
    return f"{value:.4f}" if value > 1e-6 else "0"


def _told(row: Row) -> str:
    return f"{row.found:.4f} ± {row.error:.4f}" if row.error else _shown(row.found)


def main() -> int:
    """Make the study and write its data and table, or only the table from the data with --table."""
    parser = argparse.ArgumentParser(prog="studies family", description=__doc__)
    parser.add_argument("--table", action="store_true", help="write the table from the data")
    if not parser.parse_args().table:
        rows = [measured(births, tables) for births, tables in BIRTHS.items()]
        if wrong := [row for row in rows if abs(row.found - row.exact) > ALLOWED * row.error + 1e-6]:
            print(*wrong, sep="\n", file=sys.stderr)
            return 1
        facts = {"runs": RUNS, "distance": DISTANCE, "rows": [asdict(row) for row in rows]}
        DATA.write_text(json.dumps(facts, indent=1) + "\n", "utf-8")
    kept = [Row(**row) for row in json.loads(DATA.read_text("utf-8"))["rows"]]
    PAGE.write_text(TABLE.sub(lambda _: table(kept), PAGE.read_text("utf-8")), "utf-8")
    return 0
