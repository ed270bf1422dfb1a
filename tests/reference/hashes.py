"""What a stream version stands for: some values of the draws of every law and of each column of runs.

`python -m tests.reference.hashes` prints them in the environment it is called in, or `draws` alone, or the runs that it
is given; with --write it makes all of them the golden ones of the present stream version.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import xxhash

from rubnoise.contact.distributions import Fixed, Gamma, Lognormal, Normal, Power, Weibull
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import OFF_CENTRE_LENS, TRIANGLE
from rubnoise.model import Model, Slider
from rubnoise.simulation.draws import Engine
from rubnoise.streams import STREAM_VERSION, Stream, uniforms
from tests.models import UNEQUAL, model, recorded

SEED = 20_240_229
PUSHING_BACK = Slider(mass=0.005, stiffness=300.0, damping=0.05, coupling="two-way")
GOLDEN = Path(__file__).parent / f"stream_{STREAM_VERSION}.json"
GOLDEN_DRAWS = GOLDEN.with_name(f"draws_{STREAM_VERSION}.json")
COUNT = 20_000
SIZES = (
    Fixed(value=5.53),
    Normal(centre=5.53, std=0.2),
    Normal(centre=1.0, std=3.0),
    Lognormal(mean=5.53, std=1.1),
    Lognormal(mean=1.0, std=3.0),
    Weibull(mean=5.53, std=5.53),
    Gamma(mean=5.53, std=1.1),
    Gamma(mean=1.0, std=3.0),
    Weibull(mean=5.53, std=1.1),
    Power(exponent=2.5, smallest=2.0, largest=20.0),
    Power(exponent=1.0, smallest=2.0, largest=20.0),
)
STRENGTHS = (
    Fixed(value=250.0),
    Normal(centre=250.0, std=100.0),
    Lognormal(mean=250.0, std=100.0),
    Weibull(mean=250.0, std=100.0),
)
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


SOME = 12
"""Rows of a column that are kept."""


def hashes(*names: str) -> dict[str, dict[str, Any]]:
    """Return what stands for each column, by run and by group/column; of all runs, or of some."""
    return {name: columns_of(RUNS[name]) for name in names or RUNS}


def draws() -> dict[str, list[float]]:
    """Return some of what each law makes of the same uniforms."""
    uniform = uniforms(SEED, Stream.DIAMETERS, 0, COUNT)
    return {str(law): some_of(law.quantile(uniform)) for law in (*SIZES, *STRENGTHS)}


def columns_of(run: Model, engine: Engine = "events") -> dict[str, Any]:
    """Return of each column of numbers its rows, largest value and some values; of whole numbers the xxh3_128."""
    groups = recorded(run, SEED, engine=engine).groups
    return {
        f"{group}/{column}": some_of(values) if values.dtype.kind == "f" else hash_of(values)
        for group, columns in groups.items()
        for column, values in columns.items()
    }


def some_of(values: np.ndarray) -> list[float]:
    if not values.size:
        return [0.0]
    chosen = np.linspace(0, values.size - 1, SOME).astype(int)
    return [float(values.size), float(np.nanmax(np.abs(values))), *values[chosen].tolist()]


def hash_of(values: np.ndarray) -> str:
    return xxhash.xxh3_128_hexdigest(values.astype(values.dtype.newbyteorder("<")).tobytes())


if __name__ == "__main__":
    chosen = sys.argv[1:]
    if "--write" in chosen:
        for place, made in ((GOLDEN, hashes()), (GOLDEN_DRAWS, draws())):
            place.write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
    else:
        made = draws() if chosen == ["draws"] else hashes(*chosen)
        sys.stdout.write(json.dumps(made, indent=1) + "\n")
