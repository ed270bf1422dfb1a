"""`rubnoise infer`: from a measured trace back to its junctions, as text, as JSON, as a scenario and as a page."""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import asdict
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rubnoise.answer import printable
from rubnoise.cli.layout import json_text, line, remark
from rubnoise.cli.options import AsJson, ReplaceFiles
from rubnoise.errors import in_shell

if TYPE_CHECKING:
    from rubnoise.inference.assumed import OtherPulse
    from rubnoise.inference.estimates import Estimate
    from rubnoise.inference.inference import InferenceResult

Shape = StrEnum("Shape", "lens parabola")
Offset = StrEnum("Offset", "none uniform")
Zero = StrEnum("Zero", "known unknown")
LawChoice = StrEnum("LawChoice", "auto fixed normal lognormal exponential gamma")
"""Lives that can be read, how far passes miss the centre line, whether 0 means no force, laws of sizes."""


def command(
    trace: Annotated[
        str,
        typer.Argument(
            help="A measured trace: text, WAV, MATLAB 5, a result, FILE.h5:PATH, FILE.nc:NAME, or - (standard input).",
            metavar="TRACE",
        ),
    ],
    *,
    speed: Annotated[
        str | None, typer.Option(help='Sliding speed, for a trace over time: "1 mm/s".', metavar="SPEED")
    ] = None,
    column: Annotated[str | None, typer.Option(help="Which column, by its name or number.", metavar="NAME")] = None,
    place: Annotated[
        str | None, typer.Option(help="The column of distances, by name or number.", metavar="NAME")
    ] = None,
    time: Annotated[str | None, typer.Option(help="The column of times, by name or number.", metavar="NAME")] = None,
    unit: Annotated[
        str | None,
        typer.Option(help='Unit of the values, or what a value of 1 is: mN, "-0.5 mN", V.', metavar="U"),
    ] = None,
    rate: Annotated[
        str | None, typer.Option(help='Samples a second, whatever the file says: "20 kHz".', metavar="R")
    ] = None,
    zero: Annotated[Zero, typer.Option(help="Whether 0 is no force: known, unknown.", metavar="ZERO")] = Zero.unknown,
    strength: Annotated[
        str | None, typer.Option(help='Shear strength, where it is known: "250 MPa".', metavar="PSI")
    ] = None,
    strength_spread: Annotated[
        str | None,
        typer.Option(help='Standard deviation of strengths over their mean: "50 %".', metavar="V", show_default="none"),
    ] = None,
    pulse: Annotated[
        Shape | None, typer.Option(help="Life of a junction: lens (the default), parabola.", metavar="SHAPE")
    ] = None,
    offset: Annotated[
        Offset, typer.Option(help="How far passes miss the centre: none, uniform.", metavar="OFFSET")
    ] = Offset.none,
    bandwidth: Annotated[
        str | None, typer.Option(help='Corner of the sensor\'s filter: "200 Hz".', metavar="F")
    ] = None,
    poles: Annotated[int, typer.Option(help="Poles of this filter.", metavar="P", min=1, max=2)] = 1,
    law: Annotated[
        LawChoice,
        typer.Option(help="Law of sizes: auto, fixed, normal, lognormal, exponential, gamma.", metavar="LAW"),
    ] = LawChoice.auto,
    mask: Annotated[
        list[str] | None, typer.Option(help='A frequency to leave out: "50 Hz". May be repeated.', metavar="F")
    ] = None,
    drift: Annotated[bool, typer.Option("--drift", help="Fit a random walk of the sensor as well.")] = False,
    from_: Annotated[
        str | None, typer.Option("--from", help='First sample, from 1 on, or a time: "2 s".', metavar="A")
    ] = None,
    to: Annotated[str | None, typer.Option(help='Last sample, or a time: "30 s".', metavar="B")] = None,
    strokes: Annotated[
        str | None, typer.Option(help='Cut at reversals, leave out so much of each end: "10 %".', metavar="PART")
    ] = None,
    bootstrap: Annotated[
        int, typer.Option(help="Simulate so many traces of what was found, to check its errors.", metavar="N", min=0)
    ] = 0,
    as_json: AsJson = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Write a scenario that simulates what was found.", metavar="TOML"),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write a page with pictures and tests.", metavar="HTML")] = None,
    force: ReplaceFiles = False,
) -> None:
    """Find the junctions behind a friction trace.

    Their number, size, spread and strength, with 95 % intervals.

    The exit code is 3 if the trace does not follow the model, or says too little.

    Example: rubnoise infer friction.csv --speed "1 mm/s" --zero known
    """
    from rubnoise.api.inferring import infer
    from rubnoise.errors import Refused, TraceDoubtful
    from rubnoise.storage.output import check_output, whole_file

    for path in (output, report):
        if path is not None:
            check_output(path, force=force, reads=[trace])
    if output is not None and report is not None and output.absolute() == report.absolute():
        raise Refused(f"{output}: -o and --report name the same file")
    found = infer(
        trace,
        speed=speed,
        column=column,
        place=place,
        time=time,
        unit=unit,
        rate=rate,
        zero=zero.value,  # type: ignore[arg-type]  # one of both
        strength=strength,
        strength_spread=strength_spread,
        pulse=None if pulse is None else pulse.value,
        offset=offset.value,
        bandwidth=bandwidth,
        poles=poles,
        law=law.value,
        mask=tuple(mask or ()),
        drift=drift,
        from_=from_,
        to=to,
        strokes=strokes,
        bootstrap=bootstrap,
    )
    texts: dict[Path, str] = {}
    if output is not None and found.refused_because is None:
        texts[output] = found.to_toml()
    if report is not None and found.refused_because is None:
        from rubnoise.figures.inference import page

        texts[report] = page(found, trace, list(described(found, trace)))
    with ExitStack() as files:  # each gets its name when all are written: all or none
        for path, text in texts.items():
            files.enter_context(whole_file(path, force=force)).write_text(text, encoding="utf-8")
    print(json_text(contents(found, trace)) if as_json else "\n".join(described(found, trace)))
    if found.refused_because is not None:
        raise TraceDoubtful(f"{printable(trace)}: refused: {found.refused_because}")
    if found.flags:
        raise TraceDoubtful(f"{printable(trace)}: flagged: {'; '.join(found.flags)}")


