"""The command line: `rubnoise COMMAND`.

A call imports only the module of its command, and each command imports large libraries in its functions: --help, which
shows all commands, takes a tenth of a second.
"""

import os
import sys
import traceback
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from importlib import import_module
from inspect import signature
from io import StringIO
from pathlib import Path
from typing import Any, Final, TextIO

import typer
from typer import Typer
from typer.core import TyperCommand, TyperGroup

from rubnoise.answer import printable
from rubnoise.errors import OutputRefused, Refused, RubnoiseError, RunFileRefused, ScenarioRefused, in_shell

DEBUG = "--debug"

INSTEAD: Final = {
    "animate": "films are not drawn any more; `rubnoise page RUN.h5 --as lesson` shows junctions as they slide",
    "cite": "the entry to cite is CITATION.cff of the project; `rubnoise --version` prints the version to give with it",
    "claims": "`python tools/paper` in a clone of the project tests the claims of the paper and of its field",
    "contact": "call rubnoise.greenwood_williamson(...) in Python, which takes the same words",
    "docs": "the pages stand in the folder docs of the project, and on its site",
    "figures": "`python tools/paper -o figures` in a clone of the project draws the figures of the paper",
    "resume": "a run is not resumed any more; the `rubnoise run` that began it makes it again, with the same bits",
}
"""What to do in place of each command of an earlier version, which ends with exit code 2."""

HEADINGS: Final = {
    "Begin and run": ("check.new", "check.examples", "check.check", "make.run", "make.sweep", "make.demo"),
    "Look at a result": (
        "ask.info",
        "junctions.junctions",
        "plot.plot",
        "write.page",
        "write.listen",
        "write.export",
    ),
    "Compare": ("theory.theory", "ask.compare", "ask.verify"),
    "Measure": ("measure.infer", "measure.surface"),
    "Hidden": ("check.schema", "measure.surface --synthesise"),
}
"""The modules and functions of the commands, which have the same names, under the headings of --help."""

COMMANDS: Final = {path.partition(".")[2]: path.partition(".")[0] for paths in HEADINGS.values() for path in paths}
"""The module of this package with each command."""

EARLIER: Final = {
    "view": ("page", "--as", "view"),
    "report": ("page", "--as", "report"),
    "teach": ("page", "--as", "lesson"),
    "junction": ("junctions",),
}
"""Words of earlier versions, which go on working, with what each stands for."""


class Command(TyperCommand):
    """A command whose arguments are explained without their types."""

    def __init__(self, *names: Any, **rest: Any) -> None:
        """Make a command (see click)."""
        super().__init__(*names, **rest)
        for param in self.params:
            if param.param_type_name == "argument":
                param.display_type_rich = lambda **_context: ""  # type: ignore[attr-defined]


class Commands(TyperGroup):
    """The group of commands: --help lists them under their headings."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands that are not hidden with a line each, under their headings (see click)."""
        del ctx
        for heading, paths in HEADINGS.items():
            names = [path.partition(".")[2] for path in paths]
            some = [self.commands[name] for name in names if name in self.commands and heading != "Hidden"]
            if some:
                with formatter.section(heading):
                    formatter.write_dl([(str(each.name), each.get_short_help_str(formatter.width)) for each in some])


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
    for name in sorted(names, key=[*COMMANDS].index):
        command = getattr(import_module(f"rubnoise.cli.{COMMANDS[name]}"), name.rpartition("--")[2])
        app.command(name, cls=Command, hidden=f"{COMMANDS[name]}.{name}" in HEADINGS["Hidden"])(command)
        for given in signature(command).parameters.values():
            for about in getattr(given.annotation, "__metadata__", ()):
                # A command that opens a file says in one line what is wrong with it; typer would say less, in a frame.
                about.readable = False
                if given.annotation.__origin__ == Path | None and about.metavar != "DIR":
                    about.parser = _file_name
                if about.show_default is True and given.default in (None, given.empty):
                    about.show_default = False  # options without a default; some versions of typer show None
    return app


def _file_name(text: str) -> Path:
    """Return the path of a file; refuse a slash at the end, which a Path would drop."""
    if text.endswith(("/", os.sep)):
        raise typer.BadParameter(f"{text}: names a folder; name a file")
    return Path(text)


