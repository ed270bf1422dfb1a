"""The change of a spectrum along a run: of the real contact area, or of the slider's force and motion."""

from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.sound import Heard
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.motion import Motion
from rubnoise.figures.motion_spectrum import FARTHEST, QUANTITIES, whose
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import AREA, DISTANCE, add_title, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS: Final = 120
FEWEST: Final = 8
"""Segments that a picture shows, and at least; half of each lies in the next."""

FEWEST_ROWS: Final = 64
RANGE: Final = 60.0
"""Decibels below the loudest that have a shade of their own."""

LIVES: Final = 8.0
"""Mean lives in a segment at least, that its lowest frequencies hold what junctions do."""


def spectrogram_figure(stretch: Stretch, heard: Heard | None = None) -> "Figure":
    """Draw spectra of short segments side by side, in decibels below the loudest.

    The area is drawn over wavenumber and sliding distance, a slider over frequency and time. Raises Refused for too
    short a stretch.
    """
    if heard is None:
        values, apart = stretch.record("trace", "real_contact_area"), stretch.model.tick
        begin, highest, words = stretch.start, 0.5 / apart, AREA.split(" (")[0]
        labels = DISTANCE, "cycles per µm"
        least = LIVES * stretch.model.mean_life_distance
    else:
        quantity = QUANTITIES[heard]
        motion = Motion.of(stretch, quantity.group, quantity.column)
        values, apart = motion.record(quantity.column), motion.apart
        begin, words = motion.begin, whose(heard)
        highest = min(0.5 / apart, FARTHEST * motion.frequency)
        labels = "time (s)", "frequency (Hz)"
        least = LIVES * stretch.model.mean_life_distance / motion.speed
    place, frequency, level = _levels(values, apart, round(least / apart), words)
    figure = new_figure(7.2, 4.4)
    add_title(figure, stretch, f"How the spectrum of the {words} changes along the run")
    axes = figure.subplots()
    loud = frequency[level.max(axis=1) > -RANGE]
    shown = frequency <= min(highest, 1.1 * float(loud[-1]))
    mesh = axes.pcolormesh(begin + place, frequency[shown], level[shown], vmin=-RANGE, vmax=0.0, cmap="cividis")
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    figure.colorbar(mesh, ax=axes, label="spectral density (dB below the largest)", pad=0.01)
    return figure


def _levels(values: Doubles, apart: float, least: int, words: str) -> tuple[Doubles, Doubles, Doubles]:
    """Return places, frequencies and levels in dB of segments of a Hann window that overlap by half."""
    from scipy.signal import spectrogram

    rows = max(min(2 * values.size // (COLUMNS + 1), values.size), FEWEST_ROWS, least)
    rows = min(rows, 2 * values.size // (FEWEST + 1))
    if rows < FEWEST_ROWS:
        needed = FEWEST_ROWS * (FEWEST + 1) // 2
        raise Refused(f"{values.size:,} rows are too few for a spectrogram, which needs {needed:,}")
    frequency, place, density = spectrogram(
        values, fs=1.0 / apart, window="hann", nperseg=rows, noverlap=rows // 2, detrend="constant"
    )
    loudest = float(density.max())
    if loudest <= 0.0:
        raise Refused(f"the {words} does not vary in this stretch, so it has no spectrum")
    return place, frequency, 10.0 * np.log10(np.maximum(density / loudest, 1e-30))
