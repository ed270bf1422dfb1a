"""The page of the field's ledger, docs/field.md: its rows, exponents under a load, and what the model lacks."""

from collections.abc import Iterator, Sequence
from math import inf, isfinite, isnan

from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.field import FieldClaim, Range

_HEAD = """\
# The field

This page puts what others published beside the numbers of this model. A row is here if its source was read at least
as an abstract. `rubnoise claims --field` makes the runs from fixed seeds, prints the rows with their reasons and
conditions, and writes this page with `-o docs`; the same rows stand in [field.json](field.json). The claims of the
paper are on [another page](paper.md).

A row *agrees* if the exact number lies in the published range and the 95 % interval of the runs touches it. It has
*no test* if no number could disagree. `(2)` marks numbers that are known from the notes of others. The published
levels are for motion normal to the surface. Rows that say so are for a slider that may leave its contact
([load.md](load.md#free-to-bounce)); the other rows are for the motion along the surface, at a constant separation.
"""

_LOAD = """
## Exponents under a load

A slider that rises and falls on its load ([load.md](load.md)) has $m = (1 + n)/2$, $m$ the exponent of height and $n$
that of speed: [theory](theory.md#exponents-of-size-and-speed) has the proof. First order alone has $n = 1$ at low
speed and $-1/2$ at high speed. A slider that bounces has values between, in the rows above.
"""

_EXPONENTS: tuple[tuple[str, Range, Range], ...] = (
    ("Ben Abdelounis and others 2010 (2), one reading of two", (0.7, 0.96), (0.8, 1.16)),
    ("Ben Abdelounis and others 2010 (2), the other reading", (0.8, 1.16), (0.7, 0.96)),
    ("Dang and others 2013 (2)", (0.52, 0.63), (0.63, 0.67)),
)
"""Published exponents of speed and of height."""

_NO_TEST = """
Yokoi and Nakai 1979 are known from memory alone, so they have no test. The contact resonance goes as $s_0^{-1/2}$, so
it falls with roughness; whether the peak of Stoimenov and others 2007 rises or falls by its factor of 1.5 was not
seen: no test either.
"""

_LACKS = """
## What the model lacks

- Damping in the contact, and a nominal area (Le Bot and Bou-Chakra 2010; Le Bot and others 2011).
- Specimens with many modes, a size and a material (Othman and Elkholy 1990).
- Excitation by displacement of both sides (Rice and Moslehy 1997).
"""


def page(claims: Sequence[FieldClaim]) -> Iterator[str]:
    """Yield the lines of the page."""
    yield _HEAD
    yield "| source: statement; *quantity* | published | exact | simulated (95 %) | verdict |"
    yield "|---|---|---|---|---|"
    yield from map(_row, claims)
    yield _LOAD
    yield "| source | n | (1 + n)/2 | published m | verdict |"
    yield "|---|---|---|---|---|"
    for name, speed, height in _EXPONENTS:
        expected = (0.5 + 0.5 * speed[0], 0.5 + 0.5 * speed[1])
        agree = expected[0] <= height[1] and height[0] <= expected[1]
        ranges = (as_range(each) for each in (speed, expected, height))
        yield f"| {name} | {' | '.join(ranges)} | {'agrees' if agree else 'disagrees'} |"
    yield _NO_TEST.rstrip()
    yield _LACKS.rstrip()


def as_range(published: Range | None) -> str:
    """Return a published range in words; empty if the source gives no number."""
    if published is None:
        return ""
    low, high = published
    if not isfinite(low) or not isfinite(high):
        return f"above {low:.6g}" if high == inf else f"below {high:.6g}"
    return f"{low:.4g}" if high - low < 1e-5 else f"{low:.4g} to {high:.4g}"


def _row(claim: FieldClaim) -> str:
    source = claim.source
    name = f"[{source.name}](https://doi.org/{source.doi})" if source.doi else source.name
    mark = " (2)" if "second-hand" in source.known.value else ""
    numbers = ("", "", "") if claim.quantity is None else _numbers(claim.quantity)
    quantity, exact, simulated = numbers
    cells = (f"{name}{mark}: {claim.statement} {quantity}".rstrip(), as_range(claim.published), exact, simulated)
    return f"| {' | '.join(cells)} | {claim.verdict.value} |"


def _numbers(quantity: ClaimedNumber) -> tuple[str, str, str]:
    name = f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.4g}"
    low, high = quantity.simulated.interval
    return f"*{name}*", exact, f"{quantity.simulated.value:.4g} ± {0.5 * (high - low):.2g}"
