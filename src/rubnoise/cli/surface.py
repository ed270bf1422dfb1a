"""`rubnoise surface`: from measured surfaces to the junctions that carry a load, and to the scenario of their noise."""

from collections.abc import Iterator
from contextlib import ExitStack
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from rubnoise.answer import printable
from rubnoise.cli.layout import json_text, line, number, remark, sentence
from rubnoise.cli.options import AsJson, ReplaceFiles
from rubnoise.errors import Refused, in_shell

if TYPE_CHECKING:
    from rubnoise.api.surface import Surface
    from rubnoise.surface.sliding import SlidingContact

Form = StrEnum("Form", "none tilt polynomial cylinder sphere")
"""Forms that can be removed."""

_SCENARIO: Final = ("speed", "distance", "mass", "damping_ratio")
"""Options of the scenario."""

_LAGS: Final = 200
_WAVES: Final = 120


def command(
    context: typer.Context,
    scans: Annotated[
        list[Path] | None, typer.Argument(help="A scan, or two: the track, then the slider.", metavar="SCAN [SCAN]")
    ] = None,
    *,
    cutoff: Annotated[str | None, typer.Option(help='Shortest wave that counts: "5 um".', metavar="LENGTH")] = None,
    load: Annotated[str | None, typer.Option(help='Load of the slider: "0.2 N".', metavar="FORCE")] = None,
    hardness: Annotated[str | None, typer.Option(help='Hardness of the softer: "1 GPa".', metavar="PRESSURE")] = None,
    longest: Annotated[
        str | None, typer.Option(help="Longest wave that counts; default: all.", metavar="LENGTH")
    ] = None,
    form: Annotated[
        Form, typer.Option(help="Form to remove: none, tilt, polynomial, cylinder, sphere.", metavar="FORM")
    ] = Form.tilt,
    unit: Annotated[str | None, typer.Option(help="Unit of a scan that names none: um.", metavar="UNIT")] = None,
    height_unit: Annotated[str | None, typer.Option(help="Unit of its heights, if another.", metavar="UNIT")] = None,
    size: Annotated[
        str | None, typer.Option(help='Size of a bare matrix: "128 um x 128 um".', metavar="LENGTHS")
    ] = None,
    channel: Annotated[str | None, typer.Option(help="Which map of a file with several.", metavar="NAME")] = None,
    turn: Annotated[bool, typer.Option("--turn", help="Slide along the second index of the scans.")] = False,
    slider_length: Annotated[
        str | None, typer.Option(help="Length of a slider longer than its scan.", metavar="LENGTH")
    ] = None,
    speed: Annotated[
        str | None, typer.Option(help='Sliding speed of the scenario: "10 mm/s".', metavar="SPEED")
    ] = None,
    distance: Annotated[
        str | None, typer.Option(help="Its sliding distance; default: 1000 mean lives.", metavar="LENGTH")
    ] = None,
    mass: Annotated[
        str | None, typer.Option(help="Let the slider rise and fall on its load: its mass.", metavar="MASS")
    ] = None,
    damping_ratio: Annotated[float | None, typer.Option(help="Damping ratio of this motion.", metavar="RATIO")] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Write the scenario.", metavar="FILE"),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write a page with maps and curves.", metavar="HTML")] = None,
    as_json: AsJson = False,
    force: ReplaceFiles = False,
    # Read before the command is chosen (`app.py`); here it is for --help alone.
    _synthesise: Annotated[
        bool,
        typer.Option(
            "--synthesise", help="Make a surface instead: surface --synthesise --help has the options of that."
        ),
    ] = False,
) -> None:
    """Find the junctions between two measured surfaces.

    How many of what size carry a load; the answer is a scenario too.

    Theory is exact for Gaussian surfaces with the measured spectra; beside it stands what is counted on the maps. The
    number of junctions depends on the cut-off, so that one has to be given.

    Example: rubnoise surface track.al3d slider.x3p --cutoff "5 um" --load "0.2 N" --hardness "1 GPa" -o scenario.toml
    """
    from rubnoise.api.surface import Surface
    from rubnoise.storage.output import check_output

    if output is None and report is None:
        _refuse_unused(context)
    for path in (output, report):
        if path is not None:
            check_output(path, force=force, reads=scans or ())
    if scans is None or len(scans) not in (1, 2):
        raise typer.BadParameter("one scan or two are needed: the track, then the slider")
    told: dict[str, Any] = {"unit": unit, "height_unit": height_unit, "size": size, "channel": channel, "turn": turn}
    surfaces = [Surface.read(path, form=form.value, **told) for path in scans]
    slider = surfaces[1] if len(surfaces) == 2 else None
    _ask_for_needed(surfaces[0], slider, cutoff, load, hardness, longest)
    contact = surfaces[0].slide(
        slider, cutoff=cutoff, load=load, hardness=hardness, longest=longest, slider_length=slider_length
    )
    wanted = _wanted(speed, distance, mass, damping_ratio)
    _write(contact, output, report, wanted, force=force)
    moved = motions(contact, wanted)
    print(json_text(contents(contact) | moved) if as_json else "\n".join((*described(contact), *_moving(moved))))
    if contact.refused:
        raise Refused(f"{printable(str(scans[-1]))}: refused: {'; '.join(contact.refused)}")


