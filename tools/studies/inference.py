"""Fit thousands of traces whose junctions are known: coverage, median errors, and which wrong models are noticed.

    .venv/bin/python tools/studies inference run FOLDER [--traces 300] [--jobs 2] [--only TEXT]
    .venv/bin/python tools/studies inference docs FOLDER

`run` may be stopped at any time; the same command resumes it. Each finished fit is a line in FOLDER. `docs`
keeps what every cell showed in docs/coverage.json, and writes the tables of docs/inference.md. Texts for --only: a law
such as normal, or a kind with a colon: right:, drift:, auto:, unknown:, wrong:, outside:. Traces of `outside:` are
those of right_traces.py, read as a user would.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tomllib
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal
from zlib import crc32

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # PYTHONSAFEPATH and -P leave it out

import numpy as np
from parts import fill
from parts import table as markdown

from rubnoise.api.inferring import infer
from rubnoise.arrays import Doubles
from rubnoise.contact.births import RegularBirths
from rubnoise.contact.laws import LAWS
from rubnoise.inference.inference import InferenceResult, infer_signal
from rubnoise.inference.signal import Signal
from rubnoise.model import Model, Slider
from studies.right_traces import Contact, trace
from tests.inference.traces import contact as contact_of
from tests.models import recorded

PER_LIFE, LIVES, NOISE = 64, 450, 0.05
"""Samples in a mean life, mean lives in a trace, and white noise over the spread of the trace."""

DIAMETER = 5.5
WORDS: dict[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
POPULATIONS: dict[str, float] = WORDS["populations"]
KINDS: dict[str, dict[str, Any]] = WORDS["kinds"]
WRONG: dict[str, str] = WORDS["wrong"]
ZEROS: tuple[Literal["known", "unknown"], ...] = ("known", "unknown")
JUDGED, SHOWN = 200, 60
"""Traces of a case that judges, and of one that shows something."""
CYCLES = (5, 10, 15, 20, 40)

PAGE = Path(__file__).parents[2] / "docs" / "inference.md"
COVERAGE = PAGE.with_name("coverage.json")
ALL = "all of these"
QUANTITIES = ("junction_count", "diameter", "relative_spread", "shear_strength")


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One kind of trace: its law and number, or the wrong model, and how it is fitted."""

    name: str
    law: str = ""
    count: int = 20
    fitted: str = ""
    zero: Literal["known", "unknown"] = "known"
    kind: str = "right"
    drift: float = 0.0
    contact: Contact | None = None
    options: tuple[tuple[str, str], ...] = ()
    most: int = 10**9


def cells() -> Iterator[Cell]:
    """Yield every cell of the study."""
    for kind, about in KINDS.items():
        for law in about.get("laws", POPULATIONS):
            for count in about.get("counts", (20,)):
                own = {key: about[key] for key in ("zero", "drift") if key in about}
                fitted = about.get("fitted", law)
                yield Cell(name=f"{kind} {law} {count}", law=law, count=count, fitted=fitted, kind=kind, **own)
    for law in WRONG:
        for zero in ZEROS:
            yield Cell(name=f"wrong {law} (zero {zero})", law=law, fitted="auto", zero=zero, kind="wrong")
    yield from outside()


def outside() -> Iterator[Cell]:
    """Yield the cells whose traces are made outside the package: with an option, and without it."""
    cases = dict(WORDS["outside"])
    for cycles in CYCLES:
        pole = {"contact": {"bandwidth": cycles}}
        cases |= {
            f"{cycles} cycles without": pole,
            f"{cycles} cycles with": pole | {"options": {"bandwidth": f"{cycles}"}},
        }
    for name, about in cases.items():
        options = tuple(about.get("options", {}).items())
        most = JUDGED if about.get("judges") else SHOWN
        made, law = Contact(**about.get("contact", {})), about.get("law", "fixed")
        yield Cell(name=f"outside {name}", kind="outside", contact=made, fitted=law, options=options, most=most)


def model(law: str, count: float) -> Model:
    """Return a contact of mean diameter 5.5 um over 450 mean lives of 64 ticks."""
    return contact_of(law, POPULATIONS[law], count, LIVES, mean=DIAMETER)


def force_of(contact: Model, seed: int) -> Doubles:
    """Return the friction force of a run in uN."""
    return np.array(recorded(contact, seed, engine="batch")["trace"]["friction_force"])


def right(cell: Cell, seed: int) -> Signal:
    """Return a trace of the model, with white noise."""
    contact = model(cell.law, cell.count)
    # Cells of one seed share no junctions, so that they can be pooled.
    own = crc32(f"{cell.name} {seed}".encode())
    values = force_of(contact, own)
    spread = values.std()
    values += NOISE * spread * np.random.default_rng([own, 1]).standard_normal(values.size)
    if cell.drift:
        steps = np.random.default_rng([own, 3]).standard_normal(values.size)
        values += cell.drift * spread * np.cumsum(steps)
    return Signal(values=values, tick=contact.tick, unit="uN", scale=1.0)


