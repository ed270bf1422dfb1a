"""What is kept of a run that keeps no trace: its figures, and its distribution, spectrum and memory on few places."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.covariance_sum import CovarianceSum
from rubnoise.analysis.histogram_sum import HistogramSum
from rubnoise.analysis.run_layout import BANDS, BINS, LAGS, RunLayout
from rubnoise.analysis.spectra import WelchSum
from rubnoise.analysis.summary import summarise
from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.record.sink import Columns
from rubnoise.record.tally import Tally
from rubnoise.theory.campbell import area_cumulants

CURVES: Final = {"histogram": BINS, "histogram_standard_error": BINS, "spectrum": BANDS, "autocovariance": LAGS}
"""The curves of a summary, and how many numbers each has; those left over are nan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """The figures of a run, and its curves of real contact area by name: um^-2, um^4 per rad/um, um^4.

    The places of the curves, and what theory expects there, are `rubnoise.analysis.curve_theory.curve_theory`.
    """

    figures: list[Agreement]
    curves: dict[str, Doubles]


class SummarySink:
    """A sink that sums a run up while its rows pass by; what it holds does not grow with the run."""

    def __init__(self, model: Model) -> None:
        """Begin with nothing."""
        layout = RunLayout.of(model)
        self._model = model
        self._layout = layout
        self._tally = Tally.of(model)
        self._histogram = HistogramSum(layout.edges, layout.batch)
        self._spectrum = WelchSum(layout.segment, layout.step)
        self._covariance = CovarianceSum(int(layout.lags[-1]), area_cumulants(model).mean)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Take in rows of a group (see Sink)."""
        self._tally.write(group, first_row, columns)
        if group != "trace":
            return
        area = np.asarray(columns["real_contact_area"], dtype=np.float64)
        self._histogram.add(area)
        thinned = area[-first_row % self._layout.stride :: self._layout.stride]
        self._spectrum.add(thinned)
        self._covariance.add(thinned)

    def finish(self) -> RunSummary:
        """Return what the rows so far come to."""
        histogram, spectrum = self._histogram.histogram(), self._spectrum.spectrum()
        curves = {
            "histogram": histogram.density,
            "histogram_standard_error": histogram.standard_error,
            "spectrum": self._layout.banded(spectrum.density),
            "autocovariance": self._covariance.covariances()[self._layout.lags],
        }
        return RunSummary(
            figures=summarise(self._model, self._tally),
            curves={name: filled_up(values, CURVES[name]) for name, values in curves.items()},
        )


def filled_up(values: Doubles, count: int) -> Doubles:
    """Return values with nan after them up to a count, and in place of what is infinite."""
    finite = np.where(np.isfinite(values), values, np.nan)
    return np.pad(finite, (0, count - values.size), constant_values=np.nan)
