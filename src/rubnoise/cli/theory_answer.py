"""The exact values of a model, by name, in working units and ready for JSON, at the places of the --at options."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations_with_replacement
from math import isfinite, nan
from typing import Any, Final

import numpy as np

from rubnoise.answer import Answer, Row, Table, printable, rows
from rubnoise.arrays import Doubles
from rubnoise.cli.derivation import ONE_WAY_ALONE, load_notes, load_rows, motion_rows, motion_warnings
from rubnoise.cli.terminal import NUMBER
from rubnoise.cli.vocabulary import UNITS, fields_of, named
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused, naming
from rubnoise.model import Model
from rubnoise.theory.ancestors import velocity_weakening, white_noise
from rubnoise.theory.coupling import third_octaves
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.moments import area_cumulants, force_cumulants
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import area_noise, autocovariance, covariance_reach
from rubnoise.theory.sizes import longest_life

_FEW, _MANY = 8, 241  # steps between points by default: on a terminal, and for everything else
_LITTLE, _NOTHING = 1e-3, 1e-9  # parts of the variance at which lags end, likewise
_REACH: Final = 6.0  # standard deviations from the mean to which areas reach by default
_MOST_LINES, _LINES_SHOWN, _BINS_SHOWN = 64, 6, 8  # spectral lines in an answer and in text, bins of an estimate there
_CONVENTION: Final = (
    "two-sided, um^4 per rad/um: R(lag) = 1/(2 pi) * integral of S(k) exp(i k lag) dk over k from -inf to inf"
)

At = Mapping[str, Doubles]  # places by wavenumber (rad/um), lag (um), area (um^2) and distance (um)
Part = Iterator[Row | Table]  # some rows and tables of the answer


def places(given: Mapping[str, Sequence[str] | None]) -> At:
    """Return the places that options name; raises Refused, naming option and value, if a number is not finite."""
    return {
        name: np.array([_number(f"--at-{name}", part.strip()) for text in texts for part in text.split(",")])
        for name, texts in given.items()
        if texts
    }


def _number(option: str, text: str) -> float:
    value = float(text) if NUMBER.fullmatch(text) else nan
    if not isfinite(value):
        shown = f'"{printable(text[:40])}" is no finite number' if text else "a number is missing"
        raise Refused(f"{option}: {shown}; right form: {option} 0.5,1,2e3")
    return value


def _usual_places(theory: Exact, *, brief: bool) -> dict[str, Doubles]:
    """Return wavenumbers far to both sides of the corner, lags to the end of all correlation, areas about the mean.

    Wavenumbers are even in their logarithm; brief ones are few and round.
    """
    unit, area = 1.0 / theory.model.mean_life_distance, theory.area
    reach = covariance_reach(theory.model, _LITTLE if brief else _NOTHING)
    if brief:
        step = _rounded(0.75 * area.std) or area.mean
        around = step * (np.round(area.mean / step) + np.arange(_FEW + 1.0) - _FEW // 2)
        factors = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
        return {
            "wavenumber": np.array([0.0, *(_rounded(unit * factor) for factor in factors)]),
            "lag": _rounded(reach / _FEW) * np.arange(_FEW + 1, dtype=np.float64),
            "area": around[around >= 0.0],
        }
    lowest, highest = max(0.0, area.mean - _REACH * area.std), area.mean + _REACH * area.std
    return {
        "wavenumber": np.concatenate([np.zeros(1), unit * np.geomspace(0.01, 1e4, _MANY)]),
        "lag": np.linspace(0.0, reach, _MANY),
        "area": np.unique(np.linspace(lowest, highest, _MANY)),
    }


def _rounded(value: float) -> float:
    return float(f"{value * (1.0 + 1e-9):.1g}")  # a half goes up, whatever its last bit


def theory_answer(
    title: str, model: Model, at: At, *, brief: bool, segment: int | None = None, white: bool = False
) -> Answer:
    """Return moments, and spectrum, autocovariance, distribution and the rest at places, by default some that suit.

    ``brief``: whether these are few, for a terminal; ``segment``: ticks of a segment of Welch's method; ``white``:
    whether to add Kilburn's white noise. A part that does not apply to the model is left out; raises Refused if an
    option requests it.
    """
    if model.slider is not None and model.slider.excitation == "velocity-weakening":
        # Without junctions there is no noise: of the contact's force only the mean is left (Block; Oden and Martins).
        known = {"mean_force": force_cumulants(model).mean} | velocity_weakening(model)
        return Answer(title=title, rows=tuple(named("velocity_weakening", known)))
    theory = exact(model)
    usual = _usual_places(theory, brief=brief)
    with np.errstate(over="ignore", under="ignore", divide="ignore"):  # the square of a far point, where 0 is left
        found = [
            *_moments(theory),
            *_motions(theory, white=white),
            *_curves(theory, usual | dict(at)),
            *_distribution(theory, at.get("area"), usual["area"]),
            *_estimated(theory, segment),
            *_from_empty(theory, at.get("distance"), _FEW if brief else _MANY - 1),
        ]
    notes = [f"warning: {warning}" for warning in motion_warnings(theory)]
    notes += [ONE_WAY_ALONE] if model.is_two_way else []
    return Answer(
        title=title,
        rows=tuple(each for each in found if isinstance(each, Row)),
        tables=tuple(each for each in found if isinstance(each, Table)),
        notes=(*notes, *load_notes(theory)),
    )


def _moments(theory: Exact) -> Part:
    """Yield the moments of diameters, count, area and force, and the cumulants of area and force."""
    held = "" if theory.free is None else "at constant separation"
    yield from rows(
        "diameter",
        ("calibrated", theory.model.calibrated_diameter, "um"),
        ("mean", theory.mean_diameter, "um"),
        ("length_biased_mean", theory.length_biased_mean_diameter, "um"),
    )
    yield from rows("count", ("mean", theory.count_mean, "", held), ("variance", theory.count_variance, "", held))
    orders: dict[str, Any] = {"order": list(range(1, len(theory.area.values) + 1))}
    for part, found, unit in (("area", theory.area, "um^2"), ("force", theory.force, "uN")):
        if found is not None:
            units = {"mean": unit, "std": unit, "skewness": "", "excess_kurtosis": ""}
            yield from rows(part, *((name, getattr(found, name), units[name], held) for name in units))
            orders[part] = list(found.values)
    yield Table(name="cumulants", columns=orders)  # in powers of their units


def _motions(theory: Exact, *, white: bool) -> Part:
    """Yield the motion of a slider, that under a load that weighs, and what older models make of it."""
    yield from motion_rows(theory)
    if theory.model.held is not None:
        yield from load_rows(theory)
    if theory.load is not None:
        found = theory.load.covariances  # at one time
        for one, other in combinations_with_replacement(dict.fromkeys(one for one, _ in found), 2):
            unit = f"{UNITS[one]}*{UNITS[other]}"
            yield Row(part="load_covariances", name=f"{one}*{other}", value=found[one, other], unit=unit)
        yield Table(name="third_octaves", columns=third_octaves(theory.model), units=UNITS | {"level": "dB"})
    if theory.model.slider is not None and theory.model.slider.excitation == "base":
        # Of other pulses too: the base is made of triangles of the same diameters (Rice and Moslehy).
        triangles = replace(theory.model, pulse=TRIANGLE)
        motion, area, lift = response(triangles), area_cumulants(triangles), triangles.base_per_area
        known = {"base_mean": lift * area.mean, "base_std": lift * area.std}
        yield from named("base_excitation", known | fields_of(motion, "displacement_std velocity_std"))
    if white:  # of the same level at low frequency (Kilburn)
        yield from named("white_noise", white_noise(theory.model))


def _curves(theory: Exact, at: At) -> Part:
    """Yield spectrum and autocovariance of the area."""
    units = UNITS | {"density": "um^4/(rad/um)", "power": "um^4", "value": "um^4"}
    wavenumbers, lags = at["wavenumber"], at["lag"]
    yield Row(part="spectrum", name="convention", value=_CONVENTION)
    columns = {"wavenumber": wavenumbers, "density": theory.spectral_density(wavenumbers)}
    yield Table(name="spectrum", columns=columns, units=units)
    wavenumber, power = area_noise(theory.model).lines
    if power.size:  # the first lines of regular births
        columns = {"wavenumber": wavenumber[:_MOST_LINES], "power": power[:_MOST_LINES]}
        shown = range(min(power.size, _LINES_SHOWN))
        yield Table(name="spectral_lines", columns=columns, units=units, shown=shown)
    columns = {"lag": lags, "value": autocovariance(theory.model, lags)}
    yield Table(name="autocovariance", columns=columns, units=units)


def _distribution(theory: Exact, asked: Doubles | None, usual: Doubles) -> Part:
    try:
        law = theory.distribution()
    except Refused as refusal:
        if asked is not None:
            raise Refused(f"--at-area: {refusal}") from refusal
        return
    area = usual if asked is None else asked
    yield Row(part="distribution", name="atom_at_zero", value=float(law.atom_at_zero))
    columns = {"area": area, "density": law.density(area), "cdf": law.cdf(area)}
    yield Table(name="distribution", columns=columns, units=UNITS | {"density": "1/um^2"})


def _estimated(theory: Exact, segment: int | None) -> Part:
    """Yield what Welch's method shows; text has bins evenly in the logarithm of their number."""
    if segment is None:
        return
    with naming("--segment"):
        seen = theory.estimated_spectrum(segment)
    columns = fields_of(seen, "wavenumber density standard_error")
    if np.isnan(seen.standard_error).any():
        del columns["standard_error"]
    units = UNITS | dict.fromkeys(("density", "standard_error"), "um^4/(rad/um)")
    shown = sorted({0, *(round(each) for each in np.geomspace(1, seen.wavenumber.size - 1, _BINS_SHOWN))})
    yield from named("estimated_spectrum", fields_of(seen, "ticks segments"))
    yield Table(name="estimated_spectrum", columns=columns, units=units, shown=shown)


def _from_empty(theory: Exact, distances: Doubles | None, steps: int) -> Part:
    """Yield the growth of a contact from an empty start, if the scenario has one or --at-distance requests it."""
    if distances is None and theory.model.start != "empty":
        return
    distances = np.linspace(0.0, longest_life(theory.model), steps + 1) if distances is None else distances
    empty = exact(replace(theory.model, start="empty"))
    area, count = empty.area_from_empty(distances), empty.count_from_empty(distances)
    yield from rows(
        "from_empty",
        ("run_area_mean", empty.expected_mean_area(), "um^2", "over the whole run"),
        ("run_count_mean", empty.expected_mean_count(), "", "over the whole run"),
    )
    columns = {"distance": distances, "area_mean": area, "count_mean": count}
    yield Table(name="from_empty", columns=columns, units=UNITS)
