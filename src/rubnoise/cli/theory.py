"""`rubnoise theory`: exact values of a scenario without a run, as text, CSV, JSON or a picture."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.cli.layout import (
    ONE_WAY_ALONE,
    LineWords,
    json_text,
    line,
    lines,
    plain,
    printable,
    remark,
    sentence,
    words,
)
from rubnoise.cli.load import format_load, load_notes
from rubnoise.cli.options import AsJson, Changes, ReplacePlot
from rubnoise.cli.plot import check_picture, write_picture
from rubnoise.errors import Refused

if TYPE_CHECKING:
    from rubnoise.model import Model


def command(
    file: Annotated[Path, typer.Argument(help="A scenario file, or a result.", metavar="FILE")],
    picture: Annotated[
        Path | None,
        typer.Argument(help="The file of --plot; default: FILE_theory.png, in this folder.", metavar="PICTURE"),
    ] = None,
    *,
    changes: Changes = None,
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
    white: Annotated[
        bool, typer.Option("--white", help="Add white noise of the same level at low frequency (Kilburn).")
    ] = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print CSV, one row per number.")] = False,
    as_json: AsJson = False,
    plot: Annotated[bool, typer.Option("--plot", help="Draw it into a png, pdf or svg file.")] = False,
    force: ReplacePlot = False,
) -> None:
    """Print the exact values of a scenario.

    Moments, spectrum, autocovariance, distribution, and the response of the slider.

    Options add the rate at which the slider passes a level, the growth from an empty start, and the expected estimate
    of the spectrum.

    Example: rubnoise theory scenarios/paper/fig5.toml --at-wavenumber 0,0.1,1
    """
    from rubnoise.cli import theory_answer
    from rubnoise.cli.loading import scenario_or_result
    from rubnoise.cli.theory_answer import Points

    if as_csv + as_json + plot > 1:
        raise typer.BadParameter("only one of --csv, --json and --plot")
    if not plot and (picture is not None or force):
        raise typer.BadParameter(f"{picture or '--force'} is for --plot")
    points_given = bool(wavenumbers or lags or areas or distances or segment is not None or white)
    if plot and points_given:
        raise typer.BadParameter("--plot draws curves; points are for numbers")
    if plot:
        picture = picture or Path(f"{file.stem}_theory.png")
        check_picture(picture, force=force, reads=[file])
    scenario = scenario_or_result(file, changes or (), quiet=as_json)
    model = scenario.model()
    if (plot or points_given) and model.slider is not None and model.slider.excitation == "velocity-weakening":
        raise Refused(f"{file}: a force that falls with speed has no noise, so there are no curves of it")
    if plot and picture is not None:
        from rubnoise.figures.theory import theory_picture

        write_picture(picture, lambda kind: theory_picture(model, file.name, kind), force=force)
        return
    brief = not (as_csv or as_json)
    points = Points.of(
        model,
        wavenumbers=wavenumbers,
        lags=lags,
        areas=areas,
        distances=distances,
        brief=brief,
    )
    answer = theory_answer.theory_as_json(model, points, segment, white=white)
    if as_json:
        print(json_text(answer))
    else:
        heading = f"{file}: {scenario.title}".removesuffix(": ")
        text = partial(format_theory, heading, model)
        print("\n".join(csv_rows(answer) if as_csv else text(answer)))


COLUMN: Final = 19
LINES_SHOWN: Final = 6
BINS_SHOWN: Final = 8
GUIDE_SKEWNESS: Final = 0.45
"""Of the displacement: up to there the series for passages was compared with the exact law."""

MOMENTS: Final[tuple[LineWords, ...]] = (
    ("mean diameter d_m", "{diameter.calibrated} um (calibration {calibration})"),
    ("diameters as drawn", "mean {diameter.mean} um"),
    ("of those found alive", "mean {diameter.length_biased_mean} um"),
    ("junction count", "mean {count.mean}, variance {count.variance}{held}"),
    ("real contact area", "mean {area.mean}, std {area.std} um^2{held}"),
    ("", "skewness {area.skewness}, excess kurtosis {area.excess_kurtosis}"),
    ("friction force", "mean {force.mean}, std {force.std} uN{held}"),
    ("", "skewness {force.skewness}, excess kurtosis {force.excess_kurtosis}"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveTable:
    """A group that is a curve: its heading, and of each column name, label and unit; the first is the abscissa.

    Braces in a label stand for the unit.
    """

    heading: str
    columns: tuple[tuple[str, str, str], ...]


CURVES: Final = {
    "spectrum": CurveTable(
        heading="spectral density of the area, two-sided",
        columns=(("wavenumber", "k ({})", "rad/um"), ("density", "S ({})", "um^4/(rad/um)")),
    ),
    "spectral_lines": CurveTable(
        heading="and the first of its lines",
        columns=(("wavenumber", "k ({})", "rad/um"), ("power", "power ({})", "um^4")),
    ),
    "autocovariance": CurveTable(
        heading="autocovariance of the area",
        columns=(("lag", "lag ({})", "um"), ("value", "R ({})", "um^4")),
    ),
    "third_octaves": CurveTable(
        heading="normal velocity in third octaves",
        columns=(("frequency", "f ({})", "Hz"), ("velocity", "rms ({})", "um/s"), ("level", "dB re 50 nm/s", "dB")),
    ),
    "estimated_spectrum": CurveTable(
        heading="what Welch's method shows with {segments} segments of {ticks} ticks; {shown} of {bins} bins",
        columns=(
            ("wavenumber", "k ({})", "rad/um"),
            ("density", "S ({})", "um^4/(rad/um)"),
            ("standard_error", "std error", "um^4/(rad/um)"),
        ),
    ),
    "from_empty": CurveTable(
        heading="means after an empty start; over the whole run {run_area_mean} um^2 and {run_count_mean} junctions",
        columns=(
            ("distance", "distance ({})", "um"),
            ("area_mean", "area ({})", "um^2"),
            ("count_mean", "junctions", "1"),
        ),
    ),
    "distribution": CurveTable(
        heading="distribution of the area, which is 0 with probability {atom_at_zero}",
        columns=(("area", "area ({})", "um^2"), ("density", "density ({})", "1/um^2"), ("cdf", "P(A_r <= area)", "1")),
    ),
}
"""The curves of an answer, in the order in which they are shown."""

COVARYING: Final = {
    "separation": "um",
    "normal_velocity": "um/s",
    "load": "uN",
    "friction_force": "uN",
    "displacement": "um",
    "velocity": "um/s",
}
"""What moves under a load that weighs, and its unit."""

UNITS: Final = {
    "area.mean": "um^2",
    "area.std": "um^2",
    "force.mean": "uN",
    "force.std": "uN",
    "slider.displacement_mean": "um",
    "slider.displacement_std": "um",
    "slider.velocity_std": "um/s",
    "diameter.calibrated": "um",
    "diameter.mean": "um",
    "diameter.length_biased_mean": "um",
    "base_excitation.base_mean": "um",
    "base_excitation.base_std": "um",
    "base_excitation.displacement_std": "um",
    "base_excitation.velocity_std": "um/s",
    "velocity_weakening.mean_force": "uN",
    "velocity_weakening.border": "N*s/m",
    "velocity_weakening.mean_displacement": "um",
    "velocity_weakening.amplitude": "um",
    "velocity_weakening.slowest": "um/s",
    "velocity_weakening.fastest": "um/s",
    "velocity_weakening.period": "s",
    "white_noise.force_density": "uN^2*s",
    "white_noise.displacement_std": "um",
    "white_noise.velocity_std": "um/s",
    "white_noise.wavenumber": "rad/um",
    "from_empty.run_area_mean": "um^2",
    "load.contact_resonance": "Hz",
    "load.separation_std": "um",
    "load.velocity_std": "um/s",
    "load.velocity_level": "dB",
    "load.load_std": "uN",
    "load.load_mean": "uN",
    "load.area_mean": "um^2",
    "load.fast_area_mean": "um^2",
    "load.force_mean": "uN",
    "load.first_order_separation_std": "um",
    "load.first_order_velocity_std": "um/s",
    **{
        f"load_covariances.{one}*{other}": f"{of_one}*{of_other}"
        for one, of_one in COVARYING.items()
        for other, of_other in COVARYING.items()
    },
    **{f"{group}.{name}": unit for group, curve in CURVES.items() for name, _, unit in curve.columns},
}
"""Units by the path of a field; what is not here is a plain number, but for cumulants, each of its own unit."""

OTHER_MODELS: Final = {
    "base_excitation": "excitation by the base (Rice and Moslehy)",
    "velocity_weakening": "a force that falls with speed (Block; Oden and Martins)",
    "white_noise": "white noise of the same level at low frequency (Kilburn)",
}
"""Groups of older models, and what they are called."""


def format_theory(heading: str, model: "Model", answer: dict[str, Any]) -> Iterator[str]:
    """Yield the exact values, as lines to print under a heading."""
    from rubnoise.cli.derivation import MOTION, motion_warnings, words_of_model

    yield from (sentence(printable(heading)), "")
    yield from lines(answer | words_of_model(model), MOMENTS)
    if "slider" in answer:
        yield from lines(answer["slider"], MOTION)
        yield from [remark(f"note: {ONE_WAY_ALONE}")] if model.is_two_way else []
    if "load" in answer:
        yield from format_load(answer["load"])
        yield from (remark(f"note: {note}") for note in load_notes(answer["load"]))
    yield from (remark(f"warning: {warning}") for warning in motion_warnings(model, answer))
    for group, name in OTHER_MODELS.items():
        yield from ("", sentence(name)) if group in answer else ()
        for key, value in answer.get(group, {}).items():
            yield line(key.replace("_", " "), f"{plain(value)} {UNITS.get(f'{group}.{key}', '')}".rstrip())
    for group, curve in CURVES.items():
        if group in answer:
            yield from _curve_lines(group, curve, answer[group])


def _curve_lines(group: str, curve: CurveTable, answer: dict[str, Any]) -> Iterator[str]:
    """Yield a curve as a table; of lines and bins only some."""
    columns = {label.format(unit): answer[name] for name, label, unit in curve.columns if name in answer}
    rows = list(zip(*columns.values(), strict=True))
    shown = _shown_rows(group, len(rows))
    yield from ("", sentence(words(curve.heading, answer | {"shown": len(shown), "bins": len(rows)})))
    yield "  " + "".join(f"{label:>{COLUMN}}" for label in columns)
    for row in shown:
        yield "  " + "".join(f"{plain(value):>{COLUMN}}" for value in rows[row])
    if abs(answer.get("displacement_skewness", 0.0)) > GUIDE_SKEWNESS:
        yield remark(f"note: beyond a skewness of {GUIDE_SKEWNESS} these rates are a guide alone")


def _shown_rows(group: str, rows: int) -> Sequence[int]:
    """Return which rows of a curve are shown: the first lines, bins evenly in the logarithm of their number, or all."""
    if group == "spectral_lines":
        return range(min(rows, LINES_SHOWN))
    if group == "estimated_spectrum":
        import numpy as np

        return sorted({0, *(round(each) for each in np.geomspace(1, rows - 1, BINS_SHOWN))})
    return range(rows)


def csv_rows(answer: dict[str, Any]) -> Iterator[str]:
    """Return a heading and a row for each number: its name, its place with unit, its value and its unit.

    Numbers have all their digits; a value that is not finite is empty.
    """
    yield "quantity,at,at_unit,value,unit"
    for group, fields in answer.items():
        at = CURVES[group].columns[0][0] if group in CURVES else None
        for name, value in fields.items():
            path = f"{group}.{name}"
            if name == "cumulants":
                for order, each in enumerate(value, start=1):
                    yield _row(path, order, "order", each, _power(UNITS[f"{group}.mean"], order))
            elif isinstance(value, list) and name != at:
                for where, each in zip(fields[at], value, strict=True):
                    yield _row(path, where, UNITS[f"{group}.{at}"], each, UNITS.get(path, "1"))
            elif not isinstance(value, list | str):
                yield _row(path, "", "", value, UNITS.get(path, "1"))


def _power(unit: str, order: int) -> str:
    base, _, power = unit.partition("^")
    exponent = order * int(power or 1)
    return base if exponent == 1 else f"{base}^{exponent}"


def _row(*cells: Any) -> str:
    return ",".join("" if cell is None else str(cell) for cell in cells)
