"""Hashes of what every size and strength law makes of the same uniforms: the bits that a stream version stands for.

`python -m tests.golden.draws` prints them, in the environment it is called in; with --write it makes them the golden
ones of the present stream version.
"""

import json
import sys
from pathlib import Path

import xxhash

from rubnoise.contact.laws import Exponential, Fixed, Gamma, Lognormal, Normal, Power, Weibull
from rubnoise.streams import STREAM_VERSION, Stream, generator

SEED = 20_240_229
COUNT = 20_000
GOLDEN = Path(__file__).parent / f"draws_{STREAM_VERSION}.json"
SIZES = (
    Fixed(value=5.53),
    Normal(centre=5.53, std=0.2),
    Normal(centre=1.0, std=3.0),
    Lognormal(mean=5.53, std=1.1),
    Lognormal(mean=1.0, std=3.0),
    Exponential(mean=5.53),
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