def _refuse_unused(context: typer.Context) -> None:
    """Refuse options of a scenario that no -o and no --report writes."""
    for name in _SCENARIO:
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            option = f"--{name.replace('_', '-')}"
            raise typer.BadParameter(f"{option} is for the scenario, which -o or --report writes")


def _write(
    contact: "SlidingContact", output: Path | None, report: Path | None, scenario: dict[str, Any], *, force: bool
) -> None:
    """Write scenario and report, both or none; neither for a refused contact."""
    from rubnoise.storage.output import whole_file

    texts: dict[Path, str] = {}
    if output is not None and not contact.refused:
        texts[output] = contact.scenario_text(**scenario)
    if report is not None and not contact.refused:
        from rubnoise.pages.surface_report import surface_report

        texts[report] = surface_report(contact, list(described(contact)), **scenario)
    with ExitStack() as files:
        for path, text in texts.items():
            files.enter_context(whole_file(path, force=force)).write_text(text, encoding="utf-8")


def _ask_for_needed(
    track: "Surface",
    slider: "Surface | None",
    cutoff: str | None,
    load: str | None,
    hardness: str | None,
    longest: str | None,
) -> None:
    """Refuse a call without a cut-off after the curve over cut-offs, and one without a load or a hardness."""
    import sys

    if cutoff is None:
        lengths, counts = track.count_over_cutoff(slider, longest=longest)
        print("cut-off (um)  junctions at 1 % of the area", file=sys.stderr)
        for length, count in zip(lengths, counts, strict=True):
            print(f"{length:12.4g}  {count:.4g}", file=sys.stderr)
        raise Refused(
            '--cutoff is needed: the number of junctions depends on it as above; right form: --cutoff "5 um", a wave'
            " longer than the noise of the instrument"
        )
    for option, value, example in (("--load", load, "0.2 N"), ("--hardness", hardness, "1 GPa")):
        if value is None:
            raise Refused(f'{option} is needed; right form: {option} "{example}"')


def _wanted(speed: str | None, distance: str | None, mass: str | None, damping_ratio: float | None) -> dict[str, Any]:
    from rubnoise.api import keywords
    from rubnoise.units import LENGTH, MASS, SPEED

    if damping_ratio is not None and not (isfinite(damping_ratio) and damping_ratio >= 0.0):
        raise Refused(f"--damping-ratio: {damping_ratio} is no number from 0 on")
    return {
        "speed": keywords.quantity("speed", speed, SPEED),
        "distance": keywords.quantity("distance", distance, LENGTH),
        "mass": keywords.quantity("mass", mass, MASS),
        "damping_ratio": damping_ratio,
    }


def figures(contact: "SlidingContact") -> Iterator[tuple[str, str, str, str, float]]:
    """Yield every figure of an answer: its table and key in JSON, its label, its unit and its value."""
    gaussian, counted, scenario = contact.gaussian, contact.counted, contact.in_scenario
    exact = (
        ("real_contact_area", "real contact area", "um^2", gaussian.real_contact_area),
        ("junction_count", "junctions", "", gaussian.junction_count),
        ("count_slope", "  d N / d ln(cut-off)", "", gaussian.count_slope(contact.cutoff)),
        ("birth_rate", "births", "per um", gaussian.birth_rate),
        ("mean_life", "mean life", "um", gaussian.mean_life),
        ("relative_std", "std/mean, long run", "", gaussian.relative_std),
        ("relative_std_short", "std/mean, short run", "", gaussian.relative_std_short),
        ("frozen_share", "frozen share of variance", "", gaussian.frozen_share),
        ("correlation_length", "correlation length", "um", gaussian.correlation_length),
        ("height_scale", "height scale of the area", "um", gaussian.height_scale),
        ("separation_std", "std of the gap under load", "um", gaussian.load_std),
        ("separation_slope", "its rms slope", "", contact.gap_slope),
    )
    maps = (
        ("patch_count", "patches", "", counted.patch_count),
        ("largest_share", "largest patch over all", "", counted.largest_share),
        ("real_contact_area", "their area", "um^2", counted.real_contact_area),
        ("map_area", "area of the map", "um^2", counted.map_area),
        ("mean_diameter", "mean diameter", "um", counted.mean_diameter),
        ("relative_spread", "spread of areas over mean", "", counted.relative_spread),
        ("over_gaussian", "counted over exact", "", contact.honesty),
    )
    ours = (
        ("relative_std", "std/mean", "", scenario["relative_std"]),
        ("correlation_length", "correlation length", "um", scenario["correlation_length"]),
        ("separation_std", "std of the gap under load", "um", scenario["separation_std"]),
        ("separation_slope", "its rms slope", "", scenario["separation_slope"]),
    )
    for table, rows in (("gaussian", exact), ("counted", maps), ("scenario", ours)):
        yield from ((table, *row) for row in rows)


