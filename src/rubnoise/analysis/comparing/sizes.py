"""How large and how strong the junctions are that were born along the run."""

from collections.abc import Callable
from math import sqrt
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.comparing.findings import Finding, Identity, LeftOut
from rubnoise.analysis.comparing.judging import LARGEST_SKEWNESS, judged, too_short
from rubnoise.analysis.comparing.size_distribution import size_distribution
from rubnoise.analysis.comparing.tails import Drawn, tail_of_squares
from rubnoise.analysis.kolmogorov import FEWEST, UniformSample, kolmogorov_figure
from rubnoise.analysis.records import longer
from rubnoise.contact.laws import Fixed
from rubnoise.model import Model
from rubnoise.record.tally import Moments
from rubnoise.theory.quadrature import size_range

Doubles = NDArray[np.float64]

_ROUNDING = 2.0**-50
_NARROW = 1e-3  # std over mean below which moments about 0 leave no digits to the fourth central one


class _Law(Drawn, Protocol):
    """A law of diameters or of strengths."""

    def moment(self, power: int) -> float:
        """Return E[x^n]."""
        ...


class Marks:
    """Gathers what every junction that is born draws for itself: its diameter, and its strength where there is one."""

    def __init__(self, model: Model) -> None:
        low, high = size_range(model.sizes)
        self._law = size_distribution(model.sizes) if low < high else None
        self._alike = {"diameter": model.sizes.moment(1)}
        if model.strengths is not None:
            self._alike["shear_strength"] = model.strengths.moment(1)
        self.moments = {name: Moments(powers=2) for name in self._alike}
        self.deviations = dict.fromkeys(self._alike, 0.0)
        self.sizes = UniformSample()

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Take in a panel of /junctions."""
        born = ~np.signbit(columns["birth_distance"])
        if not born.any():
            return
        for name, value in self._alike.items():
            self.moments[name].add(columns[name][born])
            away = float(np.abs(columns[name][born] - value).max())
            self.deviations[name] = max(self.deviations[name], away)
        if self._law is not None:
            self.sizes.add(self._law(columns["diameter"][born]))


def mark_findings(model: Model, marks: Marks) -> list[Finding]:
    """Return diameters and strengths beside their laws: mean, standard deviation, and the whole law of diameters.

    The born are drawn from the law itself, whatever becomes of them; those alive at the start are not, and left aside.
    """
    count = marks.moments["diameter"].count
    if not count:
        return [too_short("diameter", FEWEST * model.mean_birth_spacing)]
    low, high = size_range(model.sizes)
    if low == high:
        found = [_alike("diameter", marks, model.sizes.moment(1), "um")]
    else:
        found = _spread("diameter", marks.moments["diameter"], model.sizes, model)
        if count >= FEWEST:
            found.append(kolmogorov_figure("diameter_kolmogorov", marks.sizes.distance(), count))
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
        return [found, LeftOut(name=f"{name}_std", reason="the law is too narrow for its moments to tell it")]
    error = sqrt((fourth - second**2) / seen.count) / (2.0 * std)
    tail = tail_of_squares(law, mean, seen.count, length)
    return [found, judged(f"{name}_std", seen.std, std, error, length=length, tail=tail)]


def central_moments(moment: Callable[[int], float]) -> tuple[float, float, float]:
    """Return the second, third and fourth central moments of a law from its moments about 0, E[x^n]."""
    from mpmath import mpf

    m1, m2, m3, m4 = (mpf(moment(n)) for n in (1, 2, 3, 4))
    second, third = m2 - m1**2, m3 - 3 * m1 * m2 + 2 * m1**3
    return float(second), float(third), float(m4 - 4 * m1 * m3 + 6 * m1**2 * m2 - 3 * m1**4)
