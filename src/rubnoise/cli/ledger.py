"""The field's ledger as `rubnoise claims --field` prints and writes it."""

import json
from collections.abc import Sequence
from math import isfinite, isnan
from pathlib import Path
from typing import Any

from rubnoise.claims.claim import Quantity
from rubnoise.claims.field import FieldClaim
from rubnoise.claims.field_page import agreement, as_range, page
from rubnoise.cli.layout import remark, table_row

_LABEL = 46
_FILES = ("field.md", "field.json")


def row_as_json(claim: FieldClaim) -> dict[str, Any]:
    """Return a row by name, numbers in the unit of its quantity; None where there is no number."""
    quantity, published = claim.quantity, claim.published
    low, high = published or (None, None)
    interval = (None, None) if quantity is None else quantity.simulated.interval
    return {
        "id": claim.id,
        "source": claim.source.name,
        "doi": claim.source.doi,
        "known_from": claim.source.known.value,
        "statement": claim.statement,
        "conditions": claim.conditions,
        "quantity": None if quantity is None else quantity.name,
        "unit": None if quantity is None else quantity.unit,
        "published": [_number(low), _number(high)],
        "exact": None if quantity is None else _number(quantity.exact),
        "simulated": None if quantity is None else quantity.simulated.value,
        "interval": [_number(end) for end in interval],
        "numbers": agreement(claim) or None,
        "verdict": claim.verdict.value,
        "missing": claim.missing,
        "because": claim.because,
        "scenario": claim.scenario,
    }


def format_ledger(claims: Sequence[FieldClaim]) -> list[str]:
    """Return all rows as lines to print."""
    lines = []
    for claim in claims:
        verdict = f"{claim.verdict.value} ({claim.source.known.value})"
        lines += [f"{claim.id}: {verdict}", remark(f"{claim.source.name}. {claim.statement}")]
        if claim.quantity is not None:
            lines += [table_row(f"  {'':<{_LABEL}}", f"{'exact':>9} {'simulated (95 %)':>20}")]
            lines += [_numbers(claim.quantity)]
        if claim.published is not None:
            lines += [remark(f"Published: {as_range(claim.published)}; the numbers {agreement(claim)}.")]
        if claim.cannot_fail:
            lines += [remark("No test: these numbers cannot disagree.")]
        lines += [remark(claim.because), ""]
    return lines[:-1]


def check_places(folder: Path, *, force: bool) -> None:
    """Raise OutputRefused before anything runs where the page may not or cannot be written."""
    from rubnoise.storage.output import check_output

    for name in _FILES:
        check_output(folder / name, force=force)


def write_ledger(folder: Path, claims: Sequence[FieldClaim], *, force: bool) -> list[Path]:
    """Write field.md and field.json into a folder and return their paths."""
    from rubnoise.storage.output import whole_file

    contents = json.dumps({"claims": [row_as_json(claim) for claim in claims]}, indent=1)
    paths = [folder / name for name in _FILES]
    for path, text in zip(paths, ("\n".join(page(claims)), contents), strict=True):
        with whole_file(path, force=force) as part:
            part.write_text(f"{text}\n", encoding="utf-8")
    return paths


def _number(value: float | None) -> float | None:
    return value if value is not None and isfinite(value) else None


def _numbers(quantity: Quantity) -> str:
    label = quantity.name + (f" ({quantity.unit})" if quantity.unit else "")
    low, high = quantity.simulated.interval
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.4g}"
    return table_row(
        f"  {label:<{_LABEL}}", f"{exact:>9} {f'{quantity.simulated.value:.4g} +- {0.5 * (high - low):.1g}':>20}"
    )
