"""`rubnoise infer` and `rubnoise surface`: from a measured trace, or from measured surfaces, to junctions."""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, NoReturn

import typer

from rubnoise.answer import Answer, Row, Table, printable, rows
from rubnoise.cli.terminal import AsCsv, AsJson, ReplaceFile, ReplaceFiles, argument, flag, option, show, write_texts
from rubnoise.cli.vocabulary import UNITS, fields_of, named
from rubnoise.errors import Refused, in_shell

if TYPE_CHECKING:
    from rubnoise.api.surface import Surface
    from rubnoise.surface.gaussian import NormalMotion
    from rubnoise.surface.sliding import SlidingContact
    from rubnoise.theory.coupling import LoadMotion

Shape = StrEnum("Shape", "lens parabola")
Offset = StrEnum("Offset", "none uniform")
Zero = StrEnum("Zero", "known unknown")
LawChoice = StrEnum("LawChoice", "auto fixed normal lognormal exponential gamma")
"""Lives that can be read, how far passes miss the centre line, whether 0 means no force, laws of sizes."""


OF_COMMAND: Final = ("as_json", "as_csv", "output", "report", "force")
"""Options that say what becomes of the answer; all others are those of `rubnoise.infer`."""


def infer(
    trace: Annotated[
        str,
        argument(
            "TRACE",
            "A measured trace: text, WAV, MATLAB 5, a result, FILE.h5:PATH, FILE.nc:NAME, or - (standard input).",
        ),
    ],
    *,
    speed: Annotated[str | None, option("SPEED", 'Sliding speed, for a trace over time: "1 mm/s".')] = None,
    column: Annotated[str | None, option("NAME", "Which column, by its name or number.")] = None,
    place: Annotated[str | None, option("NAME", "The column of distances, by name or number.")] = None,
    time: Annotated[str | None, option("NAME", "The column of times, by name or number.")] = None,
    unit: Annotated[str | None, option("U", 'Unit of the values, or what a value of 1 is: mN, "-0.5 mN", V.')] = None,
    rate: Annotated[str | None, option("R", 'Samples a second, whatever the file says: "20 kHz".')] = None,
    zero: Annotated[Zero, option("ZERO", "Whether 0 is no force: known, unknown.")] = Zero.unknown,
    strength: Annotated[str | None, option("PSI", 'Shear strength, where it is known: "250 MPa".')] = None,
    strength_spread: Annotated[
        str | None, option("V", 'Standard deviation of strengths over their mean: "50 %".', show_default="none")
    ] = None,
    pulse: Annotated[Shape | None, option("SHAPE", "Life of a junction: lens (the default), parabola.")] = None,
    offset: Annotated[Offset, option("OFFSET", "How far passes miss the centre: none, uniform.")] = Offset.none,
    bandwidth: Annotated[str | None, option("F", 'Corner of the sensor\'s filter: "200 Hz".')] = None,
    poles: Annotated[int, option("P", "Poles of this filter.", min=1, max=2)] = 1,
    law: Annotated[
        LawChoice, option("LAW", "Law of sizes: auto, fixed, normal, lognormal, exponential, gamma.")
    ] = LawChoice.auto,
    mask: Annotated[list[str] | None, option("F", 'A frequency to leave out: "50 Hz". May be repeated.')] = None,
    drift: Annotated[bool, flag("Fit a random walk of the sensor as well.", "--drift")] = False,
    from_: Annotated[str | None, option("A", 'First sample, from 1 on, or a time: "2 s".', "--from")] = None,
    to: Annotated[str | None, option("B", 'Last sample, or a time: "30 s".')] = None,
    strokes: Annotated[str | None, option("PART", 'Cut at reversals, leave out so much of each end: "10 %".')] = None,
    bootstrap: Annotated[
        int, option("N", "Simulate so many traces of what was found, to check its errors.", min=0)
    ] = 0,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    output: Annotated[
        Path | None, option("TOML", "Write a scenario that simulates what was found.", "-o", "--output")
    ] = None,
    report: Annotated[Path | None, option("HTML", "Write a page with pictures and tests.")] = None,
    force: ReplaceFiles = False,
) -> None:
    """Find the junctions behind a friction trace.

    Their number, size, spread and strength, with 95 % intervals.

    The exit code is 3 if the trace does not follow the model, or says too little.

    Example: rubnoise infer friction.csv --speed "1 mm/s" --zero known
    """
    told = {name: value for name, value in locals().items() if name not in OF_COMMAND}
    from rubnoise.api.inferring import infer as inferred
    from rubnoise.errors import NotPassed, Refused
    from rubnoise.storage.output import check_output

    for path in filter(None, (output, report)):
        check_output(path, force=force, reads=[trace])
    if output and report and output.absolute() == report.absolute():
        raise Refused(f"{output}: -o and --report name the same file")
    found = replace(inferred(**(told | {"mask": tuple(mask or ())})), name=trace)
    answer = found.answer
    rows = tuple(replace(row, name=in_shell(row.name), note=in_shell(row.note)) for row in answer.rows)
    answer = replace(answer, rows=rows, notes=tuple(map(in_shell, answer.notes)))
    texts = {output: found.to_toml()} if output and found.refused_because is None else {}
    if report and found.refused_because is None:
        from rubnoise.figures.fits import fit_page

        texts[report] = fit_page(found, trace, answer.to_text())
    write_texts(texts, force=force)
    show(answer, as_json=as_json, as_csv=as_csv)
    if found.refused_because is not None:
        raise NotPassed(f"{printable(trace)}: refused: {found.refused_because}")
    if found.flags:
        raise NotPassed(f"{printable(trace)}: flagged: {'; '.join(found.flags)}")


