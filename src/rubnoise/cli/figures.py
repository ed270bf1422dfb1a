"""`rubnoise figures`: the figures of the paper, drawn from scenarios, with the theory over them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from rubnoise.cli.progress import StatusLine, announce_compilation, on_terminal
from rubnoise.errors import OutputRefused

if TYPE_CHECKING:
    from rubnoise.figures.style import Format


PICTURES: Final = ("png", "pdf", "svg")


def formats_of_pictures() -> tuple[str, ...]:
    """Return the values of --format, which shells complete."""
    return PICTURES


def command(
    names: Annotated[
        list[str] | None,
        typer.Argument(help="fig2, fig3 ... fig9, or all.", metavar="FIG", show_default=False),
    ] = None,
    *,
    folder: Annotated[
        Path, typer.Option("-o", "--output", help="Folder of the pictures; created if missing.", metavar="DIR")
    ] = Path("figures"),
    formats: Annotated[
        list[str] | None,
        typer.Option(
            "--format",
            help="png, pdf or svg; repeat it for several; default: all three.",
            metavar="FORMAT",
            autocompletion=formats_of_pictures,
        ),
    ] = None,
    scenarios: Annotated[
        Path | None,
        typer.Option(help="Folder with scenarios of these names, instead of the installed ones.", metavar="DIR"),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace existing pictures.")] = False,
    quiet: Annotated[bool, typer.Option("-q", "--quiet", help="Print only errors.")] = False,
) -> None:
    """Draw figures 2 to 9 of the paper: simulated by the scenarios of scenarios/paper, and by exact theory.

    Example: rubnoise figures fig4 fig8 -o figures --format png
    """
    from rubnoise.figures.paper import check_sources, chosen
    from rubnoise.figures.style import house_style

    wanted, kinds = chosen(names or ()), _formats(formats)
    house_style()  # says at once where matplotlib is missing
    check_sources(wanted, scenarios)
    files = {name: {kind: folder / f"{name}.{kind}" for kind in kinds} for name in wanted}
    _check_places(folder, [file for own in files.values() for file in own.values()], force=force)
    shown = on_terminal() and not quiet
    if not quiet:
        announce_compilation()
    _make(folder)
    for name, own in files.items():
        with StatusLine(shown=shown) as status:
            pictures = _drawn(name, kinds, scenarios, status)
        for kind, file in own.items():
            _write(file, pictures[kind], force=force)
            if not quiet:
                print(file)


def _make(folder: Path) -> None:

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise OutputRefused(f"{folder}: cannot be written: {problem.strerror}") from problem


def _drawn(
    name: str, kinds: "tuple[Format, ...]", scenarios: Path | None, status: "StatusLine"
) -> "dict[Format, bytes]":
    from rubnoise.figures.paper import paper_figure
    from rubnoise.figures.paper_sources import Sources

    status.show(name)
    sources = Sources(folder=scenarios, watch=lambda done, runs: status.show(f"{name}: {done} of {runs} runs"))
    return paper_figure(name, kinds, sources)


def _formats(wanted: Sequence[str] | None) -> "tuple[Format, ...]":
    from rubnoise.figures.style import FORMATS

    wrong = [kind for kind in wanted or () if kind not in FORMATS]
    if wrong:
        raise typer.BadParameter(f"--format {wrong[0]}: there are {', '.join(FORMATS)}")
    return tuple(kind for kind in FORMATS if not wanted or kind in wanted)


def _check_places(folder: Path, files: Sequence[Path], *, force: bool) -> None:
    """Raise OutputRefused before anything is drawn where a picture may not or cannot be written."""
    from rubnoise.storage.output import check_output

    try:
        above = next(place for place in (folder, *folder.absolute().parents) if place.exists())
    except OSError as problem:
        raise OutputRefused(f"{folder}: cannot be written: {problem.strerror}") from problem
    if not above.is_dir():
        raise OutputRefused(f"{above}: is no folder")
    if above == folder:
        for file in files:
            check_output(file, force=force)
    else:
        check_output(above / folder.name, force=True)


def _write(file: Path, picture: bytes, *, force: bool) -> None:
    from rubnoise.storage.output import whole_file

    with whole_file(file, force=force) as part:
        part.write_bytes(picture)
