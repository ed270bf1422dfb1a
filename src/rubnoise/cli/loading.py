"""Open the input of a command: a scenario with its overrides and warnings, a sweep, or a finished result."""

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import rubnoise
from rubnoise.api.scenarios import Loaded, read_by
from rubnoise.cli.terminal import NUMBER
from rubnoise.errors import Refused, naming
from rubnoise.regular_file import is_hdf5
from rubnoise.scenario import Scenario, load
from rubnoise.scenario.layers import OptionOverride, override_value
from rubnoise.scenario.reading import in_full

if TYPE_CHECKING:
    from rubnoise.storage.reader import RunFile


def overrides(changes: Sequence[str] | None, *, seed: int | None = None, engine: str | None = None) -> tuple[str, ...]:
    """Return all KEY=VALUE changes, with those of options for a single key."""
    named = (("--seed", "run.seed", seed), ("--engine", "run.engine", engine))
    return (*(changes or ()), *(OptionOverride(*each) for each in named if each[-1] is not None))


def axes(over: Sequence[str] | None) -> tuple[str, ...]:
    """Return changes that add each KEY=VALUE,VALUE,... to the grid of a sweep; raises Refused for another form.

    Numbers without a unit have that of the last value; a list of TOML, ``diameter.law=["normal", "gamma"]``, is taken
    as it is.
    """
    found = []
    for each in over or ():
        key, equals, text = each.partition("=")
        values = override_value(text) if text.lstrip().startswith("[") else _listed(text)
        if not equals or not isinstance(values, list) or not values:
            raise Refused(f"--over: {each!r:.60} is no key with values; right form: --over sliding.speed=5,10,20mm/s")
        (named,) = in_full([f"{key}=x"])
        found.append(OptionOverride(f"--over {key}", f"sweep.grid.{named.partition('=')[0]}", json.dumps(values)))
    return tuple(found)


def _listed(text: str) -> list[float | str]:
    """Return values between commas: numbers, texts, and quantities with the unit of the last one."""
    parts = [part.strip() for part in text.split(",")]
    unit = NUMBER.sub("", parts[-1]).strip()
    with_unit = bool(unit) and unit != parts[-1]
    return [f"{part} {unit}" if with_unit and NUMBER.fullmatch(part) else override_value(part) for part in parts]


def loaded(read: Callable[..., Loaded], file: Path, changes: Sequence[str] = (), *, quiet: bool = False) -> Loaded:
    """Read a scenario or a sweep, from a file or by its shipped name, and print its warnings; raises ScenarioRefused.

    ``read`` says which: `load`, `load_sweep`, or `load_either`.
    """
    found = read_by(read, file, changes)
    if not quiet:
        for warning in found.warnings:
            print(warning, file=sys.stderr)
    return found


def scenario_or_result(file: Path, changes: Sequence[str] = (), *, quiet: bool = False) -> Scenario:
    """Load a scenario, or take that of a result; raises Refused for changes to the scenario of a result."""
    if not is_hdf5(file):
        return loaded(load, file, changes, quiet=quiet)
    if changes:
        raise Refused(f"{file}: is a result, whose scenario --set can't change any more")
    with rubnoise.open(file) as run:
        return run.scenario


@contextmanager
def finished_run(path: Path) -> Iterator["RunFile"]:
    """Open a result file; the message of a refusal begins with its name.

    Raises RunFileRefused if open_run refuses it, or if its values cannot be used.
    """
    from rubnoise.storage.reader import calculating, open_run

    with open_run(path) as file, naming(path), calculating(path):
        yield file
