"""The command line: `rubnoise COMMAND`.

A call imports only the module of its command, and each command imports large libraries in its functions: --help, which
shows all commands, takes a tenth of a second.
"""

import gc
import os
import sys
import traceback
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from inspect import signature
from io import BufferedWriter, RawIOBase, TextIOWrapper
from typing import Any, Final, TextIO

import typer
from typer import Typer

from rubnoise.cli.commands import Command, Commands, escaping
from rubnoise.cli.ended import INSTEAD
from rubnoise.errors import OutputRefused, RubnoiseError, RunFileRefused, ScenarioRefused, in_shell

DEBUG = "--debug"

HEADINGS: Final = {
    "Begin and run": {
        "new": "new.command",
        "examples": "new.print_examples",
        "check": "check.command",
        "run": "run.command",
        "sweep": "sweep.command",
        "demo": "demo.command",
    },
    "Look at a result": {
        "info": "info.command",
        "junctions": "junctions.command",
        "plot": "plot.command",
        "page": "page.command",
        "listen": "listen.command",
        "export": "export.command",
    },
    "Compare": {
        "theory": "theory.command",
        "compare": "compare.command",
        "verify": "verify.command",
    },
    "Measure": {
        "infer": "infer.command",
        "surface": "surface.command",
    },
    "Hidden": {
        "schema": "new.print_schema",
        "surface --synthesise": "synthesise.command",
        **dict.fromkeys(INSTEAD, "ended.command"),
    },
}
"""The commands under the headings of --help: the module of this package and the function of each."""

COMMANDS: Final = {name: place for commands in HEADINGS.values() for name, place in commands.items()}

EARLIER: Final = {
    "view": ("page", "--as", "view"),
    "report": ("page", "--as", "report"),
    "teach": ("page", "--as", "lesson"),
    "junction": ("junctions",),
}
"""Words of earlier versions, which go on working, with what each stands for."""


def program(names: Iterable[str] = COMMANDS) -> Typer:
    """Return the command line with some of its commands; the modules of the others are not imported."""
    app = Typer(
        name="rubnoise",
        cls=Commands,
        help="Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die.\n\n"
        "Begin with: rubnoise demo, or with rubnoise run first/rubbing and what it prints.",
        rich_markup_mode=None,  # help in plain text
        pretty_exceptions_enable=False,
    )
    app.callback(invoke_without_command=True)(root)
    for name in sorted(names, key=list(COMMANDS).index):
        module_name, _, function = COMMANDS[name].partition(".")
        module = import_module(f"rubnoise.cli.{module_name}")
        command = getattr(module, function)
        panel = next(heading for heading, commands in HEADINGS.items() if name in commands)
        settings = {"cls": Command, "rich_help_panel": panel, **getattr(module, "SETTINGS", {})}
        settings |= {"hidden": panel == "Hidden"}
        app.command(name, **settings)(command)
        for given in signature(command).parameters.values():
            for about in getattr(given.annotation, "__metadata__", ()):
                # A command that opens a file says in one line what is wrong with it; typer would say less, in a frame.
                about.readable = False
                if about.show_default is True and given.default in (None, given.empty):
                    about.show_default = False  # options without a default; some versions of typer show None
    return app


@dataclass(slots=True)
class Flags:
    """The options of the command line as a whole, which ``main`` needs when a command has failed."""

    debug: bool = False


def root(
    context: typer.Context,
    *,
    version: bool = typer.Option(False, "--version", "-V", help="Print the version and exit.", is_eager=True),
    debug: bool = typer.Option(False, DEBUG, help="Show where in the program something failed; also after COMMAND."),
) -> None:
    """Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die."""
    context.obj.debug = debug
    if version:
        from rubnoise.cli.version import version_line

        print(version_line())
        raise typer.Exit


def main() -> None:
    """Run the command line; an error becomes one text on stderr and an exit code.

    Only --debug prints a traceback.
    """
    # What a command loads stays to the end, and a run makes no garbage that grows.
    gc.set_threshold(20_000, 50, 50)
    warnings.formatwarning = _warning_text
    with _lossless_streams():
        _answer(Flags())


