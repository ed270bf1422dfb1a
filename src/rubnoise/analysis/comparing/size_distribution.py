"""The distribution function of a size law, from its density."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.laws import Law
from rubnoise.theory.quadrature import panels

Doubles = NDArray[np.float64]

_CELLS = 8192
_NODES = 6
_NARROW = 4.0
_FINE, _DEEP = 20.0, 400.0


def size_distribution(law: Law, *, alive: bool = False) -> Callable[[Doubles], Doubles]:
    """Return P(diameter <= d) as a function of d in um, for a law that has a density; error below 1e-5.

    With ``alive`` it is that of junctions found alive, whose density is proportional to d f(d). The density is
    integrated from the top down over fine cells, equal in d for a narrow law and in log d for a wide one, whose cells
    become coarse but go on to e^-420 of its largest diameter: a density may grow without bound towards d = 0.
    """
    low, high = law.support
    narrow = high <= _NARROW * low
    cells = np.linspace(low, high, _CELLS) if narrow else _logarithmic(float(np.log(high)))
    places, weights = panels(cells, _NODES)
    diameters = places if narrow else np.exp(places)
    shares = weights * law.density(diameters) * diameters ** (alive + (not narrow))
    masses = shares.reshape(cells.size - 1, _NODES).sum(axis=1)
    below = 1.0 - np.append(np.cumsum(masses[::-1])[::-1], 0.0) / masses.sum()
    tiny = float(np.finfo(np.float64).tiny)
    return lambda d: np.interp(d if narrow else np.log(np.maximum(d, tiny)), cells, below)


def _logarithmic(top: float) -> Doubles:
    deep = np.arange(top - _FINE - _DEEP, top - _FINE)
    return np.concatenate([deep, np.linspace(top - _FINE, top, _CELLS)])
