"""Everything the theory says about one model, in one frozen answer."""

from dataclasses import dataclass
from math import sqrt

from rubnoise.model import Model
from rubnoise.theory.campbell import Cumulants, area_cumulants, force_cumulants
from rubnoise.theory.occupancy import (
    expected_births,
    expected_junction_rows,
    length_biased_mean_diameter,
    mean_count,
)
from rubnoise.theory.response import Response, response


@dataclass(frozen=True, slots=True, kw_only=True)
class Exact:
    """Exact stationary results: area in um^2, force in uN (None without a strength), slider (None without one)."""

    area: Cumulants
    count_mean: float
    length_biased_mean_diameter: float
    expected_births: float
    expected_junction_rows: float
    force: Cumulants | None
    slider: Response | None

    @property
    def count_std(self) -> float:
        """Standard deviation of the Poisson number of live junctions."""
        return sqrt(self.count_mean)


def exact(model: Model) -> Exact:
    """Return the exact results for a model: cumulants of area and force, the live count, the one-way slider's response.

    Equations and sources are those of `area_cumulants`, `mean_count`, `length_biased_mean_diameter` and `response`.
    """
    return Exact(
        area=area_cumulants(model),
        count_mean=mean_count(model),
        length_biased_mean_diameter=length_biased_mean_diameter(model),
        expected_births=expected_births(model),
        expected_junction_rows=expected_junction_rows(model),
        force=None if model.strengths is None else force_cumulants(model),
        slider=None if model.slider is None else response(model),
    )
