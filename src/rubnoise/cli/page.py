"""`rubnoise page`: a web page to explore one result or two, to send, or for a class."""

from collections.abc import Sequence
from enum import StrEnum
from os.path import realpath  # unlike resolve, it takes a loop of links for a name
from pathlib import Path
from typing import Annotated

import typer

import rubnoise
from rubnoise.answer import size
from rubnoise.cli.layout import sentence, write_texts
from rubnoise.cli.options import NewFile, ReplaceFile, StretchEnd, StretchStart, argument, option, output
from rubnoise.cli.plot import distance
from rubnoise.regular_file import is_folder, is_hdf5

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
    from rubnoise.cli.info import run_answer
    from rubnoise.cli.loading import finished_run
    from rubnoise.cli.progress import stoppable
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
