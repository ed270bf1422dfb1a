"""`rubnoise page`, `listen` and `export`: a result as a web page, as sound, and for tools that do not read HDF5."""

import sys
from collections.abc import Sequence
from contextlib import ExitStack
from enum import StrEnum
from functools import partial
from math import isfinite
from os.path import realpath  # unlike resolve, it takes a loop of links for a name
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

import rubnoise
from rubnoise import __version__
from rubnoise.answer import Answer, rows, size
from rubnoise.cli.plot import distance
from rubnoise.cli.terminal import (
    NewFile,
    ReplaceFile,
    ReplaceFiles,
    ResultFile,
    StretchEnd,
    StretchStart,
    argument,
    option,
    output,
    sentence,
    show,
    stoppable,
    write_texts,
)
from rubnoise.regular_file import is_folder, is_hdf5

if TYPE_CHECKING:
    from rubnoise.analysis.sound import Heard, Sound

Ends = tuple[float | None, float | None]

PageForm = StrEnum("PageForm", "view report lesson")  # what a page is for


def page(
    files: Annotated[
        list[Path] | None,
        argument(
            "RUN.h5|DIR|SCENARIO",
            "A result, the folder of a sweep, or a scenario for a lesson; default: a lesson on first/rubbing. Two"
            " results are shown side by side.",
        ),
    ] = None,
    *,
    form: Annotated[
        PageForm | None,
        option("FORM", "view (to explore; default of a result), report (to send), or lesson (for a class).", "--as"),
    ] = None,
    output: Annotated[
        NewFile, output("OUT.html", "The page to write; default: RUN.html, RUN_report.html or lesson.html, here.")
    ] = None,
    start: StretchStart = None,
    stop: StretchEnd = None,
    force: ReplaceFile = False,
) -> None:
    """Write a web page: explore a result, report it, or teach.

    The page of two results shows them side by side. It is one file, which a browser opens without a network.

    Example: rubnoise page fig5.h5 --from 1mm --to 2mm
    """
    from rubnoise.storage.output import check_output

    sources = files or []
    runs = (is_folder(each) or is_hdf5(each) or each.suffix.lower() == ".h5" for each in sources)
    wanted = form or (PageForm.view if sources and all(runs) else PageForm.lesson)
    ends = distance("--from", start), distance("--to", stop)
    _check(sources, wanted, ends)
    stem = "_".join(Path(realpath(each)).stem for each in sources)
    usual = {PageForm.view: f"{stem}.html", PageForm.report: f"{stem}_report.html", PageForm.lesson: "lesson.html"}
    path = output or Path(usual[wanted])
    if path.suffix.lower() not in {".html", ".htm"}:
        raise typer.BadParameter(f"{path} does not end in .html")
    check_output(path, force=force, reads=sources)
    text, what = _written(sources, wanted, ends)
    write_texts({path: text}, force=force)
    print(sentence(f"{path}: {what}{size(path.stat().st_size)}; a browser opens it, with or without a network"))


def _check(sources: Sequence[Path], form: PageForm, ends: Ends) -> None:
    """Raise BadParameter if a form of page cannot be made of the sources."""
    if len(sources) > 2:
        raise typer.BadParameter("a page shows one result, or two side by side")
    if len(sources) == 2 and (form != PageForm.view or any(map(is_folder, sources))):
        raise typer.BadParameter("only two results are shown side by side, with --as view")
    if not sources and form != PageForm.lesson:
        raise typer.BadParameter(f"--as {form} needs a result: rubnoise page RUN.h5 --as {form}")
    if ends != (None, None) and (form != PageForm.view or is_folder(sources[0])):
        raise typer.BadParameter("--from and --to are for the view of a run")


def _written(sources: Sequence[Path], form: PageForm, ends: Ends) -> tuple[str, str]:
    """Return the text of a page, and what the command says about it."""
    if form == PageForm.lesson:
        return lesson_page(sources[0] if sources else Path("first/rubbing")), ""
    if form == PageForm.report:
        return report_page(sources[0]), ""
    views = [view_page(each, ends) for each in sources]
    if len(views) == 1:
        return views[0]
    from rubnoise.pages.page import side_by_side

    return side_by_side(dict(zip(map(str, sources), (text for text, _ in views), strict=True))), "two runs, "


def view_page(source: Path, ends: Ends = (None, None)) -> tuple[str, str]:
    """Return a page to explore a result or a sweep, and what it holds in words."""
    from rubnoise.cli.loading import finished_run
    from rubnoise.figures.tracks import Stretch
    from rubnoise.pages.run_view import held_by_a_page, run_page
    from rubnoise.pages.sweep_view import sweep_page

    if is_folder(source):
        with rubnoise.open_sweep(source) as sweep:
            return sweep_page(sweep, str(source)), f"{sweep.count('done'):,} runs, "
    with finished_run(source) as run:
        shown = held_by_a_page(Stretch.of(run, *ends))
        return run_page(shown), f"every tick from {shown.start:g} to {shown.stop:g} um, "


