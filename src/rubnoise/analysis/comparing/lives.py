"""Compare the lives in /junctions with theory and trace: their length, their mean area, and their sum, the trace."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.comparing.findings import Finding, Identity
from rubnoise.analysis.comparing.trace import TraceSums
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.off_centre import OFF_CENTRE_LENS, area_of, half_life, overlap
from rubnoise.contact.pulses import Pulse
from rubnoise.model import Model
from rubnoise.theory.second_order import autocovariance, spectral_density
from rubnoise.theory.sizes import panels

_ROUNDING = 2.0**-50
_NODES = 40
_ALIASES = 64
_AT_ONCE = 4096
_AREA_ROUNDING = 1e-9  # in diameters squared: what formulas of a life's area lose near its ends


class Lives:
    """Sums rows of /junctions to compare them with the trace: lengths, areas, and the sums at sampled ticks."""

    def __init__(self, model: Model, trace: TraceSums) -> None:
        self._model = model
        self._end = model.tick_count * model.tick
        self._ticks = trace.column("distance")
        self.area, self.count = np.zeros(self._ticks.size), np.zeros(self._ticks.size)
        self.longest_difference, self.death_difference = 0.0, 0.0
        self.total_area, self.total_life, self.tick_variance, self.largest = 0.0, 0.0, 0.0, 0.0

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        birth, death, diameter = (columns[name] for name in ("birth_distance", "death_distance", "diameter"))
        offset = columns.get("lateral_offset")
        if not birth.size:
            return
        self._check(columns)
        self._add_totals(birth, death, diameter, offset)
        # Sampled ticks are farther apart than any life is long: a junction is alive at one of them at most.
        tick = np.searchsorted(self._ticks, birth)
        there = np.flatnonzero(tick < self._ticks.size)
        there = there[self._ticks[tick[there]] < death[there]]
        aside = None if offset is None else offset[there]
        area = area_of(self._model.pulse, self._ticks[tick[there]] - birth[there], diameter[there], aside)
        self.area += np.bincount(tick[there], area, self._ticks.size)
        self.count += np.bincount(tick[there], minlength=self._ticks.size)

    def _check(self, columns: dict[str, NDArray[Any]]) -> None:
        birth, life, diameter = (columns[name] for name in ("birth_distance", "life_distance", "diameter"))
        whole = 2.0 * half_life(diameter, columns.get("lateral_offset"))
        self.longest_difference = max(self.longest_difference, float(np.abs(life - whole).max()))
        self.death_difference = max(
            self.death_difference, float(np.abs(columns["death_distance"] - birth - life).max())
        )
        self.largest = max(self.largest, float(diameter.max()))

    def _add_totals(self, birth: Doubles, death: Doubles, diameter: Doubles, offset: Doubles | None) -> None:
        """Add the totals of rows between the first and the last tick; a tick represents half a step on either side."""
        half, end = 0.5 * self._model.tick, self._end
        first, last = np.clip(birth, 0.0, end), np.clip(death, 0.0, end)
        cut = (first > birth) | (last < death)
        ages = np.clip(np.stack([first, last]) - birth, 0.0, death - birth)[:, cut]
        pulse = self._model.pulse
        if offset is None:
            whole = pulse.life_integral(1) * diameter**3
            before, after = life_so_far(pulse, ages, diameter[cut])
        else:
            whole = 2.0 * from_mid_life(pulse, half_life(diameter, offset), diameter, offset)
            from_middle = ages - half_life(diameter[cut], offset[cut])
            before, after = from_mid_life(pulse, from_middle, diameter[cut], offset[cut])
        self.total_area += float(whole[~cut].sum() + (after - before).sum())
        lives = np.clip(death, -half, end + half) - np.clip(birth, -half, end + half)
        share = lives / self._model.tick % 1.0
        self.total_life += float(lives.sum())
        self.tick_variance += float((share * (1.0 - share)).sum()) * self._model.tick**2


def life_findings(model: Model, lives: Lives, trace: TraceSums) -> list[Finding]:
    """Return the relations between rows and trace: lives of 2d, sums that are the trace, the mean area over a life.

    The trace's integral divided by the rows' gives the mean area over a life in units of d^2, except for what the ticks
    miss; the count gives likewise the life in diameters. With random births every life meets the ticks in another
    phase, so both are nearly exact: see `missed_by_ticks`.
    """
    found = _identities(model, lives, trace)
    if not isinstance(model.births, PoissonBirths):
        reason = "births that may keep step with the ticks leave no law for what ticks miss"
        return [*found, LeftOut(name="life_mean", reason=reason)]
    if not (lives.total_area > 0.0 and lives.total_life > 0.0):
        return [*found, LeftOut(name="life_mean", reason="no junction was alive")]
    mean = model.pulse.life_integral(1) / model.pulse.mean_life
    area = model.tick * (trace.area_total - 0.5 * (trace.first_area + trace.last_area))
    rounding = _ROUNDING * trace.ticks**0.5
    missed = missed_by_ticks(model, trace.ticks) / lives.total_area
    life = (lives.tick_variance**0.5 / lives.total_life, model.tick * trace.count_total / lives.total_life)
    return [
        *found,
        _ratio("life_mean_area", area / lives.total_area, mean, missed + rounding),
        _ratio("life_over_diameter", life[1], model.pulse.mean_life, life[0] + rounding),
    ]


def _ratio(name: str, observed: float, expected: float, error: float) -> Agreement:
    return Agreement(name=name, observed=observed * expected, expected=expected, standard_error=error * expected)


def missed_by_ticks(model: Model, ticks: int) -> float:
    """Return the standard error in um^3 of the trapezoidal integral of A_r over ticks h apart, for random births.

    A life that meets the ticks in a random phase has h sum A - int A = sum over n != 0 of A^(2 pi n/h) e^(i phase), so
    that T um of them have the variance 2 T sum over n >= 1 of S(2 pi n/h); each end adds about
    (h/12)^2 E[(A_r(h) - A_r(0))^2]. Source: Poisson's summation formula with Campbell's theorem.
    """
    h = model.tick
    aliases = spectral_density(model, 2.0 * np.pi / h * np.arange(1, _ALIASES + 1))
    still, moved = autocovariance(model, np.array([0.0, h]))
    return float(2.0 * ticks * h * aliases.sum() + 4.0 * (still - moved) * (h / 12.0) ** 2) ** 0.5


def life_so_far(pulse: Pulse, age: Doubles, diameter: Doubles) -> Doubles:
    """Return the integral of A over a life up to an age in um^3; age and diameter in um, 0 <= age <= 2d.

    The second half of a life is the mirror image of the first, and age = reach y^2 makes the birth smooth.
    """
    reach = np.minimum(age, 2.0 * diameter - age)[..., None]
    y, weights = panels([0.0, 1.0], _NODES)
    rising = (pulse.area(reach * y * y, diameter[..., None]) * (2.0 * y * weights * reach)).sum(axis=-1)
    return np.where(age <= diameter, rising, pulse.life_integral(1) * diameter**3 - rising)


def from_mid_life(pulse: Pulse, x: Doubles, diameter: Doubles, offset: Doubles) -> Doubles:
    """Return the integral of A from mid-life to x = s - h in um^3, negative for x < 0; all in um, |x| <= h.

    (pi/4) ((d^2 - b^2) x - x^3/3) for the parabola. For the lens x = |b| sinh(v) takes the turn at mid-life away, and
    v = V (1 - (1 - t)^2) the root at the end of a life.
    """
    if pulse.shape == "parabola":
        return 0.25 * np.pi * x * ((diameter - offset) * (diameter + offset) - x * x / 3.0)
    some = range(0, diameter.size, _AT_ONCE)
    parts = [
        _from_mid_life(x[..., n : n + _AT_ONCE], diameter[n : n + _AT_ONCE], np.abs(offset[n : n + _AT_ONCE]))
        for n in some
    ]
    return np.concatenate([np.zeros((*x.shape[:-1], 0)), *parts], axis=-1)


def _from_mid_life(x: Doubles, diameter: Doubles, b: Doubles) -> Doubles:
    highest = np.arcsinh(np.abs(x) / b)[..., None]
    t, weights = panels([0.0, 1.0], _NODES)
    v = highest * (1.0 - (1.0 - t) ** 2)
    r = (b / diameter)[..., None] * np.cosh(v)
    total = (overlap(r, OFF_CENTRE_LENS) * np.cosh(v) * (2.0 * weights * (1.0 - t) * highest)).sum(axis=-1)
    return np.asarray(np.sign(x) * diameter * diameter * b * total, dtype=np.float64)


def _identities(model: Model, lives: Lives, trace: TraceSums) -> list[Finding]:
    reach = model.distance + 2.0 * lives.largest
    crowd = max(1.0, float(lives.count.max(initial=0.0)))
    # Distances are known to a rounding of the farthest; so are ages, and areas by their slope of at most pi d/2.
    rounding = crowd * lives.largest * (_AREA_ROUNDING * lives.largest + 4.0 * _ROUNDING * reach)
    area = np.abs(lives.area - trace.column("real_contact_area")).max(initial=0.0)
    count = np.abs(lives.count - trace.column("junction_count")).max(initial=0.0)
    return [
        Identity(name="life", deviation=lives.longest_difference, allowed=_ROUNDING * 2.0 * lives.largest, units="um"),
        Identity(name="death", deviation=lives.death_difference, allowed=_ROUNDING * reach, units="um"),
        Identity(name="area_from_rows", deviation=float(area), allowed=rounding, units="um^2"),
        Identity(name="count_from_rows", deviation=float(count), allowed=0.0, units=""),
    ]
