"""Event-driven simulation of the vibrations excited by adhesive micro-junctions during sliding."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rubnoise.api import (
        Agreement,
        Autocovariance,
        Column,
        Columns,
        Comparison,
        Exact,
        Inference,
        Junction,
        JunctionState,
        LiveJunctions,
        Observer,
        PowerSpectrum,
        Record,
        Refused,
        RubnoiseError,
        Run,
        Scenario,
        Surface,
        SweepResult,
        Trace,
        Verification,
        build,
        draw_figures,
        exact,
        example,
        examples,
        expand,
        greenwood_williamson,
        infer,
        load,
        load_sweep,
        open,  # noqa: A004  (rubnoise.open reads like h5py.File)
        open_sweep,
        resume,
        run,
        run_sweep,
        simulate,
    )

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
    "draw_figures",
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
    "resume",
    "run",
    "run_sweep",
    "simulate",
]


def __getattr__(name: str) -> object:
    """Return a public name on its first use, so that importing rubnoise costs nothing (PEP 562)."""
    if name not in __all__:
        message = f"module {__name__!r} has no attribute {name!r}"
        if name.startswith("read_"):
            message += '; rubnoise.Trace("trace.csv") reads a measurement, rubnoise.open a result'
        elif near := next((each for each in __all__ if each in name.split("_")), ""):
            message += f"; did you mean rubnoise.{near}?"
        raise AttributeError(message)
    return getattr(import_module("rubnoise.api"), name)


def __dir__() -> list[str]:
    return __all__
