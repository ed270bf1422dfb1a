"""Fit thousands of traces whose junctions are known: coverage, median errors, and which wrong models are noticed.

    .venv/bin/python tools/infer_study.py run FOLDER [--traces 300] [--jobs 2] [--only TEXT]
    .venv/bin/python tools/infer_study.py table FOLDER

`run` may be stopped at any time; the same command goes on where it was. Each finished fit is a line in FOLDER.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from rubnoise.contact.births import BirthLaw, PoissonBirths, RegularBirths
from rubnoise.contact.laws import LAWS
from rubnoise.inference.inference import infer_signal
from rubnoise.inference.signal import Signal
from rubnoise.model import Model, Slider
from rubnoise.record.sink import Columns
from rubnoise.simulation.run import simulate

PER_LIFE = 64
DIAMETER = 5.5
COUNTS = (5, 20, 100)
POPULATIONS = {"normal": 0.2, "lognormal": 0.5, "exponential": 1.0, "gamma": 0.4, "fixed": 0.0}
WRONG = ("stick-slip", "lorentzian", "exponential pulses", "sine", "white", "regular")
QUANTITIES = ("junction_count", "diameter", "relative_spread", "shear_strength")


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One kind of trace: its law and number, or the wrong model, and how it is fitted."""

    name: str
    law: str = ""
    count: int = 20
    lives: int = 450
    noise: float = 0.05
    fitted: str = ""
    zero: str = "known"


def cells() -> list[Cell]:
    """Return every cell of the study."""
    found = [Cell(name=f"{law} {n}", law=law, count=n, fitted=law) for law in POPULATIONS for n in COUNTS]
    found += [
        Cell(name=f"clean {law}", law=law, noise=0.0, fitted=law) for law in ("normal", "lognormal", "exponential")
    ]
    found += [Cell(name=f"long {law}", law=law, lives=5000, fitted=law) for law in ("normal",)]
    found += [Cell(name=f"auto {law}", law=law, fitted="auto") for law in POPULATIONS]
    found += [Cell(name=f"unknown {law}", law=law, fitted="auto", zero="unknown") for law in POPULATIONS]
    found += [Cell(name=f"wrong {kind}", law=kind, fitted="auto", zero=zero) for kind in WRONG for zero in ("unknown",)]
    return found


