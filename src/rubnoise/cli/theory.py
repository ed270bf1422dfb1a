"""`rubnoise theory`: exact values of a scenario without a run, as text, CSV, JSON or a picture."""

from pathlib import Path
from typing import Annotated

import typer

from rubnoise.cli.layout import show
from rubnoise.cli.options import AsCsv, AsJson, Changes, ReplacePlot, argument, flag, option
from rubnoise.cli.plot import check_picture, check_plot, write_picture
from rubnoise.errors import Refused


def theory(
    file: Annotated[Path, argument("FILE", "A scenario file, or a result.")],
    picture: Annotated[
        Path | None, argument("PICTURE", "The file of --plot; default: FILE_theory.png, in this folder.")
    ] = None,
    *,
    changes: Changes = None,
    wavenumbers: Annotated[
        list[str] | None, option("K,...", "Wavenumbers of the spectrum, in rad/um.", "--at-wavenumber")
    ] = None,
    lags: Annotated[list[str] | None, option("S,...", "Lags of the autocovariance, in um.", "--at-lag")] = None,
    areas: Annotated[list[str] | None, option("A,...", "Areas of the distribution, in um^2.", "--at-area")] = None,
    distances: Annotated[
        list[str] | None, option("S,...", "Distances for the means after an empty start, in um.", "--at-distance")
    ] = None,
    segment: Annotated[
        int | None, option("N", "Add the expected result of Welch's method with segments of N ticks.", "--segment")
    ] = None,
    white: Annotated[bool, flag("Add white noise of the same level at low frequency (Kilburn).", "--white")] = False,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    plot: Annotated[bool, flag("Draw it into a png, pdf or svg file.", "--plot")] = False,
    force: ReplacePlot = False,
) -> None:
    """Print the exact values of a scenario.

    Moments, spectrum, autocovariance, distribution, and the response of the slider.

    Options add the rate at which the slider passes a level, the growth from an empty start, and the expected estimate
    of the spectrum.

    Example: rubnoise theory scenarios/paper/fig5.toml --at-wavenumber 0,0.1,1
    """
    from rubnoise.cli.loading import scenario_or_result
    from rubnoise.cli.theory_answer import places, theory_answer

    check_plot(picture, plot=plot, printed=as_csv or as_json, force=force)
    points_given = bool(wavenumbers or lags or areas or distances or segment is not None or white)
    if plot and points_given:
        raise typer.BadParameter("--plot draws curves; points are for numbers")
    picture = picture or Path(f"{file.stem}_theory.png")
    if plot:
        check_picture(picture, force=force, reads=[file])
    scenario = scenario_or_result(file, changes or (), quiet=as_json)
    model = scenario.model()
    if (plot or points_given) and model.slider is not None and model.slider.excitation == "velocity-weakening":
        raise Refused(f"{file}: a force that falls with speed has no noise, so there are no curves of it")
    if plot:
        from rubnoise.figures.theory import theory_figure

        write_picture(picture, lambda: theory_figure(model, file.name), force=force)
        return
    at = places({"wavenumber": wavenumbers, "lag": lags, "area": areas, "distance": distances})
    title = f"{file}: {scenario.title}".removesuffix(": ")
    answer = theory_answer(title, model, at, brief=not (as_csv or as_json), segment=segment, white=white)
    show(answer, as_json=as_json, as_csv=as_csv)
