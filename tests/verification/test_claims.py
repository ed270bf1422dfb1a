"""Verdicts follow from numbers, and claims of the paper and of the field have them."""

import json
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from math import inf, log, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.special

from rubnoise.analysis.replicates import PooledEstimate, difference, estimate, ratio
from rubnoise.claims import catalogue
from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict
from rubnoise.claims.field import FieldClaim, FieldVerdict, Known, Publication, exponent, exponent_of
from rubnoise.claims.field_page import as_range, page
from rubnoise.cli.claims import row_as_json
from rubnoise.cli.layout import json_text
from rubnoise.figures.paper import FIGURES
from rubnoise.scenario.shipped import shipped
from tests.architecture.sources import ROOT
from tests.cli.terminal import call
from tools import generate_paper

# Claims of the paper and rows of the field's ledger have verdicts, by runs and theory that agree.
# Every claim of the paper has a verdict, by runs and by theory that agree.
VERDICTS = {
    "life_mean": Verdict.CORRECTED,
    "rabinowicz": Verdict.CORRECTED,
    "present_mean": Verdict.CORRECTED,
    "mean_area": Verdict.CORRECTED,
    "live_count": Verdict.HOLDS,
    "constant_speed": Verdict.FAILS,
    "area_spread": Verdict.HOLDS,
    "psd_decay": Verdict.HOLDS,
    "psd_same": Verdict.FAILS,
    "psd_sizes": Verdict.FAILS,
    "psd_floor": Verdict.FAILS,
    "few_or_many": Verdict.HOLDS,
}
EXACT = {
    ("life_mean", 0): 1.0 / 3.0,
    ("rabinowicz", 1): 0.0013092,
    ("rabinowicz", 2): 0.000996,
    ("mean_area", 0): 204.6736,
    ("present_mean", 0): 1.0,
    ("live_count", 0): 20.0,
    ("constant_speed", 0): 47.2411,
    ("area_spread", 0): 21.60,
    ("area_spread", 1): 109.25,
}
"""Of physics worked out elsewhere, to the digits given."""


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    told: list[str] = []
    found = {claim.name: claim for claim in catalogue.evaluate_claims(told.append)}
    assert told
    return found


def test_every_claim_is_settled_in_the_order_of_the_paper(claims: dict[str, Claim]) -> None:
    assert tuple(claims) == catalogue.ORDER
    assert {name: claim.verdict for name, claim in claims.items()} == VERDICTS


def test_all_of_them_are_told(claims: dict[str, Claim], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "evaluate_claims", lambda _: tuple(claims.values()))
    answer = call("claims")
    assert (answer.code, answer.err) == (0, "")
    heads = [f"{claim.where}: {claim.verdict.value}" for claim in claims.values()]
    assert [line for line in answer.out.splitlines() if line in heads] == heads


def test_the_exact_numbers_are_those_known(claims: dict[str, Claim]) -> None:
    for (name, index), value in EXACT.items():
        assert claims[name].quantities[index].exact == pytest.approx(value, rel=2.5e-4), name
    assert claims["rabinowicz"].quantities[0].exact < 1e-12


def test_no_run_is_so_coarse_that_it_would_agree_with_anything(claims: dict[str, Claim]) -> None:
    for name, claim in claims.items():
        for quantity in claim.quantities:
            low, high = quantity.simulated.interval
            size = quantity.simulated.value if math.isnan(quantity.exact) else quantity.exact
            assert high - low < 0.25 * abs(size) + 1e-12, (name, quantity.name)


