"""Runs of which a sweep keeps a summary: no file, but figures and curves, and what theory expects of the curves."""

from typing import Any, cast

from numpy.typing import NDArray

from rubnoise.analysis.run_summary import SummarySink, curve_theory
from rubnoise.model import Model
from rubnoise.scenario.points import Point
from rubnoise.simulation.block import Watch
from rubnoise.simulation.run import Engine, simulate
from rubnoise.sweep.journal import RunRow
from rubnoise.sweep.pool import CANCELLATION


def keep_summary(point: Point, *, watch: Watch = CANCELLATION.check) -> RunRow:
    """Carry out one run of a sweep and return what it comes to, without a trace of it anywhere.

    The arrays are those of `rubnoise.analysis.run_summary.CURVES`; ``watch`` is called after each range of ticks and
    may raise; by default it raises if the sweep was cancelled.
    """
    model = point.scenario.model()
    sink = SummarySink(model)
    simulate(model, point.seed, sink, engine=cast(Engine, point.scenario.run.engine), watch=watch)
    summary = sink.finish()
    figures: dict[str, float] = {}
    for figure in summary.figures:
        figures |= figure.as_attributes()
    of_point = summary_theory(model) if point.replicate == 0 else {}
    return RunRow(run_id=point.run_id, figures=figures, arrays=summary.curves, of_point=of_point)


def summary_theory(model: Model) -> dict[str, NDArray[Any]]:
    """Return where the curves of a model's summaries lie and what is expected there: `spectrum_place` and so on.

    The same for all runs of a point; nan where theory is silent.
    """
    return {
        f"{name}_{part}": getattr(theory, part)
        for name, theory in curve_theory(model).items()
        for part in ("place", "expected", "standard_error")
        # The histogram's errors are those of each run.
        if (name, part) != ("histogram", "standard_error")
    }
