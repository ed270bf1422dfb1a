"""How far the real contact area spreads in the runs of a sweep, beside the exact spread of each point."""

from dataclasses import dataclass
from math import sqrt
from typing import Final

from rubnoise.figures.sources import Sources
from rubnoise.model import Model
from rubnoise.record.sink import Extent
from rubnoise.record.tally import Tally
from rubnoise.scenario import Scenario
from rubnoise.scenario.points import Point
from rubnoise.sweep.execution import Measure
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.sampling import standard_errors


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """The spread of A_r in the runs of one point with its standard error, and the exact one with the mean, in um^2."""

    scenario: Scenario
    std: float
    standard_error: float
    exact_std: float
    exact_mean: float

    @property
    def count(self) -> float:
        """N_jm."""
        return self.scenario.interface.mean_junction_count


def spreads_of(sources: Sources, name: str) -> list[Spread]:
    """Run a sweep, and return the spread at each of its points, the replicates taken together."""
    runs: dict[tuple[object, ...], tuple[Point, list[float]]] = {}
    for point, variance in sources.results(name, VARIANCE):
        runs.setdefault(tuple(point.values.values()), (point, []))[1].append(variance)
    return [_spread(point.scenario, variances) for point, variances in runs.values()]


def _tally(extent: Extent) -> Tally:
    del extent
    return Tally()


def _variance(model: Model, tally: Tally) -> float:
    del model
    return tally.moments["real_contact_area"].variance


VARIANCE: Final = Measure(sink=_tally, read=_variance)


def _spread(scenario: Scenario, variances: list[float]) -> Spread:
    model = scenario.model()
    exact = area_cumulants(model)
    return Spread(
        scenario=scenario,
        std=sqrt(sum(variances) / len(variances)),
        standard_error=standard_errors(model).std / sqrt(len(variances)),
        exact_std=exact.std,
        exact_mean=exact.mean,
    )


def by_area(spreads: list[Spread]) -> dict[float, list[Spread]]:
    """Return spreads by their mean area A_rm in um^2, each family by its number of junctions, all rising."""
    families: dict[float, list[Spread]] = {}
    for spread in sorted(spreads, key=lambda each: each.count):
        families.setdefault(float(spread.scenario.interface.mean_real_contact_area), []).append(spread)
    return dict(sorted(families.items()))
