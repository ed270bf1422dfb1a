"""The normal velocity of a run in third octaves, as roughness noise is reported, beside theory."""

from dataclasses import dataclass
from math import log10, nan, pi, sqrt
from typing import Final

import numpy as np

from rubnoise.analysis.spectra import WelchSum
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.record.reader import Rows, column_chunks
from rubnoise.record.tally import Moments
from rubnoise.theory.coupling import THIRD, band_numbers, level, third_octaves

MOST_ROWS: Final = 1 << 22
"""Rows of /load that are looked at, from the first on: more would make a look at a long run slow."""

_SEGMENTS: Final = 16
_MOST_TICKS: Final = 1 << 17
_FEWEST_BINS: Final = 4
_PART_LEFT_OUT: Final = 1e-6  # of the power, 60 dB: as in theory


@dataclass(frozen=True, slots=True, kw_only=True)
class HeardBands:
    """Levels in dB re 50 nm/s in third octaves about frequencies in Hz: of a run, and exact ones (None if not known).

    ``velocity`` is the standard deviation in um/s, over all frequencies.
    """

    velocity: float
    frequency: Doubles
    level: Doubles
    exact: Doubles | None

    @property
    def whole_level(self) -> float:
        """The level of all bands together."""
        return level(self.velocity)


def heard_bands(rows: Rows, model: Model) -> HeardBands:
    """Return the normal velocity of a run in the third octaves that hold more than 1e-6 of its power.

    The whole is the standard deviation of the velocity, a band the integral of Welch's estimate over it,
    (1/pi) int S dw; bands of fewer than 4 of its bins are left out.
    Raises Refused for a run without a load that weighs, and for one too short for any band.
    """
    if "load" not in rows.columns or model.tick_duration is None:
        raise Refused("the normal motion is that under a load that weighs ([load])")
    count = min(rows.rows("load"), MOST_ROWS)
    ticks = min(2 * (count // (_SEGMENTS + 1)), _MOST_TICKS)
    if ticks < 4 * _FEWEST_BINS:
        raise Refused(f"{count} ticks are too few for third octaves")
    total, moments = WelchSum(ticks, model.tick_duration), Moments(powers=2)
    for velocity in column_chunks(rows, "load", "velocity", 0, count):
        total.add(velocity)
        moments.add(velocity)
    spectrum = total.spectrum()
    width = float(spectrum.wavenumber[1]) / (2.0 * pi)
    edges = width * (np.arange(spectrum.density.size) + 0.5)
    running = np.cumsum(spectrum.density[1:]) * (float(spectrum.wavenumber[1]) / pi)
    lowest = _FEWEST_BINS * width / (THIRD - 1.0 / THIRD)
    middles = 10.0 ** (0.1 * np.array(band_numbers(lowest, edges[-1] / THIRD)))
    upper, lower = (np.interp(middles * side, edges[1:], running) for side in (THIRD, 1.0 / THIRD))
    power = upper - lower
    kept, exact = power > _PART_LEFT_OUT * running[-1], None
    if (known := _exact(model)) is not None:
        numbers = [round(10.0 * log10(middle)) for middle in middles.tolist()]
        kept &= np.array([number in known for number in numbers])
        exact = np.array([known.get(number, nan) for number in numbers])[kept]
    return HeardBands(
        velocity=moments.std,
        frequency=middles[kept],
        level=np.array([level(sqrt(each)) for each in power[kept].tolist()]),
        exact=exact,
    )


def _exact(model: Model) -> dict[int, float] | None:
    """Return exact levels by the numbers of their bands; None if theory knows none."""
    try:
        bands = third_octaves(model)
    except Refused:
        return None
    numbers = (round(10.0 * log10(middle)) for middle in bands["frequency"].tolist())
    return dict(zip(numbers, bands["level"].tolist(), strict=True))
