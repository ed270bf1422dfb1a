"""Reading a scenario for a command: overrides in, warnings on stderr, refusals raised."""

import sys
from collections.abc import Sequence
from pathlib import Path

from rubnoise.scenario import Scenario, load


def overrides(changes: Sequence[str] | None, *, seed: int | None = None, engine: str | None = None) -> tuple[str, ...]:
    """Return KEY=VALUE changes, those of the options that stand for a key among them."""
    named = {"run.seed": seed, "run.engine": engine}
    return (*(changes or ()), *(f"{key}={value}" for key, value in named.items() if value is not None))


def scenario_of(file: Path, changes: Sequence[str] = (), *, quiet: bool = False) -> Scenario:
    """Load a scenario and print its warnings; raises ScenarioRefused with every problem at once."""
    scenario = load(file, changes)
    if not quiet:
        for warning in scenario.warnings:
            print(warning, file=sys.stderr)
    return scenario
