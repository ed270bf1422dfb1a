"""Level of the noise over roughness and cut-off of two surfaces: `python tools/studies surface_levels`.

Writes docs/surface_levels.json and its table in docs/surfaces.md. Synthetic surfaces go the whole way: spectra, theory
of the contact, scenario with the slider's mass, a run of it. Where a run is further from the scenario's theory than
four standard errors, nothing is written, and the exit code is 1.
"""

import argparse
import json
import re
import sys
from dataclasses import asdict, dataclass
from math import log, log10
from pathlib import Path
from typing import Final

import rubnoise
from rubnoise.record.tally import Tally
from rubnoise.scenario import loads
from rubnoise.simulation.run import simulate
from rubnoise.theory.load import level, load_errors, load_motion

ROOT: Final = Path(__file__).resolve().parents[2]
DATA: Final = ROOT / "docs" / "surface_levels.json"
PAGE: Final = ROOT / "docs" / "surfaces.md"
TABLE: Final = re.compile(r"(?<=<!-- study: surface levels -->\n).*?(?=<!-- end -->)", re.DOTALL)
POINTS: Final = 1024
HURST: Final = 0.8
ROLLOFF: Final = 128.0
ROUGHNESSES: Final = (0.3, 1.0, 3.0)
CUTOFFS: Final = (8.0, 16.0, 32.0)
"""Of each surface, in um; its points are 1 um apart."""

LOAD: Final = 10.4
MASS: Final = LOAD / 9.81
"""In N and kg: the slider rests under its own weight, and 1 % of the area is in contact."""

SPEED: Final = 30_000.0
RATIO: Final = 0.3
SEED: Final = 381
ALLOWED: Final = 4.0


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One roughness and cut-off: the contact, and the level of the normal velocity in dB re 50 nm/s."""

    roughness: float
    cutoff: float
    junction_count: float
    relative_speed: float
    exact: float
    found: float
    error: float


def measured(roughness: float, cutoff: float, seed: int) -> Cell:
    """Return a cell, from two surfaces and one run of their scenario."""
    track, slider = (
        rubnoise.Surface.synthesise(
            points=POINTS,
            roughness=f"{roughness} um",
            hurst=HURST,
            rolloff=f"{ROLLOFF} um",
            cutoff=f"{cutoff} um",
            seed=n,
        )
        for n in (1, 2)
    )
    contact = track.slide(slider, cutoff=f"{cutoff} um", load=f"{LOAD} N", hardness="1 GPa")
    text = contact.scenario_text(speed=SPEED, mass=MASS, damping_ratio=RATIO)
    model = loads(text).model()
    tally, motion = Tally.of(model), load_motion(model)
    simulate(model, seed, tally, engine="batch")
    relative = load_errors(model, model.distance).velocity_std / motion.velocity_std
    return Cell(
        roughness=roughness,
        cutoff=cutoff,
        junction_count=contact.gaussian.junction_count,
        relative_speed=motion.relative_speed,
        exact=motion.velocity_level,
        found=level(tally.moments["normal_velocity"].std),
        error=20.0 / log(10.0) * relative,
    )


def table(cells: list[Cell]) -> str:
    """Return the cells as a table of Markdown, a row for each roughness."""
    head = "| rms height of each | " + " | ".join(f"cut-off {cutoff:g} µm" for cutoff in CUTOFFS) + " |\n"
    rows = (
        f"| {roughness:g} µm | " + " | ".join(_told(each) for each in cells if each.roughness == roughness) + " |\n"
        for roughness in ROUGHNESSES
    )
    counts = " | ".join(f"{each.junction_count:.3g} junctions" for each in cells if each.roughness == ROUGHNESSES[0])
    return head + "|---" * (1 + len(CUTOFFS)) + f"|\n| | {counts} |\n" + "".join(rows)


def _told(each: Cell) -> str:
    return f"{each.exact:.1f} dB, run {each.found:.1f} ± {each.error:.1f}"


def exponent(cells: list[Cell], cutoff: float) -> float:
    """Return d ln level / d ln roughness by theory at a cut-off, over all roughnesses."""
    own = [each for each in cells if each.cutoff == cutoff]
    return (own[-1].exact - own[0].exact) / (20.0 * log10(own[-1].roughness / own[0].roughness))


def kept() -> list[Cell]:
    """Return the cells of the data."""
    return [Cell(**each) for each in json.loads(DATA.read_text("utf-8"))["cells"]]


def main() -> int:
    """Make the study and write its data and table, or only the table from the data with --table."""
    parser = argparse.ArgumentParser(prog="studies surface_levels", description=__doc__)
    parser.add_argument("--table", action="store_true", help="draw the table from the data")
    if not parser.parse_args().table:
        places = [(roughness, cutoff) for roughness in ROUGHNESSES for cutoff in CUTOFFS]
        cells = [measured(*place, SEED + n) for n, place in enumerate(places)]
        if wrong := [each for each in cells if abs(each.found - each.exact) > ALLOWED * each.error]:
            print(*wrong, sep="\n", file=sys.stderr)
            return 1
        facts = {"points": POINTS, "hurst": HURST, "rolloff": ROLLOFF, "load": LOAD, "speed": SPEED, "seed": SEED}
        DATA.write_text(json.dumps({**facts, "cells": [asdict(each) for each in cells]}, indent=1) + "\n", "utf-8")
    PAGE.write_text(TABLE.sub(lambda _: table(kept()), PAGE.read_text("utf-8")), "utf-8")
    return 0
