"""Columns of the index of a sweep: numbers with their units, and texts."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.scenario.keys import SECTIONS
from rubnoise.scenario.scenario import Scenario
from rubnoise.storage.index import Filled
from rubnoise.storage.schema import SLIDER, TRACE, Column
from rubnoise.units import RATIO, Quantity

_UNITS: Final = {column.name: column.units for group in (TRACE, SLIDER) for column in group.columns} | {
    "mean_force": "uN",
    "sticks_per_s": "1/s",
    "reversals_per_s": "1/s",
    "slips_longer_than_d_per_s": "1/s",
}
_PURE: Final = ("skewness", "kurtosis")


def text(name: str, meaning: str, texts: Sequence[str]) -> Filled:
    """Return texts as bytes of one length; at least two, as h5netcdf hands single bytes over undecoded."""
    raw = [each.encode("utf-8", "backslashreplace") for each in texts]
    about = Column(name=name, units="", long_name=meaning, symbol="", dtype=f"|S{max(2, *map(len, [b'', *raw]))}")
    return Filled(about=about, values=np.array(raw, about.dtype))


def whole(name: str, meaning: str, numbers: Sequence[int]) -> Filled:
    """Return whole numbers."""
    about = Column(name=name, units="1", long_name=meaning, symbol="", dtype="<i8")
    return Filled(about=about, values=np.array(numbers, dtype=np.int64))


def figure(name: str, values: NDArray[np.float64]) -> Filled:
    """Return a figure of /summary, in the unit of the quantity with whose name its own begins."""
    return Filled(
        about=Column(name=name, units=_unit(name), long_name=name.replace("_", " "), symbol=""), values=values
    )


@lru_cache(maxsize=1024)
def _unit(name: str) -> str:
    if any(word in name for word in _PURE):
        return "1"
    return next((unit for quantity, unit in _UNITS.items() if name.startswith(quantity)), "1")


def swept(key: str, scenarios: Sequence[Scenario]) -> Filled:
    """Return the values of a key as numbers in its working unit, or as texts where they are no numbers of one kind."""
    section, name = key.split(".")
    values = [getattr(getattr(scenario, section), name) for scenario in scenarios]
    meaning = SECTIONS[section].model_fields[name].description or name
    units = {_unit_of(value) for value in values}
    if len(units) == 1 and all(isinstance(value, int | float) for value in values):
        about = Column(name=key, units=units.pop(), long_name=meaning, symbol="")
        return Filled(about=about, values=np.array(values, dtype=np.float64))
    return text(key, meaning, [value.as_text() if isinstance(value, Quantity) else str(value) for value in values])


def _unit_of(value: object) -> str:
    """Return the unit of a value; a ratio is kept as a part of 1."""
    return value.kind.unit if isinstance(value, Quantity) and value.kind != RATIO else "1"
