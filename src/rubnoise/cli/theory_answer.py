"""The exact values of a model, by name, in working units and ready for JSON, at the places of the --at options."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations_with_replacement
from math import isfinite
from typing import Any, Final

import numpy as np

from rubnoise.answer import Answer, Row, Table, printable, rows
from rubnoise.arrays import Doubles
from rubnoise.cli.derivation import ONE_WAY_ALONE, load_notes, load_rows, motion_rows, motion_warnings
from rubnoise.cli.options import NUMBER
from rubnoise.cli.vocabulary import UNITS, fields_of, named
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

LONGEST_SHOWN: Final = 40
FEW: Final = 8
MANY: Final = 241
"""Steps between points by default: on a terminal, and for everything else."""

LITTLE, NOTHING = 1e-3, 1e-9
"""Parts of the variance at which lags end."""

REACH: Final = 6.0
"""How many standard deviations from the mean the areas reach by default."""


def places(given: Mapping[str, Sequence[str] | None]) -> dict[str, Doubles]:
    """Return the places that options name: by wavenumber (rad/um), lag (um), area (um^2) and distance (um).

    Raises Refused, naming option and value, if a number is not finite.
    """
    return {
        name: np.array([_number(f"--at-{name}", part.strip()) for text in texts for part in text.split(",")])
        for name, texts in given.items()
        if texts
    }


def _number(option: str, text: str) -> float:
    if not NUMBER.fullmatch(text):
        shown = f'"{printable(text[:LONGEST_SHOWN])}" is no finite number' if text else "a number is missing"
        raise Refused(f"{option}: {shown}; right form: {option} 0.5,1,2e3")
    value = float(text)
    if not isfinite(value):
        raise Refused(f"{option}: {text[:LONGEST_SHOWN]} is beyond the largest number there is")
    return value


def _usual_places(model: Model, *, brief: bool) -> dict[str, Doubles]:
    """Return wavenumbers far to both sides of the corner, lags to the end of all correlation, areas about the mean.

    Wavenumbers are even in their logarithm; brief ones are few and round.
    """
    unit, area = 1.0 / model.mean_life_distance, area_cumulants(model)
    if brief:
        step = _rounded(0.75 * area.std) or area.mean
        around = step * (np.round(area.mean / step) + np.arange(FEW + 1.0) - FEW // 2)
        factors = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0)
        return {
            "wavenumber": np.array([0.0, *(_rounded(unit * factor) for factor in factors)]),
            "lag": _rounded(covariance_reach(model, LITTLE) / FEW) * np.arange(FEW + 1, dtype=np.float64),
            "area": around[around >= 0.0],
        }
    lowest, highest = max(0.0, area.mean - REACH * area.std), area.mean + REACH * area.std
    return {
        "wavenumber": np.concatenate([np.zeros(1), unit * np.geomspace(0.01, 1e4, MANY)]),
        "lag": np.linspace(0.0, covariance_reach(model, NOTHING), MANY),
        "area": np.unique(np.linspace(lowest, highest, MANY)),
    }


def _rounded(value: float) -> float:
    return float(f"{value * (1.0 + 1e-9):.1g}")  # a half goes up, whatever its last bit


CONVENTION: Final = (
    "two-sided, um^4 per rad/um: R(lag) = 1/(2 pi) * integral of S(k) exp(i k lag) dk over k from -inf to inf"
)

MOST_LINES: Final = 64
LINES_SHOWN: Final = 6
BINS_SHOWN: Final = 8
"""Spectral lines in an answer, and how many of them and of the bins of an estimate text shows."""


def theory_answer(
    title: str, model: Model, at: Mapping[str, Doubles], *, brief: bool, segment: int | None = None, white: bool = False
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
    found = [*_moments(theory), *motion_rows(theory)]
    found += [*load_rows(theory), *_covariances(theory)] if model.held is not None else []
    found += _other_models(model, white=white)
    tables, shown_at = [_cumulants(theory), *_third_octaves(theory)], _usual_places(model, brief=brief) | dict(at)
    # The square of a far point may overflow: what is left there is 0.
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        for more_rows, table in (
            *_at(model, shown_at),
            *_distribution(model, shown_at, asked="area" in at),
            *_estimated(theory, segment),
            *_from_empty(theory, at.get("distance"), FEW if brief else MANY - 1),
        ):
            found += more_rows
            tables.append(table)
    notes = [f"warning: {warning}" for warning in motion_warnings(theory)]
    notes += [ONE_WAY_ALONE] if model.is_two_way else []
    notes += load_notes(theory) if model.held is not None else []
    return Answer(title=title, rows=tuple(found), tables=tuple(tables), notes=tuple(notes))


def _moments(theory: Exact) -> Iterator[Row]:
    held = "" if theory.free is None else "at constant separation"
    yield from rows(
        "diameter",
        ("calibrated", theory.model.calibrated_diameter, "um"),
        ("mean", theory.mean_diameter, "um"),
        ("length_biased_mean", theory.length_biased_mean_diameter, "um"),
    )
    yield from rows("count", ("mean", theory.count_mean, "", held), ("variance", theory.count_variance, "", held))
    for part, found, unit in (("area", theory.area, "um^2"), ("force", theory.force, "uN")):
        if found is not None:
            yield from rows(part, ("mean", found.mean, unit, held), ("std", found.std, unit, held))
            shapes = ("skewness", found.skewness, "", held), ("excess_kurtosis", found.excess_kurtosis, "", held)
            yield from rows(part, *shapes)


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
            unit = f"{UNITS[one]}*{UNITS[other]}"
            yield Row(part="load_covariances", name=f"{one}*{other}", value=found[one, other], unit=unit)


def _third_octaves(theory: Exact) -> Iterator[Table]:
    if theory.free is None and theory.load is not None:
        yield Table(name="third_octaves", columns=third_octaves(theory.model), units=UNITS | {"level": "dB"})


def _other_models(model: Model, *, white: bool) -> Iterator[Row]:
    """Yield the values of an older model, instead of or beside the contact's own force."""
    if model.slider is not None and model.slider.excitation == "base":
        # Of other pulses too: the base is made of triangles of the same diameters (Rice and Moslehy).
        triangles = replace(model, pulse=TRIANGLE)
        motion, area = response(triangles), area_cumulants(triangles)
        lift = {"base_mean": model.base_per_area * area.mean, "base_std": model.base_per_area * area.std}
        yield from named("base_excitation", lift | fields_of(motion, "displacement_std velocity_std"))
    if white:  # of the same level at low frequency (Kilburn)
        yield from named("white_noise", white_noise(model))