# Surfaces.
Form = StrEnum("Form", "none tilt polynomial cylinder sphere")  # forms that can be removed
_SCENARIO: Final = ("speed", "distance", "mass", "damping_ratio")  # options of the scenario

_LAGS: Final = 200
_WAVES: Final = 120


def surface(
    scans: Annotated[list[Path] | None, argument("SCAN [SCAN]", "A scan, or two: the track, then the slider.")] = None,
    *,
    cutoff: Annotated[str | None, option("LENGTH", 'Shortest wave that counts: "5 um".')] = None,
    load: Annotated[str | None, option("FORCE", 'Load of the slider: "0.2 N".')] = None,
    hardness: Annotated[str | None, option("PRESSURE", 'Hardness of the softer: "1 GPa".')] = None,
    longest: Annotated[str | None, option("LENGTH", "Longest wave that counts; default: all.")] = None,
    form: Annotated[Form, option("FORM", "Form to remove: none, tilt, polynomial, cylinder, sphere.")] = Form.tilt,
    unit: Annotated[str | None, option("UNIT", "Unit of a scan that names none: um.")] = None,
    height_unit: Annotated[str | None, option("UNIT", "Unit of its heights, if another.")] = None,
    size: Annotated[str | None, option("LENGTHS", 'Size of a bare matrix: "128 um x 128 um".')] = None,
    channel: Annotated[str | None, option("NAME", "Which map of a file with several.")] = None,
    turn: Annotated[bool, flag("Slide along the second index of the scans.", "--turn")] = False,
    slider_length: Annotated[str | None, option("LENGTH", "Length of a slider longer than its scan.")] = None,
    speed: Annotated[str | None, option("SPEED", 'Sliding speed of the scenario: "10 mm/s".')] = None,
    distance: Annotated[str | None, option("LENGTH", "Its sliding distance; default: 1000 mean lives.")] = None,
    mass: Annotated[str | None, option("MASS", "Let the slider rise and fall on its load: its mass.")] = None,
    damping_ratio: Annotated[float | None, option("RATIO", "Damping ratio of this motion.")] = None,
    output: Annotated[Path | None, option("FILE", "Write the scenario.", "-o", "--output")] = None,
    report: Annotated[Path | None, option("HTML", "Write a page with maps and curves.")] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
    force: ReplaceFiles = False,
    # Read before the command is chosen (`app.py`); here it is for --help alone.
    _synthesise: Annotated[
        bool, flag("Make a surface instead: surface --synthesise --help has the options of that.", "--synthesise")
    ] = False,
) -> None:
    """Find the junctions between two measured surfaces.

    How many of what size carry a load; the answer is a scenario too.

    Theory is exact for Gaussian surfaces with the measured spectra; beside it stands what is counted on the maps. The
    number of junctions depends on the cut-off, so that one has to be given.

    Example: rubnoise surface track.al3d slider.x3p --cutoff "5 um" --load "0.2 N" --hardness "1 GPa" -o scenario.toml
    """
    asked = locals()
    from rubnoise.api.surface import Surface
    from rubnoise.storage.output import check_output

    for name in _SCENARIO if output is None and report is None else ():
        if asked[name] is not None:
            raise typer.BadParameter(f"--{name.replace('_', '-')} is for the scenario, which -o or --report writes")
    for path in filter(None, (output, report)):
        check_output(path, force=force, reads=scans or ())
    if scans is None or len(scans) not in (1, 2):
        raise typer.BadParameter("one scan or two are needed: the track, then the slider")
    told = {name: asked[name] for name in ("unit", "height_unit", "size", "channel", "turn")}
    track, *others = (Surface.read(path, form=form.value, **told) for path in scans)
    slider = others[0] if others else None
    if cutoff is None:
        _ask_for_cutoff(track, slider, longest)
    pressed = {name: asked[name] for name in ("cutoff", "load", "hardness", "longest", "slider_length")}
    contact, wanted = track.slide(slider, **pressed), _wanted(asked)
    answer = answer_of(contact, wanted)
    texts = {output: contact.scenario_text(**wanted)} if output and not contact.refused else {}
    if report and not contact.refused:
        from rubnoise.pages.report import surface_report

        texts[report] = surface_report(contact, answer.to_text(), **wanted)
    write_texts(texts, force=force)
    show(answer, as_json=as_json, as_csv=as_csv)
    if contact.refused:
        raise Refused(f"{printable(str(scans[-1]))}: refused: {'; '.join(contact.refused)}")