def wrong(kind: str, seed: int) -> Signal:
    """Return a trace of something else, with noise of 5 % of its spread."""
    from scipy.signal import lfilter

    rng = np.random.default_rng([seed, 2])
    n, life = LIVES * PER_LIFE, float(PER_LIFE)
    contact = model("normal", 20)
    if kind == "stick-slip":
        slider = Slider(mass=0.005, stiffness=300.0, damping=0.05, coupling="two-way")
        contact = replace(contact, slider=slider)
        values = 300.0 * recorded(contact, seed, engine="batch")["slider"]["displacement"][:n]
    elif kind == "regular":
        values = force_of(replace(contact, births=RegularBirths(mean_spacing=contact.mean_birth_spacing)), seed)
    elif kind == "lorentzian":
        a = np.exp(-4.0 / life)
        values = 50.0 + 10.0 * lfilter([np.sqrt(1.0 - a * a)], [1.0, -a], rng.standard_normal(n + 1000))[1000:]
    elif kind == "exponential pulses":
        values = lfilter([1.0], [1.0, -np.exp(-4.0 / life)], rng.poisson(20.0 / life, n + 1000))[1000:]
    elif kind == "sine":
        values = 50.0 + np.sin(2.0 * np.pi * (np.arange(n) / life + rng.random()))
    else:
        values = 50.0 + rng.standard_normal(n)
    values = values + NOISE * values.std() * rng.standard_normal(values.size)
    return Signal(values=values, tick=contact.tick, unit="uN", scale=1.0)


def read_outside(cell: Cell, seed: int) -> InferenceResult:
    """Return what `infer` says of a trace made outside the package, over time, with the options of the cell."""
    contact = cell.contact or Contact()
    values = trace(contact, np.random.default_rng(crc32(f"{cell.name} {seed}".encode())))
    options: dict[str, Any] = dict(cell.options)
    speed = 1000.0 * contact.tick
    if "bandwidth" in options:
        options["bandwidth"] = f"{float(options['bandwidth']) * speed / (2.0 * contact.diameter):.12f} Hz"
    if "poles" in options:
        options["poles"] = int(options["poles"])
    if "strokes" not in options:
        options["zero"] = "known"
    return infer(values, rate="1 kHz", speed=f"{speed:.12f} um/s", unit="uN", law=cell.fitted, **options)


def fit(job: tuple[Cell, int]) -> dict[str, Any]:
    """Make one trace and fit it; return what was found beside what is true."""
    cell, seed = job
    if cell.contact is not None:
        true = {"junction_count": 20.0, "diameter": 5.5, "shear_strength": 250.0}
        return _answer(cell, seed, read_outside(cell, seed), true)
    signal = wrong(cell.law, seed) if cell.kind == "wrong" else right(cell, seed)
    true = truth(cell) if cell.kind != "wrong" else {}
    return _answer(cell, seed, infer_signal(signal, zero=cell.zero, law=cell.fitted, drift=cell.drift > 0.0), true)


def _answer(cell: Cell, seed: int, found: InferenceResult, true: dict[str, float]) -> dict[str, Any]:
    answer: dict[str, Any] = {"cell": cell.name, "seed": seed}
    answer["refused"] = found.refused_because
    answer["flags"] = [test.name for test in found.tests if test.flagged]
    answer["true"] = true
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
    chosen = [cell for cell in cells() if any(part in f"{cell.kind}: {cell.name}" for part in only.split(","))]
    wanted = [
        (cell, seed)
        for seed in range(1, traces + 1)
        for cell in chosen
        if (cell.name, seed) not in done and seed <= cell.most
    ]
    with ProcessPoolExecutor(jobs) as pool, (folder / "fits.jsonl").open("a", encoding="utf-8") as out:
        for number, row in enumerate(pool.map(fit, wanted, chunksize=4), 1):
            out.write(json.dumps(row) + "\n")
            out.flush()
            if sys.stderr.isatty():
                print(f"\r{number} of {len(wanted)}", end="", file=sys.stderr)


def scores(rows: list[dict[str, Any]], name: str) -> tuple[int, int, float] | None:
    """Return how many intervals of a quantity hold the truth, of how many, and the median error; None without any."""
    told = [(*row["estimates"][name], row["true"].get(name)) for row in rows if name in row["estimates"]]
    told = [each for each in told if each[-1]]
    if not told:
        return None
    value, _, low, high, true = np.array(told, dtype=np.float64).T
    return int(np.sum((low <= true) & (true <= high))), true.size, float(np.median(np.abs(value / true - 1.0)))


