"""The command line: `rubnoise COMMAND`. Commands import what they need when they are called, so that --help is fast."""

import os
import sys
import traceback
from dataclasses import dataclass
from io import TextIOWrapper

import typer
from typer import Typer

from rubnoise.cli import (
    animate,
    check,
    claims,
    compare,
    export,
    figures,
    info,
    junction,
    junctions,
    listen,
    new,
    plot,
    resume,
    run,
    schema,
    sweep,
    teach,
    theory,
    verify,
)
from rubnoise.cli.helping import Command
from rubnoise.cli.showing import Commands, escaping
from rubnoise.cli.starting import collect_garbage_seldom
from rubnoise.errors import OutputRefused, RubnoiseError, RunFileRefused

DEBUG = "--debug"

app = Typer(
    name="rubnoise",
    cls=Commands,
    help="Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
app.command("run", cls=Command)(run.command)
app.command("resume", cls=Command)(resume.command)
app.command("sweep", cls=Command)(sweep.command)
app.command("check", cls=Command)(check.command)
app.command("info", cls=Command)(info.command)
# Unknown options pass, so that the row number -1 gets its own answer; the command refuses the others.
app.command("junction", cls=Command, context_settings={"ignore_unknown_options": True})(junction.command)
app.command("junctions", cls=Command)(junctions.command)
app.command("compare", cls=Command)(compare.command)
app.command("verify", cls=verify.BareCount)(verify.command)
app.command("plot", cls=Command)(plot.command)
app.command("animate", cls=Command)(animate.command)
app.command("theory", cls=Command)(theory.command)
app.command("figures", cls=Command)(figures.command)
app.command("claims", cls=Command)(claims.command)
app.command("listen", cls=Command)(listen.command)
app.command("teach", cls=Command)(teach.command)
app.command("export", cls=Command)(export.command)
app.command("new", cls=Command)(new.command)
app.command("schema", cls=Command)(schema.command)

for registered in app.registered_commands:
    for annotation in getattr(registered.callback, "__annotations__", {}).values():
        for about in getattr(annotation, "__metadata__", ()):
            # A command that opens a file says in one line what is wrong with it; typer would say less, in a frame.
            about.readable = False


@dataclass(slots=True)
class Wishes:
    """What was asked of the command line as a whole, for ``main`` to know when a command has failed."""

    debug: bool = False


@app.callback(invoke_without_command=True)
def root(
    context: typer.Context,
    *,
    version: bool = typer.Option(False, "--version", help="Print the version and exit.", is_eager=True),
    debug: bool = typer.Option(False, DEBUG, help="Show where in the program something failed; also after COMMAND."),
) -> None:
    """Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die."""
    context.obj.debug = debug
    if version:
        from rubnoise import __version__

        print(f"rubnoise {__version__}")
        raise typer.Exit


def main() -> None:
    """Run the command line; what is refused or fails is one text on stderr and an exit code.

    A traceback is for who asks for it, with --debug.
    """
    collect_garbage_seldom()
    for stream in (sys.stdout, sys.stderr):
        # A file name or title that the terminal's encoding lacks is no reason to fail.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    wishes = Wishes()
    try:
        _call(wishes)
    except KeyboardInterrupt:
        sys.exit(130)
    except BrokenPipeError:
        _forget_output()  # whoever read it has seen enough
        sys.exit(1)
    except Exception as problem:  # noqa: BLE001  (whatever it is, it is told in a line)
        if isinstance(problem, OSError):
            _forget_output()
        with escaping():
            if wishes.debug:
                traceback.print_exc()
            print(_told(problem), file=sys.stderr)
        sys.exit(problem.exit_code if isinstance(problem, RubnoiseError) else 1)


def _call(wishes: Wishes) -> None:
    try:
        app(_debug_first(sys.argv[1:]), prog_name="rubnoise", obj=wishes)
    finally:
        sys.stdout.flush()


def _debug_first(arguments: list[str]) -> list[str]:
    """Return the arguments with --debug, wherever it stands before a --, in front of the command."""
    end = arguments.index("--") if "--" in arguments else len(arguments)
    others = [word for word in arguments[:end] if word != DEBUG]
    return [DEBUG] * (len(others) < end) + others + arguments[end:]


def _told(problem: Exception) -> str:
    """Return a failure as a line; a refused scenario has one for each of its problems."""
    if isinstance(problem, RunFileRefused | OutputRefused):
        return str(problem).replace("\n", "\\n")  # of a name, which has no line of its own
    if isinstance(problem, RubnoiseError):
        return str(problem)
    if isinstance(problem, OSError):
        return f"{problem.filename or 'output'}: {problem.strerror or problem}"
    if isinstance(problem, MemoryError):
        return "out of memory; a shorter run, or a coarser output.tick, needs less"
    what = " ".join(f"{type(problem).__name__}: {problem}".split())
    return f"internal error, which should not be: {what} ({DEBUG} shows where)"


def _forget_output() -> None:
    """Keep Python from trying once more, at exit, to write what could not be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
