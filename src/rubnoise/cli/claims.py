"""`rubnoise claims`: the claims of the paper, tested by simulation and by theory."""

from collections.abc import Sequence
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rubnoise.cli.layout import json_text, remark, table_row
from rubnoise.cli.options import AsJson
from rubnoise.cli.progress import StatusLine, on_terminal

if TYPE_CHECKING:
    from rubnoise.claims.claim import Claim, ClaimedNumber
    from rubnoise.claims.field import FieldClaim

_LABEL = 38


def command(
    *,
    field: Annotated[
        bool, typer.Option("--field", help="Show the published laws of the field instead of the paper's claims.")
    ] = False,
    folder: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="With --field: folder for field.md and field.json.", metavar="DIR"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace field.md and field.json.")] = False,
    as_json: AsJson = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Show no progress.")] = False,
) -> None:
    """Test every claim of the paper: its words, the numbers simulated and exact, and the verdict.

    With --field, compare published laws of rubbing with the model. All runs use fixed seeds, and take less than a
    minute. Exit code 3 if simulation and theory disagree.

    Example: rubnoise claims
    """
    if field:
        _field(folder, force=force, as_json=as_json, quiet=quiet)
    elif folder is not None or force:
        raise typer.BadParameter("-o and --force need --field")
    else:
        _paper(as_json=as_json, quiet=quiet)


def _paper(*, as_json: bool, quiet: bool) -> None:
    from rubnoise.claims.catalogue import evaluate_claims
    from rubnoise.claims.claim import Verdict

    with StatusLine(shown=on_terminal() and not quiet) as status:
        claims = evaluate_claims(status.show)
    print(
        json_text({"claims": [claim_as_json(claim) for claim in claims]})
        if as_json
        else "\n".join(format_claims(claims))
    )
    if any(claim.verdict is Verdict.UNSETTLED for claim in claims):
        raise typer.Exit(3)


def _field(folder: Path | None, *, force: bool, as_json: bool, quiet: bool) -> None:
    import sys

    from rubnoise.claims.catalogue import disagreeing, evaluate_field

    if folder is not None:
        check_places(folder, force=force)
    with StatusLine(shown=on_terminal() and not quiet) as status:
        claims = evaluate_field(status.show)
    if as_json:
        print(json_text({"claims": [row_as_json(claim) for claim in claims]}))
    elif folder is None:
        print("\n".join(format_ledger(claims)))
    if wrong := disagreeing(claims):
        print(f"rubnoise: simulation and theory disagree: {', '.join(wrong)}", file=sys.stderr)
        raise typer.Exit(3)
    if folder is not None:
        for path in write_ledger(folder, claims, force=force):
            if not (as_json or quiet):
                print(path)


def claim_as_json(claim: "Claim") -> dict[str, Any]:
    """Return a claim by name, numbers in the unit of each quantity."""
    return {
        "name": claim.name,
        "where": claim.where,
        "says": claim.says,
        "quantities": [_quantity(quantity) for quantity in claim.quantities],
        "verdict": claim.verdict.value,
        "because": claim.because,
        "scenario": claim.scenario,
    }


def _quantity(quantity: "ClaimedNumber") -> dict[str, Any]:
    low, high = quantity.simulated.interval
    return {
        "name": quantity.name,
        "unit": quantity.unit,
        "printed": quantity.printed,
        "simulated": {"value": quantity.simulated.value, "low": low, "high": high, "runs": quantity.simulated.runs},
        "exact": quantity.exact,
        "agree": quantity.agrees,
    }


def format_claims(claims: tuple["Claim", ...]) -> list[str]:
    """Return all claims as lines to print."""
    lines = []
    for claim in claims:
        lines += [f"{claim.where}: {claim.verdict.value}", remark(claim.says)]
        lines += [table_row(f"  {'':<{_LABEL}}", f"{'printed':>8} {'simulated (95 %)':>20} {'exact':>9}")]
        lines += [line for quantity in claim.quantities for line in _lines(quantity)]
        lines += [remark(claim.because), ""]
    return lines[:-1]


def _lines(quantity: "ClaimedNumber") -> list[str]:
    label = quantity.name + (f" ({quantity.unit})" if quantity.unit else "")
    printed = "" if quantity.printed is None else f"{quantity.printed:g}"
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.4g}"
    numbers = f"{printed:>8} {_with_interval(quantity):>20} {exact:>9}"
    if len(label) < _LABEL:
        return [table_row(f"  {label:<{_LABEL}}", numbers)]
    return [f"  {label}", table_row(f"  {'':<{_LABEL}}", numbers)]


def _with_interval(quantity: "ClaimedNumber") -> str:
    low, high = quantity.simulated.interval
    return f"{quantity.simulated.value:.4g} +- {0.5 * (high - low):.1g}"


_FIELD_LABEL = 46
_FILES = ("field.md", "field.json")


def row_as_json(claim: "FieldClaim") -> dict[str, Any]:
    """Return a row by name, numbers in the unit of its quantity; None if there is no number."""
    quantity = claim.quantity
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
        "published": claim.published or (None, None),
        "exact": None if quantity is None else quantity.exact,
        "simulated": None if quantity is None else quantity.simulated.value,
        "interval": interval,
        "verdict": claim.verdict.value,
        "because": claim.because,
        "scenario": claim.scenario,
    }


def format_ledger(claims: Sequence["FieldClaim"]) -> list[str]:
    """Return all rows as lines to print."""
    from rubnoise.claims.field_page import as_range

    lines = []
    for claim in claims:
        verdict = f"{claim.verdict.value} ({claim.source.known.value})"
        lines += [f"{claim.id}: {verdict}", remark(f"{claim.source.name}. {claim.statement}")]
        if claim.quantity is not None:
            lines += [table_row(f"  {'':<{_FIELD_LABEL}}", f"{'exact':>9} {'simulated (95 %)':>20}")]
            lines += [_numbers(claim.quantity)]
        if claim.published is not None:
            lines += [remark(f"Published: {as_range(claim.published)}.")]
        lines += [remark(claim.because), ""]
    return lines[:-1]


def check_places(folder: Path, *, force: bool) -> None:
    """Raise OutputRefused, before any run, if the page may not or cannot be written."""
    from rubnoise.storage.output import check_output

    for name in _FILES:
        check_output(folder / name, force=force)


def write_ledger(folder: Path, claims: Sequence["FieldClaim"], *, force: bool) -> list[Path]:
    """Write field.md and field.json into a folder and return their paths."""
    from rubnoise.claims.field_page import page
    from rubnoise.storage.output import whole_file

    contents = json_text({"claims": [row_as_json(claim) for claim in claims]}, indent=1)
    paths = [folder / name for name in _FILES]
    for path, text in zip(paths, ("\n".join(page(claims)), contents), strict=True):
        with whole_file(path, force=force) as part:
            part.write_text(f"{text}\n", encoding="utf-8")
    return paths


def _numbers(quantity: "ClaimedNumber") -> str:
    label = quantity.name + (f" ({quantity.unit})" if quantity.unit else "")
    exact = "" if isnan(quantity.exact) else f"{quantity.exact:.4g}"
    return table_row(f"  {label:<{_FIELD_LABEL}}", f"{exact:>9} {_with_interval(quantity):>20}")
