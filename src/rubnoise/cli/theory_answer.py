"""The exact values of a model, by name, in working units and ready for JSON, at the points of the --at options."""

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import combinations_with_replacement
from math import isfinite
from typing import Any, Final, Self

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.cli.derivation import motion_as_json
from rubnoise.cli.layout import finite, printable
from rubnoise.cli.load import load_as_json
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.ancestors import velocity_weakening, white_noise
from rubnoise.theory.cumulants import Cumulants, area_cumulants, force_cumulants
from rubnoise.theory.distribution import distribution
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.load import third_octaves
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import autocovariance, covariance_reach, spectral_density, visible_lines
from rubnoise.theory.sizes import longest_life

NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
LONGEST_SHOWN: Final = 40
FEW: Final = 8
MANY: Final = 241
"""Steps between points by default: on a terminal, and for everything else."""

LITTLE, NOTHING = 1e-3, 1e-9
"""Parts of the variance at which lags end."""

REACH: Final = 6.0
"""How many standard deviations from the mean the areas reach by default."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Points:
    """Wavenumbers in rad/um, lags in um and areas in um^2, in the order of the options.

    ``distances`` from an empty start are in um; None if no option names any.
    ``areas_given``: whether an option names areas; ``brief``: whether default points are for a terminal.
    """

    wavenumbers: Doubles
    lags: Doubles
    areas: Doubles
    distances: Doubles | None
    areas_given: bool
    brief: bool

    @classmethod
    def of(
        cls,
        model: Model,
        *,
        wavenumbers: Sequence[str] | None,
        lags: Sequence[str] | None,
        areas: Sequence[str] | None,
        distances: Sequence[str] | None,
        brief: bool,
    ) -> Self:
        """Return the points that options name, otherwise default points that suit the model, few if ``brief``.

        Raises Refused, naming option and value, if a number is not finite.
        """
        given = [
            _read(option, texts)
            for option, texts in (("--at-wavenumber", wavenumbers), ("--at-lag", lags), ("--at-area", areas))
        ]
        return cls(
            wavenumbers=_wavenumbers(model, brief=brief) if given[0] is None else given[0],
            lags=_lags(model, brief=brief) if given[1] is None else given[1],
            areas=_areas(model, brief=brief) if given[2] is None else given[2],
            distances=_read("--at-distance", distances),
            areas_given=given[2] is not None,
            brief=brief,
        )

    def distances_up_to(self, longest: float) -> Doubles:
        """Return the given distances, or some from 0 to the longest life."""
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
    """Return lags from 0 to the end of all correlation."""
    if brief:
        return _rounded(covariance_reach(model, LITTLE) / FEW) * np.arange(FEW + 1, dtype=np.float64)
    return np.linspace(0.0, covariance_reach(model, NOTHING), MANY)


def _areas(model: Model, *, brief: bool) -> Doubles:
    """Return areas from far below the mean, or from 0, to as far above it."""
    area = area_cumulants(model)
    if brief:
        step = _rounded(0.75 * area.std) or area.mean
        around = step * (np.round(area.mean / step) + np.arange(FEW + 1.0) - FEW // 2)
        return around[around >= 0.0]
    return np.unique(np.linspace(max(0.0, area.mean - REACH * area.std), area.mean + REACH * area.std, MANY))


def _rounded(value: float) -> float:
    return float(f"{value:.1g}")


CONVENTION: Final = (
    "two-sided, um^4 per rad/um: R(lag) = 1/(2 pi) * integral of S(k) exp(i k lag) dk over k from -inf to inf"
)

MOST_LINES: Final = 64


def theory_as_json(model: Model, points: Points, segment: int | None = None, *, white: bool = False) -> dict[str, Any]:
    """Return moments, and spectrum, autocovariance, distribution and the rest at the points; None for what is infinite.

    ``segment``: ticks of a segment of Welch's method; ``white``: whether to add Kilburn's white noise. A group
    that does not apply to the model is left out; raises Refused if an option requests it.
    """
    if model.slider is not None and model.slider.excitation == "velocity-weakening":
        # Without junctions there is no noise: of the contact's force only the mean is left.
        known = {"mean_force": force_cumulants(model).mean} | asdict(velocity_weakening(model))
        return {"velocity_weakening": known}
    theory = exact(model)
    answer: dict[str, Any] = {
        "count": {"mean": theory.count_mean, "variance": theory.count_variance},
        "area": _moments(theory.area),
    }
    if theory.force is not None:
        answer["force"] = _moments(theory.force)
    if motion := motion_as_json(theory):
        answer["slider"] = motion
    answer |= _load(theory) | _other_models(model, white=white)
    answer["diameter"] = {
        "calibrated": model.calibrated_diameter,
        "mean": theory.mean_diameter,
        "length_biased_mean": theory.length_biased_mean_diameter,
    }
    # The square of a far point may overflow: what is left there is 0.
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        answer |= _at(model, points)
        answer |= _estimated(theory, segment) | _from_empty(theory, points)
    return dict(finite(answer))


def _moments(cumulants: Cumulants) -> dict[str, Any]:
    return {
        "mean": cumulants.mean,
        "std": cumulants.std,
        "skewness": cumulants.skewness,
        "excess_kurtosis": cumulants.excess_kurtosis,
        "cumulants": [each for each in cumulants.values if isfinite(each)],
    }


def _load(theory: Exact) -> dict[str, Any]:
    """Return the motion under a load that weighs, its covariances and its third octaves; nothing without one."""
    if theory.free is not None:
        return {"load": load_as_json(theory)}
    if theory.load is None:
        return {}
    bands, motion = third_octaves(theory.model), theory.load
    pairs = combinations_with_replacement(motion.covariances.names, 2)
    return {
        "load": load_as_json(theory),
        "load_covariances": {f"{one}*{other}": motion.covariances.of(one, other) for one, other in pairs},
        "third_octaves": {"frequency": bands.frequency, "velocity": bands.velocity, "level": bands.level},
    }


def _other_models(model: Model, *, white: bool) -> dict[str, Any]:
    """Return the values of an older model, instead of or beside the contact's own force."""
    found: dict[str, Any] = {}
    if model.slider is not None and model.slider.excitation == "base":
        # Of other pulses too: the base is made of triangles of the same diameters.
        triangles = replace(model, pulse=TRIANGLE)
        motion, area = response(triangles), area_cumulants(triangles)
        found["base_excitation"] = {
            "base_mean": model.base_per_area * area.mean,
            "base_std": model.base_per_area * area.std,
            "displacement_std": motion.displacement_std,
            "velocity_std": motion.velocity_std,
        }
    if white:
        found["white_noise"] = asdict(white_noise(model))
    return found


