"""`rubnoise compare`: the rows of a result compared with the theory of its scenario."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rubnoise.analysis.agreement import FAMILY_WISE_ERROR, as_json
from rubnoise.cli.layout import FIGURE_HEADS, agreement_row, json_text, printable, remark, table_row
from rubnoise.cli.options import AsJson, ResultFile
from rubnoise.errors import Refused, RunOutside

if TYPE_CHECKING:
    from rubnoise.analysis.findings import Comparison, Identity
    from rubnoise.model import Model


def command(
    file: ResultFile,
    *,
    bound: Annotated[
        float | None,
        typer.Option(
            help="Largest |z| of a figure that agrees; default: the family-wise bound of all figures.", metavar="Z"
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compare the rows of a result with exact theory.

    The exit code is 3 if a value is outside.

    Example: rubnoise compare fig5.h5
    """
    from rubnoise.analysis.comparison import compare
    from rubnoise.analysis.records import RecordTooShort
    from rubnoise.cli.loading import finished_run
    from rubnoise.scenario.reading import stored

    if bound is not None and not (isfinite(bound) and bound > 0.0):
        raise typer.BadParameter(f"--bound: {bound} is no bound on |z|; it is a number above 0")
    with finished_run(file) as run:
        try:
            model = stored(run.provenance["scenario_resolved"]).model()
            found = compare(model, run, bound)
        except RecordTooShort as refusal:
            raise Refused(str(refusal)) from refusal
        white = _white_noise(model)
        if as_json:
            print(json_text(comparison_as_json(found, file) | ({} if white is None else {"white_noise": white})))
        else:
            print("\n".join(format_comparison(found, file)))
            if white is not None and isfinite(white["displacement_std"]):
                stds = f"{white['displacement_std']:.4g} um and {white['velocity_std']:.4g} um/s"
                print(remark(f"white noise of the same level at low frequency (Kilburn) would leave std of {stds}"))
    if found.outside:
        raise RunOutside(f"{printable(str(file))}: outside: {', '.join(found.outside)}")


def comparison_as_json(found: "Comparison", file: Path) -> dict[str, Any]:
    """Return a comparison by name."""
    identities = {
        each.name: {"deviation": each.deviation, "allowed": each.allowed, "holds": each.holds}
        for each in found.identities
    }
    return {
        "file": str(file),
        "agrees": not found.outside,
        "outside": list(found.outside),
        "bound": found.bound,
        "family_wise_error": FAMILY_WISE_ERROR if found.by_family else None,
        "begins": {part.heading: part.begins for part in found.parts if part.figures},
        "figures": as_json(found.figures),
        "identities": identities,
        "left_out": found.left_out,
    }


def _white_noise(model: "Model") -> dict[str, float] | None:
    """Return Kilburn's white noise beside a one-way slider, by name; None if the contact drives none."""
    from rubnoise.theory.ancestors import white_noise

    if model.is_two_way or model.separation is not None:
        return None
    try:
        white = white_noise(model)
    except Refused:
        return None
    return {"displacement_std": white.displacement_std, "velocity_std": white.velocity_std}


SHORTER = {
    "junction_count_zero_share": "share without contact",
    "real_contact_area_autocovariance_": "area autocovariance ",
    "real_contact_area": "area",
    "junction_count": "count",
    "friction_force": "force",
    "spectrum_": "power, k ",
    "kolmogorov": "Kolmogorov D",
}


def format_comparison(found: "Comparison", file: Path) -> Iterator[str]:
    """Yield a table for each part, the identities, the figures left out, and the verdict."""
    yield f"{printable(str(file))}: compared with the theory of its scenario"
    for part in found.parts:
        if part.figures:
            heading = f"{part.heading}, from {part.begins:.4g} um on" if part.begins else part.heading
            yield ""
            yield table_row(f"{heading:<34}", f"{FIGURE_HEADS} ")
        for figure in part.figures:
            mark = "*" if figure.name in found.outside else " "
            yield agreement_row(label(figure.name), figure, width=32, score=_score, mark=mark)
    if found.identities:
        yield ""
        yield table_row(f"{'exact but for rounding':<34}", f"{'off by':>13}{'allowed':>14}  ")
        yield from map(_identity, found.identities)
    if found.omitted:
        yield "\nleft out"
        yield from (remark(f"{label(each.name)}: {each.reason}") for each in found.omitted)
    yield ""
    yield from format_verdict(found)


def format_verdict(found: "Comparison") -> list[str]:
    """Return the number of figures within the bound, the bound, and the number of identities that hold."""
    scored = sum(figure.z is not None for figure in found.figures)
    whence = f", which all keep in {1.0 - FAMILY_WISE_ERROR:.1%} of right runs" if found.by_family else ""
    broken = sum(not each.holds for each in found.identities)
    beyond = len(found.outside) - broken
    figures = remark(f"{scored - beyond} of {scored} figures are within |z| <= {found.bound:.2f}{whence}")
    identities = remark(f"{len(found.identities) - broken} of {len(found.identities)} identities hold")
    return [figures, identities] if scored else [identities]


def label(name: str) -> str:
    """Return a name as words, shortened if it is long."""
    for long, short in SHORTER.items():
        name = name.replace(long, short)
    return name.replace("_", " ")


def _score(z: float) -> str:
    """Return a score in at most six characters."""
    return f"{z:+.2f}" if abs(z) < 99.995 else f"{z:+.0f}" if abs(z) < 99_999.5 else f"{z:+.0e}"


def _identity(each: "Identity") -> str:
    name = label(each.name) + (f" ({each.units})" if each.units else "")
    return table_row(f"  {name:<32}", f"{each.deviation:>13.3g}{each.allowed:>14.3g}{'  ' if each.holds else ' *'}")
