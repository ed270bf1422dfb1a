"""`rubnoise theory`: what is exact about a scenario, without a run."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer


def command(
    file: Annotated[Path, typer.Argument(help="A scenario file, or a result.", metavar="FILE", show_default=False)],
    picture: Annotated[
        Path | None,
        typer.Argument(
            help="The file of --plot; default: FILE_theory.png, in this folder.", metavar="PICTURE", show_default=False
        ),
    ] = None,
    *,
    changes: Annotated[
        list[str] | None, typer.Option("--set", help="Change a key, as for run.", metavar="KEY=VALUE")
    ] = None,
    wavenumbers: Annotated[
        list[str] | None,
        typer.Option("--at-wavenumber", help="Wavenumbers of the spectrum, in rad/um.", metavar="K,..."),
    ] = None,
    lags: Annotated[
        list[str] | None, typer.Option("--at-lag", help="Lags of the autocovariance, in um.", metavar="S,...")
    ] = None,
    areas: Annotated[
        list[str] | None, typer.Option("--at-area", help="Areas of the distribution, in um^2.", metavar="A,...")
    ] = None,
    levels: Annotated[
        list[str] | None,
        typer.Option("--at-level", help="Levels for the slider's upward passages, in um.", metavar="X,..."),
    ] = None,
    distances: Annotated[
        list[str] | None,
        typer.Option("--at-distance", help="Distances for the means after an empty start, in um.", metavar="S,..."),
    ] = None,
    segment: Annotated[
        int | None,
        typer.Option(
            "--segment", help="Add the expected result of Welch's method with segments of N ticks.", metavar="N"
        ),
    ] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print CSV, one row per number.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    plot: Annotated[bool, typer.Option("--plot", help="Draw it into a png, pdf or svg file.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Let --plot replace a file.")] = False,
) -> None:
    """Print the exact values of a scenario: moments, spectrum, autocovariance, distribution, slider response.

    Options add the rate at which the slider passes a level, the growth from an empty start, and the expected estimate
    of the spectrum.

    Example: rubnoise theory scenarios/paper/fig5.toml --at-wavenumber 0,0.1,1
    """
    import json

    from rubnoise.cli import theory_answer, theory_text
    from rubnoise.cli.loading import scenario_or_result
    from rubnoise.cli.pictures import check_picture, write_picture
    from rubnoise.cli.theory_points import Points

    if as_csv + as_json + plot > 1:
        raise typer.BadParameter("only one of --csv, --json and --plot")
    if not plot and (picture is not None or force):
        raise typer.BadParameter(f"{picture or '--force'} is for --plot")
    if plot and (wavenumbers or lags or areas or levels or distances or segment is not None):
        raise typer.BadParameter("--plot draws curves; points are for numbers")
    if plot:
        picture = picture or Path(f"{file.stem}_theory.png")
        check_picture(picture, force=force)
    scenario = scenario_or_result(file, changes or (), quiet=as_json)
    model = scenario.model()
    if plot and picture is not None:
        from rubnoise.figures.theory import theory_picture

        write_picture(picture, lambda kind: theory_picture(model, scenario.title or file.stem, kind), force=force)
        return
    brief = not (as_csv or as_json)
    points = Points.of(
        model,
        wavenumbers=wavenumbers,
        lags=lags,
        areas=areas,
        levels=levels,
        distances=distances,
        brief=brief,
    )
    answer = theory_answer.answered(model, points, segment)
    if as_json:
        print(json.dumps(answer))
    else:
        heading = f"{file}: {scenario.title}".removesuffix(": ")
        told = partial(theory_text.described, heading, model.calibration, two_way=model.is_two_way)
        lines = theory_text.rows(answer) if as_csv else told(answer)
        print("\n".join(lines))
