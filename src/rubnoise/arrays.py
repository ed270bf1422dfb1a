"""Arrays of real numbers: their types, and numbers given from Python, in the needed unit or refused."""

from collections.abc import Callable, Iterator
from math import isfinite
from numbers import Real
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.errors import Refused
from rubnoise.units import BESIDE, NONE, Kind, QuantityError, in_unit, is_of_pint, parse_unit, quantity_of

Doubles = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Integers = NDArray[np.int64]
Bytes = NDArray[np.uint8]

CHUNK_ROWS: Final = 65_536
"""Rows that are read or written at once, so that a longer run needs no more memory: half a megabyte of a column."""


def slices(start: int, stop: int, size: int | None = None) -> Iterator[slice]:
    """Yield slices of ``size`` rows (CHUNK_ROWS when None) from ``start`` to ``stop``, the last one shorter."""
    size = size or CHUNK_ROWS
    for first in range(start, stop, size):
        yield slice(first, min(first + size, stop))


# Numbers from Python.
def real_numbers(values: Any, what: str, unit: str | None = None) -> Doubles:
    """Return values of any shape as doubles; quantities of pint are converted to ``unit``.

    Raises Refused for texts, complex and masked values, and anything else that is not a number; for quantities of
    another unit, and for all quantities if no unit is needed.
    """
    if unit is None and any(map(is_of_pint, values if isinstance(values, list | tuple) else [values])):
        raise Refused(f"{what}: has a unit of its own; plain numbers are needed")
    try:
        found = np.asarray(values if unit is None else in_unit(values, unit))
    except QuantityError as problem:
        raise Refused(f"{what}: {problem}") from problem
    except (ValueError, TypeError) as problem:
        raise Refused(f"{what}: rows of numbers are needed, all of one length") from problem
    if found.dtype.kind not in "fiu":
        given = f"holds {found.dtype}; real numbers are needed" if found.ndim else f"{values!r:.40} is no real number"
        raise Refused(f"{what}: {given}")
    if np.ma.is_masked(values):
        raise Refused(f"{what}: holds masked values; every sample needs a number")
    return found.astype(np.float64)


def number_in(value: Any, what: str, kind: Kind, *, positive: bool = False) -> float:
    """Return a finite number, or a text or quantity of pint in the working unit of its kind.

    Raises Refused for anything else, and unless it is above 0 if it has to be ``positive``.
    """
    try:
        is_number = not isinstance(value, bool) and isinstance(value, Real) and isfinite(value)
        number = float(value if is_number else quantity_of(value, kind))
    except QuantityError as problem:
        hint = problem.hint or f'right form: "{kind.example}"'
        raise Refused(f"{what}: {value!s:.40}: {problem}; {hint}") from problem
    if positive and not number > 0.0:
        raise Refused(f"{what}: {value!s:.40}: must be above 0")
    return number


def at_each(
    function: Callable[[Doubles], Doubles], given: Any, what: str, unit: str, limits: tuple[float, float] | None
) -> Doubles:
    """Return the values of a function at places of any shape: nan at nan, and the ``limits`` at -inf and inf.

    Raises Refused as `real_numbers`, and for an infinite place if ``limits`` is None.
    """
    places = real_numbers(given, what, unit)
    finite = np.isfinite(places)
    if places.size and finite.all():
        return function(places)
    if limits is None and np.isinf(places).any():
        raise Refused(f"{what}: inf: there is no limit; finite numbers are needed")
    values = np.where(np.isnan(places), np.nan, np.where(places < 0.0, *(limits or (np.nan, np.nan))))
    if finite.any():
        values[finite] = function(places[finite])
    return values[()]


def check_unit(unit: str, what: str) -> None:
    """Raise Refused, which names the unit, if it is unknown."""
    try:
        if unit not in NONE | BESIDE:
            parse_unit(unit)
    except QuantityError as problem:
        raise Refused(f"{what}: {problem}{f' ({problem.hint})' if problem.hint else ''}") from None
