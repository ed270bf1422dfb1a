"""Write the claims of docs/paper.md and its pictures: `.venv/bin/python tools/generate_paper.py`.

Needs `tools/dev.py sync`. The page holds every claim of the paper as `rubnoise claims` settles it; the pictures are
what `rubnoise figures` draws.
"""

import re
import sys
from math import isnan
from pathlib import Path

from parts import filled, table
from small_png import small

from rubnoise.claims.catalogue import evaluate_claims
from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict
from rubnoise.figures.paper import FIGURES, paper_figure
from rubnoise.figures.paper_sources import Sources

DOCS = Path(__file__).resolve().parent.parent / "docs"
PICTURES = DOCS / "pictures" / "paper"

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
    path = DOCS / "paper.md"
    path.write_text(page(claims, path.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


def page(claims: tuple[Claim, ...], text: str) -> str:
    """Return the text of the page with what the claims say in it now."""
    rows = ((f"[{claim.name}](#{claim.name})", claim.where, claim.verdict.value) for claim in claims)
    index = table(("claim", "where", "verdict"), rows)
    return filled(text, {"index": index, "claims": "\n".join(map(_claim, claims))})


def typeset(text: str) -> str:
    """Return a text of a claim with its formulas as the site sets them."""
    return _PLAIN.sub(lambda found: TYPESET[found[0]], text)


def _claim(claim: Claim) -> str:
    quantities = table(("quantity", "printed", "simulated (95 %)", "exact"), map(_quantity, claim.quantities))
    verdict = f"**Verdict: {claim.verdict.value}.** {typeset(claim.because)} Runs: `scenarios/{claim.scenario}`."
    return f"### {claim.name}\n\n**{claim.where}.** {typeset(claim.says)}\n\n{quantities}\n{verdict}\n"


def _quantity(quantity: ClaimedNumber) -> tuple[str, ...]:
    name = typeset(f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name)
    printed = "" if quantity.printed is None else f"{quantity.printed:g}"
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.6g}"
    low, high = quantity.simulated.interval
    return name, printed, f"{quantity.simulated.value:.5g} ± {0.5 * (high - low):.2g}", exact


if __name__ == "__main__":
    sys.exit(main())
