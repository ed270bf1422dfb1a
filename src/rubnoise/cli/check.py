"""`rubnoise check`: what scenario files say, what follows from them, and what is wrong with them."""

import sys
from collections.abc import Sequence
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

    For a file with a table [sweep], check and list every point.

    Example: rubnoise check scenarios/paper/fig5.toml
    """
    import json

    from rubnoise.errors import RubnoiseError

    answers: dict[str, dict[str, Any]] = {"scenarios": {}, "sweeps": {}, "refused": {}}
    for file in files:
        try:
            group, answer, lines = _checked(file, changes or (), quiet=as_json)
        except RubnoiseError as problem:
            print(problem, file=sys.stderr)
            answers["refused"][str(file)] = str(problem)
            continue
        answers[group][str(file)] = answer
        if not as_json:
            print("\n".join([f"{file}: ok", *lines]))
    if as_json:
        print(json.dumps(answers))
    if answers["refused"]:
        raise typer.Exit(2)


def _checked(file: Path, changes: Sequence[str], *, quiet: bool) -> tuple[str, dict[str, Any], list[str]]:
    """Return the group that the answer for a file belongs to, the answer, and its lines to print."""
    from rubnoise.cli import derivation, sweep_table
    from rubnoise.cli.loading import scenario_or_sweep
    from rubnoise.scenario import Scenario

    found = scenario_or_sweep(file, changes, quiet=quiet)
    if isinstance(found, Scenario):
        answer = derivation.derived(found) | {"cost": derivation.cost(found)}
        answer["notes"] += derivation.shortages(found, file)
        return "scenarios", answer, derivation.described(found, answer)
    answer = sweep_table.contents(found)
    return "sweeps", answer, sweep_table.described(answer)
