"""The laws of single junctions for histograms: of sizes, of lives, and of gaps between births."""

from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import BirthLaw, GammaBirths, PoissonBirths
from rubnoise.model import Model

QUANTILES: Final = 1 << 15
"""Sizes at even probabilities over which an expectation is taken: a share of births is then right to 3e-5."""


def share_of_sizes(model: Model, edges: Doubles) -> Doubles:
    """Return the probability that a junction is born with a diameter in each bin between edges in um."""
    return np.diff(np.searchsorted(_sizes(model), edges) / QUANTILES)


def share_of_lives(model: Model, edges: Doubles) -> Doubles:
    """Return the probability that the length of a life is in each bin between edges in um.

    P(L > l) = P(2 d > l) for passes through both centres, and E[sqrt(1 - (l/2d)^2)] for uniform offsets.
    """
    sizes = _sizes(model)
    if model.pulse.offset == "none":
        return np.diff(np.searchsorted(2.0 * sizes, edges) / QUANTILES)
    lasting = [float(np.sqrt(np.clip(1.0 - (edge / (2.0 * sizes)) ** 2, 0.0, None)).mean()) for edge in edges]
    return -np.diff(lasting)


def share_of_gaps(births: BirthLaw, edges: Doubles) -> Doubles | None:
    """Return the probability that a gap is in each bin between edges in um; None if the law has no closed form.

    Poisson: 1 - exp(-x/s_jm). Gamma: the incomplete gamma function of a x/s_jm. Source: Cox, Renewal Theory (1962).
    """
    from scipy.special import gammainc

    shape = births.shape if isinstance(births, GammaBirths) else 1.0
    if not isinstance(births, GammaBirths | PoissonBirths):
        return None
    return np.asarray(np.diff(gammainc(shape, shape * np.maximum(edges, 0.0) / births.mean)), dtype=np.float64)


def _sizes(model: Model) -> Doubles:
    """Return diameters in um at even probabilities, in ascending order."""
    return np.sort(model.sizes.draw((np.arange(QUANTILES) + 0.5) / QUANTILES))