def report_page(file: Path) -> str:
    """Return the report of a result or of a sweep."""
    from rubnoise.api.run import Run
    from rubnoise.cli.ask import run_answer
    from rubnoise.cli.loading import finished_run
    from rubnoise.cli.terminal import stoppable
    from rubnoise.pages.report import run_report, sweep_report

    with stoppable() as between:
        if is_folder(file):
            with rubnoise.open_sweep(file) as sweep:
                return sweep_report(sweep, between)
        with finished_run(file) as run:
            return run_report(run, run_answer(Run(run), file).to_text(), between)


def lesson_page(source: Path) -> str:
    """Return a lesson about a scenario; of a finished result its junctions are replayed."""
    from rubnoise.cli.loading import finished_run, loaded
    from rubnoise.lesson.page import page, record_of
    from rubnoise.scenario import load

    record = None
    if is_hdf5(source):
        with finished_run(source), rubnoise.open(source) as run:
            scenario, record = run.scenario, record_of(run)
    else:
        scenario = loaded(load, source)
    return page(scenario.title or source.stem, scenario, record)


# Sound.
What = StrEnum("What", "velocity force displacement normal-velocity load")
Rate = StrEnum("Rate", {"CD": "44100", "VIDEO": "48000"})
"""What can be heard, and samples a second."""


def listen(
    files: Annotated[list[Path], argument("RUN.h5", "Result files.")],
    *,
    output: Annotated[NewFile, output("WAV", "The file to write; default: RUN_WHAT.wav, in this folder.")] = None,
    what: Annotated[What, option("WHAT", f"The sound: {', '.join(What)}.")] = What.velocity,
    speed_up: Annotated[
        float | None, option("X", "How much faster than the run; default: 1, of several runs what is audible.")
    ] = None,
    seconds: Annotated[float | None, option("S", "Length of the sound, from the start; default: all.")] = None,
    rate: Annotated[Rate, option("RATE", "Samples a second: 44100 or 48000.")] = Rate.VIDEO,
    force: ReplaceFile = False,
) -> None:
    """Write the slider's motion as sound.

    Band-limited, without mean, peak at -3 dB, physical scale in the file.

    Several runs get one scale and one length, so that they differ in loudness as they do in motion.

    Example: rubnoise listen few.h5 many.h5 --speed-up 10
    """
    from rubnoise.analysis.sound import Sound
    from rubnoise.cli.loading import finished_run
    from rubnoise.storage.output import whole_file
    from rubnoise.storage.sound import write_wave

    for name, value in (("--speed-up", speed_up), ("--seconds", seconds)):
        if value is not None and not (isfinite(value) and value > 0.0):
            raise typer.BadParameter(f"{name}: {value:g} is no number above 0")
    if output and len(files) > 1:
        raise typer.BadParameter("-o names one file; several runs are written as RUN_WHAT.wav in this folder")
    with ExitStack() as opened, stoppable() as between:
        runs = [opened.enter_context(finished_run(file)) for file in files]
        choose = partial(Sound.of, what=cast("Heard", what.value), rate=int(rate))
        if speed_up is None and len(runs) > 1:
            speed_up = choose(runs[0], speed_up=1.0).better
        sounds = [choose(run, speed_up=speed_up or 1.0) for run in runs]
        paths = [output or Path(f"{sound.file.path.stem}_{sound.what}.wav") for sound in sounds]
        _check_paths(files, paths, force=force)
        shortest = seconds or min(sound.seconds for sound in sounds)
        sounds = [sound.lasting(shortest) for sound in sounds]
        full_scale = 0.0  # that of the loudest, so that loudness compares runs
        for sound in sounds:
            between()
            full_scale = max(full_scale, sound.full_scale)
        for path, sound in zip(paths, sounds, strict=True):
            pieces, texts = sound.pieces(full_scale, between), _wave_comments(sound, full_scale)
            with whole_file(path, force=force) as part, part.open("w+b") as stream:
                write_wave(stream, pieces, samples=sound.samples, rate=sound.rate, texts=texts)
            show(_answer(path, sound, full_scale, others=len(sounds) - 1))


def _check_paths(files: list[Path], paths: list[Path], *, force: bool) -> None:
    """Raise Refused before anything is written if the sound of a file cannot be written to its path."""
    from rubnoise.storage.output import check_output

    for i, path in enumerate(paths):
        if path in paths[:i]:
            raise typer.BadParameter(f"{files[paths.index(path)]} and {files[i]} would both be written to {path}")
        if path.suffix.lower() != ".wav":
            raise typer.BadParameter(f"{path} does not end in .wav")
        check_output(path, force=force, reads=files)


