"""`rubnoise teach`: a page for a class, with the model, its exact theory and lessons in it."""

from pathlib import Path
from typing import Annotated

import typer


def command(
    file: Annotated[
        Path | None,
        typer.Argument(
            help="A scenario file, or a result to replay; the paper's Figure 5 when left out.",
            metavar="[SCENARIO | RUN.h5]",
            show_default=False,
        ),
    ] = None,
    *,
    output: Annotated[Path, typer.Option("-o", "--output", help="The page to write.", metavar="OUT.html")] = Path(
        "lesson.html"
    ),
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Write a page that shows junctions being born and dying, with knobs, exact predictions and lessons.

    It is one file that a browser opens from anywhere, without a network.

    Example: rubnoise teach scenarios/paper/fig5.toml -o lesson.html
    """
    from rubnoise.cli.layout import size
    from rubnoise.cli.loading import scenario_or_result
    from rubnoise.lesson.page import page
    from rubnoise.lesson.settings import settings_of
    from rubnoise.scenario.shipped import shipped
    from rubnoise.storage.output import check_output, give_final_name, sole_writer

    check_output(output, force=force)
    scenario = scenario_or_result(file or shipped("paper/fig5.toml"))
    settings = settings_of(scenario)
    text = page(scenario.title or "rubnoise", "", settings)
    paths = check_output(output, force=force)
    with sole_writer(paths):
        check_output(output, force=force)
        paths.part.write_text(text, encoding="utf-8")
        give_final_name(paths, force=force)
    print(f"{output}: {size(output.stat().st_size)}; a browser opens it, with or without a network")
