"""The page of the field's ledger, docs/field.md: its rules, its rows, and the proof of the identity of exponents."""

from collections.abc import Iterator, Sequence
from math import inf, isfinite, isnan

from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.field import FieldClaim, Range

_HEAD = """\
# The field's ledger

A century of measurements of rubbing speaks of level against roughness and speed, of junction sizes, of peaks and of
spectra. This page puts published statements beside the numbers of this model. `rubnoise claims --field` makes the
runs, prints the rows, and writes this page with `-o docs`. The same numbers stand in [field.json](field.json). The
paper that the model comes from has its own page: [paper.md](paper.md).

Each row has a source, its conditions, the published number, the exact number of the model and the simulated one with
its 95 % interval. Runs use fixed seeds. If simulation and theory disagree by more than four standard errors, the exit
code is 3 and this page is not written.

**Verdicts.** We have read no source of this list in full. So the rules are strict:

- *Reproduces* and *contradicts* need an original that was read, or a statement that is proved here.
- *Out of scope*: the abstract shows a subject that the model does not have, such as motion normal to the surface.
- *Not yet* is the verdict of all other rows: an abstract, a number from the notes of others, or memory. The original
  must be checked first. The column *numbers* says whether the numbers agree so far; it is no verdict. *No test* marks
  a number that agrees by assumption, or for which the source has none that could disagree.

**How roughness becomes a diameter.** The model has no roughness, and we know no source that says how the diameter d
of junctions grows with it. The rows assume that d grows as Ra^0.5, so that the exponent of Ra is half of the exponent
m_d of d. With d in proportion to Ra it would be m_d itself. On the surfaces of Dang and others (2013) the correlation
length grows as Rq^0.09 alone: from 400 to 500 um, while Rq grows from 3.57 to 38.61 um.

**A caveat about levels.** The published laws of level are for motion normal to the surface. The model moves along the
surface, at a constant separation. So a disagreement can also mean that the source speaks of something else. The
exponents of Ben Abdelounis and others (2010) are known from notes alone, which differ on which of two ranges belongs to
roughness and which to speed. The rows take both ranges together.
"""

_IDENTITY = """
## Exponents of size and speed add up to 1

The published laws have a level that grows with roughness and with speed, with independent exponents. The model cannot
have them. Let the real contact area A_rm and the law of strengths psi be fixed. Let every diameter be d y, where the
law of y does not depend on d. Let births be at random, and coupling one-way. Then every amplitude of the motion is d
h(V/d), and its exponents of d and of V add up to 1.

**Proof.** A junction of diameter d y has the area d^2 y^2 a(s/(d y)). Its mean over a life is a fixed multiple of
d^2, so N_jm is proportional to A_rm/d^2. Births come at the rate lam = N_jm/(2d), proportional to A_rm/d^3. By
Campbell's theorem, the autocovariance of the area is

    R(tau) = lam E[int A(s) A(s + tau) ds] = A_rm d^2 rho(tau/d)

because the two areas give d^4 and the integral gives d. The function rho does not depend on d. The spectrum of the
force is then S_F(k) = E[psi^2] A_rm d^3 g(k d). One-way, s = V t. Let H(omega) be the response of any linear
structure: a slider of any damping, a beam with many modes, its velocity, or its sound in any band. The variance of
that response is

    (1/2 pi) int |H(omega)|^2 S_F(omega/V)/V domega
        = d^2 (E[psi^2] A_rm/2 pi) int |H(omega)|^2 (d/V) g(omega d/V) domega

The integral on the right depends on V/d alone. So the amplitude is d h(V/d). With q = V/d, its exponents are m_d = 1
- q h'/h and n = q h'/h. They add up to 1.

**Consequences.** A slider with a force that is white over its resonance has n = -1/2 and m_d = 3/2. A slider that
follows the force as a spring does has n = 0 and m_d = 1. The published exponents, as far as we know them, need more:
with d growing as Ra^0.5 a sum of 2.2 or more (Yokoi and Nakai; Ben Abdelounis and others with either reading), with d
growing as Ra of 1.4 (Yokoi and Nakai) or 1.5 or more. No choice of pulse, sizes, strengths, speed or structure gives
the model such a sum.

For Figure 5, the displacement has n between 0.6 and 1.1 only from 0.203 to 0.219 mm/s and from 0.393 to 0.475 mm/s. The
velocity has it from 0.41 to 0.49 mm/s, and in a few narrow windows below 0.2 mm/s, where harmonics of the junctions'
life pass the resonance.

**Checks.** Tests compare the amplitude at (2 d, 2 V) with twice that at (d, V) by `rubnoise.exact`. They do so for
every law of sizes and of strengths, both pulses, and light, critical and heavy damping. The relative difference is
below 1e-6. The row `identity_one_way` shows the sum in runs. Sizes with an absolute spread break a condition, and the
tests find that they break the identity. So do births at regular spacing, as far as their spectral lines matter.

**Higher cumulants.** The j-th cumulant of the motion is d^(2j - 2) times a function of V/d. So its j-th root has
exponents that add up to 2 - 2/j. Only the second cumulant has the sum 1.

## Does feedback repair it?

Two-way coupling changes n and m_d, but hardly their sum. Write the force as F = F_0 + d f(s/d). For many junctions, f
is a Gaussian function whose law does not depend on d. Put x = F_0/k + d y. While the slider slips forward, s = V t -
x and

    m y'' + c y' + k y = f((V/d) t - y)

up to a shift of s, which changes nothing in a stationary contact. The slider sticks as long as k x + c V is below F,
which is k y + c V/d < f. Both conditions contain d only in V/d. So the amplitude is again d h(V/d), with another h.

Two things can break this. The force of few junctions is not Gaussian: its skewness is 1.41/sqrt(N_jm). And a slider
that reverses meets the force -F, in which F_0 does not cancel.

The study `scenarios/studies/exponents.toml` measures both exponents with both couplings
([sweeps.md](sweeps.md#exponents)). Where the slider sticks and slips, feedback turns the sign of n: the velocity
grows about as V^0.5, like the published laws. From 80 to 20 junctions, the sum is 1.01 to 1.05 for velocity and 1.03
to 1.12 for displacement. From 20 to 5 it is 1.05 to 1.08 and 1.07 to 1.14. So feedback does not repair the sum. A law
of level needs junctions whose force depends on speed, such as shocks.
"""

