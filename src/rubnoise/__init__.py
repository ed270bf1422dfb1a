"""Event-driven simulation of the vibrations excited by adhesive micro-junctions during sliding."""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rubnoise.analysis.findings import Comparison as Comparison
    from rubnoise.answer import Row as Row
    from rubnoise.api.columns import Column as Column
    from rubnoise.api.columns import Columns as Columns
    from rubnoise.api.estimates import Autocovariance as Autocovariance
    from rubnoise.api.estimates import PowerSpectrum as PowerSpectrum
    from rubnoise.api.fit import Inference as Inference
    from rubnoise.api.inferring import infer as infer
    from rubnoise.api.run import Junction as Junction
    from rubnoise.api.run import Run as Run
    from rubnoise.api.run import open as open  # noqa: A004  (rubnoise.open reads like h5py.File)
    from rubnoise.api.running import Record as Record
    from rubnoise.api.running import exact as exact
    from rubnoise.api.running import run as run
    from rubnoise.api.running import run_sweep as run_sweep
    from rubnoise.api.running import simulate as simulate
    from rubnoise.api.running import sweep as sweep
    from rubnoise.api.scenarios import build as build
    from rubnoise.api.scenarios import example as example
    from rubnoise.api.scenarios import examples as examples
    from rubnoise.api.scenarios import load as load
    from rubnoise.api.scenarios import load_sweep as load_sweep
    from rubnoise.api.surface import Surface as Surface
    from rubnoise.api.sweep_result import SweepResult as SweepResult
    from rubnoise.api.sweep_result import open_sweep as open_sweep
    from rubnoise.api.trace import Trace as Trace
    from rubnoise.errors import Refused as Refused
    from rubnoise.errors import RubnoiseError as RubnoiseError
    from rubnoise.record.rows import JunctionState as JunctionState
    from rubnoise.runs.verification import Verification as Verification
    from rubnoise.scenario import Scenario as Scenario
    from rubnoise.scenario.sweep import expand as expand
    from rubnoise.simulation.observer import LiveJunctions as LiveJunctions
    from rubnoise.simulation.observer import Observer as Observer
    from rubnoise.theory.ancestors import greenwood_williamson as greenwood_williamson
    from rubnoise.theory.exact import Exact as Exact

__version__ = "0.1.0"
HOMES: Final = {
    "rubnoise.answer": ("Row",),
    "rubnoise.analysis.findings": ("Comparison",),
    "rubnoise.runs.verification": ("Verification",),
    "rubnoise.api.columns": ("Column", "Columns"),
    "rubnoise.api.estimates": ("Autocovariance", "PowerSpectrum"),
    "rubnoise.api.fit": ("Inference",),
    "rubnoise.api.inferring": ("infer",),
    "rubnoise.api.run": ("Junction", "Run", "open"),
    "rubnoise.api.running": ("Record", "exact", "run", "run_sweep", "simulate", "sweep"),
    "rubnoise.api.scenarios": ("build", "example", "examples", "load", "load_sweep"),
    "rubnoise.api.surface": ("Surface",),
    "rubnoise.api.sweep_result": ("SweepResult", "open_sweep"),
    "rubnoise.api.trace": ("Trace",),
    "rubnoise.errors": ("Refused", "RubnoiseError"),
    "rubnoise.record.rows": ("JunctionState",),
    "rubnoise.scenario": ("Scenario",),
    "rubnoise.scenario.sweep": ("expand",),
    "rubnoise.simulation.observer": ("LiveJunctions", "Observer"),
    "rubnoise.theory.ancestors": ("greenwood_williamson",),
    "rubnoise.theory.exact": ("Exact",),
}
"""The module of each public name."""

__all__ = sorted(["__version__", *(name for names in HOMES.values() for name in names)])  # noqa: PLE0605  (said once)


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
