"""Where theory is asked: the places of the --at options, or ones that suit the model."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Final, Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.cli.layout import printable
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.lags import covariance_reach

NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
LONGEST_SHOWN: Final = 40
FEW: Final = 8
MANY: Final = 241
"""Steps between points where nobody says which: for a terminal, and for everything else."""

LITTLE, NOTHING = 1e-3, 1e-9
"""Parts of the variance at which lags end."""

REACH: Final = 6.0
"""How many standard deviations from the mean the areas reach where nobody says which."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Points:
    """Wavenumbers in rad/um, lags in um and areas in um^2, in the order in which they were asked for.

    So are ``levels`` of the displacement and ``distances`` from an empty start, in um; None where none were asked for.
    ``areas_asked``: whether the areas were; ``brief``: whether points that nobody chose are for a terminal.
    """

    wavenumbers: Doubles
    lags: Doubles
    areas: Doubles
    levels: Doubles | None
    distances: Doubles | None
    areas_asked: bool
    brief: bool

    @classmethod
    def of(
        cls,
        model: Model,
        *,
        wavenumbers: Sequence[str] | None,
        lags: Sequence[str] | None,
        areas: Sequence[str] | None,
        levels: Sequence[str] | None,
        distances: Sequence[str] | None,
        brief: bool,
    ) -> Self:
        """Return the points that options name, and for those left out some that suit the model, few when ``brief``.

        Raises Refused, naming option and value, for what is no finite number.
        """
        given = [
            _read(option, texts)
            for option, texts in (("--at-wavenumber", wavenumbers), ("--at-lag", lags), ("--at-area", areas))
        ]
        return cls(
            wavenumbers=_wavenumbers(model, brief=brief) if given[0] is None else given[0],
            lags=_lags(model, brief=brief) if given[1] is None else given[1],
            areas=_areas(model, brief=brief) if given[2] is None else given[2],
            levels=_read("--at-level", levels),
            distances=_read("--at-distance", distances),
            areas_asked=given[2] is not None,
            brief=brief,
        )

    def levels_about(self, mean: float, std: float) -> Doubles:
        """Return the levels asked for, or some as far from a mean as a displacement of that spread ever goes."""
        if self.levels is not None:
            return self.levels
        return mean + std * (np.arange(-3.0, 4.0) if self.brief else np.linspace(-REACH, REACH, MANY))

    def distances_up_to(self, longest: float) -> Doubles:
        """Return the distances asked for, or some from 0 to the longest life."""
        if self.distances is not None:
            return self.distances
        return np.linspace(0.0, longest, FEW + 1 if self.brief else MANY)


def _read(option: str, texts: Sequence[str] | None) -> Doubles | None:
    if not texts:
        return None
    return np.array([_number(option, part.strip()) for text in texts for part in text.split(",")])


def _number(option: str, text: str) -> float:
    if not NUMBER.fullmatch(text):
        shown = f'"{printable(text[:LONGEST_SHOWN])}" is no finite number' if text else "a number is missing"
        raise Refused(f"{option}: {shown}; right form: {option} 0.5,1,2e3")
    value = float(text)
    if not isfinite(value):
        raise Refused(f"{option}: {text[:LONGEST_SHOWN]} is beyond the largest number there is")
    return value


def _wavenumbers(model: Model, *, brief: bool) -> Doubles:
    """Return 0 and wavenumbers from far below to far above the corner, evenly in their logarithm."""
    unit = 1.0 / model.mean_life_distance
    if brief:
        return np.array([0.0, *(_rounded(unit * factor) for factor in (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0))])
    return np.concatenate([np.zeros(1), unit * np.geomspace(0.01, 1e4, 241)])


def _lags(model: Model, *, brief: bool) -> Doubles:
    """Return lags from 0 to where nothing is left of the contact."""
    if brief:
        return _rounded(covariance_reach(model, LITTLE) / FEW) * np.arange(FEW + 1, dtype=np.float64)
    return np.linspace(0.0, covariance_reach(model, NOTHING), MANY)


def _areas(model: Model, *, brief: bool) -> Doubles:
    """Return areas from far below the mean, or 0, to as far above it."""
    area = area_cumulants(model)
    if brief:
        step = _rounded(0.75 * area.std) or area.mean
        around = step * (np.round(area.mean / step) + np.arange(FEW + 1.0) - FEW // 2)
        return around[around >= 0.0]
    return np.unique(np.linspace(max(0.0, area.mean - REACH * area.std), area.mean + REACH * area.std, MANY))


def _rounded(value: float) -> float:
    return float(f"{value:.1g}")