def _ask_for_cutoff(track: "Surface", slider: "Surface | None", longest: str | None) -> NoReturn:
    """Refuse a call without a cut-off, after the curve over cut-offs."""
    print("cut-off (um)  junctions at 1 % of the area", file=sys.stderr)
    for length, count in zip(*track.count_over_cutoff(slider, longest=longest), strict=True):
        print(f"{length:12.4g}  {count:.4g}", file=sys.stderr)
    raise Refused(
        '--cutoff is needed: the number of junctions depends on it as above; right form: --cutoff "5 um", a wave'
        " longer than the noise of the instrument"
    )


def _wanted(asked: dict[str, Any]) -> dict[str, Any]:
    """Return what the scenario is to have beside the contact; raises Refused for what is no quantity."""
    from rubnoise.api import keywords
    from rubnoise.units import LENGTH, MASS, SPEED

    ratio, kinds = asked["damping_ratio"], {"speed": SPEED, "distance": LENGTH, "mass": MASS}
    if ratio is not None and not (isfinite(ratio) and ratio >= 0.0):
        raise Refused(f"--damping-ratio: {ratio} is no number from 0 on")
    return {name: keywords.quantity(name, asked[name], kind) for name, kind in kinds.items()} | {"damping_ratio": ratio}


def answer_of(contact: "SlidingContact", wanted: dict[str, Any]) -> Answer:
    """Return what carries the load: exact for Gaussian surfaces, as counted on the maps, and in the scenario."""
    import numpy as np

    gaussian, moved = contact.gaussian, _moved(contact, wanted)
    lags = np.linspace(0.0, gaussian.curve[0][-1], _LAGS)
    waves = np.geomspace(0.02, 20.0, _WAVES) * np.pi / contact.cutoff
    covariance = {"lag": lags, "value": gaussian.autocovariance(lags)}
    spectrum = {"wavenumber": waves, "value": gaussian.spectrum(waves)}
    refused = [Row(name="refused", value=in_shell(reason), fails=True) for reason in contact.refused]
    known = _known(contact)
    for part, motion in zip(("gaussian_motion", "scenario_motion"), moved, strict=False):  # to first order
        known[part] = fields_of(motion, "separation_std velocity_std velocity_level")
    return Answer(
        title=f"{contact.slider.name} on {contact.track.name}",
        rows=(*refused, *(row for part, values in known.items() for row in named(part, values, _NOTES))),
        tables=(
            Table(name="autocovariance", columns=covariance, units=UNITS | {"value": "um^4"}, shown=()),
            Table(name="spectrum", columns=spectrum, units=UNITS | {"value": "um^5"}, shown=()),
        ),
        notes=(contact.direction, *(f"warning: {each}" for each in (*contact.remarks, *_level_off(moved)))),
    )


