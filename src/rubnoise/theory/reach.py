"""How far the contact remembers itself."""

import numpy as np

from rubnoise.model import Model
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.lags import longest_life

_PLACES = 17


def covariance_reach(model: Model, part: float) -> float:
    """Return a lag in um beyond which |R| is below a part of the variance: the longest life, or half of it, or less.

    A size law with a long tail has lives that hardly ever come, up to hundreds of mean lives: most lags up to them show
    nothing. Where R never falls so far, as with regular births of one size, it is the longest life.
    """
    reach, least = longest_life(model), part * float(autocovariance(model, 0.0))
    while np.all(np.abs(autocovariance(model, np.linspace(0.5 * reach, reach, _PLACES))) < least):
        reach *= 0.5
    return reach
