"""Event-driven simulation of the vibrations excited by adhesive micro-junctions during sliding."""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rubnoise.analysis.agreement import Agreement
    from rubnoise.analysis.findings import Comparison
    from rubnoise.api.column_group import Columns
    from rubnoise.api.columns import Column
    from rubnoise.api.estimates import Autocovariance, PowerSpectrum
    from rubnoise.api.fit import Inference
    from rubnoise.api.inferring import infer
    from rubnoise.api.junction import Junction
    from rubnoise.api.run import Run, open  # noqa: A004  (rubnoise.open reads like h5py.File)
    from rubnoise.api.running import Record, exact, run, simulate
    from rubnoise.api.scenarios import build, example, examples, load, load_sweep
    from rubnoise.api.surface import Surface
    from rubnoise.api.sweep_result import SweepResult, open_sweep
    from rubnoise.api.sweeps import run_sweep, sweep
    from rubnoise.api.trace import Trace
    from rubnoise.errors import Refused, RubnoiseError
    from rubnoise.record.rows import JunctionState
    from rubnoise.runs.verification import Verification
    from rubnoise.scenario import Scenario
    from rubnoise.scenario.sweep import expand
    from rubnoise.simulation.intervention import LiveJunctions
    from rubnoise.simulation.observer import Observer
    from rubnoise.theory.ancestors import greenwood_williamson
    from rubnoise.theory.exact import Exact

__version__ = "0.1.0"
__all__ = [
    "Agreement",
    "Autocovariance",
    "Column",
    "Columns",
    "Comparison",
    "Exact",
    "Inference",
    "Junction",
    "JunctionState",
    "LiveJunctions",
    "Observer",
    "PowerSpectrum",
    "Record",
    "Refused",
    "RubnoiseError",
    "Run",
    "Scenario",
    "Surface",
    "SweepResult",
    "Trace",
    "Verification",
    "__version__",
    "build",
    "exact",
    "example",
    "examples",
    "expand",
    "greenwood_williamson",
    "infer",
    "load",
    "load_sweep",
    "open",
    "open_sweep",
    "run",
    "run_sweep",
    "simulate",
    "sweep",
]

HOMES: Final = {
    "rubnoise.analysis.agreement": ("Agreement",),
    "rubnoise.analysis.findings": ("Comparison",),
    "rubnoise.runs.verification": ("Verification",),
    "rubnoise.api.column_group": ("Columns",),
    "rubnoise.api.columns": ("Column",),
    "rubnoise.api.estimates": ("Autocovariance", "PowerSpectrum"),
    "rubnoise.api.fit": ("Inference",),
    "rubnoise.api.inferring": ("infer",),
    "rubnoise.api.junction": ("Junction",),
    "rubnoise.api.run": ("Run", "open"),
    "rubnoise.api.running": ("Record", "exact", "run", "simulate"),
    "rubnoise.api.scenarios": ("build", "example", "examples", "load", "load_sweep"),
    "rubnoise.api.surface": ("Surface",),
    "rubnoise.api.sweep_result": ("SweepResult", "open_sweep"),
    "rubnoise.api.sweeps": ("run_sweep", "sweep"),
    "rubnoise.api.trace": ("Trace",),
    "rubnoise.errors": ("Refused", "RubnoiseError"),
    "rubnoise.record.rows": ("JunctionState",),
    "rubnoise.scenario": ("Scenario",),
    "rubnoise.scenario.sweep": ("expand",),
    "rubnoise.simulation.intervention": ("LiveJunctions",),
    "rubnoise.simulation.observer": ("Observer",),
    "rubnoise.theory.ancestors": ("greenwood_williamson",),
    "rubnoise.theory.exact": ("Exact",),
}
"""The module of each public name."""


def __getattr__(name: str) -> object:
    """Return a public name on its first use, so that unused modules are not loaded (PEP 562)."""
    home = next((module for module, names in HOMES.items() if name in names), None)
    if home is None:
        message = f"module {__name__!r} has no attribute {name!r}"
        if name.startswith("read_"):
            message += '; rubnoise.Trace("trace.csv") reads a measurement, rubnoise.open a result'
        elif near := next((each for each in __all__ if each in name.split("_")), ""):
            message += f"; did you mean rubnoise.{near}?"
        raise AttributeError(message)
    value = globals()[name] = getattr(import_module(home), name)
    return value


def __dir__() -> list[str]:
    return __all__
