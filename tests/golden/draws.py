"""Hashes of what every size and strength law makes of the same uniforms: the bits that a stream version stands for.

`python -m tests.golden.draws` prints them, in the environment it is called in; with --write it makes them the golden
ones of the present stream version.
"""

import json
import sys
from pathlib import Path

import xxhash

from rubnoise.contact.sizes import FixedSizes, NormalSizes
from rubnoise.contact.sizes_gamma import ExponentialSizes, GammaSizes
from rubnoise.contact.sizes_lognormal import LognormalSizes
from rubnoise.contact.strengths import ConstantStrength
from rubnoise.contact.strengths_spread import LognormalStrength, NormalStrength, WeibullStrength
from rubnoise.streams import STREAM_VERSION, Stream, generator

SEED = 20_240_229
COUNT = 20_000
GOLDEN = Path(__file__).parent / f"draws_{STREAM_VERSION}.json"
SIZES = (
    FixedSizes(diameter=5.53),
    NormalSizes(mean=5.53, std=0.2),
    NormalSizes(mean=1.0, std=3.0),
    LognormalSizes(mean=5.53, std=1.1),
    LognormalSizes(mean=1.0, std=3.0),
    ExponentialSizes(mean=5.53),
    GammaSizes(mean=5.53, std=1.1),
    GammaSizes(mean=1.0, std=3.0),
)
STRENGTHS = (
    ConstantStrength(mean=250.0),
    NormalStrength(centre=250.0, std=100.0),
    LognormalStrength(mean=250.0, std=100.0),
    WeibullStrength(mean=250.0, std=100.0),
)


def hashes() -> dict[str, str]:
    """Return the xxh3_128 of the draws of each law, little-endian, and of the live sizes' draws."""
    uniform = generator(SEED, Stream.DIAMETERS).random(COUNT)
    drawn = {str(law): law.draw(uniform) for law in (*SIZES, *STRENGTHS)}
    live = {f"live {law}": law.draw_length_biased(generator(SEED, Stream.START_DIAMETERS), COUNT) for law in SIZES}
    return {name: xxhash.xxh3_128_hexdigest(values.astype("<f8").tobytes()) for name, values in (drawn | live).items()}


if __name__ == "__main__":
    text = json.dumps(hashes(), indent=1) + "\n"
    if "--write" in sys.argv:
        GOLDEN.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)