def root(
    *,
    version: bool = typer.Option(False, "--version", "-V", help="Print the version and exit.", is_eager=True),
    # Read before the command is chosen; here it is for --help alone.
    _debug: bool = typer.Option(False, DEBUG, help="Show where in the program something failed; also after COMMAND."),
) -> None:
    """Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die."""
    if version:
        from rubnoise.cli.version import version_line

        print(version_line())
        raise typer.Exit


def main() -> None:
    """Run the command line; an error becomes one text on stderr and an exit code.

    Only --debug prints a traceback.
    """
    warnings.formatwarning = lambda message, *_where, **_line: f"warning: {message}\n"
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # a name that the terminal's encoding lacks is no reason to fail
            stream.reconfigure(errors="backslashreplace")
    end = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    arguments = [word for word in sys.argv[1:end] if word != DEBUG] + sys.argv[end:]
    with escaping():
        try:
            sys.exit(_call(arguments or ["--help"]) or 0)
        except Exception as problem:  # noqa: BLE001  (any failure is printed as one line)
            if isinstance(problem, OSError):  # Python does not try to write again at exit
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            if DEBUG in sys.argv[1:end]:
                traceback.print_exc()
            if not isinstance(problem, BrokenPipeError):  # whose reader has closed the pipe
                print(_error_text(problem), file=sys.stderr)
            sys.exit(getattr(problem, "exit_code", 1))


class Escaping:
    """A stream that escapes what does not print as itself in the texts written to it: files may hold anything.

    Line ends stay, and a carriage return in front, with which a line of progress overwrites the one before.
    """

    def __init__(self, stream: TextIO) -> None:
        """Take the stream beneath."""
        self.beneath = stream

    def write(self, text: str) -> int:
        """Write a text, escaped."""
        return self.beneath.write(escaped(text))

    def writelines(self, lines: Iterator[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.beneath, name)


def escaped(text: str) -> str:
    """Return a text with its line ends, and other characters that do not print as themselves escaped."""
    if text.replace("\n", "").isprintable():
        return text
    start = "\r" if text.startswith("\r") else ""
    return start + "\n".join(map(printable, text[len(start) :].split("\n")))


@contextmanager
def escaping() -> Iterator[None]:
    """Escape all output on both streams in this context."""
    with redirect_stdout(Escaping(sys.stdout)), redirect_stderr(Escaping(sys.stderr)):
        yield


def _call(arguments: list[str]) -> Any:
    """Call a command, and return its exit code, None if it has none."""
    out = sys.stdout  # for which typer puts another in a closed pipe, whose flush says nothing
    try:
        command = next((word for word in arguments if not word.startswith("-")), None)
        if command in INSTEAD:
            raise Refused(f"rubnoise {command}: {INSTEAD[command]}")
        if command in EARLIER:
            place = arguments.index(command)
            arguments[place : place + 1] = EARLIER[command]
            command = arguments[place]
        if command == "surface" and "--synthesise" in arguments:
            arguments.remove("--synthesise")
            arguments[arguments.index(command)] = command = "surface --synthesise"
        app = program([command]) if command in COMMANDS else program()
        return app(arguments, prog_name="rubnoise", standalone_mode=False)
    finally:
        out.flush()


def _error_text(problem: Exception) -> str:
    """Return the message of an error: one line, for a refused scenario one for each of its problems."""
    if hasattr(problem, "show"):  # a wrong call, of which typer says how it is called
        problem.message = str(problem.message).removeprefix("Value error, ")  # type: ignore[attr-defined]
        problem.show(shown := StringIO())
        return shown.getvalue().expandtabs().removesuffix("\n")
    if isinstance(problem, ScenarioRefused):
        return str(problem)  # which holds lines of a file
    if isinstance(problem, RubnoiseError):
        of_a_name = isinstance(problem, RunFileRefused | OutputRefused)  # names may hold line ends
        return in_shell(str(problem)).replace("\n", "\\n" if of_a_name else "\n")
    if isinstance(problem, OSError):
        return f"{problem.filename or 'output'}: {problem.strerror or problem}"
    if isinstance(problem, MemoryError):
        return "out of memory; a shorter run, or a coarser output.tick, needs less"
    what = " ".join(f"{type(problem).__name__}: {problem}".split())
    return f"internal error, which should not be: {what} ({DEBUG} shows where)"
