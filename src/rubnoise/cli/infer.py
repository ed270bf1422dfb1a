"""`rubnoise infer`: from a measured trace back to its junctions, as text, as JSON, as a scenario and as a page."""

from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Final

from rubnoise.answer import printable
from rubnoise.cli.layout import show, write_texts
from rubnoise.cli.options import AsCsv, AsJson, ReplaceFiles, argument, flag, option
from rubnoise.errors import in_shell

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
