"""Hashes of every column of a run of some 10 000 rows: the bits that a stream version stands for.

`python -m tests.golden.hashes` prints them, in the environment it is called in, or those of the runs that it is given;
with --write it makes them the golden ones of the present stream version.
"""

import json
import sys
from pathlib import Path

import numpy as np
import xxhash

from rubnoise.contact.laws import Spread
from rubnoise.contact.off_centre import OFF_CENTRE_LENS
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.model import Model, Slider
from rubnoise.simulation.extent import Engine
from rubnoise.streams import STREAM_VERSION
from tests.models import UNEQUAL, model, recorded

SEED = 20_240_229
PUSHING_BACK = Slider(mass=0.005, stiffness=300.0, damping=0.05, coupling="two-way")
GOLDEN = Path(__file__).parent / f"stream_{STREAM_VERSION}.json"
RUNS: dict[str, Model] = {
    "figure 5": model(distance=5_500.0, tick=0.1),
    "figure 5, fine ticks, some lives finer than others": model(
        spread=Spread(relative=0.2), distance=1_200.0, tick=0.05
    ),
    "fine ticks that the slider divides, unequal strengths": model(
        strength=UNEQUAL, distance=300.0, tick=0.05, speed=20.0
    ),
    "wide sizes, slow, from empty": model(
        spread=Spread(absolute=4.0), distance=300.0, tick=0.5, speed=20.0, start="empty"
    ),
    "matched, relative spread, few": model(
        count=2.0, calibration="matched", spread=Spread(relative=0.2), distance=3_000.0, tick=1.0
    ),
    "triangles, regular births, one size": model(
        pulse=TRIANGLE, births="regular", spread=Spread(), distance=1_200.0, tick=0.3
    ),
    "triangles, unequal strengths, slow": model(
        pulse=TRIANGLE, strength=UNEQUAL, spread=Spread(relative=0.3), distance=700.0, tick=0.5, speed=20.0
    ),
    "lenses, regular births, wide sizes, unequal strengths": model(
        births="regular", strength=UNEQUAL, spread=Spread(relative=0.5), distance=1_500.0, tick=0.5
    ),
    "off the centre line, fine ticks, wide sizes": model(
        pulse=OFF_CENTRE_LENS, spread=Spread(relative=0.3), distance=900.0, tick=0.05
    ),
    "off the centre line, slow, unequal strengths": model(
        pulse=OFF_CENTRE_LENS, strength=UNEQUAL, distance=900.0, tick=0.5, speed=20.0
    ),
    "figure 5, two-way": model(distance=1_200.0, tick=0.3, slider=PUSHING_BACK),
    "few, two-way, with reversals": model(count=2.0, distance=6_000.0, tick=1.0, slider=PUSHING_BACK),
}


def hashes(*names: str) -> dict[str, dict[str, str]]:
    """Return the xxh3_128 of each column, little-endian, by run and by group/column; of all runs, or of some."""
    return {name: columns_of(RUNS[name]) for name in names or RUNS}


def columns_of(run: Model, engine: Engine = "events") -> dict[str, str]:
    groups = recorded(run, SEED, engine=engine).groups
    return {
        f"{group}/{column}": xxhash.xxh3_128_hexdigest(little_endian(values).tobytes())
        for group, columns in groups.items()
        if group != "blocks"  # says how the run was cut, not what happened in it
        for column, values in columns.items()
    }


def little_endian(values: np.ndarray) -> np.ndarray:
    return values.astype(values.dtype.newbyteorder("<"))


if __name__ == "__main__":
    chosen = sys.argv[1:]
    if "--write" in chosen:
        GOLDEN.write_text(json.dumps(hashes(), indent=1) + "\n", encoding="utf-8")
    else:
        sys.stdout.write(json.dumps(hashes(*chosen), indent=1) + "\n")
