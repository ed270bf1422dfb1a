"""The sensor's filter: equal analogue poles before sampling, and white noise after it."""

from dataclasses import dataclass
from math import inf, isinf
from typing import Final

import numpy as np

from rubnoise.arrays import Complexes, Doubles

_PIECE: Final = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """A filter |H|^2 = 1/(1 + (k/kc)^2)^p with ``corner`` kc in rad per tick and ``poles`` p; inf passes everything."""

    corner: float = inf
    poles: int = 1

    @property
    def is_open(self) -> bool:
        """Whether it passes everything."""
        return isinf(self.corner)

    def energy(self, wavenumber: Doubles) -> Doubles:
        """Return |H|^2."""
        return (1.0 + np.square(wavenumber / self.corner)) ** -self.poles

    def slopes(self, wavenumber: Doubles) -> tuple[Doubles, Doubles]:
        """Return the first and second derivative of |H|^2 by ln k: with x = (k/kc)^2, -2 p x and 4 p x (p x - 1)."""
        x, p = np.square(wavenumber / self.corner), self.poles
        whole = (1.0 + x) ** (-p - 2.0)
        return -2.0 * p * x * (1.0 + x) * whole, 4.0 * p * x * (p * x - 1.0) * whole

    def response(self, wavenumber: Doubles) -> Complexes:
        """Return H = 1/(1 + i k/kc)^p, a causal filter."""
        return np.asarray((1.0 + 1j * wavenumber / self.corner) ** -self.poles, dtype=np.complex128)

    def filtered(self, values: Doubles) -> Doubles:
        """Return a trace after the filter; it wraps round at its ends."""
        from scipy.fft import irfft, rfft

        k = 2.0 * np.pi * np.arange(values.size // 2 + 1) / values.size
        found: Doubles = irfft(rfft(values) * self.response(k), values.size)
        return found

    def mirrored(self, values: Doubles) -> Doubles:
        """Return a trace without the delay of the filter, |H|/H, in which a life is its own mirror image again.

        It is done in parts, to limit memory; white noise stays white.
        """
        from scipy.fft import irfft, rfft

        if self.is_open:
            return values
        found = np.empty_like(values)
        parts = -(-values.size // _PIECE)
        for begin, end in zip(
            np.arange(parts) * values.size // parts, (np.arange(parts) + 1) * values.size // parts, strict=True
        ):
            k = 2.0 * np.pi * np.arange((end - begin) // 2 + 1) / (end - begin)
            seen = self.response(k)
            found[begin:end] = irfft(rfft(values[begin:end]) * np.abs(seen) / seen, end - begin)
        return found


OPEN: Final = Sensor()
"""A sensor that passes everything."""