def _wave_comments(sound: "Sound", full_scale: float) -> dict[str, str]:
    """Return the texts in a sound file: title, the scale of its samples, and the program that wrote it."""
    figures = {
        "quantity": sound.what,
        "unit": sound.units,
        "full_scale": repr(full_scale),
        "mean": repr(sound.mean),
        "speed_up": repr(sound.speed_up),
        "sample_rate": str(sound.rate),
        "run": sound.file.path.name,
    }
    return {
        "INAM": str(sound.file.attributes["title"]) or sound.file.path.stem,
        "ICMT": "; ".join(f"{name}={text}" for name, text in figures.items()),
        "ISFT": f"rubnoise {__version__}",
    }


def _answer(path: Path, sound: "Sound", full_scale: float, others: int) -> Answer:
    """Return the file that was written, its scale, and its audible part; ``others`` have the same scale."""
    from rubnoise.storage.sound import BITS

    whose = "the loudest sample of all runs" if others else "the loudest sample"
    heard = sound.hearing
    told = rows(
        "",
        ("begins_at", sound.first * sound.tick_duration or None, "s", "after the transient"),
        ("speed_up", sound.speed_up),
        ("full_scale", full_scale, sound.units, f"{whose} 3 dB below"),
        ("mean", sound.mean, sound.units, "taken away"),
        ("natural_frequency", sound.natural, "Hz", f"heard at {(sound.natural or 0.0) * sound.speed_up:.4g} Hz"),
        ("middle", heard and heard.middle, "Hz", "half of the power lies below"),
        ("audible_share", heard and heard.audible, "", "20 Hz to 20 kHz"),
        ("level", sound.laptop_level(full_scale), "dB", "re full scale, 200 to 4000 Hz: what a laptop plays"),
    )
    title = f"{path}: {sound.seconds:.6g} s of {sound.what}, {sound.rate:,} samples a second of {BITS} bits"
    return Answer(title=title, rows=tuple(told), notes=_advice(sound))


def _advice(sound: "Sound") -> tuple[str, ...]:
    """Return advice for a sound that most ears and small loudspeakers miss."""
    heard = sound.hearing
    if heard is None:
        return ("too short to estimate the audible part",)
    if sound.better is None:
        return ()
    if heard.audible < 0.01:
        problem = "next to nothing of it can be heard"
    elif heard.middle < 100.0:
        problem = "most of it is deeper than small loudspeakers go"
    else:
        problem = "most of it is higher than many can hear"
    middle = heard.middle * sound.better / sound.speed_up
    return (f"{problem}; --speed-up {sound.better:g} would bring the middle to {middle:.3g} Hz",)


# Tables for other tools.
STANDARD_OUTPUT = Path("-")
ExportedGroup = StrEnum("ExportedGroup", "junctions trace slider load landmarks")
ExportFormat = StrEnum("ExportFormat", "csv parquet netcdf")


def export(
    file: ResultFile,
    *,
    kind: Annotated[ExportFormat, option("FORMAT", "csv, parquet or netcdf.", "--to")],
    group: Annotated[
        ExportedGroup | None, option("GROUP", f"One group of the run: {', '.join(ExportedGroup)}; default: all.")
    ] = None,
    output: Annotated[
        NewFile,
        output("OUT", "The file to write, - for standard output (CSV); default: RUN_GROUP.csv and so on, here."),
    ] = None,
    force: ReplaceFiles = False,
) -> None:
    """Write a result as CSV, Parquet or netCDF.

    CSV has units in the names of columns, the others beside them.

    CSV and Parquet files hold one group each, a netCDF file holds all. -o - prints one group as CSV.

    Example: rubnoise export fig5.h5 --to csv --group trace -o trace.csv
    """
    from rubnoise.storage.export import export as write
    from rubnoise.storage.export import plan, write_csv
    from rubnoise.storage.reader import open_run

    printed = output == STANDARD_OUTPUT
    if printed and kind is not ExportFormat.csv:
        raise typer.BadParameter(f"-o -: only CSV goes to standard output; {kind} is binary: name a file")
    if printed and force:
        raise typer.BadParameter("--force replaces files; standard output is not a file")
    with open_run(file) as run, stoppable() as between:
        files = plan(run, kind.value, group and group.value, output)  # type: ignore[arg-type]  # one of three
        if printed:
            write_csv(sys.stdout, run, files[STANDARD_OUTPUT][0], between)
            return
        write(run, kind.value, files, force=force, between=between)  # type: ignore[arg-type]
        for path, groups in files.items():
            rows = ", ".join(f"{run.rows(each.name):,} rows of {each.name}" for each in groups)
            print(f"{path}: {rows}, {size(path.stat().st_size)}")