def contents(found: "InferenceResult", trace: str) -> dict[str, Any]:
    """Return an inference by name, for JSON."""
    return {
        "trace": trace,
        "law": found.law,
        "estimates": _in_order(found.estimates),
        "not_identified": {name: in_shell(reason) for name, reason in found.not_identified.items()},
        "flags": [in_shell(flag) for flag in found.flags],
        "refused": found.refused_because,
        "laws": {
            each.law: {
                "criterion": each.criterion,
                "worse_by": each.worse_by,
                "worse_by_error": each.error,
                "told_apart": each.told_apart,
                "estimates": _in_order(each.estimates),
            }
            for each in found.laws
        },
        "tests": {
            each.name: {"statistic": each.statistic, "p": each.p, "level": each.level, "flagged": each.flagged}
            for each in found.tests
        },
        "law_free": dict(found.law_free),
        "left_out": list(found.signal.left_out),
        "notes": [in_shell(note) for note in found.signal.notes],
        "assumptions": list(found.assumptions),
        **_other(found),
        "by_strength_spread": [asdict(each) for each in found.by_strength_spread],
        "bootstrap": {name: asdict(each) for name, each in found.bootstrap.items()},
    }


def _in_order(estimates: Mapping[str, "Estimate"]) -> dict[str, Any]:
    return {name: asdict(estimates[name]) for name in _LABELS if name in estimates}


def _other(found: "InferenceResult") -> dict[str, Any]:
    told = {}
    for key, other in (("offset", found.other_offset), ("shape", found.other_shape)):
        if other is not None:
            told[f"other_{key}"] = {
                key: getattr(other.pulse, key),
                "worse_by": other.worse_by,
                "worse_by_error": other.error,
                "diameter": other.diameter,
                "diameter_off": other.diameter_off,
                "told_apart": other.told_apart,
                "estimates": _in_order(other.estimates),
            }
    return told


_LABELS = {
    "junction_count": "junctions at a time",
    "diameter": "mean diameter",
    "relative_spread": "spread over mean",
    "shear_strength": "shear strength",
    "strength_spread": "spread of strengths",
    "mean_real_contact_area": "real contact area",
    "noise": "noise of the sensor",
}
"""The estimates of an answer, in order, and what they are called."""