def stopped(rows: list[dict[str, Any]]) -> int:
    """Return how many traces were flagged or refused."""
    return sum(bool(row["flags"] or row["refused"]) for row in rows)


def document(folder: Path) -> None:
    """Keep what every cell has shown, and write the tables of docs/inference.md."""
    found, kept = read(folder), json.loads(COVERAGE.read_text(encoding="utf-8"))
    whole = [row for cell in cells() if cell.kind == "right" for row in found.get(cell.name, [])]
    seen = {cell.name: found[cell.name] for cell in cells() if cell.name in found} | ({ALL: whole} if whole else {})
    # What was not made again stays as it is.
    kept |= {name: _covered(rows) for name, rows in seen.items()}
    COVERAGE.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    fill(PAGE, tables(kept))


def _covered(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return how many traces there were and how many were stopped, and of each quantity [share held, median error]."""
    found = {name: score for name in QUANTITIES if (score := scores(rows, name)) is not None}
    held = {name: [round(a / b, 3), round(error, 3)] for name, (a, b, error) in found.items()}
    return {"traces": len(rows), "flagged_or_refused": stopped(rows), "held": held}


def tables(data: dict[str, Any]) -> dict[str, str]:
    """Return the tables of the page by name."""
    return {
        "coverage": _coverage(data),
        "outside": _outside(data),
        "bandwidth": _bandwidth(data),
        "wrong": _wrong(data),
    }


def _coverage(data: dict[str, Any]) -> str:
    """Return the table of the lowest share and the largest median error in the cells of each law and each kind."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for cell in cells():
        if cell.kind in KINDS and cell.name in data:
            label = KINDS[cell.kind].get("label") or WORDS["labels"].get(cell.law, cell.law)
            groups.setdefault(label, []).append(data[cell.name])
    groups[ALL] = [data[ALL]]
    lines = []
    for label, group in groups.items():
        worst = []
        for name in QUANTITIES:
            held = [each["held"][name] for each in group if name in each["held"]]
            worst.append(_shown(min(share for share, _ in held), max(error for _, error in held)) if held else "")
        lines.append((label, str(sum(each["traces"] for each in group)), *worst))
    return markdown(("traces", "number", "N", "diameter", "spread", "strength"), lines)


def _shown(share: float, error: float) -> str:
    return f"{100.0 * share:.1f} %, {100.0 * error:.1f} %"


def _held(case: dict[str, Any], *names: str) -> list[str]:
    return [_shown(*case["held"][name]) if name in case["held"] else "" for name in names]


def _outside(data: dict[str, Any]) -> str:
    """Return the table of traces made outside the package."""
    rows = []
    for cell in outside():
        name = cell.name.removeprefix("outside ")
        if name in WORDS["outside"]:
            case = data[cell.name]
            option = " ".join(f"--{key.replace('_', '-')} {_SAID.get(key, value)}" for key, value in cell.options)
            shown = _held(case, "junction_count", "diameter", "shear_strength")
            option = f"`{option}`" if option else ""
            rows.append(
                (name.removesuffix(", not said"), cell.fitted, option, str(case["traces"]), *shown, _stops(case))
            )
    return markdown(("trace", "law", "option", "number", "N", "diameter", "strength", "flagged or refused"), rows)


_SAID = {"bandwidth": "F", "strength_spread": '"50 %"', "strokes": '"5 %"'}


def _stops(case: dict[str, Any]) -> str:
    return f"{case['flagged_or_refused']} of {case.get('tested', case['traces'])}"


def _bandwidth(data: dict[str, Any]) -> str:
    """Return the table of one pole at some cycles a life, with and without its corner given."""
    rows = []
    for cycles in CYCLES:
        pair = [data[f"outside {cycles} cycles {which}"] for which in ("without", "with")]
        rows.append((str(cycles), *(cell for case in pair for cell in _held(case, "junction_count", "shear_strength"))))
    return markdown(("cycles a life", "N without", "strength without", "N with", "strength with"), rows)


def _wrong(data: dict[str, Any]) -> str:
    lines = []
    for law, words in WRONG.items():
        lines.append((words, *(_stops(data[f"wrong {law} (zero {zero})"]) for zero in reversed(ZEROS))))
    return markdown(("trace of", "zero unknown", "zero known"), lines)


def main() -> int:
    """Read the command and do it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("run", "docs"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--traces", type=int, default=300)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="texts between commas, one of them part of KIND: NAME")
    asked = parser.parse_args()
    if asked.what == "run":
        run(asked.folder, asked.traces, asked.jobs, asked.only)
    else:
        document(asked.folder)
    return 0
