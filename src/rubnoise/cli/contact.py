"""`rubnoise contact`: real contact area and number of contacts of a rough surface under a load."""

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from rubnoise.cli.layout import json_text, line, number, remark, sentence
from rubnoise.cli.options import AsJson
from rubnoise.errors import Refused


class Heights(StrEnum):
    """Laws of the heights of asperities."""

    GAUSSIAN = "gaussian"
    EXPONENTIAL = "exponential"


class Regime(StrEnum):
    """How asperities give way."""

    ELASTIC = "elastic"
    PLASTIC = "plastic"


def command(
    *,
    radius: Annotated[str, typer.Option(help="Radius of asperities.", metavar="R")],
    height: Annotated[str, typer.Option(help="Scale of their heights.", metavar="S")],
    density: Annotated[str, typer.Option(help="Asperities per area, as in 300 1/mm^2.", metavar="ETA")],
    modulus: Annotated[str, typer.Option(help="Elastic modulus E* of both sides, plane strain.", metavar="E")],
    load: Annotated[str | None, typer.Option(help="Normal load.", metavar="W")] = None,
    separation: Annotated[str | None, typer.Option(help="Separation of the mean planes.", metavar="H")] = None,
    nominal_area: Annotated[str, typer.Option(help="Nominal area.", metavar="A")] = "1 mm^2",
    hardness: Annotated[str | None, typer.Option(help="Hardness of the softer side.", metavar="H")] = None,
    heights: Annotated[Heights, typer.Option(help="Law of heights.", metavar="LAW")] = Heights.GAUSSIAN,
    regime: Annotated[Regime, typer.Option(help="elastic or plastic.", metavar="REGIME")] = Regime.ELASTIC,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Write [interface] into a file, for scenarios to extend.", metavar="FILE"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Work out the static contact of a rough surface with a smooth one (Greenwood and Williamson).

    Example: rubnoise contact --radius '50 um' --height '0.5 um' --density '300 1/mm^2' --modulus '100 GPa' --load '1 N'
    """
    from rubnoise.scenario.document import AREAS, COUNTS
    from rubnoise.storage.output import whole_file
    from rubnoise.theory.asperities import greenwood_williamson

    found = greenwood_williamson(
        radius=radius,
        height=height,
        density=density,
        modulus=modulus,
        load=load,
        separation=separation,
        nominal_area=nominal_area,
        hardness=hardness,
        heights=heights.value,
        regime=regime.value,
    )
    if found.junction_count < COUNTS.low or found.real_contact_area < AREAS.low:
        given = f"--load {load}" if separation is None else f"--separation {separation}"
        few = f"{number(found.junction_count)} contacts of {number(found.real_contact_area)} um^2 in all"
        hint = "larger" if separation is None else "smaller"
        raise Refused(f"{given}: leaves {few}, too few for a scenario; take a {hint} one")
    if output is not None:
        with whole_file(output, force=False) as part:
            part.write_text(f"format = 1\n\n{found.interface()}", encoding="utf-8", newline="\n")
    if as_json:
        print(json_text(asdict(found) | {"interface": found.interface()}))
        return
    index = "not known without a hardness" if found.plasticity_index is None else number(found.plasticity_index)
    lines = [
        sentence(f"static contact of {heights.value} heights, {regime.value}, on {nominal_area}"),
        line("separation", f"{number(found.separation)} um"),
        line("load", f"{number(found.load)} uN"),
        line("real contact area", f"{number(found.real_contact_area)} um^2"),
        line("contacts", number(found.junction_count)),
        line("mean pressure", f"{number(found.mean_pressure)} MPa"),
        line("plasticity index", f"{index} (elastic below 0.6, plastic above 1)"),
        remark("note: the contact is static; sliding changes it"),
        "",
        found.interface().rstrip(),
    ]
    print("\n".join(lines))
