"""Write docs/paper.md and its pictures: `.venv/bin/python tools/generate_paper.py`, after `tools/dev.py sync`.

The page holds every claim of the paper as `rubnoise claims` settles it, every figure as `rubnoise figures` draws it.
"""

import sys
from collections.abc import Iterator
from math import isnan
from pathlib import Path

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
its model once and described the results. This page lists its explicit and implied claims. For each claim it gives
runs from fixed seeds, the exact theory, and the verdict. `rubnoise claims` repeats the runs in less than a minute,
and `rubnoise figures all -o DIR` draws the pictures. `tools/generate_paper.py` wrote this page from both.

Each simulated number is the mean of independent runs, or follows from such means. The 95 % interval comes from their
scatter, without theory. Exact numbers follow from the model alone ([model.md](model.md)). Two-way coupling
([two-way.md](two-way.md)) has none; there the verdict follows from runs and their intervals. If simulation and theory
disagree by more than four standard errors, the verdict is *unsettled*, and the tool does not write this page. The
claims are in our own words, with the printed numbers.
"""

LIMITS = """
## What the paper leaves out

Section 4 of the paper states three limits of its model. rubnoise computes the same model and has the same limits:

- **Constant separation.** The surfaces slide at a constant distance. The normal load appears only in A_rm. Nothing in a
  run raises or lowers the slider, or changes the load.
- **Parallel flats.** Junctions form between flats parallel to the plane of sliding. All forces lie in that plane. There
  is no vibration normal to it, no loss of contact and no impact.
- **No measured surfaces.** A_rm and N_jm are inputs. They do not follow from a measured profile and a load.

Two more limits follow from its equations:

- **Passes through both centres.** Eq. (2) is the overlap of two circles of one diameter whose centres move along one
  line. Suppose instead that centres pass at distances spread evenly from 0 to d. For equal sizes, std over mean is then
  1.356/sqrt(N_jm) and not 1.230/sqrt(N_jm). The tail of the spectrum is k^-5 and not k^-4, because only a centred pass
  has a kink at mid-life. `pulse.offset = "uniform"` runs this contact, and has its exact theory
  ([theory.md](theory.md#passes-off-the-centre-line)). Compared at one mean area and N_jm, three claims change:
  - life_mean: the mean area over a life is (pi/16) d^2 = 0.196 d^2.
  - area_spread: from 10 to 50 junctions of equal size, the std falls by 24 um^2 at 100 um^2 and by 119 um^2 at 500
    um^2. The printed 22 and 110 um^2 belong to centred passes.
  - psd_floor: the exponent is -5. There is no floor either.

  The others stand: S(0) is 58 % larger at every N_jm, and all spreads still fall as 1/sqrt(N_jm). The displacement of
  Figure 5 spreads by 226 um, not by 195 um.
- **A slider that does not act back.** The area depends on the sliding distance. This grows evenly, however the slider
  moves: see [constant_speed](#constant_speed). rubnoise has this limit with `slider.coupling = "one-way"`, the default,
  and not with `"two-way"`.
"""


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
    yield "| claim | where | verdict |"
    yield "|---|---|---|"
    yield from (f"| [{claim.name}](#{claim.name}) | {claim.where} | {claim.verdict.value} |" for claim in claims)
    yield "\n## Claims"
    for claim in claims:
        yield from _claim(claim)
    yield LIMITS.rstrip()
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


def _quantity(quantity: ClaimedNumber) -> str:
    name = f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name
    printed = "" if quantity.printed is None else f"{quantity.printed:g}"
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.6g}"
    low, high = quantity.simulated.interval
    return f"| {name} | {printed} | {quantity.simulated.value:.5g} ± {0.5 * (high - low):.2g} | {exact} |"


if __name__ == "__main__":
    sys.exit(main())