def described(found: "InferenceResult", trace: str) -> Iterator[str]:
    """Yield the lines of an inference."""
    yield from _heading(found, trace)
    if found.refused_because is not None:
        yield remark(f"refused: {found.refused_because}")
        return
    alike = [each.law for each in found.laws if not each.told_apart and each.law != found.law]
    laws = f"{found.law}; not distinguished from it: {', '.join(alike)}" if alike else found.law
    yield line("law of sizes", laws)
    for name, label in _LABELS.items():
        if name in found.estimates:
            yield line(label, _value(found.estimates[name]))
    if alike:
        yield remark("Intervals hold 95 % whichever of these laws is right.")
    for name, reason in found.not_identified.items():
        yield remark(f"{_LABELS[name]}: not identified: {in_shell(reason)}")
    yield from _granted(found)
    yield "without a law"
    yield line("diameter m6/m5", f"{found.law_free['effective_diameter']:.4g} um")
    if "effective_count" in found.law_free:
        yield line("number, if sizes were equal", f"{found.law_free['effective_count']:.4g}")
    if found.bootstrap:
        yield "bootstrap: mean and scatter of simulated traces"
        for name, each in found.bootstrap.items():
            yield line(_LABELS[name], f"{each.value:.4g} +- {each.standard_error:.2g} {_unit(each)}".rstrip())
    yield "tests of the trace"
    for test in found.tests:
        yield remark(f"{'FLAGGED: ' if test.flagged else ''}{in_shell(test.words)} (p = {test.p:.2g})")


def _heading(found: "InferenceResult", trace: str) -> Iterator[str]:
    """Yield the length of the trace, and the parts that were left out."""
    signal = found.signal
    length = signal.tick * signal.values.size
    yield f"{printable(trace)}: {signal.values.size:,} samples over {length:.4g} um of sliding"
    for words in (*signal.left_out, *signal.notes):
        yield remark(in_shell(words))


def _granted(found: "InferenceResult") -> Iterator[str]:
    """Yield the assumptions, and how number and strength depend on them."""
    if found.assumptions:
        yield "taken for granted"
    for words in found.assumptions:
        yield remark(in_shell(words))
    if found.other_offset is not None:
        uniform = found.other_offset.pulse.offset == "uniform"
        passes = "passes off the centre (--offset uniform)" if uniform else "passes through the centre"
        yield remark(_compared(passes, found.other_offset))
    if found.other_shape is not None:
        shape = found.other_shape.pulse.shape
        yield remark(_compared(f"lives of the shape {shape} (--pulse {shape})", found.other_shape))
    for each in found.by_strength_spread:
        strength = "" if each.shear_strength is None else f" of {each.shear_strength:.4g} MPa"
        numbers = f"{each.junction_count:.4g} junctions{strength}"
        yield line(f"strengths spread by {100.0 * each.strength_spread:.0f} %", numbers)


def _compared(what: str, other: "OtherPulse") -> str:
    which, size = ("worse" if other.worse_by >= 0.0 else "better"), ("more" if other.diameter_off >= 0.0 else "less")
    fit = f"{what} fit {which} by {abs(other.worse_by):.3g} +- {other.error:.2g} of the criterion"
    told = "" if other.told_apart else ", which decides nothing"
    numbers = [
        f"{_LABELS[name]} {each.value:.4g} {_unit(each)}".rstrip()
        for name, each in other.estimates.items()
        if name in {"junction_count", "shear_strength"}
    ]
    size = f"mean diameter {other.diameter:.4g} um ({100.0 * abs(other.diameter_off):.2g} % {size})"
    return f"{fit}{told}; they give {', '.join([size, *numbers])}"


def _value(estimate: "Estimate") -> str:
    low, high = estimate.interval
    ends = f"{low:.4g} to {high:.4g}" if isfinite(high) else f"from {low:.4g}"
    return f"{estimate.value:.4g} {_unit(estimate)}".rstrip() + f"  (95 %: {ends})"


def _unit(estimate: "Estimate") -> str:
    return "" if estimate.unit == "1" else estimate.unit
