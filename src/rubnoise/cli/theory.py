"""`rubnoise theory`: exact values of a scenario without a run, as text, CSV, JSON or a picture."""

import json
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from rubnoise.cli.layout import ONE_WAY_ALONE, line, number, printable, remark, sentence
from rubnoise.cli.load import format_load
from rubnoise.cli.options import AsJson, Changes
from rubnoise.cli.plot import check_picture, write_picture


def command(
    file: Annotated[Path, typer.Argument(help="A scenario file, or a result.", metavar="FILE", show_default=False)],
    picture: Annotated[
        Path | None,
        typer.Argument(
            help="The file of --plot; default: FILE_theory.png, in this folder.", metavar="PICTURE", show_default=False
        ),
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
    white: Annotated[
        bool, typer.Option("--white", help="Add white noise of the same level at low frequency (Kilburn).")
    ] = False,
    as_csv: Annotated[bool, typer.Option("--csv", help="Print CSV, one row per number.")] = False,
    as_json: AsJson = False,
    plot: Annotated[bool, typer.Option("--plot", help="Draw it into a png, pdf or svg file.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Let --plot replace a file.")] = False,
) -> None:
    """Print the exact values of a scenario: moments, spectrum, autocovariance, distribution, slider response.

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
    if plot and (wavenumbers or lags or areas or levels or distances or segment is not None or white):
        raise typer.BadParameter("--plot draws curves; points are for numbers")
    if plot:
        picture = picture or Path(f"{file.stem}_theory.png")
        check_picture(picture, force=force)
    scenario = scenario_or_result(file, changes or (), quiet=as_json)
    model = scenario.model()
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
        levels=levels,
        distances=distances,
        brief=brief,
    )
    answer = theory_answer.theory_as_json(model, points, segment, white=white)
    if as_json:
        print(json.dumps(answer))
    else:
        heading = f"{file}: {scenario.title}".removesuffix(": ")
        lines_of = partial(format_theory, heading, model.calibration, two_way=model.is_two_way)
        lines = csv_rows(answer) if as_csv else lines_of(answer)
        print("\n".join(lines))


COLUMN: Final = 19
LINES_SHOWN: Final = 6
BINS_SHOWN: Final = 8
GUIDE_SKEWNESS: Final = 0.45
"""Of the displacement: up to there the series for passages was compared with the exact law."""

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
    "spectrum.wavenumber": "rad/um",
    "spectrum.density": "um^4/(rad/um)",
    "spectral_lines.wavenumber": "rad/um",
    "spectral_lines.power": "um^4",
    "autocovariance.lag": "um",
    "autocovariance.value": "um^4",
    "estimated_spectrum.wavenumber": "rad/um",
    "estimated_spectrum.density": "um^4/(rad/um)",
    "estimated_spectrum.standard_error": "um^4/(rad/um)",
    "crossings.level": "um",
    "crossings.rate": "1/s",
    "crossings.gaussian_rate": "1/s",
    "from_empty.distance": "um",
    "from_empty.area_mean": "um^2",
    "from_empty.run_area_mean": "um^2",
    "load.contact_resonance": "Hz",
    "load.separation_std": "um",
    "load.velocity_std": "um/s",
    "load.velocity_level": "dB",
    "load.load_std": "uN",
    "third_octaves.frequency": "Hz",
    "third_octaves.velocity": "um/s",
    "third_octaves.level": "dB",
    "distribution.area": "um^2",
    "distribution.density": "1/um^2",
    **{
        f"load_covariances.{one}*{other}": f"{of_one}*{of_other}"
        for one, of_one in COVARYING.items()
        for other, of_other in COVARYING.items()
    },
}
"""Units by the path of a field; what is not here is a plain number, but for cumulants, each of its own unit."""

OTHER_MODELS: Final = {
    "base_excitation": "excitation by the base (Rice and Moslehy)",
    "velocity_weakening": "a force that falls with speed (Block; Oden and Martins)",
    "white_noise": "white noise of the same level at low frequency (Kilburn)",
}
"""Groups of older models, and what they are called."""

CURVES: Final = {
    "spectrum": "wavenumber",
    "spectral_lines": "wavenumber",
    "autocovariance": "lag",
    "distribution": "area",
    "estimated_spectrum": "wavenumber",
    "crossings": "level",
    "from_empty": "distance",
    "third_octaves": "frequency",
}
"""Groups that are curves, and the field that holds their abscissas."""


def format_theory(heading: str, calibration: str, answer: dict[str, Any], *, two_way: bool) -> list[str]:
    """Return what theory says, as lines to print under a heading."""
    return [
        sentence(printable(heading)),
        "",
        *_moment_lines(calibration, answer),
        *_slider_lines(answer.get("slider"), two_way=two_way),
        *(format_load(answer["load"]) if "load" in answer else ()),
        *_other_lines(answer),
        *_curve_lines(answer),
    ]


def _moment_lines(calibration: str, answer: dict[str, Any]) -> Iterator[str]:
    count, sizes = answer["count"], answer["diameter"]
    yield line("mean diameter d_m", f"{_shown(sizes['calibrated'])} um (calibration {calibration})")
    yield line("diameters as drawn", f"mean {_shown(sizes['mean'])} um")
    yield line("of those found alive", f"mean {_shown(sizes['length_biased_mean'])} um")
    yield line("junction count", f"mean {_shown(count['mean'])}, variance {_shown(count['variance'])}")
    for name, label, unit in (("area", "real contact area", "um^2"), ("force", "friction force", "uN")):
        if name in answer:
            yield from _cumulant_lines(label, unit, answer[name])


def _cumulant_lines(label: str, unit: str, group: dict[str, Any]) -> Iterator[str]:
    yield line(label, f"mean {_shown(group['mean'])}, std {_shown(group['std'])} {unit}")
    yield line("", f"skewness {_shown(group['skewness'])}, excess kurtosis {_shown(group['excess_kurtosis'])}")


def _slider_lines(slider: dict[str, Any] | None, *, two_way: bool) -> Iterator[str]:
    if slider is None:
        return
    place = f"mean {_shown(slider['displacement_mean'])}, std {_shown(slider['displacement_std'])} um"
    yield line("displacement", place)
    yield line("velocity", f"std {_shown(slider['velocity_std'])} um/s")
    from rubnoise.cli.derivation import format_coupling

    yield from format_coupling(slider, two_way=two_way)
    if two_way:
        yield remark(f"note: {ONE_WAY_ALONE}")


def _other_lines(answer: dict[str, Any]) -> Iterator[str]:
    """Yield what older models of the family say: a name, a value and its unit in each line."""
    for group in OTHER_MODELS:
        fields = answer.get(group, {})
        if fields:
            yield from ("", sentence(OTHER_MODELS[group]))
        for name, value in fields.items():
            shown = ("yes" if value else "no") if isinstance(value, bool) else _shown(value)
            yield line(name.replace("_", " "), f"{shown} {UNITS.get(f'{group}.{name}', '')}".rstrip())


def _curve_lines(answer: dict[str, Any]) -> Iterator[str]:
    spectrum, covariance, law = answer["spectrum"], answer["autocovariance"], answer.get("distribution")
    yield from _table_lines(
        "spectral density of the area, two-sided",
        {"k (rad/um)": spectrum["wavenumber"], "S (um^4/(rad/um))": spectrum["density"]},
    )
    if "spectral_lines" in answer:
        k, power = (answer["spectral_lines"][name][:LINES_SHOWN] for name in ("wavenumber", "power"))
        yield from _table_lines("and the first of its lines", {"k (rad/um)": k, "power (um^4)": power})
    yield from _table_lines(
        "autocovariance of the area", {"lag (um)": covariance["lag"], "R (um^4)": covariance["value"]}
    )
    if "third_octaves" in answer:
        heard = answer["third_octaves"]
        yield from _table_lines(
            "normal velocity in third octaves",
            {"f (Hz)": heard["frequency"], "rms (um/s)": heard["velocity"], "dB re 50 nm/s": heard["level"]},
        )
    yield from _estimated_lines(answer.get("estimated_spectrum"))
    yield from _crossing_lines(answer.get("crossings"))
    yield from _growth_lines(answer.get("from_empty"))
    if law is not None:
        yield from _table_lines(
            f"distribution of the area, which is 0 with probability {_shown(law['atom_at_zero'])}",
            {"area (um^2)": law["area"], "density (1/um^2)": law["density"], "P(A_r <= area)": law["cdf"]},
        )


def _estimated_lines(seen: dict[str, Any] | None) -> Iterator[str]:
    """Yield some of the bins of an estimate, evenly spaced in the logarithm of the wavenumber."""
    if seen is None:
        return
    bins = len(seen["wavenumber"])
    import numpy as np

    shown = sorted({0, *(round(each) for each in np.geomspace(1, bins - 1, BINS_SHOWN))})
    columns = {"k (rad/um)": "wavenumber", "S (um^4/(rad/um))": "density", "std error": "standard_error"}
    cut = f"{seen['segments']} segments of {seen['ticks']} ticks"
    yield from _table_lines(
        f"what Welch's method shows with {cut}; {len(shown)} of {bins} bins",
        {label: [seen[name][n] for n in shown] for label, name in columns.items() if name in seen},
    )


def _crossing_lines(passed: dict[str, Any] | None) -> Iterator[str]:
    if passed is None:
        return
    skewness = passed["displacement_skewness"]
    yield from _table_lines(
        f"passages of the displacement upwards, whose skewness is {_shown(skewness)}",
        {"level (um)": passed["level"], "rate (1/s)": passed["rate"], "if Gaussian (1/s)": passed["gaussian_rate"]},
    )
    if abs(skewness) > GUIDE_SKEWNESS:
        yield remark(f"note: beyond a skewness of {GUIDE_SKEWNESS} these rates are a guide alone")


def _growth_lines(grown: dict[str, Any] | None) -> Iterator[str]:
    if grown is None:
        return
    over = f"{_shown(grown['run_area_mean'])} um^2 and {_shown(grown['run_count_mean'])} junctions"
    yield from _table_lines(
        f"means after an empty start; over the whole run {over}",
        {"distance (um)": grown["distance"], "area (um^2)": grown["area_mean"], "junctions": grown["count_mean"]},
    )


def _table_lines(heading: str, columns: dict[str, Sequence[float | None]]) -> Iterator[str]:
    yield from ("", sentence(heading))
    yield "  " + "".join(f"{name:>{COLUMN}}" for name in columns)
    for row in zip(*columns.values(), strict=True):
        yield "  " + "".join(f"{_shown(value):>{COLUMN}}" for value in row)


def _shown(value: float | None) -> str:
    return "none" if value is None else number(value)


def csv_rows(answer: dict[str, Any]) -> Iterator[str]:
    """Return a heading and a row a number: its name, where it is taken and in which unit, its value and its unit.

    Numbers are to their last bit; a value that is not finite is left empty.
    """
    yield "quantity,at,at_unit,value,unit"
    for group, fields in answer.items():
        at = CURVES.get(group)
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
