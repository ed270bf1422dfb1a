"""Compare sizes and strengths of junctions with their laws: of those born along the run, and alive at its start."""

from collections.abc import Callable
from math import sqrt
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.comparing.findings import (
    LARGEST_SKEWNESS,
    Drawn,
    Finding,
    Identity,
    judged,
    poisson_figure,
    tail_of_squares,
    too_short,
)
from rubnoise.analysis.kolmogorov import FEWEST, UniformSample, kolmogorov_figure, sample_distance
from rubnoise.analysis.records import longer
from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Fixed, Law
from rubnoise.contact.laws.discrete import has_single_values
from rubnoise.contact.off_centre import half_life
from rubnoise.model import Model
from rubnoise.record.rows import JunctionState
from rubnoise.record.tally import Moments
from rubnoise.theory.live_count import mean_count
from rubnoise.theory.second_order import need_random_births
from rubnoise.theory.sizes import panels, size_range

_CELLS = 8192
_NODES = 6
_NARROW_PANELS = 4.0
_FINE, _DEEP = 20.0, 400.0


def size_distribution(law: Law, *, alive: bool = False) -> Callable[[Doubles], Doubles]:
    """Return P(diameter <= d) as a function of d in um, for a law that has a density; error below 1e-5.

    With ``alive`` it is that of live junctions, whose density is proportional to d f(d). The density is integrated from
    the top down over fine cells, equal in d for a narrow law and in log d for a wide one, whose cells become coarse but
    reach down to e^-420 of its largest diameter: a density may grow without bound towards d = 0.
    """
    low, high = law.support
    narrow = high <= _NARROW_PANELS * low
    if narrow:
        cells = np.linspace(low, high, _CELLS)
    else:
        top = float(np.log(high))
        deep = np.arange(top - _FINE - _DEEP, top - _FINE)
        cells = np.concatenate([deep, np.linspace(top - _FINE, top, _CELLS)])
    places, weights = panels(cells, _NODES)
    diameters = places if narrow else np.exp(places)
    shares = weights * law.density(diameters) * diameters ** (alive + (not narrow))
    masses = shares.reshape(cells.size - 1, _NODES).sum(axis=1)
    below = 1.0 - np.append(np.cumsum(masses[::-1])[::-1], 0.0) / masses.sum()
    tiny = float(np.finfo(np.float64).tiny)
    return lambda d: np.interp(d if narrow else np.log(np.maximum(d, tiny)), cells, below)


_ROUNDING = 2.0**-50
_NARROW = 1e-3  # std over mean below which moments about 0 leave no digits to the fourth central one


class _Law(Drawn, Protocol):
    """A law of diameters or of strengths."""

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        ...


class Marks:
    """Sums over the values that every junction draws at its birth: its diameter, and its strength if there is one."""

    def __init__(self, model: Model) -> None:
        low, high = size_range(model.sizes)
        self._law = size_distribution(model.sizes) if low < high and not has_single_values(model.sizes) else None
        self._alike = {"diameter": model.sizes.moment(1)}
        if model.strengths is not None:
            self._alike["shear_strength"] = model.strengths.moment(1)
        self.moments = {name: Moments(powers=2) for name in self._alike}
        self.deviations = dict.fromkeys(self._alike, 0.0)
        self.sizes = UniformSample()
        self.offsets = UniformSample()

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        born = ~np.signbit(columns["birth_distance"])
        if not born.any():
            return
        for name, value in self._alike.items():
            self.moments[name].add(columns[name][born])
            away = float(np.abs(columns[name][born] - value).max())
            self.deviations[name] = max(self.deviations[name], away)
        if self._law is not None:
            self.sizes.add(self._law(columns["diameter"][born]))
        if "lateral_offset" in columns:
            self.offsets.add(0.5 + 0.5 * columns["lateral_offset"][born] / columns["diameter"][born])


def mark_findings(model: Model, marks: Marks) -> list[Finding]:
    """Return diameters and strengths beside their laws: mean, standard deviation, and the whole law of diameters.

    Junctions that are born have the law itself; those alive at the start do not, and are left out.
    """
    count = marks.moments["diameter"].count
    if not count:
        return [too_short("diameter", FEWEST * model.mean_birth_spacing)]
    low, high = size_range(model.sizes)
    if low == high:
        found = [_alike("diameter", marks, model.sizes.moment(1), "um")]
    else:
        found = _spread("diameter", marks.moments["diameter"], model.sizes, model)
        if count >= FEWEST and not has_single_values(model.sizes):
            found.append(kolmogorov_figure("diameter_kolmogorov", marks.sizes.distance(), count))
    if model.pulse.offset != "none" and count >= FEWEST:
        found.append(kolmogorov_figure("offset_kolmogorov", marks.offsets.distance(), count))
    return found + _strength_findings(model, marks)


