"""The page of the field's ledger, docs/field.md: one table, its sources, and what the model lacks."""

from collections.abc import Iterator, Sequence
from math import inf, isfinite, isnan

from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.field import FieldClaim, Known, Publication, Range
from rubnoise.claims.sources import BA_2010, DANG_2013, THIS_MODEL

_HEAD = """\
# The field

Published numbers beside those of this model. A row *agrees* if the exact number lies in the published range and the
95 % interval of the runs touches it. To lie in a range that holds two readings of its source is *no test*: amplitude or
power for 3/4, and two notes on which exponent is 0.7 to 0.96 and which 0.8 to 1.16. $n$ is the exponent of speed $V$
and $m$ that of height, of a level of vibration.
*Normal*: a slider that [may leave its contact](load.md#free-to-bounce); other motion is along the surface. A star marks
numbers from the notes of others. `rubnoise claims --field` makes the runs from fixed seeds, and has conditions and
reasons of each row, as [field.json](field.json); [another page](paper.md) has the claims of the paper.

| source | number | published | exact | simulated (95 %) | verdict |
|---|---|---|---|---|---|"""

_FOOT = """
The last rows are for [any slider under a load](theory.md#exponents-of-size-and-speed). The model lacks damping in the
contact (Le Bot 2010, 2011), specimens with many modes (Othman 1990), and a drive from both sides (Rice and Moslehy
1997).

<details><summary>The sources, each read at least as an abstract</summary>
"""

_EXPONENTS: tuple[tuple[Publication, Range, Range], ...] = (
    (BA_2010, (0.7, 0.96), (0.8, 1.16)),
    (BA_2010, (0.8, 1.16), (0.7, 0.96)),
    (DANG_2013, (0.52, 0.63), (0.63, 0.67)),
)
"""Published exponents of speed and of height; two notes differ on which of the first source's are which."""


def page(claims: Sequence[FieldClaim]) -> Iterator[str]:
    """Yield the lines of the page."""
    yield _HEAD
    yield from map(_row, claims)
    yield from (_under_a_load(*each) for each in _EXPONENTS)
    yield _FOOT
    cited = {claim.source.label: claim.source for claim in claims if claim.source is not THIS_MODEL}
    yield from (_source(cited[label]) for label in sorted(cited))
    yield "\n</details>"


def as_range(published: Range | None) -> str:
    """Return a published range in words; empty if the source gives no number."""
    if published is None:
        return ""
    low, high = published
    if not isfinite(low) or not isfinite(high):
        return f"above {low:.6g}" if high == inf else f"below {high:.6g}"
    return f"{low:.4g}" if high - low < 1e-5 else f"{low:.4g} to {high:.4g}"


def _row(claim: FieldClaim) -> str:
    exact, simulated = ("", "") if claim.quantity is None else _numbers(claim.quantity)
    return _cells(claim.source, claim.label, as_range(claim.published), exact, simulated, claim.verdict.value)


def _under_a_load(source: Publication, speed: Range, height: Range) -> str:
    expected = (0.5 + 0.5 * speed[0], 0.5 + 0.5 * speed[1])
    agree = expected[0] <= height[1] and height[0] <= expected[1]
    name = f"$m = (1 + n)/2$, $n$ {as_range(speed)}"
    return _cells(source, name, as_range(height), as_range(expected), "", "agrees" if agree else "disagrees")


def _cells(source: Publication, *others: str) -> str:
    mark = "\\*" if source.known is Known.SECOND_HAND else ""
    return f"| {' | '.join((f'{source.label}{mark}', *others))} |"


def _source(source: Publication) -> str:
    return f"- [{source.name}](https://doi.org/{source.doi})" if source.doi else f"- {source.name}"


def _numbers(quantity: ClaimedNumber) -> tuple[str, str]:
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.4g}"
    low, high = quantity.simulated.interval
    return exact, f"{quantity.simulated.value:.4g} ± {0.5 * (high - low):.2g}"
