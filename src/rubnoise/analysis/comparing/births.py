"""Compare the births along the run: their number, their gaps and their places."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.agreement import Agreement
from rubnoise.analysis.comparing.findings import Finding, Identity, judged, poisson_figure, too_short
from rubnoise.analysis.kolmogorov import FEWEST, UniformSample, kolmogorov_figure
from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.errors import Refused
from rubnoise.model import Model

FEWEST_GAPS = 1000
"""Births from which the spread of their gaps, a mean of squares of exponentials, has a score."""

_SKEWNESS = 5.0
_MEMORIES = 30.0
_ROUNDING = 2.0**-49  # of a distance that is a sum of gaps, each rounded


class Births:
    """Sums over the births of a run, s >= 0, from rows in order of birth."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self.last = 0.0
        self.count = 0
        self.squares = 0.0
        self.shortest, self.longest = np.inf, 0.0
        self.places = UniformSample()
        self.gaps = UniformSample()

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        birth = columns["birth_distance"][~np.signbit(columns["birth_distance"])]
        if not birth.size:
            return
        gaps = np.diff(birth, prepend=self.last)
        later = gaps[1:] if self.count == 0 else gaps
        if later.size:
            self.shortest = min(self.shortest, float(later.min()))
            self.longest = max(self.longest, float(later.max()))
        self.squares += float(np.square(gaps).sum())
        self.gaps.add(-np.expm1(-gaps / self._model.mean_birth_spacing))
        self.places.add(birth / self._model.distance)
        self.last, self.count = float(birth[-1]), self.count + birth.size


def birth_findings(model: Model, births: Births) -> list[Finding]:
    """Return the births of a run beside their law; raises Refused if theory knows no figure for the law."""
    if isinstance(model.births, PoissonBirths):
        return _at_random(model, births)
    if isinstance(model.births, RegularBirths):
        return _regular(model, births)
    if model.births.dispersion == 0.0:
        raise Refused("births of this law are not compared: their number hardly varies")
    expected = model.birth_rate * model.distance
    # Long beside what births remember, their number varies by its dispersion; near the ends they lack neighbours.
    error = (model.births.dispersion * expected) ** 0.5
    if model.distance < _MEMORIES * model.births.memory:
        return [too_short("birth_count", _MEMORIES * model.births.memory)]
    return [Agreement(name="birth_count", observed=float(births.count), expected=expected, standard_error=error)]


def _at_random(model: Model, births: Births) -> list[Finding]:
    found: list[Finding] = [poisson_figure("birth_count", births.count, model.birth_rate * model.distance)]
    needed = (FEWEST_GAPS + 1) * model.mean_birth_spacing
    found.append(
        _gap_spread(model, births) if births.count >= FEWEST_GAPS else too_short("birth_gap_variation", needed)
    )
    if births.count < FEWEST:
        return [*found, too_short("births", FEWEST * model.mean_birth_spacing)]
    found.append(kolmogorov_figure("birth_gap_kolmogorov", births.gaps.distance(), births.count))
    return [*found, kolmogorov_figure("birth_place_kolmogorov", births.places.distance(), births.count)]


def _gap_spread(model: Model, births: Births) -> Finding:
    """Return variance over squared mean of the n + 1 gaps into which n births divide the run.

    The births of a Poisson process are uniform on the run once their number is known, and so the sum of squared shares
    G has the mean 2/(n + 2) and the variance 4n / ((n + 2)^2 (n + 3)(n + 4)). Its skewness tends to 10/sqrt(n).
    Source: Moran (1947), doi:10.1111/j.2517-6161.1947.tb01572.x.
    """
    n = births.count
    squares = births.squares + (model.distance - births.last) ** 2
    error = 2.0 * (n + 1) / (n + 2) * (n / ((n + 3) * (n + 4))) ** 0.5
    return judged(
        "birth_gap_variation",
        (n + 1) * squares / model.distance**2 - 1.0,
        (n + 1) * 2.0 / (n + 2) - 1.0,
        error,
        length=model.distance,
        skewness=_SKEWNESS,
    )


def _regular(model: Model, births: Births) -> list[Finding]:
    spacing = model.mean_birth_spacing
    away = max(births.longest - spacing, spacing - births.shortest) if births.count > 1 else 0.0
    rounding = _ROUNDING * (model.distance + births.count * spacing)
    missing = abs(births.count - model.distance / spacing)
    return [
        Identity(name="birth_gap", deviation=away, allowed=rounding, units="um"),
        Identity(name="birth_count", deviation=missing, allowed=1.0 + rounding / spacing, units=""),
    ]