def _strength_findings(model: Model, marks: Marks) -> list[Finding]:
    if model.strengths is None:
        return []
    if isinstance(model.strengths, Fixed):
        return [_alike("shear_strength", marks, model.strengths.mean, "MPa")]
    return _spread("shear_strength", marks.moments["shear_strength"], model.strengths, model)


def _alike(name: str, marks: Marks, value: float, units: str) -> Finding:
    return Identity(name=name, deviation=marks.deviations[name], allowed=_ROUNDING * value, units=units)


def _spread(name: str, seen: Moments, law: _Law, model: Model) -> list[Finding]:
    """Return mean and std of independent values: errors std/sqrt(n), and sqrt((mu_4 - mu_2^2)/n) over 2 std."""
    mean, length = law.moment(1), seen.count * model.mean_birth_spacing
    second, third, fourth = central_moments(law.moment)
    std, skewness = sqrt(second), abs(third) / second**1.5 / sqrt(seen.count)
    found: Finding = Agreement(
        name=f"{name}_mean", observed=seen.mean, expected=mean, standard_error=std / sqrt(seen.count)
    )
    if skewness > LARGEST_SKEWNESS:
        found = too_short(f"{name}_mean", longer(length, skewness, LARGEST_SKEWNESS))
    if std < _NARROW * mean:
        return [found, LeftOut(name=f"{name}_std", reason="the law is too narrow for its moments to show it")]
    error = sqrt((fourth - second**2) / seen.count) / (2.0 * std)
    tail = tail_of_squares(law, mean, seen.count, length)
    return [found, judged(f"{name}_std", seen.std, std, error, length=length, tail=tail)]


def central_moments(moment: Callable[[int], float]) -> tuple[float, float, float]:
    """Return the second, third and fourth central moments of a law from its moments about 0, E[x^n]."""
    from mpmath import mpf

    m1, m2, m3, m4 = (mpf(moment(n)) for n in (1, 2, 3, 4))
    second, third = m2 - m1**2, m3 - 3 * m1 * m2 + 2 * m1**3
    return float(second), float(third), float(m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4)


class AliveAtStart:
    """Collects the rows of junctions that were alive at the start."""

    def __init__(self) -> None:
        self._births: list[Doubles] = []
        self._diameters: list[Doubles] = []
        self._offsets: list[Doubles] = []

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        there = (columns["state"] & JunctionState.ALIVE_AT_START) != 0
        self._births.append(columns["birth_distance"][there])
        self._diameters.append(columns["diameter"][there])
        if "lateral_offset" in columns:
            self._offsets.append(columns["lateral_offset"][there])

    @property
    def diameters(self) -> Doubles:
        """Their diameters in um."""
        return np.concatenate([np.empty(0), *self._diameters])

    @property
    def ages(self) -> Doubles:
        """Their ages as a share of their lives."""
        return -np.concatenate([np.empty(0), *self._births]) / (2.0 * half_life(self.diameters, self.offsets))

    @property
    def offsets(self) -> Doubles | None:
        """Their lateral offsets in um; None if all pass through both centres."""
        return np.concatenate(self._offsets) if self._offsets else None


def start_findings(model: Model, start: AliveAtStart) -> list[Finding]:
    """Return number, ages and diameters at the start beside their laws; raises Refused unless births are random.

    The number is Poisson(lam E[life]), ages are uniform over a life, diameters have a density proportional to d f(d),
    offsets one proportional to the life, (2/pi) sqrt(1 - (b/d)^2); an empty start has no junctions to compare.
    """
    if model.start != "stationary":
        return []
    need_random_births(model, "who is alive at the start")
    diameters = start.diameters
    found: list[Finding] = [poisson_figure("start_count", diameters.size, mean_count(model))]
    if diameters.size < FEWEST:
        return found  # as few as the contact has: no length would bring more
    ages = np.sort(start.ages)
    found.append(kolmogorov_figure("start_age_kolmogorov", sample_distance(ages, ages), ages.size))
    low, high = size_range(model.sizes)
    if low < high and not has_single_values(model.sizes):
        distance = sample_distance(diameters, size_distribution(model.sizes, alive=True)(diameters))
        found.append(kolmogorov_figure("start_diameter_kolmogorov", distance, diameters.size))
    if start.offsets is not None:
        aside = start.offsets / diameters
        below = 0.5 + (aside * half_life(np.ones(aside.size), aside) + np.arcsin(aside)) / np.pi
        distance = sample_distance(below, below)
        found.append(kolmogorov_figure("start_offset_kolmogorov", distance, diameters.size))
    return found
