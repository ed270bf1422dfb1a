"""Births with gamma gaps: a bridge from regular births over Poisson's to bunches."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births.law import BirthLawEntry, Key
from rubnoise.contact.deviates import gamma_deviates
from rubnoise.contact.laws.law import LEAST

_FORGOTTEN = 30.0  # e-folds after which nothing is remembered


@dataclass(frozen=True, slots=True, kw_only=True)
class GammaBirths:
    """Independent gamma gaps of shape a and mean s_jm = L_jm / N_jm, in um: Poisson for a = 1, regular as a grows.

    Moments of a gap: mean s_jm, variance s_jm^2 / a. S_N(k)/lam = Re[(1 + f)/(1 - f)], f = (1 - i k s_jm / a)^-a.
    A place at random lies in a gap of density x f(x)/s_jm, gamma of shape a + 1, uniformly.
    Source: Cox, Renewal Theory (1962).
    """

    mean_spacing: float
    shape: float

    @property
    def mean(self) -> float:
        """Mean gap in um."""
        return self.mean_spacing

    @property
    def variance(self) -> float:
        """Variance of a gap in um^2."""
        return self.mean_spacing**2 / self.shape

    @property
    def dispersion(self) -> float:
        """1/a."""
        return 1.0 / self.shape

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on [0, 1)."""
        return self.mean_spacing * np.maximum(gamma_deviates(uniform, _exactly(self.shape)), LEAST)

    def around(self, uniform: Doubles) -> tuple[float, float]:
        """Return the distances in um from a place at random to the birth before it and to the next, from 2 uniforms."""
        mean = self.mean_spacing * (self.shape + 1.0) / self.shape
        gap = mean * float(gamma_deviates(uniform[:1], _exactly(self.shape, 1))[0])
        after = gap * float(uniform[1])
        return gap - after, after

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return 2 Re[f/(1 - f)], 1/a - 1 at k = 0."""
        turns = wavenumber * self.mean_spacing
        x = np.maximum(turns, 1e-5) / self.shape
        power = self.shape * (0.5 * np.log1p(x * x) - 1j * np.arctan(x))  # ln(1 - i x), where x is small too
        found = 2.0 * (np.exp(-power) / -np.expm1(-power)).real
        return np.where(turns < 1e-5, self.dispersion - 1.0, found)

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return 0: gaps that vary leave no line."""
        return np.zeros_like(wavenumber)

    @property
    def memory(self) -> float:
        """Distance in um: by 1/(a lam) an e-fold at the cut of f, by a/(2 pi^2 lam) at the pole of 1/(1 - f)."""
        return _FORGOTTEN * self.mean_spacing * max(1.0 / self.shape, 1.0, self.shape / 19.0)


def _exactly(shape: float, more: int = 0) -> Any:
    import mpmath

    with mpmath.workdps(80):
        return mpmath.mpf(shape) + more


ENTRY = BirthLawEntry(
    name="gamma",
    about="independent gamma gaps of a shape: 1 is poisson, large is regular, below 1 comes in bunches",
    make=GammaBirths,
    keys=(Key(name="shape", about="Shape a of the gaps, whose variance is the squared mean over a", sample=4.0),),
)
