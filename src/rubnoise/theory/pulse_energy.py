"""What the life of one junction holds at each wavenumber, averaged over the sizes."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.laws import Law
from rubnoise.contact.pulses import Pulse
from rubnoise.theory.quadrature import cut_size_rule, size_range
from rubnoise.theory.transform import STEP_END, life_from_birth, mean_life_from_birth, transform_of

Doubles = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Measure = Callable[[Doubles, Doubles, Doubles], NDArray[Any]]
"""An average over sizes, the last axis, from phases k d, diameters and probabilities."""

_LARGEST_PHASE = 480.0  # k (d_high - d_low) up to which the swing of the transform is followed through the sizes
_PANEL_PHASE = 20.0
_FIRST_PHASES = (5.0, 10.0)
_NODES = 24
_AT_ONCE = 256
_ROUNDING = 1e-12  # by which probabilities may miss 1 without any size being left out


def mean_energy(law: Law, pulse: Pulse, wavenumber: Doubles, *, exact: bool = True) -> Doubles:
    """Return E[|A^(k)|^2] in um^6 for k >= 0 in rad/um of any shape; not ``exact``, without the swing of its tail."""
    transform = transform_of(pulse)
    square = transform.square if exact else transform.mean_square
    followed, damped = (partial(_mean, 6, function) for function in (square, transform.mean_square))
    return _over_sizes(law, wavenumber, followed, damped).real


def mean_transform(law: Law, pulse: Pulse, wavenumber: Doubles) -> Complexes:
    """Return E[A^(k)] in um^3, about the birth, for k >= 0 in rad/um of any shape: the transform of the mean life."""
    transform = transform_of(pulse)
    followed, damped = (partial(_mean, 3, function) for function in (transform.from_birth, transform.mean_from_birth))
    return _over_sizes(law, wavenumber, followed, damped)


def mean_life_transform(law: Law, wavenumber: Doubles) -> Complexes:
    """Return E[(exp(2ikd) - 1)/(ik)] in um for k >= 0 in rad/um of any shape: the count of a life."""
    followed, damped = (partial(_mean, 1, function) for function in (life_from_birth, mean_life_from_birth))
    return _over_sizes(law, wavenumber, followed, damped)


def energy_spread(law: Law, pulse: Pulse, wavenumber: Doubles) -> Doubles:
    """Return E[|A^(k)|^2] - |E[A^(k)]|^2 in um^6, about the birth, for k >= 0 in rad/um; 0 for one size.

    It is added up from deviations, so that a narrow law keeps its digits.
    """
    transform = transform_of(pulse)

    def followed(phases: Doubles, diameters: Doubles, probabilities: Doubles) -> Doubles:
        return _spread(transform.from_birth(phases) * diameters**3, probabilities)

    def damped(phases: Doubles, diameters: Doubles, probabilities: Doubles) -> Doubles:
        level = transform.mean_from_birth(phases)
        within = transform.mean_square(phases) - np.square(np.abs(level))
        return _spread(level * diameters**3, probabilities) + np.sum(within * probabilities * diameters**6, axis=-1)

    return _over_sizes(law, wavenumber, followed, damped).real


def largest_swinging_wavenumber(law: Law) -> float:
    """Return the wavenumber in rad/um beyond which sizes are averaged over the swing; inf for one size.

    At k (d_high - d_low) = 480 a normal law of standard deviation sigma has k sigma > 25, and its spread leaves a
    factor exp(-320) of the swing; a gamma law with sigma = mean/10 has k sigma = 11. A law so wide that it has phases
    below 160 beside larger ones is smooth enough for the step of `PulseTransform.mean_square`.
    """
    low, high = size_range(law)
    return np.inf if low == high else _LARGEST_PHASE / (high - low)


def _over_sizes(law: Law, wavenumber: Doubles, followed: Measure, damped: Measure) -> Complexes:
    """Average where nodes follow the swing through the sizes, and where it averages out.

    Small diameters are followed everywhere: they matter where a wide law has an edge at d = 0.
    """
    k = wavenumber.ravel()
    result = np.empty(k.size, dtype=np.complex128)
    swinging = k <= largest_swinging_wavenumber(law)
    for rows in _chunks(k, np.flatnonzero(swinging)):
        diameters, probabilities = cut_size_rule(law, _followed_cuts(law, float(k[rows].max())), _NODES)
        result[rows] = followed(np.multiply.outer(k[rows], diameters), diameters, probabilities)
    phases = np.append(_FIRST_PHASES, np.arange(_PANEL_PHASE, STEP_END + 1.0, _PANEL_PHASE))
    for rows in _chunks(k, np.flatnonzero(~swinging)):
        diameters, probabilities = cut_size_rule(law, phases / k[rows, None], _NODES)
        result[rows] = damped(k[rows, None] * diameters, diameters, probabilities)
    return result.reshape(wavenumber.shape)


def _chunks(wavenumbers: Doubles, rows: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return few rows at a time, in order of wavenumber, so that memory and nodes stay few."""
    ordered = rows[np.argsort(wavenumbers[rows])]
    return [ordered[first : first + _AT_ONCE] for first in range(0, ordered.size, _AT_ONCE)]


def _followed_cuts(law: Law, fastest: float) -> Doubles:
    low, high = size_range(law)
    phases = np.append(_FIRST_PHASES, np.arange(_PANEL_PHASE, fastest * (high - low), _PANEL_PHASE))
    return low + phases / max(fastest, 1.0 / high)


def _mean(
    power: int, function: Callable[[Doubles], NDArray[Any]], phases: Doubles, diameters: Doubles, probabilities: Doubles
) -> NDArray[Any]:
    """Return E[d^n function(k d)]; one set of diameters serves all wavenumbers, or each has its own."""
    weights = probabilities * diameters**power
    values = function(phases)
    return values @ weights if weights.ndim == 1 else np.sum(values * weights, axis=-1)


def _spread(values: Complexes, probabilities: Doubles) -> Doubles:
    """Return E[|X|^2] - |E[X]|^2; what the probabilities miss belongs to diameters near 0, where X = 0."""
    mean = np.sum(values * probabilities, axis=-1)
    missing = 1.0 - np.sum(probabilities, axis=-1)
    missing = np.where(missing > _ROUNDING, missing, 0.0)
    deviations = np.square(np.abs(values - mean[..., None]))
    return np.sum(deviations * probabilities, axis=-1) + missing * np.square(np.abs(mean))
