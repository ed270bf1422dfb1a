"""The terminal side of commands: arguments and options, a printed answer, progress, and the stop after a signal."""

import json
import re
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from shutil import get_terminal_size
from types import FrameType
from typing import Annotated, Any, Final, TextIO

import typer

from rubnoise.answer import Answer
from rubnoise.answer import sentence as broken
from rubnoise.errors import RunStopped


def argument(metavar: str, about: str, **more: Any) -> Any:
    """Return an argument of a command, as help shows it."""
    return typer.Argument(help=about, metavar=metavar, **more)


def option(metavar: str, about: str, *names: str, **more: Any) -> Any:
    """Return an option with a value; without ``names`` its name is that of the parameter."""
    return typer.Option(*names, help=about, metavar=metavar, **more)


def output(metavar: str, about: str) -> Any:
    """Return the option for what is written."""
    return option(metavar, about, "-o", "--output")


def flag(about: str, *names: str, **more: Any) -> Any:
    """Return an option without a value."""
    return typer.Option(*names, help=about, **more)


def _one_form(context: typer.Context, *, value: bool) -> bool:
    if value and (context.params.get("as_json") or context.params.get("as_csv")):
        raise typer.BadParameter("only one of --csv and --json")
    return value


NewFile = Path | None
ResultFile = Annotated[Path, argument("RUN.h5", "A result file.")]
ResultOrSweep = Annotated[Path, argument("RUN.h5|DIR", "A result file, or the folder of a sweep.")]
StretchStart = Annotated[str | None, option("S", "Start of the stretch: um, or with a unit.", "--from")]
StretchEnd = Annotated[str | None, option("S", "End of the stretch.", "--to")]
AsJson = Annotated[bool, flag("Print one JSON object and nothing else.", "--json", callback=_one_form)]
AsCsv = Annotated[bool, flag("Print CSV, one line per number.", "--csv", callback=_one_form)]
Quiet = Annotated[bool, flag("Print only errors.", "-q", "--quiet")]
ReplaceFile = Annotated[bool, flag("Replace an existing file.", "--force")]
ReplaceFiles = Annotated[bool, flag("Replace existing files.", "--force")]
ReplaceResult = Annotated[bool, flag("Replace an existing result.", "--force")]
ReplacePlot = Annotated[bool, flag("Let --plot replace a file.", "--force")]
Changes = Annotated[list[str] | None, option("KEY=VALUE", "Change a key, e.g. --set sliding.distance=5mm.", "--set")]
NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
"""A number without a unit."""

EngineName = Annotated[
    str | None,
    option("ENGINE", "events or batch; both give the same bits.", autocompletion=lambda: ("events", "batch")),
]


# Answers.
WIDTH = 80  # columns of text that goes to no terminal
NARROWEST = 40  # columns below which nothing is laid out any narrower


def terminal_width() -> int | None:
    """Return the width of the terminal, None without one; COLUMNS in the environment takes precedence."""
    return get_terminal_size((0, 0)).columns or None


def width() -> int:
    """Return the width of text on standard output."""
    return max(terminal_width() or WIDTH, NARROWEST)


def sentence(text: str, indent: str = "") -> str:
    """Return a sentence broken between words on a terminal, otherwise in one line."""
    return indent + text if terminal_width() is None else broken(text, width(), indent)


def show(answer: Answer, *, as_json: bool = False, as_csv: bool = False, to: TextIO | None = None) -> None:
    """Print an answer as one JSON object, as CSV, or as text as wide as the terminal; ``to`` another stream."""
    if as_json:
        text = json.dumps(answer.to_json(), allow_nan=False)
    elif as_csv:
        text = answer.to_csv()
    else:
        title, *rest = answer.to_text(width(), terminal_width()).split("\n", 1)
        text = "\n".join([sentence(title), *rest])
    print(text, file=to)


def write_texts(texts: Mapping[Path, str], *, force: bool) -> None:
    """Write texts into files, which get their names when all are written: all or none."""
    from rubnoise.storage.output import whole_file

    with ExitStack() as files:
        for path, text in texts.items():
            files.enter_context(whole_file(path, force=force)).write_text(text, encoding="utf-8")


# Progress, and the stop after a signal.
Bar = Callable[[float, float | None, str], None]
"""Shows how much is done of a whole, and words; without a whole it only moves."""


@contextmanager
def bar(words: str = "", *, shown: bool) -> Iterator[Bar]:
    """Yield a bar with its first words on standard error, which goes at the end; it shows nothing unless ``shown``.

    Signals are caught from its first call on, and obeyed at its next call.
    """
    with ExitStack() as stack:
        show = stack.enter_context(_drawn(words)) if shown else None
        between: list[Callable[[], None]] = []

        def watched(done: float, whole: float | None, words: str) -> None:
            if not between:
                between.append(stack.enter_context(stoppable()))
            between[0]()
            if show is not None:
                show(done, whole, words)

        yield watched


@contextmanager
def _drawn(words: str) -> Iterator[Bar]:
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (BarColumn(bar_width=12), TaskProgressColumn(), TextColumn("{task.description}"), TimeRemainingColumn())
    # The stream beneath the one that escapes what is printed: the bar itself moves the cursor.
    console = Console(file=getattr(sys.stderr, "beneath", sys.stderr))
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task(words, total=None)
        yield lambda done, whole, words: progress.update(task, completed=done, total=whole, description=escape(words))


def announce_compilation(*, by_workers: bool = False) -> None:
    """Print a message, once, when this process begins to compile kernels, or if workers will: no code is kept then."""
    from rubnoise.compiling import before_compiling, is_kept
    from rubnoise.simulation.kernel import add_areas

    before_compiling(_say_compiling)
    if by_workers and not is_kept(add_areas):
        _say_compiling()


@cache
def _say_compiling() -> None:
    print("Compiling the kernels of this kind of motion; this happens once and takes up to a minute.", file=sys.stderr)


SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)


@contextmanager
def stoppable() -> Iterator[Callable[[], None]]:
    """Yield a function to call between pieces of work: it raises RunStopped after SIGINT or SIGTERM.

    It raises nowhere else, since an exception gets lost in a library that is being loaded. A second signal ends the
    process at once.
    """
    numbers: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        for each in SIGNALS:
            signal.signal(each, signal.SIG_DFL)
        numbers.append(number)

    def between() -> None:
        if numbers:
            raise RunStopped(numbers[0])

    before = {each: signal.signal(each, note) for each in SIGNALS}
    try:
        yield between
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