_FREE_MASS = """
## A free mass has the exponent 4

The displacement of a mass without spring and dashpot has the spectrum S_x(omega) = S_F(omega)/(m^2 omega^4). The
force has S_F(omega) = S(omega/V)/V, a plateau for omega below about V/d. So S_x falls as omega^-4 there. A tail of
k^-4 makes it omega^-8 far above V/d. This is the exponent of blocks without visible wear particles (row
`xu2025_measured`). A mass with no spring at all has a speed that wanders without bound, and one-way coupling fails at
the lowest frequencies. The runs have a spring and a dashpot so soft that they do not matter in the band.
"""


def page(claims: Sequence[FieldClaim]) -> Iterator[str]:
    """Yield the lines of the page."""
    yield _HEAD
    yield "| row | source | known from | numbers | verdict |"
    yield "|---|---|---|---|---|"
    for claim in claims:
        yield (
            f"| [{claim.id}](#{claim.id}) | {claim.source.name} | {claim.source.known.value} | {agreement(claim)} | "
            f"{claim.verdict.value} |"
        )
    yield _IDENTITY.rstrip()
    yield _FREE_MASS.rstrip()
    yield "\n## Rows"
    for claim in claims:
        yield from _row(claim)


def agreement(claim: FieldClaim) -> str:
    """Return in words whether the numbers agree; empty if there are none to compare."""
    if claim.cannot_fail:
        return "no test"
    return {None: "", True: "agree", False: "disagree"}[claim.numbers_agree]


def as_range(published: Range | None) -> str:
    """Return a published range in words; empty if the source gives no number."""
    if published is None:
        return ""
    low, high = published
    if not isfinite(low) or not isfinite(high):
        return f"above {low:.6g}" if high == inf else f"below {high:.6g}"
    return f"{low:.4g}" if high - low < 1e-5 else f"{low:.4g} to {high:.4g}"


def _row(claim: FieldClaim) -> Iterator[str]:
    source = claim.source
    doi = f", [doi:{source.doi}](https://doi.org/{source.doi})" if source.doi else ""
    yield f"\n### {claim.id}"
    yield f"\n**{source.name}**{doi}. {claim.statement}"
    yield f"\n*Conditions:* {claim.conditions}."
    if claim.quantity is not None:
        yield "\n| quantity | published | exact | simulated (95 %) |"
        yield "|---|---|---|---|"
        yield _numbers(claim.quantity, claim.published)
    scenario = f" Runs: `scenarios/{claim.scenario}`." if claim.scenario else ""
    lacks = f" The model lacks {claim.lacks}." if claim.lacks else ""
    missing = f" A verdict needs {claim.missing}." if claim.missing else ""
    yield f"\n**Verdict: {claim.verdict.value}.** {claim.because}{lacks}{missing}{scenario}"


def _numbers(quantity: ClaimedNumber, published: Range | None) -> str:
    name = f"{quantity.name} ({quantity.unit})" if quantity.unit else quantity.name
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.5g}"
    low, high = quantity.simulated.interval
    return f"| {name} | {as_range(published)} | {exact} | {quantity.simulated.value:.4g} ± {0.5 * (high - low):.2g} |"
