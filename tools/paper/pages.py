"""The pages on the paper and on its field, docs/paper.md and docs/field.md, with what their ledgers say."""

from collections.abc import Sequence
from math import inf, isfinite, isnan
from pathlib import Path
from typing import Final

from parts import filled, table

from paper.ledger import Claim, Claimed, Ledger, Range

DOCS: Final = Path(__file__).resolve().parents[2] / "docs"
ROUNDING: Final = 1e-12
"""Below it a number is nothing but rounding, which is not the same on every processor."""

SECOND_HAND: Final = "law in the abstract, numbers second-hand"
"""How a source is known whose numbers get a star."""


def written(ledger: Ledger, claims: Sequence[Claim]) -> str:
    """Return the text of a ledger's page with what its claims say now; the words around them are kept."""
    parts = {"paper": paper_parts, "field": field_parts}[ledger.path.stem](ledger, claims)
    return filled(place(ledger).read_text(encoding="utf-8"), parts)


def place(ledger: Ledger) -> Path:
    """Return the file of a ledger's page."""
    return DOCS / f"{ledger.path.stem}.md"


def paper_parts(_ledger: Ledger, claims: Sequence[Claim]) -> dict[str, str]:
    """Return each claim of the paper with its numbers."""
    return {"claims": "\n".join(map(_section, claims))}


def _section(claim: Claim) -> str:
    rows = (
        (_name(each), "" if each.printed is None else f"{each.printed:g}", simulated(each, 5), exact(each, 6))
        for each in claim.numbers
    )
    numbers = table(("quantity", "printed", "simulated (95 %)", "exact"), rows)
    verdict = f"**Verdict: {claim.verdict}.** {claim.because}"
    return f"### {claim.id}\n\n**{claim.source.label}.** {claim.statement}\n\n{numbers}\n{verdict}\n"


def field_parts(ledger: Ledger, claims: Sequence[Claim]) -> dict[str, str]:
    """Return the table of published numbers, and the list of their sources."""
    rows = [_published(ledger, claim, each) for claim in claims for each in claim.numbers]
    rows += [_under_a_load(ledger, **each) for each in ledger.data["exponents"]]
    head = ("source", "number", "published", "exact", "simulated (95 %)", "verdict")
    return {"rows": table(head, rows), "sources": "".join(_cited(ledger))}


def _published(ledger: Ledger, claim: Claim, number: Claimed) -> tuple[str, ...]:
    source, published = _starred(ledger, claim.source.label), as_range(number.range)
    return source, _name(number), published, exact(number, 4), simulated(number, 4), claim.verdict


def _under_a_load(ledger: Ledger, source: str, speed: Range, height: Range) -> tuple[str, ...]:
    """Return a row on the exponents of speed and of height, which a slider under a load ties to each other."""
    low, high = (0.5 + 0.5 * end for end in speed)
    agree = low <= height[1] and height[0] <= high
    name = f"$m = (1 + n)/2$, $n$ {as_range(speed)}"
    verdict = ledger.data["verdicts"]["holds" if agree else "fails"]
    return _starred(ledger, source), name, as_range(height), as_range((low, high)), "", verdict


def _starred(ledger: Ledger, label: str) -> str:
    return label + ("\\*" if ledger.source(label).known == SECOND_HAND else "")


def _cited(ledger: Ledger) -> list[str]:
    """Return a line about each publication, in the order of their names in the table."""
    sources = [ledger.source(label) for label in sorted(ledger.data["sources"]) if label != "rubnoise"]
    return [f"- [{each.name}](https://doi.org/{each.doi})\n" if each.doi else f"- {each.name}\n" for each in sources]


def _name(number: Claimed) -> str:
    return f"{number.name} ({number.unit})" if number.unit else number.name


def simulated(number: Claimed, digits: int) -> str:
    """Return the mean of the runs with half its 95 % interval."""
    low, high = number.found.simulated.interval
    if 0.0 < max(abs(low), abs(high)) < ROUNDING:
        return "0, but for rounding"
    return f"{number.found.simulated.value:.{digits}g} ± {0.5 * (high - low):.2g}"


def exact(number: Claimed, digits: int) -> str:
    """Return the exact number; empty if theory has none."""
    return "" if isnan(number.found.exact) else f"{number.found.exact:.{digits}g}"


def as_range(published: Range | None) -> str:
    """Return a published range in words; empty if the source gives no number."""
    if published is None:
        return ""
    low, high = published
    if not isfinite(high - low):
        return f"above {low:.6g}" if high == inf else f"below {high:.6g}"
    return f"{low:.4g}" if high - low < 1e-5 else f"{low:.4g} to {high:.4g}"
