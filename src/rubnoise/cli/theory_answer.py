"""What theory says about a model, by name, in working units and ready for JSON."""

from dataclasses import replace
from math import isfinite
from typing import Any, Final

import numpy as np

from rubnoise.cli.coupling import coupling_figures
from rubnoise.cli.theory_points import Points
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.campbell import Cumulants
from rubnoise.theory.correlation import autocovariance
from rubnoise.theory.distribution import distribution
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.lags import longest_life
from rubnoise.theory.spectrum import spectral_density, visible_lines

CONVENTION: Final = (
    "two-sided, um^4 per rad/um: R(lag) = 1/(2 pi) * integral of S(k) exp(i k lag) dk over k from -inf to inf"
)

MOST_LINES: Final = 64


def answered(model: Model, points: Points, segment: int | None = None) -> dict[str, Any]:
    """Return moments, and spectrum, autocovariance, distribution and the rest at the points; None for what is infinite.

    ``segment``: ticks of one for what Welch's method shows. A group that does not apply to the model is left out;
    raises Refused where it was asked for.
    """
    theory = exact(model)
    answer: dict[str, Any] = {
        "count": {"mean": theory.count_mean, "variance": theory.count_variance},
        "area": _moments(theory.area),
    }
    if theory.force is not None:
        answer["force"] = _moments(theory.force)
    answer |= _motion(theory)
    answer["diameter"] = {
        "calibrated": model.calibrated_diameter,
        "mean": theory.mean_diameter,
        "length_biased_mean": theory.length_biased_mean_diameter,
    }
    # A point may lie further out than squares can be told: what is left there is 0.
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        answer |= _at(model, points)
        answer |= _estimated(theory, segment) | _crossings(theory, points) | _from_empty(theory, points)
    return {name: _finite(group) for name, group in answer.items()}


def _moments(cumulants: Cumulants) -> dict[str, Any]:
    return {
        "mean": cumulants.mean,
        "std": cumulants.std,
        "skewness": cumulants.skewness,
        "excess_kurtosis": cumulants.excess_kurtosis,
        "cumulants": list(cumulants.values),
    }


def _motion(theory: Exact) -> dict[str, Any]:
    if theory.slider is None:
        return {}
    slider = {
        "displacement_mean": theory.slider.mean_displacement,
        "displacement_std": theory.slider.displacement_std,
        "velocity_std": theory.slider.velocity_std,
        "one_way_validity": theory.slider.one_way_validity,
        **coupling_figures(theory),
    }
    return {"slider": slider}


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
    """Return the first lines that regular births put into the spectrum."""
    wavenumber, power = visible_lines(model)
    if not power.size:
        return {}
    return {"spectral_lines": {"wavenumber": wavenumber[:MOST_LINES], "power": power[:MOST_LINES]}}


def _distribution(model: Model, points: Points) -> dict[str, Any]:
    try:
        law = distribution(model)
    except Refused as refusal:
        if not points.areas_asked:
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


def _crossings(theory: Exact, points: Points) -> dict[str, Any]:
    """Return how often the slider passes levels, and how far from Gaussian it is."""
    try:
        motion = theory.motion_cumulants()
    except Refused as refusal:
        if points.levels is None:
            return {}
        raise Refused(f"--at-level: {refusal}") from refusal
    levels = points.levels_about(motion.mean, motion.displacement_std)
    crossings = {
        "level": levels,
        "rate": theory.crossing_rate(levels),
        "gaussian_rate": theory.gaussian_crossing_rate(levels),
        "displacement_skewness": motion.skewness,
        "displacement_excess_kurtosis": motion.excess_kurtosis,
    }
    return {"crossings": crossings}


def _from_empty(theory: Exact, points: Points) -> dict[str, Any]:
    """Return how a contact grows from an empty start, where the scenario has one or it was asked for."""
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


def _finite(value: Any) -> Any:
    """Return a value as JSON has it: arrays as lists, and None for what is no finite number."""
    if isinstance(value, dict):
        return {name: _finite(item) for name, item in value.items()}
    if isinstance(value, list | np.ndarray):
        return [_finite(item) for item in np.asarray(value, dtype=np.float64).tolist()]
    return value if value is None or isinstance(value, str) or isfinite(value) else None
