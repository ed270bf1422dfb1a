"""The command line: `rubnoise COMMAND`. Commands import what they need when they are called, so that --help is fast."""

import os
import sys
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
    run,
    schema,
    teach,
    theory,
)
from rubnoise.errors import RubnoiseError

app = Typer(
    name="rubnoise",
    help="Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
app.command("run")(run.command)
app.command("check")(check.command)
app.command("info")(info.command)
# Unknown options pass, so that the row number -1 gets its own answer; the command refuses the others.
app.command("junction", context_settings={"ignore_unknown_options": True})(junction.command)
app.command("junctions")(junctions.command)
app.command("compare")(compare.command)
app.command("plot")(plot.command)
app.command("animate")(animate.command)
app.command("theory")(theory.command)
app.command("figures")(figures.command)
app.command("claims")(claims.command)
app.command("listen")(listen.command)
app.command("teach")(teach.command)
app.command("export")(export.command)
app.command("new")(new.command)
app.command("schema")(schema.command)


@app.callback(invoke_without_command=True)
def root(
    *,
    version: bool = typer.Option(False, "--version", help="Print the version and leave.", is_eager=True),
) -> None:
    """Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die."""
    if version:
        from rubnoise import __version__

        print(f"rubnoise {__version__}")
        raise typer.Exit


def main() -> None:
    """Run the command line; what is refused or fails is one text on stderr and an exit code, never a traceback."""
    for stream in (sys.stdout, sys.stderr):
        # A file name or title that the terminal's encoding lacks is no reason to fail.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        _call()
    except RubnoiseError as problem:
        print(problem, file=sys.stderr)
        sys.exit(problem.exit_code)
    except KeyboardInterrupt:
        sys.exit(130)
    except BrokenPipeError:
        _forget_output()  # whoever read it has seen enough
        sys.exit(1)
    except OSError as problem:
        _forget_output()
        print(f"{problem.filename or 'output'}: {problem.strerror or problem}", file=sys.stderr)
        sys.exit(1)


def _call() -> None:
    try:
        app(prog_name="rubnoise")
    finally:
        sys.stdout.flush()


def _forget_output() -> None:
    """Keep Python from trying once more, at exit, to write what could not be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