def _normal_moment(n: int, spread: float) -> float:
    """E[d^n] over d_m^n of a normal diameter, for a spread in um about the 5.53 um of Figure 5."""
    relative = (spread / 5.5300126) ** 2
    pairs = range(0, n + 1, 2)
    return sum(math.comb(n, k) * math.prod(range(1, k, 2)) * relative ** (k // 2) for k in pairs)


def test_the_larger_junctions_are_met_more_often_as_moments_say(claims: dict[str, Claim]) -> None:
    for quantity, spread in zip(claims["present_mean"].quantities, (0.0, 0.2, 1.0, 2.0), strict=True):
        first, second, third = (_normal_moment(n, spread) for n in (1, 2, 3))
        # Redrawing diameters that are not positive moves the moments at 2 um by some 3e-3.
        assert quantity.exact == pytest.approx(third / (first * second), rel=5e-3 if spread == 2.0 else 1e-6)
    assert "0.26 % more with the spread of the paper" in claims["present_mean"].because


def test_unequal_sizes_raise_the_spectrum_as_their_sixth_moment_does(claims: dict[str, Claim]) -> None:
    claim = claims["psd_sizes"]
    for quantity, spread in zip(claim.quantities, (0.2, 1.0, 2.0), strict=False):
        # At low wavenumbers and not at 0, so a little less.
        assert 0.97 < quantity.exact / _normal_moment(6, spread) <= 1.0
    assert "one of 1 um multiplies S(0) by 1.54, and one of 2 um by 3.78" in claim.because
    assert _normal_moment(6, 1.0) == pytest.approx(1.54, abs=0.005)
    assert _normal_moment(6, 2.0) == pytest.approx(3.77, abs=0.005)


def test_spectra_are_compared_to_a_few_percent(claims: dict[str, Claim]) -> None:
    for quantity in (*claims["psd_same"].quantities, *claims["psd_sizes"].quantities):
        low, high = quantity.simulated.interval
        assert high - low < 0.08 * quantity.exact, quantity.name


def test_what_is_implied_is_not_said_to_be_claimed(claims: dict[str, Claim]) -> None:
    assert claims["constant_speed"].where == "Fig. 5, implied"
    assert "without saying so" in claims["constant_speed"].says


def test_passes_off_the_centres_are_as_the_page_says() -> None:
    """Discs that overlap with centres r diameters apart; x along the line of motion, b across it, even from 0 to 1."""
    area = np.vectorize(lambda r: 0.5 * (math.acos(r) - r * math.sqrt(1.0 - r * r)) if r < 1.0 else 0.0)
    r = (np.arange(20_000) + 0.5) / 20_000
    first, second = (math.pi * float(np.mean(r * area(r) ** n)) for n in (1, 2))
    life = 2.0 * float(np.mean(np.sqrt(1.0 - r * r)))
    page = (generate_paper.DOCS / "paper.md").read_text(encoding="utf-8")
    spread = math.sqrt(second * life) / first  # of the area over its mean, times the root of the number
    for size in (100, 500):
        fall = size * spread * (10.0**-0.5 - 50.0**-0.5)
        assert f"by {fall:.0f} µm² at {size} µm²" in page
    # E_b |A^(k; b)|^2 from the transform of the disc's autocorrelation, means over a period of the swing.
    k = 2.0 * math.pi * np.array([20.0, 80.0])[:, None] + np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    across = 400.0 * (np.arange(8_000) + 0.5) / 8_000
    power = [float(np.mean(_disc(np.hypot(row[:, None], across)) ** 2)) for row in k]
    assert math.log(power[1] / power[0]) / math.log(4.0) == pytest.approx(-5.0, abs=0.1)


def _disc(wavenumber: np.ndarray) -> np.ndarray:
    """The transform of the autocorrelation of a disc of unit diameter, (pi J_1(k/2) / k)^2."""
    return (math.pi * scipy.special.j1(0.5 * wavenumber) / wavenumber) ** 2


def test_no_page_is_written_where_simulation_and_theory_disagree(
    claims: dict[str, Claim], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = (*list(claims.values())[:-1], replace(claims["few_or_many"], if_agreed=Verdict.UNSETTLED))
    monkeypatch.setattr(generate_paper, "evaluate_claims", lambda tell: wrong)
    monkeypatch.setattr(generate_paper, "DOCS", tmp_path)
    monkeypatch.setattr(generate_paper, "PICTURES", tmp_path / "pictures")
    assert generate_paper.main() == 1
    assert "simulation and theory disagree: few_or_many" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_formulas_of_claims_are_set(claims: dict[str, Claim]) -> None:
    """On the page, that is; a terminal shows them in plain letters."""
    assert "d^2/3" in claims["life_mean"].because
    for claim in claims.values():
        texts = [claim.says, claim.because, *(f"{each.name} ({each.unit})" for each in claim.quantities)]
        plain = [re.sub(r"\$[^$]*\$", "", generate_paper.typeset(text)) for text in texts]
        assert [text for text in plain if re.search(r"\^|sqrt|\b[A-Z]_\w|\bum\b|\blam\b", text)] == [], claim.name


@pytest.mark.parametrize("name", ["life_mean", "mean_area", "rabinowicz", "psd_floor", "psd_sizes", "area_spread"])
def test_a_wrong_theory_leaves_a_claim_unsettled(claims: dict[str, Claim], name: str) -> None:
    claim = claims[name]
    wrong = tuple(replace(each, exact=1.2 * each.exact + 0.01) for each in claim.quantities)
    assert replace(claim, quantities=wrong).verdict is Verdict.UNSETTLED
    assert claim.verdict is claim.if_agreed


def test_the_page_on_the_paper_is_what_the_claims_say(claims: dict[str, Claim]) -> None:
    written = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    assert written == generate_paper.page(tuple(claims.values()), written)
    assert all((ROOT / "docs" / "pictures" / "paper" / f"{name}.png").is_file() for name in FIGURES)


# The field's ledger: every row has a source, numbers that agree between theory and runs, and an honest verdict.
KEYS = {
    "id",
    "source",
    "doi",
    "statement",
    "conditions",
    "exact",
    "simulated",
    "interval",
    "verdict",
    "scenario",
}
FIELD_EXACT = {
    "identity_one_way": 1.0,
    "ba2010_speed": -0.5,
    "dang2013_damping": -10.0,
    "xu2025_measured": 4.0,
    "rabinowicz1956_diameter": math.sqrt(30.0),
    "rabinowicz1955_load": -0.5,
    "rabinowicz1955_finish": 1.0,
    "campbell_rice": 1.5124,
}
"""Of closed forms and limits, to 1 %."""


def leaves(value: Any, kind: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield what is of a kind in a JSON document, with the way to it."""
    if isinstance(value, dict | list):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(inner, kind, f"{path}/{key}")
    elif isinstance(value, kind):
        yield path, value


@pytest.fixture(scope="module")
def field_claims() -> dict[str, FieldClaim]:
    told: list[str] = []
    found = {claim.id: claim for claim in catalogue.evaluate_field(told.append)}
    assert told
    return found


def test_there_are_enough_rows_and_each_says_where_it_is_from(field_claims: dict[str, FieldClaim]) -> None:
    assert 15 <= len(field_claims) <= 40
    beside = [claim for claim in field_claims.values() if claim.numbers_agree is not None]
    assert len(beside) >= 12
    for claim in field_claims.values():
        assert all((claim.source.name, claim.statement, claim.conditions, claim.because)), claim.id
        assert (claim.quantity is None) or (claim.scenario is not None), claim.id
        assert claim.scenario is None or shipped(claim.scenario).is_file()


def test_all_rows_are_told(field_claims: dict[str, FieldClaim], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(catalogue, "evaluate_field", lambda _: tuple(field_claims.values()))
    answer = call("claims", "--field")
    assert (answer.code, answer.err) == (0, "")
    heads = [f"{claim.id}: {claim.verdict.value} ({claim.source.known.value})" for claim in field_claims.values()]
    assert [line for line in answer.out.splitlines() if line in heads] == heads


def test_every_row_could_disagree_and_some_do(field_claims: dict[str, FieldClaim]) -> None:
    assert {claim.verdict for claim in field_claims.values()} == set(FieldVerdict)
    labels = [(claim.source.label, claim.label, claim.published) for claim in field_claims.values()]
    assert max(len(label) for _, label, _ in labels) <= 40


def test_to_lie_in_a_range_of_two_readings_is_no_test(field_claims: dict[str, FieldClaim]) -> None:
    """3/4 is that of an amplitude or of a power, and two notes differ on which exponent is 0.7 to 0.96."""
    widened = {name for name, claim in field_claims.items() if claim.widened}
    assert {field_claims[name].published for name in widened} == {(0.375, 0.75), (0.7, 1.16)}
    untested = {name for name, claim in field_claims.items() if claim.verdict is FieldVerdict.NO_TEST}
    assert untested == {"speed2019_two_way", "speed2019_normal", "ba2010_normal_speed", "ba2010_normal_height"}
    assert {field_claims[name].verdict for name in widened - untested} == {FieldVerdict.DISAGREES}
    assert all(replace(field_claims[name], widened=False).verdict is FieldVerdict.AGREES for name in untested)


def test_simulation_and_theory_agree_and_a_wrong_theory_is_noticed(field_claims: dict[str, FieldClaim]) -> None:
    rows = list(field_claims.values())
    assert catalogue.disagreeing(rows) == []
    for claim in rows:
        if claim.quantity is None or math.isnan(claim.quantity.exact):
            continue
        exact = claim.quantity.exact
        wrong = replace(claim, quantity=replace(claim.quantity, exact=1.4 * exact + math.copysign(0.3, exact)))
        assert catalogue.disagreeing([wrong]) == [claim.id]


def test_exact_numbers_are_those_of_closed_forms(field_claims: dict[str, FieldClaim]) -> None:
    for name, value in FIELD_EXACT.items():
        quantity = field_claims[name].quantity
        assert quantity is not None
        assert quantity.exact == pytest.approx(value, rel=1e-2), name


def test_the_sum_of_exponents_is_far_from_the_measured_one_with_both_couplings(
    field_claims: dict[str, FieldClaim],
) -> None:
    one_way, two_way = (field_claims[name].quantity for name in ("sum_measured", "sum_measured_two_way"))
    assert one_way is not None
    assert two_way is not None
    assert one_way.simulated.interval[0] < 1.0 < one_way.simulated.interval[1] < 1.1
    assert 1.0 < two_way.simulated.interval[1] < 1.3
    assert [field_claims[name].numbers_agree for name in ("sum_measured", "sum_measured_two_way")] == [False, False]


def test_page_and_json_are_what_the_command_writes(field_claims: dict[str, FieldClaim]) -> None:
    rows = tuple(field_claims.values())
    assert (ROOT / "docs" / "field.md").read_text(encoding="utf-8") == "\n".join(page(rows)) + "\n"
    kept = json.loads((ROOT / "docs" / "field.json").read_text(encoding="utf-8"))
    found = json.loads(json_text({"claims": [row_as_json(claim) for claim in rows]}))
    kept_numbers, found_numbers = (dict(leaves(each, float)) for each in (kept, found))
    # Sums of numpy and scipy differ in the last digits from one processor to another.
    assert kept_numbers == pytest.approx(found_numbers, rel=1e-9)
    assert dict(leaves(kept, str | int | None)) == dict(leaves(found, str | int | None))
    assert all(set(row) >= KEYS for row in kept["claims"])


# How verdicts follow from numbers.
# How a verdict follows from numbers.
def test_an_estimate_is_the_mean_of_the_runs_with_student_s_interval() -> None:
    found = estimate([1.0, 2.0, 3.0, 6.0])
    assert found.value == 3.0
    assert found.standard_error == pytest.approx(np.std([1, 2, 3, 6], ddof=1) / 2.0)
    assert found.interval[1] - 3.0 == pytest.approx(3.182446 * found.standard_error, rel=1e-6)


def test_one_run_has_no_interval_and_agrees_with_anything() -> None:
    found = estimate([1.0])
    assert found.interval == (-inf, inf)
    assert found.agrees_with(2.0)


def test_agreement_is_as_strict_as_four_standard_deviations_of_a_normal_number() -> None:
    many = PooledEstimate(value=0.0, standard_error=1.0, runs=100_000)
    assert many.agrees_with(3.99)
    assert not many.agrees_with(4.01)
    few = PooledEstimate(value=0.0, standard_error=1.0, runs=4)
    assert few.agrees_with(4.5), "few runs know their own error badly"


def test_rounding_is_forgiven_where_runs_do_not_scatter() -> None:
    still = estimate([1e-15, 1e-15])
    assert still.agrees_with(0.0, rounding=1e-12)
    assert not still.agrees_with(0.0)


def test_errors_of_differences_and_ratios_add_up() -> None:
    one, other = (
        PooledEstimate(value=8.0, standard_error=0.3, runs=5),
        PooledEstimate(value=2.0, standard_error=0.4, runs=7),
    )
    assert difference(one, other) == PooledEstimate(value=6.0, standard_error=0.5, runs=5)
    found = ratio(one, other)
    assert (found.value, found.runs) == (4.0, 5)
    assert found.standard_error == pytest.approx(4.0 * np.hypot(0.3 / 8.0, 0.4 / 2.0))


@pytest.mark.parametrize(("exact", "verdict"), [(1.0, Verdict.HOLDS), (2.0, Verdict.UNSETTLED)])
def test_a_verdict_needs_simulation_and_theory_to_agree(exact: float, verdict: Verdict) -> None:
    simulated = PooledEstimate(value=1.0, standard_error=0.01, runs=50)
    quantity = ClaimedNumber(name="mean", unit="um", printed=1.0, simulated=simulated, exact=exact)
    claim = Claim(
        name="mean",
        where="Eq. (1)",
        says="It is 1.",
        quantities=(quantity,),
        if_agreed=Verdict.HOLDS,
        because="It is.",
        scenario="",
    )
    assert claim.verdict is verdict


# How a verdict on a published statement follows from numbers and from how well the statement is known.
NEAR_2 = ClaimedNumber(
    name="exponent", unit="", printed=None, simulated=PooledEstimate(value=2.1, standard_error=0.1, runs=8), exact=2.0
)


def claim(known: Known = Known.ORIGINAL, **changes: object) -> FieldClaim:
    row = FieldClaim(
        id="row",
        label="number",
        source=Publication(label="Someone", name="Someone 1956", doi=None, known=known),
        statement="It is 2.",
        conditions="dry",
        because="It is.",
        quantity=NEAR_2,
        published=(1.9, 2.2),
    )
    return replace(row, **changes)


def test_a_number_agrees_if_the_exact_one_and_the_runs_do() -> None:
    assert claim().verdict is FieldVerdict.AGREES
    assert claim(published=(2.05, 2.2)).verdict is FieldVerdict.DISAGREES, "the exact number is outside"
    scattered = replace(NEAR_2, simulated=PooledEstimate(value=9.0, standard_error=0.1, runs=8))
    assert claim(quantity=scattered).verdict is FieldVerdict.DISAGREES, "the runs are outside"
    without_theory = replace(NEAR_2, exact=nan)
    assert claim(quantity=without_theory).verdict is FieldVerdict.AGREES
    assert claim(published=(-inf, 0.0)).verdict is FieldVerdict.DISAGREES


@pytest.mark.parametrize("changes", [{"published": None}, {"quantity": None}])
def test_what_could_not_disagree_is_no_test(changes: dict[str, object]) -> None:
    row = claim(**changes)
    assert (row.numbers_agree, row.verdict) == (None, FieldVerdict.NO_TEST)


def test_exponents_under_a_load_are_judged_by_their_identity() -> None:
    written = "\n".join(page([]))
    assert "$n$ 0.52 to 0.63 | 0.63 to 0.67 | 0.76 to 0.815 |  | disagrees |" in written
    assert written.count("| agrees |") == 2


def test_an_exponent_has_the_error_of_both_its_points() -> None:
    near = PooledEstimate(value=3.0, standard_error=0.3, runs=8)
    far = PooledEstimate(value=12.0, standard_error=0.6, runs=4)
    found = exponent(near, far, 4.0)
    assert (found.value, found.runs) == (pytest.approx(1.0), 4)
    assert found.standard_error == pytest.approx((0.1**2 + 0.05**2) ** 0.5 / log(4.0))
    half = exponent_of("half", (near, 3.0), (far, 48.0), 4.0, times=0.5)
    assert (half.exact, half.simulated.value) == (pytest.approx(1.0), pytest.approx(0.5))
    assert exponent(far, near, 0.25).standard_error > 0.0


def test_ranges_are_written_as_they_are() -> None:
    written = [as_range(each) for each in ((1.0, 2.0), (-inf, 0.0), (0.0, inf), (1.5, 1.5))]
    assert written == ["1 to 2", "below 0", "above 0", "1.5"]
