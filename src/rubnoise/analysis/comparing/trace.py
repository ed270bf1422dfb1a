"""One pass over /trace, which computes everything that a comparison needs."""

from dataclasses import dataclass, field
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.covariance import LaggedProducts
from rubnoise.analysis.moments import first_stationary_tick
from rubnoise.analysis.reading import checked_chunks
from rubnoise.analysis.spectra import WelchSum
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.record.tally import Moments
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.sizes import longest_life

COLUMNS = ("distance", "real_contact_area", "junction_count", "friction_force")

_LAG_SHARES = (0.125, 0.25, 0.5, 0.75)
_LIVES_A_SEGMENT = 16.0
_MOST_TICKS_A_LIFE = 4096
_FEWEST_TICKS = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class TraceLayout:
    """Layout of a pass: ``stationary_from`` is the first stationary tick, ``apart`` ticks separate independent ones.

    Spectrum and autocovariance take every ``stride``-th tick, so that fine ticks cost no more than they are worth;
    ``segment`` and ``lags`` count those.
    """

    stationary_from: int
    apart: int
    stride: int
    segment: int
    lags: tuple[int, ...]

    @classmethod
    def of(cls, model: Model) -> "TraceLayout":
        """Return the layout that suits a model."""
        longest = longest_life(model)
        stride = max(1, int(longest / model.tick) // _MOST_TICKS_A_LIFE)
        step = stride * model.tick
        ticks_a_segment = _LIVES_A_SEGMENT * model.mean_life_distance / step
        segment = max(_FEWEST_TICKS, 2 ** ceil(np.log2(max(ticks_a_segment, 1.0))))
        lags = {max(1, round(share * model.mean_life_distance / step)) for share in _LAG_SHARES}
        return cls(
            stationary_from=first_stationary_tick(model),
            apart=int(longest / model.tick) + 2,
            stride=stride,
            segment=segment,
            lags=tuple(sorted(lags)),
        )


@dataclass(slots=True, kw_only=True)
class TraceSums:
    """The results of one pass over /trace.

    Moments, ``zero_ticks`` (those without a live junction), lagged products and spectrum are of the stationary part;
    totals (um^3, um) and the distances, areas and counts sampled at ``apart`` ticks' distance are of the whole trace.
    """

    layout: TraceLayout
    area: Moments
    count: Moments
    force: Moments
    products: LaggedProducts
    spectrum: WelchSum
    ticks: int = 0
    zero_ticks: int = 0
    area_total: float = 0.0
    count_total: float = 0.0
    force_deviation: float = 0.0
    first_area: float = 0.0
    last_area: float = 0.0
    sampled: dict[str, list[Doubles]] = field(default_factory=dict)

    @property
    def stationary_ticks(self) -> int:
        """Number of ticks of the stationary part."""
        return self.area.count

    def column(self, name: str) -> Doubles:
        """Return the samples of a column, ``apart`` ticks from one value to the next."""
        return np.concatenate(self.sampled.get(name, [np.empty(0)]))

    def add(self, columns: dict[str, NDArray[Any]], strength: float | None) -> None:
        """Add a chunk of the trace."""
        first = max(self.layout.stationary_from - self.ticks, 0)
        area = columns["real_contact_area"]
        self.area.add(area[first:])
        self.count.add(columns["junction_count"][first:].astype(np.float64))
        self.zero_ticks += int((columns["junction_count"][first:] == 0).sum())
        self._add_totals(area, columns["junction_count"])
        if "friction_force" in columns:
            self.force.add(columns["friction_force"][first:])
            if strength is not None and area.size:
                away = np.abs(columns["friction_force"] - strength * area)
                self.force_deviation = max(self.force_deviation, float(away.max()))
        self._sample(columns)
        thinned = area[
            first + (-(self.ticks + first - self.layout.stationary_from)) % self.layout.stride :: self.layout.stride
        ]
        self.products.add(thinned)
        self.spectrum.add(thinned)
        self.ticks += area.size

    def _add_totals(self, area: Doubles, count: NDArray[Any]) -> None:
        if not area.size:
            return
        self.area_total += float(area.sum())
        self.count_total += float(count.sum())
        self.first_area = float(area[0]) if self.ticks == 0 else self.first_area
        self.last_area = float(area[-1])

    def _sample(self, columns: dict[str, NDArray[Any]]) -> None:
        apart = self.layout.apart
        start = (self.layout.stationary_from - self.ticks) % apart
        for name in ("distance", "real_contact_area", "junction_count"):
            self.sampled.setdefault(name, []).append(columns[name][start::apart].astype(np.float64))


def read_trace(model: Model, rows: Rows) -> TraceSums:
    """Read /trace once, from its first tick to its last."""
    layout = TraceLayout.of(model)
    sums = TraceSums(
        layout=layout,
        area=Moments(),
        count=Moments(powers=2),
        force=Moments(powers=2),
        products=LaggedProducts(layout.lags, area_cumulants(model).mean),
        spectrum=WelchSum(layout.segment, layout.stride * model.tick),
    )
    for columns in checked_chunks(rows, "trace", COLUMNS):
        sums.add(columns, (model.strengths.mean if isinstance(model.strengths, Fixed) else None))
    return sums