def motions(contact: "SlidingContact", wanted: dict[str, Any]) -> dict[str, Any]:
    """Return the normal motion under ``motion``, on the surfaces and in the scenario; empty without a mass."""
    asked = {name: wanted[name] for name in ("speed", "mass", "damping_ratio")}
    if None in asked.values() or not asked["damping_ratio"]:
        return {}
    return {
        "motion": {
            name: {key: getattr(each, key) for key in ("separation_std", "velocity_std", "velocity_level")}
            for name, each in zip(("gaussian", "scenario"), contact.motions(**asked), strict=True)
        }
    }


def _moving(moved: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of the normal motion, with a warning if the scenario's level is off by more than 1 dB."""
    from rubnoise.surface.sliding import NEAR_LEVEL

    if not moved:
        return
    exact, ours = (moved["motion"][name] for name in ("gaussian", "scenario"))
    yield "normal motion at this speed and mass, to first order: of the surfaces, and in the scenario"
    yield line("std of the gap", f"{exact['separation_std']:.4g} and {ours['separation_std']:.4g} um")
    yield line("level, dB re 50 nm/s", f"{exact['velocity_level']:.1f} and {ours['velocity_level']:.1f} dB")
    if abs(louder := ours["velocity_level"] - exact["velocity_level"]) > NEAR_LEVEL:
        yield remark(
            f"warning: the scenario is {abs(louder):.1f} dB too {'loud' if louder > 0.0 else 'quiet'}: take the level"
            " of the surfaces"
        )


HEADINGS: Final = {
    "gaussian": "exact for Gaussian surfaces with these spectra",
    "counted": "counted on the maps",
    "scenario": "in the scenario",
}


def contents(contact: "SlidingContact") -> dict[str, Any]:
    """Return the answer by name, lengths in um; numbers that are not finite are null."""
    import numpy as np

    gaussian = contact.gaussian
    lags = np.linspace(0.0, gaussian.curve[0][-1], _LAGS)
    waves = np.geomspace(0.02, 20.0, _WAVES) * np.pi / contact.cutoff
    tables: dict[str, dict[str, float | None]] = {name: {} for name in HEADINGS}
    for table, key, _, _, value in figures(contact):
        tables[table][key] = value
    return {
        "track": _map(contact, 0),
        "slider": _map(contact, 1),
        **{name: getattr(contact, name) for name in ("cutoff", "longest", "slider_length", "nominal_area", "share")},
        "level": gaussian.level,
        **tables,
        "autocovariance": {"lag": lags.tolist(), "value": gaussian.autocovariance(lags).tolist()},
        "spectrum": {"wavenumber": waves.tolist(), "value": gaussian.spectrum(waves).tolist()},
        "remarks": list(contact.remarks),
        "refused": list(map(in_shell, contact.refused)),
    }


def _map(contact: "SlidingContact", which: int) -> dict[str, Any]:
    surface = (contact.track, contact.slider)[which]
    return {
        "name": surface.name,
        "points": list(surface.heights.shape),
        "spacing": list(surface.spacing),
        "history": list(surface.history),
        "digest": contact.scans[which].digest,
    }


def described(contact: "SlidingContact") -> Iterator[str]:
    """Yield the lines of the answer."""
    for role, surface in (("track", contact.track), ("slider", contact.slider)):
        along, across = surface.size
        yield sentence(
            f"{role}: {printable(surface.name)}, {along:.4g} um along and {across:.4g} um across the sliding"
        )
        yield from map(remark, surface.history)
    yield remark(contact.direction)
    yield line("share of the nominal area", f"{100.0 * contact.share:.4g} %, level u = {contact.gaussian.level:.4g}")
    heading = ""
    for table, _, label, unit, value in figures(contact):
        if table != heading:
            heading = table
            yield HEADINGS[table]
        yield line(label, f"{number(value) if table == 'counted' else f'{value:.4g}'} {unit}".rstrip())
    if contact.remarks:
        yield "what the scenario does not have from the surfaces"
    yield from map(remark, contact.remarks)
