"""`rubnoise check`: what scenario files say, what follows from them, and what is wrong with them."""

import sys
from pathlib import Path
from typing import Annotated, Any

import typer


def command(
    files: Annotated[list[Path], typer.Argument(help="Scenario files.", metavar="FILE", show_default=False)],
    *,
    changes: Annotated[
        list[str] | None, typer.Option("--set", help="Change a key, as for run.", metavar="KEY=VALUE")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """Check scenarios, and print what follows from them: sizes, exact means and spreads, validity and cost.

    Example: rubnoise check scenarios/paper/fig5.toml
    """
    import json

    from rubnoise.cli.derivation import derived, described
    from rubnoise.cli.loading import scenario_of
    from rubnoise.errors import RubnoiseError

    answers: dict[str, Any] = {}
    refused: dict[str, str] = {}
    for file in files:
        try:
            scenario = scenario_of(file, changes or (), quiet=as_json)
            answers[str(file)] = derived(scenario)
        except RubnoiseError as problem:
            print(problem, file=sys.stderr)
            refused[str(file)] = str(problem)
            continue
        if not as_json:
            print("\n".join([f"{file}: ok", *described(scenario, answers[str(file)])]))
    if as_json:
        print(json.dumps({"scenarios": answers, "refused": refused}))
    if refused:
        raise typer.Exit(2)
