"""Compare the area and the count that a scenario requests with run and theory, by independent constants.

All other parts of a comparison use d_m and the birth rate that the program computes. A wrong constant in the
calibration would change run and theory in the same way, and no other figure would show it.
"""

from collections.abc import Iterable
from math import pi, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.comparing.findings import Finding, Identity, judged_mean, tail_of, too_short
from rubnoise.model import Model
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.sizes import size_range

LIFE_INTEGRALS: Final = {
    "lens": 2.0 / 3.0,
    "triangle": pi / 4.0,
    "parabola": pi / 3.0,
    "off-centre lens": pi**2 / 32.0,
    "off-centre parabola": pi**2 / 16.0,
}
"""Mean integral of the area over a life, in d^3, by the name of the pulse. Not taken from the pulse, on purpose."""

LIVES: Final = {
    "lens": 2.0,
    "triangle": 2.0,
    "parabola": 2.0,
    "off-centre lens": pi / 2.0,
    "off-centre parabola": pi / 2.0,
}
"""Mean life in d. Not taken from the pulse, either."""

PAPER_LIFE_MEAN: Final = 0.327
"""Mean area over a life in d^2, as the paper rounds it (Eq. 6): calibration paper asks for this in place of 1/3."""

_ROUNDING = 1e-9
_FLOOR = 1e-15  # square of what rounding leaves of the spread of a law that is practically one size


class Cubes:
    """Sums d^3 of the junctions that are born along the run."""

    def __init__(self) -> None:
        self.count = 0
        self.total = 0.0

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        born = columns["diameter"][~np.signbit(columns["birth_distance"])]
        self.count += born.size
        self.total += float((born**3).sum())


def asked_findings(model: Model, cubes: Cubes) -> list[Finding]:
    """Return the mean count and mean area that a scenario requests, beside the exact ones and those of the rows.

    N_jm junctions that live for L d_m, L = 2 if all pass through both centres, are born at a rate of N_jm/(L d_m),
    and with diameters d they have the mean area N_jm/(L d_m) C E[d^3], where C d^3 is the integral over a life. That
    must equal `asked_area`, with E[d^3] of the law and with the mean over the junctions that were born.
    """
    integral = LIFE_INTEGRALS.get(model.pulse.name)
    if integral is None:
        return [LeftOut(name="asked", reason="no second source has the mean area of this pulse")]
    life = LIVES[model.pulse.name] * model.calibrated_diameter
    rate, asked = model.mean_junction_count / life, asked_area(model, integral)
    means = area_cumulants(model).mean, rate * integral * model.sizes.moment(3)
    found: list[Finding] = [
        _identity("asked_mean_count", (model.birth_rate / rate,), model.mean_junction_count, ""),
        _identity("asked_mean_area", (mean / asked for mean in means), asked, "um^2"),
    ]
    if not cubes.count:
        return [*found, too_short("asked_area_from_rows", model.mean_birth_spacing)]
    return [*found, _from_rows(model, cubes, rate * integral, asked)]


def asked_area(model: Model, integral: float) -> float:
    """Return the mean area in um^2 that a calibration must give, for lives with the area integral ``integral`` d^3.

    For ``matched`` it is A_rm. ``exact`` takes all diameters as d_m, which gives A_rm E[d^3]/d_m^3; ``paper`` does so,
    too, with a mean area of 0.327 d^2 over a life in place of C/L.
    """
    if model.calibration == "matched":
        return model.mean_real_contact_area
    larger = model.sizes.moment(3) / model.calibrated_diameter**3
    whole = integral / LIVES[model.pulse.name]
    life_mean = PAPER_LIFE_MEAN if model.calibration == "paper" else whole
    return model.mean_real_contact_area * larger * whole / life_mean


def _from_rows(model: Model, cubes: Cubes, factor: float, asked: float) -> Finding:
    """Return the mean area for the diameters that were born; its error is that of the mean of their d^3."""
    name, seen = "asked_area_from_rows", factor * cubes.total / cubes.count
    low, high = size_range(model.sizes)
    if low == high:
        return _identity(name, (seen / asked,), asked, "um^2")
    spread = max(model.sizes.moment(6) / model.sizes.moment(3) ** 2 - 1.0, 0.0)
    length = cubes.count * model.mean_birth_spacing
    error = asked * sqrt(spread / cubes.count + _FLOOR)
    return judged_mean(name, seen, asked, error, length=length, tail=tail_of(model, length, 3))


def _identity(name: str, ratios: Iterable[float], asked: float, units: str) -> Identity:
    away = max(abs(ratio - 1.0) for ratio in ratios)
    return Identity(name=name, deviation=away * asked, allowed=_ROUNDING * asked, units=units)