class Column:
    """Keeps one column of a run."""

    def __init__(self, group: str, name: str) -> None:
        """Name the column."""
        self.group, self.name, self.parts = group, name, [np.empty(0)]

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Keep the rows of the column (see Sink)."""
        del first_row
        if group == self.group:
            self.parts.append(np.array(columns[self.name]))


def model(law: str, count: float, lives: int, births: type[Any] = PoissonBirths) -> Model:
    """Return a contact of mean diameter 5.5 um, 64 ticks a mean life."""
    sizes = LAWS[law].make(DIAMETER, POPULATIONS[law] * DIAMETER, {})
    spacing: BirthLaw = births(mean_spacing=2.0 * sizes.mean / count)
    tick = 2.0 * sizes.mean / PER_LIFE
    return Model(
        mean_real_contact_area=count * DIAMETER**2 / 3.0,
        mean_junction_count=float(count),
        calibration="exact",
        calibrated_diameter=DIAMETER,
        sizes=sizes,
        births=spacing,
        strengths=LAWS["fixed"].make(250.0, 0.0, {}),
        sliding_speed=1000.0,
        distance=tick * (lives * PER_LIFE - 1),
        start="stationary",
        slider=None,
        tick=tick,
        tick_count=lives * PER_LIFE - 1,
    )


def right(cell: Cell, seed: int) -> Signal:
    """Return a trace of the model, with white noise."""
    contact = model(cell.law, cell.count, cell.lives)
    kept = Column("trace", "friction_force")
    simulate(contact, seed, kept, engine="batch")
    values = np.concatenate(kept.parts)
    values += cell.noise * values.std() * np.random.default_rng([seed, 1]).standard_normal(values.size)
    return Signal(values=values, tick=contact.tick, unit="uN", scale=1.0)


def wrong(kind: str, cell: Cell, seed: int) -> Signal:
    """Return a trace of something else, with noise of 5 % of its spread."""
    from dataclasses import replace

    from scipy.signal import lfilter

    rng = np.random.default_rng([seed, 2])
    n, life = cell.lives * PER_LIFE, float(PER_LIFE)
    contact = model("normal", 20, cell.lives)
    if kind == "stick-slip":
        slider = Slider(mass=0.005, stiffness=300.0, damping=0.05, coupling="two-way")
        contact = replace(contact, slider=slider)
        kept = Column("slider", "displacement")
        simulate(contact, seed, kept, engine="batch")
        values = 300.0 * np.concatenate(kept.parts)[:n]
    elif kind == "regular":
        kept = Column("trace", "friction_force")
        simulate(model("normal", 20, cell.lives, RegularBirths), seed, kept, engine="batch")
        values = np.concatenate(kept.parts)
    elif kind == "lorentzian":
        a = np.exp(-4.0 / life)
        values = 50.0 + 10.0 * lfilter([np.sqrt(1.0 - a * a)], [1.0, -a], rng.standard_normal(n + 1000))[1000:]
    elif kind == "exponential pulses":
        values = lfilter([1.0], [1.0, -np.exp(-4.0 / life)], rng.poisson(20.0 / life, n + 1000))[1000:]
    elif kind == "sine":
        values = 50.0 + np.sin(2.0 * np.pi * (np.arange(n) / life + rng.random()))
    else:
        values = 50.0 + rng.standard_normal(n)
    values = values + 0.05 * values.std() * rng.standard_normal(values.size)
    return Signal(values=values, tick=contact.tick, unit="uN", scale=1.0)


def fit(job: tuple[Cell, int]) -> dict[str, Any]:
    """Make one trace and fit it; return what was found beside what is true."""
    cell, seed = job
    signal = right(cell, seed) if cell.law in POPULATIONS else wrong(cell.law, cell, seed)
    begun = time.process_time()
    found = infer_signal(signal, zero="known" if cell.zero == "known" else "unknown", law=cell.fitted)
    answer: dict[str, Any] = {"cell": cell.name, "seed": seed, "cpu": round(time.process_time() - begun, 4)}
    answer["refused"] = found.refused_because
    answer["flags"] = [test.name for test in found.tests if test.flagged]
    answer["p"] = {test.name: float(f"{test.p:.3g}") for test in found.tests}
    answer["law"] = found.law
    answer["estimates"] = {
        name: [each.value, each.standard_error, *each.interval] for name, each in found.estimates.items()
    }
    return answer


def truth(cell: Cell) -> dict[str, float]:
    """Return the true numbers of a cell."""
    sizes = LAWS[cell.law].make(DIAMETER, POPULATIONS[cell.law] * DIAMETER, {})
    spread = np.sqrt(max(sizes.moment(2) / sizes.moment(1) ** 2 - 1.0, 0.0))
    return {
        "junction_count": float(cell.count),
        "diameter": sizes.moment(1),
        "relative_spread": float(spread),
        "shear_strength": 250.0,
    }


def read(folder: Path) -> dict[str, list[dict[str, Any]]]:
    """Return the finished fits of each cell; a line cut short by a kill is left out."""
    found: dict[str, list[dict[str, Any]]] = {}
    for path in sorted(folder.glob("*.jsonl")):
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                row = json.loads(line)
            except json.JSONDecodeError:
                continue
            found.setdefault(row["cell"], []).append(row)
    return found


def run(folder: Path, traces: int, jobs: int, only: str) -> None:
    """Make what is missing, cells in turn, so that a study stopped early has something of each."""
    folder.mkdir(parents=True, exist_ok=True)
    done = {(row["cell"], row["seed"]) for rows in read(folder).values() for row in rows}
    chosen = [cell for cell in cells() if any(part in cell.name for part in only.split(","))]
    wanted = [(cell, seed) for seed in range(1, traces + 1) for cell in chosen if (cell.name, seed) not in done]
    with ProcessPoolExecutor(jobs) as pool, (folder / "fits.jsonl").open("a", encoding="utf-8") as out:
        for number, row in enumerate(pool.map(fit, wanted, chunksize=4), 1):
            out.write(json.dumps(row) + "\n")
            out.flush()
            if sys.stderr.isatty():
                print(f"\r{number} of {len(wanted)}", end="", file=sys.stderr)


def table(folder: Path) -> None:
    """Print coverage and median errors of each cell, and how many traces were flagged or refused."""
    found, pooled = read(folder), {name: [0, 0] for name in QUANTITIES}
    heads = "".join(f"{name.split('_')[-1]:>22}" for name in QUANTITIES)
    print(f"{'cell':26}{'fits':>6}{'cpu ms':>7}{'flag %':>7}{heads}")
    for cell in cells():
        rows = found.get(cell.name, [])
        if not rows:
            continue
        stopped = 100.0 * np.mean([bool(row["flags"] or row["refused"]) for row in rows])
        text = f"{cell.name:26}{len(rows):6}{1e3 * np.median([row['cpu'] for row in rows]):7.0f}{stopped:7.1f}"
        for name in QUANTITIES if cell.law in POPULATIONS else ():
            true = truth(cell)[name]
            told = [row["estimates"][name] for row in rows if name in row["estimates"]]
            if not told or not true:
                text += f"{'':>22}"
                continue
            values = np.array(told)
            inside = (values[:, 2] <= true) & (true <= values[:, 3])
            error = np.abs(values[:, 0] / true - 1.0)
            text += f"{100 * inside.mean():9.1f} %{100 * np.median(error):8.2f} %{'':1}"
            if cell.fitted == cell.law and cell.lives == 450 and cell.noise:
                pooled[name][0] += int(inside.sum())
                pooled[name][1] += inside.size
        print(text)
    print("pooled over laws:", ", ".join(f"{n} {100 * a / max(b, 1):.1f} % of {b}" for n, (a, b) in pooled.items()))
    flags: dict[str, int] = {}
    for row in (row for cell in cells() if cell.law in POPULATIONS for row in found.get(cell.name, [])):
        for flag in row["flags"]:
            flags[flag] = flags.get(flag, 0) + 1
    print("flags of right traces:", flags)


def main() -> None:
    """Read the command and do it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("run", "table"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--traces", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="texts, one of which is part of a cell's name, between commas")
    asked = parser.parse_args()
    if asked.what == "run":
        run(asked.folder, asked.traces, asked.jobs, asked.only)
    else:
        table(asked.folder)


if __name__ == "__main__":
    main()
