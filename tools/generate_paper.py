"""Write docs/paper.md and its pictures: `.venv/bin/python tools/generate_paper.py`, after `tools/dev.py sync`.

The page holds every claim of the paper as `rubnoise claims` settles it, every figure as `rubnoise figures` draws it.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

from rubnoise.claims.catalogue import settle
from rubnoise.claims.claim import Claim, Quantity
from rubnoise.figures.paper import FIGURES, paper_figure
from rubnoise.figures.sources import Sources

DOCS = Path(__file__).resolve().parent.parent / "docs"
PICTURES = DOCS / "pictures" / "paper"

HEAD = """\
# The paper, claim by claim

*Modelling of vibrations excited by formation and shearing of adhesive micro-junctions during sliding* ran its model
once and told what it saw. Here is what it claims, what runs from fixed seeds say to it, what the exact theory says, and
the verdict that follows from the numbers. `rubnoise claims` makes all of it anew in a minute or so, `rubnoise figures
all -o DIR` the pictures; this page is what they said, written by `tools/generate_paper.py`.

Each simulated number is the mean of independent runs with the 95 % interval of their scatter, which owes nothing to the
theory. Exact numbers follow from the model alone ([model.md](model.md)). Where the two disagreed by more than four
standard errors the verdict would be *unsettled*. The claims are told in other words, their numbers as printed.
"""


def main() -> int:
    """Settle the claims, draw the figures, and write the page."""
    claims = settle(lambda text: print(text, file=sys.stderr))
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        print(name, file=sys.stderr)
        (PICTURES / f"{name}.png").write_bytes(paper_figure(name, ["png"], Sources())["png"])
    (DOCS / "paper.md").write_text("\n".join(page(claims)) + "\n", encoding="utf-8")
    return 0


def page(claims: tuple[Claim, ...]) -> Iterator[str]:
    """Yield the lines of the page."""
    yield HEAD
    yield "| claim | where | verdict |"
    yield "|---|---|---|"
    yield from (f"| [{claim.name}](#{claim.name}) | {claim.where} | {claim.verdict.value} |" for claim in claims)
    yield "\n## Claims"
    for claim in claims:
        yield from _claim(claim)
    yield "\n## Figures"
    for name, figure in FIGURES.items():
        files = ", ".join(f"`scenarios/paper/{file}`" for file in figure.scenarios)
        yield f"\n### Figure {name.removeprefix('fig')}: {figure.title}"
        yield f"\n![{figure.title}](pictures/paper/{name}.png)"
        yield f"\n{figure.caption} From {files}."


def _claim(claim: Claim) -> Iterator[str]:
    yield f"\n### {claim.name}"
    yield f"\n**{claim.where}.** {claim.says}\n"
    yield "| quantity | printed | simulated (95 %) | exact |"
    yield "|---|---|---|---|"
    yield from map(_quantity, claim.quantities)
    yield f"\n**Verdict: {claim.verdict.value}.** {claim.because} Runs: `scenarios/{claim.scenario}`."


def _quantity(quantity: Quantity) -> str:
    name = f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name
    printed = "" if quantity.printed is None else f"{quantity.printed:g}"
    low, high = quantity.simulated.interval
    return f"| {name} | {printed} | {quantity.simulated.value:.5g} ± {0.5 * (high - low):.2g} | {quantity.exact:.6g} |"


if __name__ == "__main__":
    sys.exit(main())