def _at(model: Model, points: Points) -> dict[str, Any]:
    return {
        "spectrum": {
            "wavenumber": points.wavenumbers,
            "density": spectral_density(model, points.wavenumbers),
            "convention": CONVENTION,
        },
        **_lines(model),
        "autocovariance": {"lag": points.lags, "value": autocovariance(model, points.lags)},
    } | _distribution(model, points)


def _lines(model: Model) -> dict[str, Any]:
    """Return the first spectral lines of regular births."""
    wavenumber, power = visible_lines(model)
    if not power.size:
        return {}
    return {"spectral_lines": {"wavenumber": wavenumber[:MOST_LINES], "power": power[:MOST_LINES]}}


def _distribution(model: Model, points: Points) -> dict[str, Any]:
    try:
        law = distribution(model)
    except Refused as refusal:
        if not points.areas_given:
            return {}
        raise Refused(f"--at-area: {refusal}") from refusal
    areas = points.areas
    known = {"area": areas, "density": law.density(areas), "cdf": law.cdf(areas), "atom_at_zero": law.atom_at_zero}
    return {"distribution": known}


def _estimated(theory: Exact, segment: int | None) -> dict[str, Any]:
    if segment is None:
        return {}
    try:
        seen = theory.estimated_spectrum(segment)
    except Refused as refusal:
        raise Refused(f"--segment: {refusal}") from refusal
    group = {"wavenumber": seen.wavenumber, "density": seen.density, "ticks": seen.ticks, "segments": seen.segments}
    known = not np.isnan(seen.standard_error).any()
    return {"estimated_spectrum": group | ({"standard_error": seen.standard_error} if known else {})}


def _from_empty(theory: Exact, points: Points) -> dict[str, Any]:
    """Return the growth of a contact from an empty start, if the scenario has one or --at-distance requests it."""
    if points.distances is None and theory.model.start != "empty":
        return {}
    distances = points.distances_up_to(longest_life(theory.model))
    empty = exact(replace(theory.model, start="empty"))
    grown = {
        "distance": distances,
        "area_mean": empty.area_from_empty(distances),
        "count_mean": empty.count_from_empty(distances),
        "run_area_mean": empty.expected_mean_area(),
        "run_count_mean": empty.expected_mean_count(),
    }
    return {"from_empty": grown}
