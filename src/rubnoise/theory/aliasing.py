"""What sampling alone does to the spectrum: wavenumbers beyond half a turn per tick pass for lower ones."""

from math import ceil, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import zeta

from rubnoise.model import Model
from rubnoise.theory.spectrum import mean_spectral_density, spectral_density

Doubles = NDArray[np.float64]

_FEWEST = 40
_PHASE = 2000.0  # k d from which the spectrum is its tail
_AT_ONCE = 65_536


def sampled_spectral_density(model: Model, wavenumber: ArrayLike, tick: float) -> Doubles:
    """Return the spectral density of A_r taken at ticks of h um alone, in um^4 per rad/um, k in rad/um of any shape.

    S_h(k) = sum over all whole n of S(k + 2 pi n / h) = h sum over all whole j of R(j h) exp(-i k j h): even, of period
    2 pi / h, and R(0) = (1/2 pi) int S_h dk over one period. Aliases are summed one by one to where S is its tail, and
    from there by the zeta function with the swing of the tail averaged; error below 1e-9 S(0), and for the lens below
    1e-6 of S_h itself. Births that are not Poisson: the continuous part.
    Source: Poisson's summation formula; Priestley, Spectral Analysis and Time Series (1981), section 7.1.1.
    """
    k = np.asarray(wavenumber, dtype=np.float64)
    turn = 2.0 * pi / tick
    place = np.abs(k / turn - np.rint(k / turn)).ravel()
    last = max(_FEWEST, ceil(_PHASE / (model.sizes.moment(1) * turn)))
    result = np.empty(place.size)
    for rows in np.array_split(np.arange(place.size), 1 + place.size * (2 * last + 1) // _AT_ONCE):
        aliases = place[rows, None] + np.arange(-last, last + 1)
        result[rows] = np.sum(spectral_density(model, turn * aliases), axis=-1)
    beyond = turn * (last + 1.0)
    level = float(mean_spectral_density(model, beyond)) * (last + 1.0) ** 4
    return (result + level * (zeta(4.0, last + 1.0 + place) + zeta(4.0, last + 1.0 - place))).reshape(k.shape)
