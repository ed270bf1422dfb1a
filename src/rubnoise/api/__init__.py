"""Everything rubnoise does, as Python functions: load a scenario, run it, open a result, ask the theory."""

from rubnoise.analysis.agreement import Agreement
from rubnoise.api.columns import Column, Columns
from rubnoise.api.junction import Junction
from rubnoise.api.record import Record
from rubnoise.api.result import Run, open  # noqa: A004  (rubnoise.open reads like h5py.File)
from rubnoise.api.running import exact, run, simulate
from rubnoise.errors import Refused, RubnoiseError
from rubnoise.record.rows import JunctionState
from rubnoise.scenario import Scenario, build, load
from rubnoise.theory.exact import Exact

__all__ = [
    "Agreement",
    "Column",
    "Columns",
    "Exact",
    "Junction",
    "JunctionState",
    "Record",
    "Refused",
    "RubnoiseError",
    "Run",
    "Scenario",
    "build",
    "exact",
    "load",
    "open",
    "run",
    "simulate",
]