def _known(contact: "SlidingContact") -> dict[str, dict[str, Any]]:
    """Return the surfaces as read, what was asked of them, and figures of theory, of the maps and of the scenario."""
    gaussian, level = contact.gaussian, contact.gaussian.level
    known: dict[str, dict[str, Any]] = {}
    for part, surface, scan in zip(("track", "slider"), (contact.track, contact.slider), contact.scans, strict=True):
        said = {"points": list(surface.heights.shape), "spacing": list(surface.spacing)}
        known[part] = {"name": surface.name, **said, "history": list(surface.history), "digest": scan.digest}
    known["contact"] = fields_of(contact, "cutoff longest slider_length nominal_area share")
    known["contact"]["level"] = level if isfinite(level) else None
    known["gaussian"] = {
        **fields_of(gaussian, "real_contact_area junction_count"),
        "count_slope": gaussian.count_slope(contact.cutoff),
        **fields_of(gaussian, "birth_rate mean_life relative_std relative_std_short frozen_share correlation_length"),
        "height_scale": gaussian.height_scale,
        "separation_std": gaussian.load_std,
        "separation_slope": contact.gap_slope,
    }
    patches = "patch_count largest_share real_contact_area map_area mean_diameter relative_spread"
    known["counted"] = fields_of(contact.counted, patches) | {"over_gaussian": contact.honesty}
    return known | {"scenario": contact.in_scenario}


def _moved(contact: "SlidingContact", wanted: dict[str, Any]) -> "Sequence[NormalMotion | LoadMotion]":
    """Return the motion of the surfaces and that of the scenario; nothing without a mass."""
    asked = {name: wanted[name] for name in ("speed", "mass", "damping_ratio")}
    return contact.motions(**asked) if None not in asked.values() and asked["damping_ratio"] else ()


def _level_off(moved: "Sequence[NormalMotion | LoadMotion]") -> Iterator[str]:
    """Yield a warning if the scenario's level is off by more than 1 dB."""
    from rubnoise.surface.sliding import NEAR_LEVEL

    if moved:
        louder = moved[1].velocity_level - moved[0].velocity_level
        if abs(louder) > NEAR_LEVEL:
            much = "loud" if louder > 0.0 else "quiet"
            yield f"the scenario is {abs(louder):.1f} dB too {much}: take the level of the surfaces"


_NOTES: Final = {
    "points": "along and across the sliding",
    "count_slope": "d N / d ln(cut-off)",
    "relative_std": "long run",
    "relative_std_short": "short run",
    "frozen_share": "of the variance",
    "separation_std": "of the gap under the load",
    "separation_slope": "rms",
    "over_gaussian": "patches over exact",
    "velocity_level": "re 50 nm/s",
}


def synthesise(
    *,
    points: Annotated[int, option("N", "Points a side.")] = 512,
    spacing: Annotated[str, option("LENGTH", "Their distance.")] = "1 um",
    roughness: Annotated[str, option("LENGTH", "Rms height.")] = "1 um",
    hurst: Annotated[float, option("H", "Hurst exponent.")] = 0.8,
    rolloff: Annotated[
        str | None, option("LENGTH", "Longest self-affine wave; default: a sixteenth of a side.")
    ] = None,
    cutoff: Annotated[str | None, option("LENGTH", "Shortest wave; default: five points long.")] = None,
    seed: Annotated[int, option("N", "Seed of its random numbers.")] = 1,
    output: Annotated[
        Path | None, option("FILE.nc", "The file to write; default: surfaceSEED.nc.", "-o", "--output")
    ] = None,
    as_json: AsJson = False,
    as_csv: AsCsv = False,
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
    told = rows("", ("surface", str(path)), ("digest", made.map.digest))
    rough = named("roughness", made.roughness())
    show(Answer(title=f"{path}: {made.map.history[0]}", rows=(*told, *rough)), as_json=as_json, as_csv=as_csv)
