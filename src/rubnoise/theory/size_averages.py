"""Averages over sizes of functions of the unit life: of x/d in distance, and of k d in spectra."""

from collections.abc import Callable
from functools import partial
from math import log1p
from typing import Any

import numpy as np

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.laws import Law
from rubnoise.model import Model
from rubnoise.theory.sizes import cut_sizes, is_one_size, longest_life, size_range, sizes_of
from rubnoise.theory.unit_pulse import Function, cubic_spline, energy, from_birth, settled_energy

_FEW = 8
_TABLE = 2400
_TURNS, _NARROW = 400, 2.0
_AT_ONCE = 4096
_TOGETHER = 1 << 17


def is_one_life(model: Model) -> bool:
    """Return whether all lives are equal."""
    return is_one_size(model.sizes) and model.pulse.offset == "none"


def over_sizes(model: Model, unit: Function, power: int, x: Doubles) -> Doubles:
    """Return lam E[d^power unit(x/d)] at x >= 0 in um, sizes cut where x is the end or the middle of a life."""
    found = np.empty(x.size)
    for rows in np.array_split(np.arange(x.size), 1 + x.size // _AT_ONCE):
        some = x.ravel()[rows, None]
        diameter, probability = cut_sizes(model.sizes, some * (0.5, 1.0))
        found[rows] = np.sum(unit(some / diameter) * probability * diameter**power, axis=-1)
    return model.birth_rate * found.reshape(x.shape)


def table_over_sizes(model: Model, unit: Function, power: int) -> Function:
    """Return `over_sizes` as a function of x, for many sizes by a table; beyond the longest life it is constant.

    The table is even in u, x = c (exp(b u^2) - 1): closer at 0, where lives begin like roots, and far apart in the rare
    longest lives.
    """
    if sizes_of(model.sizes).diameter.size < _FEW:
        return lambda x: over_sizes(model, unit, power, x)
    scale = 0.5 * model.sizes.moment(2) / model.sizes.moment(1)
    octaves = log1p(longest_life(model) / scale)
    turns = np.linspace(*size_range(model.sizes), _TURNS)

    def place(x: Doubles) -> Doubles:
        return np.sqrt(np.minimum(np.log1p(x / scale) / octaves, 1.0))

    even = np.linspace(0.0, 1.0, _TABLE + 1)
    # Lives of nearly equal sizes turn within a narrow stretch, and end in another.
    knots = np.unique(np.concatenate([even, place(turns), place(2.0 * turns)])) if _is_narrow(model) else even
    spline = cubic_spline(knots, over_sizes(model, unit, power, scale * np.expm1(octaves * np.square(knots))))
    return lambda x: spline(place(x))


def _is_narrow(model: Model) -> bool:
    low, high = size_range(model.sizes)
    return high < _NARROW * low


def mean_energy(model: Model, wavenumber: Doubles, *, exact: bool = True) -> Doubles:
    """Return E[|A^(k)|^2] in um^6 at k >= 0 in rad/um; not ``exact``, without the swing of its tail."""
    settled = partial(settled_energy, model.pulse)
    return _over_phases(model.sizes, wavenumber, partial(energy, model.pulse) if exact else settled, settled, 6).real


def mean_life_energy(model: Model, wavenumber: Doubles) -> Doubles:
    """Return |E[A^(k)]|^2 in um^6 at k >= 0 in rad/um, A^ about the birth: the energy of the mean life."""
    followed, settled = (partial(from_birth, model.pulse, exact=exact) for exact in (True, False))
    return np.square(np.abs(_over_phases(model.sizes, wavenumber, followed, settled, 3)))


def _over_phases(
    law: Law, wavenumber: Doubles, followed: Callable[..., Any], settled: Callable[..., Any], power: int
) -> Complexes:
    """Return E[d^power g(k d)], g the first function where diameters follow its swing and the second beyond."""
    sizes, k = sizes_of(law), np.asarray(wavenumber, dtype=np.float64).ravel()
    weight, found = sizes.probability * sizes.diameter**power, np.zeros(k.size, dtype=np.complex128)
    for last in np.unique(sizes.followed).tolist():
        part = sizes.followed == last
        for rows in np.array_split(np.arange(k.size), 1 + k.size * int(part.sum()) // _TOGETHER):
            for some, unit in ((rows[k[rows] <= last], followed), (rows[k[rows] > last], settled)):
                found[some] += unit(k[some, None] * sizes.diameter[part]) @ weight[part]
    return found.reshape(np.shape(wavenumber))
