"""Spectra of simulated areas for the figures of the paper: Welch's estimate, on as few wavenumbers as can be drawn."""

from typing import Any, Final

import numpy as np

from rubnoise.analysis.spectra import Spectrum, welch
from rubnoise.arrays import Doubles
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord

SEGMENT: Final = 1024.0
"""Length of a segment in um, some hundred mean lives and more: a resolution far finer than the corner of a spectrum."""

PER_DECADE: Final = 40
WIDEST: Final = 0.1
"""Bins drawn as one: a fortieth of a decade of wavenumbers, and no more than a fraction of a swing of the tail."""

FIRST: Final = 2
"""The first bin that is drawn: through the window the subtracted mean reaches those before."""

SIMULATED: Final[dict[str, Any]] = {"lw": 2.6, "alpha": 0.55, "solid_joinstyle": "round"}
"""A simulated spectrum is drawn broad and pale, for the exact one lies on it."""

AXIS: Final = "wavenumber (rad/µm)"
DENSITY: Final = "two-sided spectral\ndensity (µm⁴ per rad/µm)"


def spectrum_of(model: Model, record: MemoryRecord) -> Spectrum:
    """Return Welch's estimate of the two-sided S(k) of A_r in a run, in um^4 per rad/um."""
    return welch(record["trace"]["real_contact_area"], model.tick, 2 * round(0.5 * SEGMENT / model.tick))


def drawn(spectrum: Spectrum) -> tuple[Doubles, Doubles]:
    """Return wavenumbers and the mean density of the bins about each: of single bins first, then of ever more."""
    wavenumber, density = spectrum.wavenumber[FIRST:], spectrum.density[FIRST:]
    edges = [float(wavenumber[0])]
    while edges[-1] < wavenumber[-1]:
        edges.append(edges[-1] + min(edges[-1] * (10.0 ** (1.0 / PER_DECADE) - 1.0), WIDEST))
    starts = np.unique(np.searchsorted(wavenumber, edges[:-1]))
    counts = np.diff([*starts.tolist(), wavenumber.size])
    return np.add.reduceat(wavenumber, starts) / counts, np.add.reduceat(density, starts) / counts
