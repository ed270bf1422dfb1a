"""A spectrum in bands of wavenumber, each beside what theory expects an estimate to show there."""

from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import Spectrum, shared_variance
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.theory.quadrature import size_rule
from rubnoise.theory.spectrum import spectral_density

_FIRST_BIN = 3
_SIZES = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """The power of a spectrum between two wavenumbers (rad/um), in the square of the record's unit."""

    lowest: float
    highest: float
    observed: float
    expected: float
    standard_error: float


def band_powers(model: Model, seen: Spectrum, expected: Doubles, length: float, count: int) -> list[Band]:
    """Return the power (1/pi) int S dk of up to ``count`` bands, equally wide in the logarithm of k, with their errors.

    ``expected`` is the expectation of ``seen.density``, from a record of ``length`` um of a contact with Poisson
    births. Two parts add up in the variance of a band's power P over its square: that of a Gaussian record, sum over
    the bins of S_i S_j times their covariance (`shared_variance`), and (lam / T) E[(sum of |A^(k_i)|^2)^2] over
    (sum of S_i)^2, the fourth cumulant of shot noise, the same for all bins: junctions are few. The bins next to k = 0,
    which hold the mean, and next to the last are left out.
    Source: as for `rubnoise.theory.correlation.autocovariance`, for four places at once.
    """
    shared = shared_variance(seen.ticks, seen.segments)
    probabilities, energies = _energies(model, seen.wavenumber)
    power = float(seen.wavenumber[1]) / pi
    found = []
    for part in bands_of(seen.density.size, count):
        variance = _gaussian_variance(expected[part], shared) / seen.segments
        variance += _shot_variance(probabilities, energies[:, part].sum(axis=1)) / (model.birth_rate * length)
        level = power * float(expected[part].sum())
        found.append(
            Band(
                lowest=float(seen.wavenumber[part[0]]),
                highest=float(seen.wavenumber[part[-1]]),
                observed=power * float(seen.density[part].sum()),
                expected=level,
                standard_error=level * sqrt(variance),
            )
        )
    return found


def bands_of(size: int, count: int) -> list[NDArray[np.int64]]:
    """Return the bins of up to ``count`` bands of a spectrum of so many, of equal ratio; those without a bin fall away.

    Bins next to k = 0, which hold the mean, and next to the last are in none.
    """
    bins = np.arange(_FIRST_BIN, size - 2)
    if not bins.size:
        return []
    edges = np.geomspace(bins[0] - 0.5, bins[-1] + 0.5, count + 1)[1:-1]
    return [part for part in np.split(bins, np.searchsorted(bins, edges)) if part.size]


def _gaussian_variance(expected: Doubles, shared: Doubles) -> float:
    """Return the relative variance of the sum of bins, times the number of segments."""
    pairs = shared[0] * float(expected @ expected)
    for apart in range(1, min(shared.size, expected.size)):
        pairs += 2.0 * shared[apart] * float(expected[apart:] @ expected[:-apart])
    return pairs / float(expected.sum()) ** 2


def _shot_variance(probabilities: Doubles, energies: Doubles) -> float:
    """Return the part of the relative variance that comes from a finite number of junctions, times that number."""
    return float(probabilities @ np.square(energies)) / float(probabilities @ energies) ** 2


def _energies(model: Model, wavenumber: Doubles) -> tuple[Doubles, Doubles]:
    """Return probabilities of sizes, and |A^(k)|^2 of each but for a factor: a row a size.

    The energy of one junction is the spectrum of a contact of its size alone.
    """
    diameters, probabilities = size_rule(model.sizes, _SIZES)
    alike = [replace(model, sizes=Fixed(value=d)) for d in diameters.tolist()]
    return probabilities, np.stack([spectral_density(each, wavenumber) for each in alike])
