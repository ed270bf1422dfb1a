"""Write docs/paper.md and its pictures: `.venv/bin/python tools/generate_paper.py`, after `tools/dev.py sync`.

The page holds every claim of the paper as `rubnoise claims` settles it; the pictures are what `rubnoise figures` draws.
"""

import re
import sys
from collections.abc import Iterator
from math import isnan
from pathlib import Path

from parts import table
from small_png import small

from rubnoise.claims.catalogue import evaluate_claims
from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict
from rubnoise.figures.paper import FIGURES, paper_figure
from rubnoise.figures.paper_sources import Sources

DOCS = Path(__file__).resolve().parent.parent / "docs"
PICTURES = DOCS / "pictures" / "paper"

HEAD = """\
# The paper, claim by claim

The paper *Modelling of vibrations excited by formation and shearing of adhesive micro-junctions during sliding* ran
its model once and described the results. Here is each of its explicit and implied claims, in our own words with the
printed numbers, beside runs from fixed seeds and exact theory. `rubnoise claims` repeats the runs in less than a
minute. The [gallery](gallery.md#the-papers-figures) has its figures.

Each simulated number is the mean of independent runs, or follows from such means, with a 95 % interval from their
scatter. Two-way coupling has no exact numbers. If simulation and theory disagreed by more than four standard errors,
the verdict would be *unsettled*, and `tools/generate_paper.py` would not write this page.
"""

LIMITS = r"""
## What the paper leaves out

Its separation is constant ([load](load.md) changes this), $A_{rm}$ and $N_{jm}$ are inputs ([surfaces](surfaces.md)
derives them), and its slider does not act back ([two-way coupling](two-way.md) does). Its passes go through both
centres. If centres pass at distances spread evenly from 0 to $d$ (`pulse.offset = "uniform"`,
[theory](theory.md#passes-off-the-centre-line)), three claims change:

- life_mean: the mean area over a life is $(\pi/16)\,d^2 = 0.196\,d^2$.
- area_spread: from 10 to 50 junctions of equal size, the std falls by 24 µm² at 100 µm² and by 119 µm² at 500 µm².
- psd_floor: the exponent is -5, because only a centred pass has a kink at mid-life. There is no floor either.

$S(0)$ is 58 % larger, and the displacement of Figure 5 spreads by 226 µm, not by 195 µm.
"""

TYPESET = {
    "E[d^3]/(E[d] E[d^2])": r"$\mathrm{E}[d^3]/(\mathrm{E}[d]\,\mathrm{E}[d^2])$",
    "1/(sqrt(3) N_jm^2)": r"$1/(\sqrt{3}\,N_{jm}^2)$",
    "4 lam E[d^2]/k^4": r"$4\lambda\,\mathrm{E}[d^2]/k^4$",
    "1.2298/sqrt(N_jm)": r"$1.2298/\sqrt{N_{jm}}$",
    "1/sqrt(N_jm)": r"$1/\sqrt{N_{jm}}$",
    "1/sqrt(5) = 0.447": r"$1/\sqrt{5} = 0.447$",
    "um^4 per rad/um": "µm⁴ per rad/µm",
    "0.327 d^2": r"$0.327\,d^2$",
    "L_jm/N_jm": r"$L_{jm}/N_{jm}$",
    "N_jm^-1.5": r"$N_{jm}^{-1.5}$",
    "(2/3) d^3": r"$\frac{2}{3} d^3$",
    "k L_jm": r"$k L_{jm}$",
    "E[d^6]": r"$\mathrm{E}[d^6]$",
    "d^2/3": "$d^2/3$",
    "N_jm": "$N_{jm}$",
    "um^2": "µm²",
    "k^-4": "$k^{-4}$",
    "k^-5": "$k^{-5}$",
    "S(0)": "$S(0)$",
    "d^2": "$d^2$",
    "d^3": "$d^3$",
    "um": "µm",
}
"""How a formula or unit of a claim, which a terminal shows, is set on the page; the longer before the shorter."""

_PLAIN = re.compile("|".join(rf"(?<!\w){re.escape(plain)}(?!\w)" for plain in TYPESET))


def main() -> int:
    """Settle the claims, draw the figures, and write the page; where a claim is unsettled only say which, return 1."""
    claims = evaluate_claims(lambda text: print(text, file=sys.stderr))
    if unsettled := [claim.name for claim in claims if claim.verdict is Verdict.UNSETTLED]:
        print(f"generate_paper: simulation and theory disagree: {', '.join(unsettled)}", file=sys.stderr)
        return 1
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        print(name, file=sys.stderr)
        (PICTURES / f"{name}.png").write_bytes(small(paper_figure(name, ["png"], Sources())["png"]))
    (DOCS / "paper.md").write_text("\n".join(page(claims)) + "\n", encoding="utf-8")
    return 0


def page(claims: tuple[Claim, ...]) -> Iterator[str]:
    """Yield the lines of the page."""
    yield HEAD
    rows = ((f"[{claim.name}](#{claim.name})", claim.where, claim.verdict.value) for claim in claims)
    yield table(("claim", "where", "verdict"), rows)
    yield "## Claims"
    for claim in claims:
        yield from _claim(claim)
    yield LIMITS.rstrip()


def typeset(text: str) -> str:
    """Return a text of a claim with its formulas as the site sets them."""
    return _PLAIN.sub(lambda found: TYPESET[found[0]], text)


def _claim(claim: Claim) -> Iterator[str]:
    yield f"\n### {claim.name}"
    yield f"\n**{claim.where}.** {typeset(claim.says)}\n"
    yield table(("quantity", "printed", "simulated (95 %)", "exact"), map(_quantity, claim.quantities))
    yield f"**Verdict: {claim.verdict.value}.** {typeset(claim.because)} Runs: `scenarios/{claim.scenario}`."


def _quantity(quantity: ClaimedNumber) -> tuple[str, ...]:
    name = typeset(f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name)
    printed = "" if quantity.printed is None else f"{quantity.printed:g}"
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.6g}"
    low, high = quantity.simulated.interval
    return name, printed, f"{quantity.simulated.value:.5g} ± {0.5 * (high - low):.2g}", exact


if __name__ == "__main__":
    sys.exit(main())
