"""`rubnoise surface --synthesise`: a self-affine surface from a seed, as a file that `rubnoise surface` reads."""

from pathlib import Path
from typing import Annotated

import typer

from rubnoise.answer import Answer, rows
from rubnoise.cli.layout import show
from rubnoise.cli.options import AsJson, ReplaceFile


def command(
    *,
    points: Annotated[int, typer.Option(help="Points a side.", metavar="N")] = 512,
    spacing: Annotated[str, typer.Option(help="Their distance.", metavar="LENGTH")] = "1 um",
    roughness: Annotated[str, typer.Option(help="Rms height.", metavar="LENGTH")] = "1 um",
    hurst: Annotated[float, typer.Option(help="Hurst exponent.", metavar="H")] = 0.8,
    rolloff: Annotated[
        str | None,
        typer.Option(help="Longest self-affine wave; default: a sixteenth of a side.", metavar="LENGTH"),
    ] = None,
    cutoff: Annotated[
        str | None, typer.Option(help="Shortest wave; default: five points long.", metavar="LENGTH")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of its random numbers.", metavar="N")] = 1,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="The file to write; default: surfaceSEED.nc.", metavar="FILE.nc"),
    ] = None,
    as_json: AsJson = False,
    force: ReplaceFile = False,
) -> None:
    """Make a self-affine surface, as a file that `rubnoise surface` reads.

    Equal arguments give equal bits.

    Example: rubnoise surface --synthesise --seed 2 -o slider.nc
    """
    from rubnoise.api.surface import Surface
    from rubnoise.storage.output import check_output

    path = output or Path(f"surface{seed}.nc")
    if path.suffix.lower() != ".nc":
        raise typer.BadParameter(f"{path} does not end in .nc, the form of file that --synthesise writes")
    check_output(path, force=force)
    made = Surface.synthesise(
        points=points, spacing=spacing, roughness=roughness, hurst=hurst, rolloff=rolloff, cutoff=cutoff, seed=seed
    )
    made.save(path, force=force)
    units, found = {"Sa": "um", "Sq": "um"}, made.roughness()
    told = rows("", ("surface", str(path)), ("digest", made.map.digest))
    rough = rows("roughness", *((name, value, units.get(name, "")) for name, value in found.items()))
    show(Answer(title=f"{path}: {made.map.history[0]}", rows=(*told, *rough)), as_json=as_json)
