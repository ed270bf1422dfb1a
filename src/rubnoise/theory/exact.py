"""Everything the theory says about one model, in one frozen answer."""

from dataclasses import dataclass, field
from math import sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.model import Model
from rubnoise.theory.campbell import Cumulants, area_cumulants, force_cumulants
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.distribution import Distribution, distribution
from rubnoise.theory.occupancy import (
    count_variance,
    expected_births,
    expected_junction_rows,
    length_biased_mean_diameter,
    mean_count,
)
from rubnoise.theory.response import Response, response
from rubnoise.theory.spectrum import spectral_density

Doubles = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Exact:
    """Exact stationary results: area in um^2, force in uN (None without a strength), slider (None without one).

    >>> import rubnoise
    >>> theory = rubnoise.exact(rubnoise.load("scenarios/paper/fig5.toml"))
    >>> round(theory.area.mean, 4), round(theory.area.std, 4)
    (204.6736, 56.4294)
    >>> theory.autocovariance([0.0, 20.0]) / theory.area.variance
    array([1., 0.])
    """

    model: Model = field(repr=False)
    area: Cumulants
    count_mean: float
    count_variance: float
    mean_diameter: float
    length_biased_mean_diameter: float
    expected_births: float
    expected_junction_rows: float
    force: Cumulants | None
    slider: Response | None

    @property
    def count_std(self) -> float:
        """Standard deviation of the number of live junctions."""
        return sqrt(self.count_variance)

    def spectral_density(self, wavenumber: ArrayLike) -> Doubles:
        """Return the two-sided S(k) of the area in um^4 per rad/um at wavenumbers in rad/um, of any shape."""
        return spectral_density(self.model, wavenumber)

    def autocovariance(self, lag: ArrayLike) -> Doubles:
        """Return R(tau) of the area in um^4 at lags in um, of any shape."""
        return autocovariance(self.model, lag)

    def distribution(self) -> Distribution:
        """Return the distribution of the area: its ``cdf`` and ``density`` at any areas, its ``atom_at_zero``.

        Raises Refused for births that are not Poisson.
        """
        return distribution(self.model)


def exact(model: Model) -> Exact:
    """Return the exact results for a model: cumulants of area and force, the live count, the one-way slider's response.

    Diameters in um are the means of a junction as it is born and as it is found alive. Equations and sources are those
    of `area_cumulants`, `mean_count`, `count_variance`, `length_biased_mean_diameter` and `response`.
    """
    return Exact(
        model=model,
        area=area_cumulants(model),
        count_mean=mean_count(model),
        count_variance=count_variance(model),
        mean_diameter=model.sizes.moment(1),
        length_biased_mean_diameter=length_biased_mean_diameter(model),
        expected_births=expected_births(model),
        expected_junction_rows=expected_junction_rows(model),
        force=None if model.strengths is None else force_cumulants(model),
        slider=None if model.slider is None else response(model),
    )
