"""The parts of a sound that an ear hears and a small loudspeaker plays, and a speed-up at which it is heard better."""

from dataclasses import dataclass
from math import floor, log10, pi
from typing import Final, Self

import numpy as np

from rubnoise.analysis.spectra import Spectrum

LOWEST: Final = 20.0
HIGHEST: Final = 20_000.0
"""The frequencies in Hz between which the young and healthy hear."""

COMFORTABLE: Final = (100.0, 5000.0)
"""Frequencies in Hz that small loudspeakers give and most people hear."""

LAPTOP: Final = (200.0, 4000.0)
"""Frequencies in Hz that the loudspeaker of a laptop plays."""

AIM: Final = 300.0
"""Frequency in Hz to which a suggestion moves the middle of the power."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hearing:
    """Shares of a sound's power between 20 Hz and 20 kHz, and in the band of a laptop's loudspeaker.

    ``middle`` is the frequency in Hz below which half of the power lies.
    """

    audible: float
    laptop: float
    middle: float

    @classmethod
    def of(cls, spectrum: Spectrum) -> Self:
        """Return the audible shares of a spectrum over w in rad/s, of its power without w = 0, the mean."""
        frequency, power = spectrum.wavenumber[1:] / (2.0 * pi), spectrum.density[1:]
        running = np.cumsum(power)
        shares = (
            float(power[(frequency >= low) & (frequency <= high)].sum() / running[-1])
            for low, high in ((LOWEST, HIGHEST), LAPTOP)
        )
        middle = frequency[np.searchsorted(running, 0.5 * running[-1])]
        return cls(audible=next(shares), laptop=next(shares), middle=float(middle))

    def better(self, speed_up: float) -> float | None:
        """Return a speed-up, 1, 2 or 5 times a power of ten, that brings the middle near 300 Hz; None if it is good.

        It is good between 100 Hz and 5 kHz.
        """
        if COMFORTABLE[0] <= self.middle <= COMFORTABLE[1]:
            return None
        wanted = speed_up * AIM / self.middle
        power = 10.0 ** floor(log10(wanted))
        return min((factor * power for factor in (1.0, 2.0, 5.0, 10.0)), key=lambda near: abs(log10(near / wanted)))