Curve = tuple[Sequence[Row], Table]
"""A curve, and numbers that belong to it."""


def _at(model: Model, at: Mapping[str, Doubles]) -> Iterator[Curve]:
    units = UNITS | {"density": "um^4/(rad/um)", "power": "um^4", "value": "um^4"}
    wavenumbers, lags = at["wavenumber"], at["lag"]
    columns: dict[str, Any] = {"wavenumber": wavenumbers, "density": spectral_density(model, wavenumbers)}
    convention = Row(part="spectrum", name="convention", value=CONVENTION)
    yield [convention], Table(name="spectrum", columns=columns, units=units)
    wavenumber, power = area_noise(model).lines
    if power.size:  # the first lines of regular births
        columns = {"wavenumber": wavenumber[:MOST_LINES], "power": power[:MOST_LINES]}
        shown = range(min(power.size, LINES_SHOWN))
        yield [], Table(name="spectral_lines", columns=columns, units=units, shown=shown)
    yield [], Table(name="autocovariance", columns={"lag": lags, "value": autocovariance(model, lags)}, units=units)


def _distribution(model: Model, at: Mapping[str, Doubles], *, asked: bool) -> Iterator[Curve]:
    try:
        law = distribution(model)
    except Refused as refusal:
        if asked:
            raise Refused(f"--at-area: {refusal}") from refusal
        return
    columns = {"area": at["area"], "density": law.density(at["area"]), "cdf": law.cdf(at["area"])}
    atom = Row(part="distribution", name="atom_at_zero", value=float(law.atom_at_zero))
    yield [atom], Table(name="distribution", columns=columns, units=UNITS | {"density": "1/um^2"})


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
    units = UNITS | dict.fromkeys(("density", "standard_error"), "um^4/(rad/um)")
    shown = sorted({0, *(round(each) for each in np.geomspace(1, seen.wavenumber.size - 1, BINS_SHOWN))})
    known = list(rows("estimated_spectrum", ("ticks", seen.ticks), ("segments", seen.segments)))
    yield known, Table(name="estimated_spectrum", columns=columns, units=units, shown=shown)


def _from_empty(theory: Exact, distances: Doubles | None, steps: int) -> Iterator[Curve]:
    """Yield the growth of a contact from an empty start, if the scenario has one or --at-distance requests it."""
    if distances is None and theory.model.start != "empty":
        return
    distances = np.linspace(0.0, longest_life(theory.model), steps + 1) if distances is None else distances
    empty = exact(replace(theory.model, start="empty"))
    columns = {
        "distance": distances,
        "area_mean": empty.area_from_empty(distances),
        "count_mean": empty.count_from_empty(distances),
    }
    area = "run_area_mean", empty.expected_mean_area(), "um^2", "over the whole run"
    count = "run_count_mean", empty.expected_mean_count(), "", "over the whole run"
    table = Table(name="from_empty", columns=columns, units=UNITS)
    yield list(rows("from_empty", area, count)), table
