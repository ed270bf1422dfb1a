"""Every claim of the paper is settled, by runs and by theory that agree."""

from dataclasses import replace

import pytest

from rubnoise.claims import catalogue
from rubnoise.claims.claim import Claim, Verdict, settled
from rubnoise.figures.paper import FIGURES
from tests.architecture.sources import ROOT
from tools import generate_paper

VERDICTS = {
    "life_mean": Verdict.CORRECTED,
    "rabinowicz": Verdict.CORRECTED,
    "mean_area": Verdict.CORRECTED,
    "live_count": Verdict.HOLDS,
    "constant_speed": Verdict.FAILS,
    "area_spread": Verdict.HOLDS,
    "psd_decay": Verdict.HOLDS,
    "psd_same": Verdict.FAILS,
    "psd_floor": Verdict.FAILS,
    "few_or_many": Verdict.HOLDS,
}
EXACT = {
    ("life_mean", 0): 1.0 / 3.0,
    ("rabinowicz", 1): 0.0013092,
    ("rabinowicz", 2): 0.000996,
    ("mean_area", 0): 204.6736,
    ("live_count", 0): 20.0,
    ("constant_speed", 0): 47.2411,
    ("area_spread", 0): 21.60,
    ("area_spread", 1): 109.25,
}
"""Of physics worked out elsewhere, to the digits given."""


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    told: list[str] = []
    found = {claim.name: claim for claim in catalogue.settle(told.append)}
    assert told
    return found


def test_every_claim_is_settled_in_the_order_of_the_paper(claims: dict[str, Claim]) -> None:
    assert tuple(claims) == catalogue.ORDER
    assert {name: claim.verdict for name, claim in claims.items()} == VERDICTS


def test_the_exact_numbers_are_those_known(claims: dict[str, Claim]) -> None:
    for (name, index), value in EXACT.items():
        assert claims[name].quantities[index].exact == pytest.approx(value, rel=2.5e-4), name
    assert claims["rabinowicz"].quantities[0].exact < 1e-12


def test_no_run_is_so_coarse_that_it_would_agree_with_anything(claims: dict[str, Claim]) -> None:
    for name, claim in claims.items():
        for quantity in claim.quantities:
            low, high = quantity.simulated.interval
            assert high - low < 0.25 * abs(quantity.exact) + 1e-12, (name, quantity.name)


@pytest.mark.parametrize("name", ["life_mean", "mean_area", "rabinowicz", "psd_floor", "area_spread"])
def test_a_wrong_theory_leaves_a_claim_unsettled(claims: dict[str, Claim], name: str) -> None:
    claim = claims[name]
    wrong = tuple(replace(each, exact=1.2 * each.exact + 0.01) for each in claim.quantities)
    assert settled(quantities=wrong, verdict=claim.verdict) is Verdict.UNSETTLED
    assert settled(quantities=claim.quantities, verdict=claim.verdict) is claim.verdict


def test_the_page_on_the_paper_is_what_the_claims_say(claims: dict[str, Claim]) -> None:
    written = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    assert written == "\n".join(generate_paper.page(tuple(claims.values()))) + "\n"
    assert all((ROOT / "docs" / "pictures" / "paper" / f"{name}.png").is_file() for name in FIGURES)
