"""`rubnoise compare`: the rows of a result compared with the theory of its scenario."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING, Annotated

import typer

from rubnoise.answer import Row, printable
from rubnoise.cli.layout import show
from rubnoise.cli.options import AsJson, ResultFile
from rubnoise.errors import NotPassed, Refused

if TYPE_CHECKING:
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
        title = f"{file}: compared with the theory of its scenario"
        show(replace(found, title=title, rows=(*found.rows, *_white_noise(model))), as_json=as_json)
    if found.outside:
        raise NotPassed(f"{printable(str(file))}: outside: {', '.join(found.outside)}")


def _white_noise(model: "Model") -> Iterator[Row]:
    """Yield what white noise of the same level at low frequency (Kilburn) would make of a one-way slider, if any."""
    from rubnoise.theory.ancestors import white_noise

    if model.is_two_way or model.separation is not None:
        return
    try:
        white = white_noise(model)
    except Refused:
        return
    for name, unit in (("displacement_std", "um"), ("velocity_std", "um/s")):
        yield Row(part="white_noise", name=name, value=white[name], unit=unit)
