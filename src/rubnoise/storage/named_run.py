"""The result of a run of a sweep, opened under the name of the run."""

import json
import os

from rubnoise.errors import Refused, RunFileRefused
from rubnoise.record.reader import Reader
from rubnoise.storage.reader import RunFile, open_run


def open_named(path: str | os.PathLike[str], run_id: str) -> RunFile:
    """Open the result of a run by its file and its name; raises RunFileRefused for the result of another run."""
    file = open_run(path)
    try:
        name = name_of(file)
    except BaseException:
        file.close()
        raise
    if name == run_id:
        return file
    file.close()
    raise RunFileRefused(f"{path}: is the result of another run, {name}")


def name_of(file: Reader) -> str:
    """Return the name that the scenario in a file has in a sweep; raises RunFileRefused where there is none."""
    from rubnoise.scenario import build
    from rubnoise.scenario.points import run_id

    try:
        return run_id(build(json.loads(str(file.provenance["scenario_resolved"]))))
    except (ValueError, RecursionError, AttributeError, TypeError, Refused) as problem:
        raise RunFileRefused(f"{file.path}: the scenario in the file is not valid") from problem
