"""The exact values of a model, by name, in working units and ready for JSON, at the points of the --at options."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from math import isfinite
from typing import Any, Final, Self

import numpy as np

from rubnoise.answer import Answer, Row, Table, printable
from rubnoise.arrays import Doubles
from rubnoise.cli.derivation import ONE_WAY_ALONE, motion_rows, motion_warnings
from rubnoise.cli.load import load_as_json, load_notes, load_rows
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.ancestors import velocity_weakening, white_noise
from rubnoise.theory.coupling import third_octaves
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.moments import area_cumulants, distribution, force_cumulants
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import area_noise, autocovariance, covariance_reach, spectral_density
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
LINES_SHOWN: Final = 6
BINS_SHOWN: Final = 8
"""Spectral lines in an answer, and how many of them and of the bins of an estimate text shows."""

COVARYING: Final = {
    "separation": "um",
    "normal_velocity": "um/s",
    "load": "uN",
    "friction_force": "uN",
    "displacement": "um",
    "velocity": "um/s",
}
"""What moves under a load that weighs, and its unit."""


def theory_answer(
    title: str, model: Model, points: Points, segment: int | None = None, *, white: bool = False
) -> Answer:
    """Return moments, and spectrum, autocovariance, distribution and the rest at the points.

    ``segment``: ticks of a segment of Welch's method; ``white``: whether to add Kilburn's white noise. A part that
    does not apply to the model is left out; raises Refused if an option requests it.
    """
    if model.slider is not None and model.slider.excitation == "velocity-weakening":
        # Without junctions there is no noise: of the contact's force only the mean is left.
        return Answer(title=title, rows=tuple(_weakening(model)))
    theory = exact(model)
    rows = [*_moments(theory), *motion_rows(theory)]
    rows += [*load_rows(theory), *_covariances(theory)] if model.held is not None else []
    rows += _other_models(model, white=white)
    tables = [_cumulants(theory), *_third_octaves(theory)]
    # The square of a far point may overflow: what is left there is 0.
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        for more_rows, table in (
            *_at(model, points),
            *_distribution(model, points),
            *_estimated(theory, segment),
            *_from_empty(theory, points),
        ):
            rows += more_rows
            tables.append(table)
    notes = [f"warning: {warning}" for warning in motion_warnings(theory)]
    notes += [ONE_WAY_ALONE] if model.is_two_way else []
    notes += load_notes(load_as_json(theory)) if model.held is not None else []
    return Answer(title=title, rows=tuple(rows), tables=tuple(tables), notes=tuple(notes))


def _rows(part: str, values: Mapping[str, Any], units: Mapping[str, str], note: str = "") -> Iterator[Row]:
    """Yield rows of a part; what is not in ``units`` is a plain number."""
    for name, value in values.items():
        yield Row(part=part, name=name, value=value, unit=units.get(name, ""), note=note)


def _moments(theory: Exact) -> Iterator[Row]:
    held = "" if theory.free is None else "at constant separation"
    sizes = {
        "calibrated": theory.model.calibrated_diameter,
        "mean": theory.mean_diameter,
        "length_biased_mean": theory.length_biased_mean_diameter,
    }
    yield from _rows("diameter", sizes, dict.fromkeys(sizes, "um"))
    yield from _rows("count", {"mean": theory.count_mean, "variance": theory.count_variance}, {}, held)
    for part, found, unit in (("area", theory.area, "um^2"), ("force", theory.force, "uN")):
        if found is not None:
            names = ("mean", "std", "skewness", "excess_kurtosis")
            known = {name: getattr(found, name) for name in names}
            yield from _rows(part, known, {"mean": unit, "std": unit}, held)


def _cumulants(theory: Exact) -> Table:
    """Return the cumulants of area and force, in powers of their units."""
    known = {"area": theory.area, "force": theory.force}
    columns = {name: list(found.values) for name, found in known.items() if found is not None}
    return Table(name="cumulants", columns={"order": list(range(1, len(columns["area"]) + 1)), **columns})


def _covariances(theory: Exact) -> Iterator[Row]:
    """Yield the covariances at one time of what moves under a load that weighs."""
    if theory.free is None and theory.load is not None:
        found = theory.load.covariances
        for one, other in combinations_with_replacement(dict.fromkeys(one for one, _ in found), 2):
            unit = f"{COVARYING[one]}*{COVARYING[other]}"
            yield Row(part="load_covariances", name=f"{one}*{other}", value=found[one, other], unit=unit)


def _third_octaves(theory: Exact) -> Iterator[Table]:
    if theory.free is None and theory.load is not None:
        columns = third_octaves(theory.model)
        yield Table(name="third_octaves", columns=columns, units={"frequency": "Hz", "velocity": "um/s", "level": "dB"})


def _weakening(model: Model) -> Iterator[Row]:
    """Yield what a force that falls with speed does (Block; Oden and Martins)."""
    units = {
        "mean_force": "uN",
        "border": "N*s/m",
        "mean_displacement": "um",
        "amplitude": "um",
        "slowest": "um/s",
        "fastest": "um/s",
        "period": "s",
    }
    known = {"mean_force": force_cumulants(model).mean} | velocity_weakening(model)
    yield from _rows("velocity_weakening", known, units)


def _other_models(model: Model, *, white: bool) -> Iterator[Row]:
    """Yield the values of an older model, instead of or beside the contact's own force."""
    units = {"base_mean": "um", "base_std": "um", "displacement_std": "um", "velocity_std": "um/s"}
    if model.slider is not None and model.slider.excitation == "base":
        # Of other pulses too: the base is made of triangles of the same diameters (Rice and Moslehy).
        triangles = replace(model, pulse=TRIANGLE)
        motion, area = response(triangles), area_cumulants(triangles)
        known = {
            "base_mean": model.base_per_area * area.mean,
            "base_std": model.base_per_area * area.std,
            "displacement_std": motion.displacement_std,
            "velocity_std": motion.velocity_std,
        }
        yield from _rows("base_excitation", known, units)
    if white:  # of the same level at low frequency (Kilburn)
        yield from _rows("white_noise", white_noise(model), units | {"force_density": "uN^2*s", "wavenumber": "rad/um"})