def _answer(flags: Flags) -> None:
    try:
        _call(flags)
    except KeyboardInterrupt:
        sys.exit(130)
    except BrokenPipeError:
        _discard_output()  # the reader has closed the pipe
        sys.exit(1)
    except Exception as problem:  # noqa: BLE001  (any failure is printed as one line)
        if isinstance(problem, OSError):
            _discard_output()
        with escaping():
            if flags.debug:
                traceback.print_exc()
            print(_error_text(problem), file=sys.stderr)
        sys.exit(problem.exit_code if isinstance(problem, RubnoiseError) else 1)


class _CompleteWrites(BufferedWriter):
    """A writer for a raw stream, which may write only a part of the bytes: it writes all of them, or raises OSError."""

    def write(self, data: Any) -> int:
        """Write all of the data."""
        written = super().write(data)
        self.flush()
        return written

    def close(self) -> None:
        """Leave the raw stream open, since it belongs to others; no bytes are waiting."""


@contextmanager
def _lossless_streams() -> Iterator[None]:
    """Replace the standard streams in this context by streams that lose no bytes and write any character."""
    before = sys.stdout, sys.stderr
    lossless = [_lossless(stream) for stream in before]
    sys.stdout, sys.stderr = lossless
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before
        for stream, was in zip(lossless, before, strict=True):
            if isinstance(stream, TextIOWrapper) and stream is not was:
                stream.detach()  # or its end would count as that of the raw stream


def _lossless(stream: TextIO) -> TextIO:
    """Return a standard stream that loses no bytes, also with PYTHONUNBUFFERED, and writes any character."""
    if not isinstance(stream, TextIOWrapper):
        return stream
    # A file name or title that the terminal's encoding lacks is no reason to fail.
    stream.reconfigure(errors="backslashreplace")
    if not isinstance(stream.buffer, RawIOBase):
        return stream
    return TextIOWrapper(
        _CompleteWrites(stream.buffer),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering,
        write_through=True,
    )


def _call(flags: Flags) -> None:
    out = sys.stdout  # for which typer puts another in a closed pipe, whose flush says nothing
    try:
        arguments = _debug_first(sys.argv[1:]) or ["--help"]
        command = next((word for word in arguments if not word.startswith("-")), None)
        if command in EARLIER:
            place = arguments.index(command)
            arguments[place : place + 1] = EARLIER[command]
            command = arguments[place]
        if command == "surface" and "--synthesise" in arguments:
            arguments.remove("--synthesise")
            arguments[arguments.index(command)] = command = "surface --synthesise"
        app = program([command]) if command in COMMANDS else program()
        app(arguments, prog_name="rubnoise", obj=flags)
    finally:
        out.flush()


def _debug_first(arguments: list[str]) -> list[str]:
    """Return the arguments with --debug, from any place before a --, moved in front of the command."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    others = [word for word in arguments[:end] if word != DEBUG]
    return [DEBUG] * (len(others) < end) + others + arguments[end:]


def _warning_text(message: Warning | str, *_where: object, **_line: object) -> str:
    """Return a warning of Python as a line in the form of all warnings of a command."""
    return f"warning: {message}\n"


def _error_text(problem: Exception) -> str:
    """Return the message of an error: one line, for a refused scenario one for each of its problems."""
    if isinstance(problem, ScenarioRefused):
        return str(problem)  # which holds lines of a file
    if isinstance(problem, RunFileRefused | OutputRefused):
        return in_shell(str(problem)).replace("\n", "\\n")  # of a name, which has no line of its own
    if isinstance(problem, RubnoiseError):
        return in_shell(str(problem))
    if isinstance(problem, OSError):
        return f"{problem.filename or 'output'}: {problem.strerror or problem}"
    if isinstance(problem, MemoryError):
        return "out of memory; a shorter run, or a coarser output.tick, needs less"
    what = " ".join(f"{type(problem).__name__}: {problem}".split())
    return f"internal error, which should not be: {what} ({DEBUG} shows where)"


def _discard_output() -> None:
    """Discard the unwritten output, so that Python does not try to write it again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
