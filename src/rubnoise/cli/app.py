"""The command line: `rubnoise COMMAND`. Commands import what they need when they are called, so that --help is fast."""

import sys

import typer
from typer import Typer

from rubnoise.cli import check, info, run, schema
from rubnoise.errors import RubnoiseError

app = Typer(
    name="rubnoise",
    help="Simulate the noise of rubbing surfaces: micro-junctions that are born, grow, shrink and die.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command("run")(run.command)
app.command("check")(check.command)
app.command("info")(info.command)
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
    try:
        app(prog_name="rubnoise")
    except RubnoiseError as problem:
        print(problem, file=sys.stderr)
        sys.exit(problem.exit_code)
    except BrokenPipeError:
        # Whoever read our output has seen enough; Python must not try to flush the rest at exit.
        sys.stderr.close()
        sys.exit(141)
