"""`rubnoise theory`: exact values of a scenario without a run, as text, CSV, JSON or a picture."""

from pathlib import Path
from typing import Annotated

import typer

from rubnoise.cli.plot import check_picture, check_plot, write_picture
from rubnoise.cli.terminal import AsCsv, AsJson, Changes, ReplacePlot, argument, flag, option, show
from rubnoise.errors import Refused

Numbers = list[str] | None


def theory(
    file: Annotated[Path, argument("FILE", "A scenario file, or a result.")],
    picture: Annotated[
        Path | None, argument("PICTURE", "The file of --plot; default: FILE_theory.png, in this folder.")
    ] = None,
    *,
    changes: Changes = None,
    at_wavenumber: Annotated[Numbers, option("K,...", "Wavenumbers of the spectrum, in rad/um.")] = None,
    at_lag: Annotated[Numbers, option("S,...", "Lags of the autocovariance, in um.")] = None,
    at_area: Annotated[Numbers, option("A,...", "Areas of the distribution, in um^2.")] = None,
    at_distance: Annotated[Numbers, option("S,...", "Distances for the means after an empty start, in um.")] = None,
    segment: Annotated[
        int | None, option("N", "Add the expected result of Welch's method with segments of N ticks.")
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

    given = {"wavenumber": at_wavenumber, "lag": at_lag, "area": at_area, "distance": at_distance}
    asked = any(given.values()) or segment is not None or white
    check_plot(picture, plot=plot, printed=as_csv or as_json, force=force)
    if plot and asked:
        raise typer.BadParameter("--plot draws curves; points are for numbers")
    picture = picture or Path(f"{file.stem}_theory.png")
    if plot:
        check_picture(picture, force=force, reads=[file])
    scenario = scenario_or_result(file, changes or (), quiet=as_json)
    model = scenario.model()
    if (plot or asked) and model.slider is not None and model.slider.excitation == "velocity-weakening":
        raise Refused(f"{file}: a force that falls with speed has no noise, so there are no curves of it")
    if plot:
        from rubnoise.figures.theory import theory_figure

        write_picture(picture, theory_figure(model, file.name), force=force)
        return
    title = f"{file}: {scenario.title}".removesuffix(": ")
    at, brief = places(given), not (as_csv or as_json)
    answer = theory_answer(title, model, at, brief=brief, segment=segment, white=white)
    show(answer, as_json=as_json, as_csv=as_csv)
