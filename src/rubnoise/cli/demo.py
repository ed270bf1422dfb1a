"""`rubnoise demo`: a first run with a picture and every page, in one folder."""

import os
import sys
import webbrowser
from pathlib import Path
from typing import Annotated, Final

import rubnoise
from rubnoise.cli.layout import sentence, write_texts
from rubnoise.cli.options import Quiet, argument, flag
from rubnoise.cli.page import lesson_page, report_page, view_page
from rubnoise.cli.progress import announce_compilation
from rubnoise.errors import OutputRefused, refusing_files

SCENARIO: Final = "first/rubbing"
FILES: Final = {
    "rubbing.h5": "the result: every junction's life, area, force and motion",
    "rubbing.png": "a picture of it beside theory",
    "rubbing.html": "a page to explore it: zoom, filter, and follow single junctions",
    "rubbing_report.html": "a report to send to a colleague",
    "lesson.html": "lessons about births and deaths, for a class",
}
"""What the folder holds at the end, and what each is."""


def demo(
    folder: Annotated[Path, argument("[FOLDER]", "The folder; it is made if it is missing.")] = Path("rubnoise-demo"),
    *,
    no_open: Annotated[bool, flag("Do not open a browser.", "--no-open")] = False,
    quiet: Quiet = False,
) -> None:
    """Run a first contact; draw, report, view and teach it.

    The pages open in the browser, where there is one. The folder may hold an earlier demo, which is replaced, and
    nothing else.

    Example: rubnoise demo
    """
    with refusing_files(folder):
        folder.mkdir(parents=True, exist_ok=True)
        others = sorted(each.name for each in folder.iterdir() if each.name not in FILES)
    if others:
        raise OutputRefused(f"{folder}: holds {others[0]}, which no demo makes; name another folder")
    result, picture, *pages = (folder / name for name in FILES)
    if not quiet:
        announce_compilation()
    with rubnoise.run(SCENARIO, result, force=True, command=["rubnoise", "demo"]) as run:
        run.plot().savefig(picture, dpi=150)
    texts = (view_page(result)[0], report_page(result), lesson_page(Path(SCENARIO)))
    write_texts(dict(zip(pages, texts, strict=True)), force=True)
    if not quiet:
        print("\n".join(sentence(f"{folder / name}: {what}") for name, what in FILES.items()))
    desktop = sys.platform == "darwin" or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if not no_open and desktop and sys.stdout.isatty():  # a browser of text would take the terminal
        for path in pages:
            webbrowser.open(path.resolve().as_uri())
