"""The field's ledger: every row has a source, numbers that agree between theory and runs, and an honest verdict."""

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from rubnoise.claims import catalogue
from rubnoise.claims.field import FieldClaim, FieldVerdict, Known
from rubnoise.claims.field_page import page
from rubnoise.cli.ledger import row_as_json
from rubnoise.scenario.shipped import shipped
from tests.architecture.sources import ROOT

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
EXACT = {
    "identity_one_way": 1.0,
    "ba2010_speed": -0.5,
    "ba2010_roughness": 0.75,
    "dang2013_damping": -10.0,
    "xu2025_measured": 4.0,
    "rabinowicz1956_method": 9.0,
    "rabinowicz1956_diameter": math.sqrt(30.0),
    "rabinowicz1955_load": -0.5,
    "rabinowicz1955_finish": 1.0,
    "kilburn1974_spread": 0.5,
    "campbell_rice": 1.5124,
    "ba2011_shocks": 1.0,
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
def claims() -> dict[str, FieldClaim]:
    told: list[str] = []
    found = {claim.id: claim for claim in catalogue.evaluate_field(told.append)}
    assert told
    return found


def test_there_are_enough_rows_and_each_says_where_it_is_from(claims: dict[str, FieldClaim]) -> None:
    assert len(claims) >= 20
    beside = [claim for claim in claims.values() if claim.numbers_agree is not None]
    assert len(beside) >= 12
    for claim in claims.values():
        assert all((claim.source.name, claim.statement, claim.conditions, claim.because)), claim.id
        assert (claim.quantity is None) or (claim.scenario is not None), claim.id
        assert claim.scenario is None or shipped(claim.scenario).is_file()


def test_no_verdict_on_numbers_rests_on_an_original_that_was_not_read(claims: dict[str, FieldClaim]) -> None:
    judged = [c for c in claims.values() if c.verdict in (FieldVerdict.REPRODUCES, FieldVerdict.CONTRADICTS)]
    assert {claim.source.known for claim in judged} == {Known.PROOF}
    assert all(claim.missing for claim in claims.values() if claim.verdict is FieldVerdict.NOT_YET)
    assert not any(claim.source.known is Known.MEMORY and claim.lacks for claim in judged)


def test_simulation_and_theory_agree_and_a_wrong_theory_is_noticed(claims: dict[str, FieldClaim]) -> None:
    rows = list(claims.values())
    assert catalogue.disagreeing(rows) == []
    for claim in rows:
        if claim.quantity is None or math.isnan(claim.quantity.exact):
            continue
        exact = claim.quantity.exact
        wrong = replace(claim, quantity=replace(claim.quantity, exact=1.4 * exact + math.copysign(0.3, exact)))
        assert catalogue.disagreeing([wrong]) == [claim.id]


def test_exact_numbers_are_those_of_closed_forms(claims: dict[str, FieldClaim]) -> None:
    for name, value in EXACT.items():
        quantity = claims[name].quantity
        assert quantity is not None
        assert quantity.exact == pytest.approx(value, rel=1e-2), name


def test_the_sum_of_exponents_is_far_from_the_measured_one_with_both_couplings(
    claims: dict[str, FieldClaim],
) -> None:
    one_way, two_way = (claims[name].quantity for name in ("sum_measured", "sum_measured_two_way"))
    assert one_way is not None
    assert two_way is not None
    assert one_way.simulated.interval[0] < 1.0 < one_way.simulated.interval[1] < 1.1
    assert 1.0 < two_way.simulated.interval[1] < 1.3
    assert [claims[name].numbers_agree for name in ("sum_measured", "sum_measured_two_way")] == [False, False]


def test_page_and_json_are_what_the_command_writes(claims: dict[str, FieldClaim]) -> None:
    rows = tuple(claims.values())
    assert (ROOT / "docs" / "field.md").read_text(encoding="utf-8") == "\n".join(page(rows)) + "\n"
    kept = json.loads((ROOT / "docs" / "field.json").read_text(encoding="utf-8"))
    found = json.loads(json.dumps({"claims": [row_as_json(claim) for claim in rows]}))
    kept_numbers, found_numbers = (dict(leaves(each, float)) for each in (kept, found))
    # Sums of numpy and scipy differ in the last digits from one processor to another.
    assert kept_numbers == pytest.approx(found_numbers, rel=1e-9)
    assert dict(leaves(kept, str | int | None)) == dict(leaves(found, str | int | None))
    assert all(set(row) >= KEYS for row in kept["claims"])
