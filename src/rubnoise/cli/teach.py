"""`rubnoise teach`: a page for a class, with the model, its exact theory and lessons in it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import rubnoise
from rubnoise.answer import size
from rubnoise.cli.layout import sentence
from rubnoise.cli.options import PageFile, ReplaceFile

if TYPE_CHECKING:
    from rubnoise.scenario import Scenario


def command(
    file: Annotated[
        Path | None,
        typer.Argument(
            help="A scenario file, or a result to replay; default: first/rubbing.", metavar="SCENARIO|RUN.h5"
        ),
    ] = None,
    *,
    output: PageFile = Path("lesson.html"),
    force: ReplaceFile = False,
) -> None:
    """Write a web page for a class: births and deaths of junctions, controls, exact predictions and lessons.

    It is one file that a browser opens from anywhere, without a network.

    Example: rubnoise teach scenarios/first/rubbing.toml -o lesson.html
    """
    from rubnoise.lesson.page import page
    from rubnoise.lesson.settings import settings_of
    from rubnoise.scenario.shipped import shipped
    from rubnoise.storage.output import check_output, whole_file

    source = file or shipped("first/rubbing.toml")
    check_output(output, force=force, reads=[source])
    scenario, record = _scenario_and_junctions(source)
    text = page(scenario.title or source.stem, settings_of(scenario), record)
    with whole_file(output, force=force) as part:
        part.write_text(text, encoding="utf-8")
    print(sentence(f"{output}: {size(output.stat().st_size)}; a browser opens it, with or without a network"))


def _scenario_and_junctions(source: Path) -> "tuple[Scenario, dict[str, Any] | None]":
    """Return the scenario, and of a finished result its junctions too."""
    from rubnoise.cli.loading import finished_run, is_result, scenario_of
    from rubnoise.lesson.page import record_of

    if not is_result(source):
        return scenario_of(source), None
    with finished_run(source), rubnoise.open(source) as run:
        return run.scenario, record_of(run)