Curve = tuple[Sequence[Row], Table]
"""A curve, and numbers that belong to it."""


def _at(model: Model, points: Points) -> Iterator[Curve]:
    units = {"wavenumber": "rad/um", "density": "um^4/(rad/um)", "power": "um^4"}
    density = spectral_density(model, points.wavenumbers)
    columns: dict[str, Any] = {"wavenumber": points.wavenumbers, "density": density}
    convention = Row(part="spectrum", name="convention", value=CONVENTION)
    yield [convention], Table(name="spectrum", columns=columns, units=units)
    wavenumber, power = area_noise(model).lines
    if power.size:  # the first lines of regular births
        columns = {"wavenumber": wavenumber[:MOST_LINES], "power": power[:MOST_LINES]}
        shown = range(min(power.size, LINES_SHOWN))
        yield [], Table(name="spectral_lines", columns=columns, units=units, shown=shown)
    columns = {"lag": points.lags, "value": autocovariance(model, points.lags)}
    yield [], Table(name="autocovariance", columns=columns, units={"lag": "um", "value": "um^4"})


def _distribution(model: Model, points: Points) -> Iterator[Curve]:
    try:
        law = distribution(model)
    except Refused as refusal:
        if points.areas_given:
            raise Refused(f"--at-area: {refusal}") from refusal
        return
    columns = {"area": points.areas, "density": law.density(points.areas), "cdf": law.cdf(points.areas)}
    atom = Row(part="distribution", name="atom_at_zero", value=float(law.atom_at_zero))
    yield [atom], Table(name="distribution", columns=columns, units={"area": "um^2", "density": "1/um^2"})


def _estimated(theory: Exact, segment: int | None) -> Iterator[Curve]:
    """Yield what Welch's method shows; text has bins evenly in the logarithm of their number."""
    if segment is None:
        return
    try:
        seen = theory.estimated_spectrum(segment)
    except Refused as refusal:
        raise Refused(f"--segment: {refusal}") from refusal
    columns = {"wavenumber": seen.wavenumber, "density": seen.density}
    if not np.isnan(seen.standard_error).any():
        columns["standard_error"] = seen.standard_error
    units = {"wavenumber": "rad/um", "density": "um^4/(rad/um)", "standard_error": "um^4/(rad/um)"}
    shown = sorted({0, *(round(each) for each in np.geomspace(1, seen.wavenumber.size - 1, BINS_SHOWN))})
    known = {"ticks": seen.ticks, "segments": seen.segments}
    rows = list(_rows("estimated_spectrum", known, {}))
    yield rows, Table(name="estimated_spectrum", columns=columns, units=units, shown=shown)


def _from_empty(theory: Exact, points: Points) -> Iterator[Curve]:
    """Yield the growth of a contact from an empty start, if the scenario has one or --at-distance requests it."""
    if points.distances is None and theory.model.start != "empty":
        return
    distances = points.distances_up_to(longest_life(theory.model))
    empty = exact(replace(theory.model, start="empty"))
    columns = {
        "distance": distances,
        "area_mean": empty.area_from_empty(distances),
        "count_mean": empty.count_from_empty(distances),
    }
    known = {"run_area_mean": empty.expected_mean_area(), "run_count_mean": empty.expected_mean_count()}
    rows = list(_rows("from_empty", known, {"run_area_mean": "um^2"}, "over the whole run"))
    yield rows, Table(name="from_empty", columns=columns, units={"distance": "um", "area_mean": "um^2"})
