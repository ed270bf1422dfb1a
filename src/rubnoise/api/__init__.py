"""Everything rubnoise does, as Python functions: load a scenario, run it, open a result, ask the theory."""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rubnoise.analysis.agreement import Agreement
    from rubnoise.api.column import Column
    from rubnoise.api.columns import Columns
    from rubnoise.api.inferring import infer
    from rubnoise.api.junction import Junction
    from rubnoise.api.record import Record
    from rubnoise.api.result import Run, open  # noqa: A004  (rubnoise.open reads like h5py.File)
    from rubnoise.api.resuming import resume
    from rubnoise.api.running import exact, run, simulate
    from rubnoise.api.sweep_result import SweepResult, open_sweep
    from rubnoise.api.sweeping import run_sweep
    from rubnoise.errors import Refused, RubnoiseError
    from rubnoise.inference.inference import Inference
    from rubnoise.record.rows import JunctionState
    from rubnoise.scenario import Scenario, build, load
    from rubnoise.scenario.sweep import expand, load_sweep
    from rubnoise.simulation.intervention import LiveJunctions
    from rubnoise.simulation.observer import Observer
    from rubnoise.theory.exact import Exact

__all__ = [
    "Agreement",
    "Column",
    "Columns",
    "Exact",
    "Inference",
    "Junction",
    "JunctionState",
    "LiveJunctions",
    "Observer",
    "Record",
    "Refused",
    "RubnoiseError",
    "Run",
    "Scenario",
    "SweepResult",
    "build",
    "exact",
    "expand",
    "infer",
    "load",
    "load_sweep",
    "open",
    "open_sweep",
    "resume",
    "run",
    "run_sweep",
    "simulate",
]

HOMES: Final = {
    "rubnoise.analysis.agreement": ("Agreement",),
    "rubnoise.api.column": ("Column",),
    "rubnoise.api.columns": ("Columns",),
    "rubnoise.api.inferring": ("infer",),
    "rubnoise.api.junction": ("Junction",),
    "rubnoise.api.record": ("Record",),
    "rubnoise.api.result": ("Run", "open"),
    "rubnoise.api.resuming": ("resume",),
    "rubnoise.api.running": ("exact", "run", "simulate"),
    "rubnoise.api.sweep_result": ("SweepResult", "open_sweep"),
    "rubnoise.api.sweeping": ("run_sweep",),
    "rubnoise.errors": ("Refused", "RubnoiseError"),
    "rubnoise.inference.inference": ("Inference",),
    "rubnoise.record.rows": ("JunctionState",),
    "rubnoise.scenario": ("Scenario", "build", "load"),
    "rubnoise.scenario.sweep": ("expand", "load_sweep"),
    "rubnoise.simulation.intervention": ("LiveJunctions",),
    "rubnoise.simulation.observer": ("Observer",),
    "rubnoise.theory.exact": ("Exact",),
}


def __getattr__(name: str) -> object:
    """Return a name on its first use: who opens a result need not wait for what runs one (PEP 562)."""
    home = next((module for module, names in HOMES.items() if name in names), None)
    if home is None:
        message = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(message)
    value = globals()[name] = getattr(import_module(home), name)
    return value
