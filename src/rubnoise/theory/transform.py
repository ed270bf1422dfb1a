"""The Fourier transform of one junction's life: itself, its square, its means over a swing and over sizes."""

import operator
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, reduce
from types import ModuleType
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Complexes, Doubles, slices
from rubnoise.contact.laws import Law
from rubnoise.contact.laws.discrete import parts_of
from rubnoise.contact.pulses import Pulse, Shape
from rubnoise.theory import off_centre, transform_lens, transform_parabola, transform_triangle
from rubnoise.theory.quadrature import complementary_error, cut_size_rule, hard_ends, size_range

_STEP_FROM = 32.0
# The step from the transform itself to its mean over a swing: an error function of width 8.5 about phase 90. It holds
# no component of phase frequency 1 above exp(-8.5^2 / 2) = 2e-16, so cutting the swing off along it loses nothing.
_STEP_CENTRE = 90.0
_STEP_WIDTH = 8.5
STEP_END = 160.0

Value = TypeVar("Value", np.float64, np.complex128)


@dataclass(frozen=True, slots=True, kw_only=True)
class PulseTransform:
    """The transform a^(z) of a pulse of unit diameter about its middle, z = k d >= 0; A^(k) = d^3 a^(k d) in um^3.

    Far out a^(z) is a level, which falls as 1/z^2, and a swing about it; about the birth, exp(i z) a^(z), only what
    begins at birth does not swing. ``level``, ``swing`` (its mean square) and ``birth_level`` are used only for z >=
    32. All functions take z of any shape.
    """

    amplitude: Callable[[ArrayLike], Doubles]
    level: Callable[[Doubles], Doubles]
    swing: Callable[[Doubles], Doubles]
    birth_level: Callable[[Doubles], Complexes]

    def square(self, phase: ArrayLike) -> Doubles:
        """Return a^(z)^2, the energy spectrum of the pulse of unit diameter."""
        return np.square(self.amplitude(phase))

    def from_birth(self, phase: ArrayLike) -> Complexes:
        """Return exp(i z) a^(z), the transform about the birth, where junctions of all sizes begin."""
        z = np.asarray(phase, dtype=np.float64)
        return np.asarray(np.exp(1j * z) * self.amplitude(z), dtype=np.complex128)

    def mean_from_birth(self, phase: ArrayLike) -> Complexes:
        """Return exp(i z) a^(z) with its swing averaged out for large z, as averages over sizes need it.

        It is the transform below z = 32, what begins at birth above 160, and a smooth blend between. Its integral
        against anything smooth on the scale z = 10 is that of exp(i z) a^(z) to 1e-15.
        """
        return _settled(phase, self.from_birth, self.birth_level)

    def mean_square(self, phase: ArrayLike) -> Doubles:
        """Return a^(z)^2 with its swing averaged out for large z, as integrals over z need it; as `mean_from_birth`."""
        return _settled(phase, self.square, lambda z: np.square(self.level(z)) + self.swing(z))


@dataclass(frozen=True, slots=True, kw_only=True)
class OffCentreEnergy:
    """The energy spectrum of passes off the centre line, averaged over offsets, and what it is without its swing."""

    square: Callable[[ArrayLike], Doubles]
    level: Callable[[Doubles], Doubles]

    def mean_square(self, phase: ArrayLike) -> Doubles:
        """Return it with its swing averaged out for large z, as `PulseTransform.mean_square`."""
        return _settled(phase, self.square, self.level)


def _settled(
    phase: ArrayLike, followed: Callable[[Doubles], NDArray[Value]], level: Callable[[Doubles], NDArray[Value]]
) -> NDArray[Value]:
    """Return what is followed below z = 32, its level above 160, and a smooth blend of both between."""
    z = np.asarray(phase, dtype=np.float64)
    result = followed(np.minimum(z, STEP_END))
    upper = z > _STEP_FROM
    kept = swing_left(z[upper])
    result[upper] = kept * result[upper] + (1.0 - kept) * level(z[upper])
    return result


def energy_of(pulse: Pulse) -> PulseTransform | OffCentreEnergy:
    """Return the energy spectrum of a pulse."""
    return transform_of(pulse) if pulse.offset == "none" else _OFF_CENTRE[pulse.shape]


_SHAPES: dict[Shape, ModuleType] = {
    "lens": transform_lens,
    "triangle": transform_triangle,
    "parabola": transform_parabola,
}
_TRANSFORMS: dict[Shape, PulseTransform] = {
    shape: PulseTransform(amplitude=of.amplitude, level=of.level, swing=of.swing, birth_level=of.birth_level)
    for shape, of in _SHAPES.items()
}

_OFF_CENTRE: dict[Shape, OffCentreEnergy] = {
    "lens": OffCentreEnergy(square=off_centre.mean_square, level=off_centre.level),
    "parabola": OffCentreEnergy(
        square=transform_parabola.off_centre_mean_square, level=transform_parabola.off_centre_level
    ),
}


def transform_of(pulse: Pulse) -> PulseTransform:
    """Return the transform of a pulse shape."""
    return _TRANSFORMS[pulse.shape]


def life_from_birth(phase: ArrayLike) -> Complexes:
    """Return (exp(2iz) - 1)/(iz), the transform about the birth of a count of 1 over the life of unit diameter."""
    z = np.asarray(phase, dtype=np.float64)
    return np.exp(1j * z) * 2.0 * np.sinc(z / np.pi)


def mean_life_from_birth(phase: ArrayLike) -> Complexes:
    """Return `life_from_birth` with the swing of the end of the life averaged out for large z, leaving i/z."""
    z = np.asarray(phase, dtype=np.float64)
    result = life_from_birth(np.minimum(z, STEP_END))
    upper = z > _STEP_FROM
    beyond = z[upper]
    result[upper] = (swing_left(beyond) * np.exp(2j * beyond) - 1.0) / (1j * beyond)
    return result


def swing_left(phase: Doubles) -> Doubles:
    """Return the factor that the step leaves of the swing at phases: 1 below 20, 0 above 160, and smooth between."""
    left = (phase < STEP_END).astype(np.float64)
    blended = (phase > 2.0 * _STEP_CENTRE - STEP_END) & (phase < STEP_END)
    left[blended] = 0.5 * complementary_error((phase[blended] - _STEP_CENTRE) / (np.sqrt(2.0) * _STEP_WIDTH))
    return left


_LARGEST_PHASE = 480.0  # k (d_high - d_low) up to which the swing of the transform is followed through the sizes
_PANEL_PHASE = 20.0
_FIRST_PHASES = (5.0, 10.0)
_NODES = 24
_AT_ONCE = 256
_MOST_KEPT = 1 << 14  # wavenumbers whose energies are kept for later calls
_ROUNDING = 1e-12  # by which probabilities may miss 1 without any size being left out


@dataclass(frozen=True, slots=True, kw_only=True)
class _Life:
    """A function of a life of unit diameter at phases k d, to be multiplied by d^power.

    ``followed`` is the function itself; ``damped`` has its swing averaged out for large phases, and ``scatter`` is the
    mean square of the swing that is then missing, for averages of squares.
    """

    power: int
    followed: Callable[[Doubles], NDArray[Any]]
    damped: Callable[[Doubles], NDArray[Any]]
    scatter: Callable[[Doubles], Doubles] = np.zeros_like


Average = Callable[[NDArray[Any], Doubles, Doubles], NDArray[Any]]
"""An average over sizes, the last axis, from values, scatter about them, and probabilities."""


def mean_energy(law: Law, pulse: Pulse, wavenumber: Doubles, *, exact: bool = True) -> Doubles:
    """Return E[|A^(k)|^2] in um^6 for k >= 0 in rad/um of any shape; not ``exact``, without the swing of its tail."""
    if parts := parts_of(law):
        return _over_parts(parts, lambda part: mean_energy(part, pulse, wavenumber, exact=exact))
    k = np.asarray(wavenumber, dtype=np.float64)
    if k.size > _MOST_KEPT:
        return _mean_energy(law, pulse, k, exact=exact)
    # Spreads, errors and cumulants of one motion ask at the nodes of one rule.
    kept = _kept_energy(law, pulse, k.tobytes(), exact=exact)
    return kept.reshape(k.shape).copy()


@lru_cache(maxsize=8)
def _kept_energy(law: Law, pulse: Pulse, wavenumbers: bytes, *, exact: bool) -> Doubles:
    return _mean_energy(law, pulse, np.frombuffer(wavenumbers), exact=exact)


def _mean_energy(law: Law, pulse: Pulse, wavenumber: Doubles, *, exact: bool) -> Doubles:
    transform = energy_of(pulse)
    square = transform.square if exact else transform.mean_square
    return _over_sizes(law, wavenumber, _Life(power=6, followed=square, damped=transform.mean_square), _mean).real


def mean_transform(law: Law, pulse: Pulse, wavenumber: Doubles) -> Complexes:
    """Return E[A^(k)] in um^3, about the birth, for k >= 0 in rad/um of any shape: the transform of the mean life."""
    if parts := parts_of(law):
        return _over_parts(parts, lambda part: mean_transform(part, pulse, wavenumber))
    transform = transform_of(pulse)
    life = _Life(power=3, followed=transform.from_birth, damped=transform.mean_from_birth)
    return _over_sizes(law, wavenumber, life, _mean)


def mean_life_transform(law: Law, wavenumber: Doubles) -> Complexes:
    """Return E[(exp(2ikd) - 1)/(ik)] in um for k >= 0 in rad/um of any shape: the count of a life."""
    if parts := parts_of(law):
        return _over_parts(parts, lambda part: mean_life_transform(part, wavenumber))
    life = _Life(power=1, followed=life_from_birth, damped=mean_life_from_birth)
    return _over_sizes(law, wavenumber, life, _mean)


def energy_spread(law: Law, pulse: Pulse, wavenumber: Doubles) -> Doubles:
    """Return E[|A^(k)|^2] - |E[A^(k)]|^2 in um^6, about the birth, for k >= 0 in rad/um; 0 for one size.

    It is added up from deviations, so that a narrow law keeps its digits.
    """
    if parts := parts_of(law):
        mean = mean_transform(law, pulse, wavenumber)

        def about_mean(part: Law) -> Doubles:
            apart = np.square(np.abs(mean_transform(part, pulse, wavenumber) - mean))
            return energy_spread(part, pulse, wavenumber) + apart

        return _over_parts(parts, about_mean)
    transform = transform_of(pulse)

    def scatter(phases: Doubles) -> Doubles:
        return transform.mean_square(phases) - np.square(np.abs(transform.mean_from_birth(phases)))

    life = _Life(power=3, followed=transform.from_birth, damped=transform.mean_from_birth, scatter=scatter)
    return _over_sizes(law, wavenumber, life, _spread).real


def _over_parts(parts: tuple[tuple[float, Law], ...], average: Callable[[Law], NDArray[Any]]) -> NDArray[Any]:
    """Return a function of a law made of parts: the weighted sum of the parts' values, in their shape."""
    return reduce(operator.add, (weight * average(part) for weight, part in parts))


def largest_swinging_wavenumber(law: Law) -> float:
    """Return the wavenumber in rad/um beyond which no swing is left; inf for one size and for a law with a hard end."""
    if parts := parts_of(law):
        return max(largest_swinging_wavenumber(part) for _, part in parts)
    return np.inf if hard_ends(law) != (None, None) else _largest_followed(law)


def _largest_followed(law: Law) -> float:
    """Return the wavenumber in rad/um up to which nodes follow the swing through all sizes; inf for one size.

    At k (d_high - d_low) = 480 a normal law of standard deviation sigma has k sigma > 25, and its spread leaves a
    factor exp(-320) of the swing; a gamma law with sigma = mean/10 has k sigma = 11. A law so wide that it has phases
    below 160 beside larger ones is smooth enough for the step of `PulseTransform.mean_square`.
    """
    low, high = size_range(law)
    return np.inf if low == high else _LARGEST_PHASE / (high - low)


def _over_sizes(law: Law, wavenumber: Doubles, life: _Life, average: Average) -> Complexes:
    """Average where nodes follow the swing through the sizes, and where it averages out.

    Small diameters are followed everywhere: they matter where a wide law has an edge at d = 0. So are those near an
    end at which the density jumps, with a weight that fades away from it as smoothly as `swing_left` does.
    """
    k = wavenumber.ravel()
    result = np.empty(k.size, dtype=np.complex128)
    followed = k <= _largest_followed(law)
    for rows in _chunks(k, np.flatnonzero(followed)):
        diameters, probabilities = cut_size_rule(law, _followed_cuts(law, float(k[rows].max())), _NODES)
        phases = np.multiply.outer(k[rows], diameters)
        result[rows] = average(life.followed(phases) * diameters**life.power, np.zeros(1), probabilities)
    steps = np.append(_FIRST_PHASES, np.arange(_PANEL_PHASE, STEP_END + 1.0, _PANEL_PHASE))
    ends = [(end, sign) for end, sign in zip(hard_ends(law), (1.0, -1.0), strict=True) if end is not None]
    for rows in _chunks(k, np.flatnonzero(~followed)):
        near = k[rows, None]
        cuts = np.concatenate([steps / near, *(end + sign * steps / near for end, sign in ends)], axis=-1)
        diameters, probabilities = cut_size_rule(law, cuts, _NODES)
        phases, powers = near * diameters, diameters**life.power
        values, scatter, shares = life.damped(phases) * powers, life.scatter(phases) * powers**2, probabilities
        for end, sign in ends:
            swinging = probabilities * swing_left(sign * (phases - near * end))
            kept = swinging > 0.0
            each = np.zeros_like(values[:, : diameters.shape[-1]])
            each[kept] = life.followed(phases[kept]) * powers[kept]
            values = np.concatenate([values, each], axis=-1)
            scatter = np.concatenate([scatter, np.zeros_like(swinging)], axis=-1)
            shares = np.concatenate([shares, swinging], axis=-1)
            shares[:, : diameters.shape[-1]] -= swinging
        result[rows] = average(values, scatter, shares)
    return result.reshape(wavenumber.shape)


def _chunks(wavenumbers: Doubles, rows: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Yield some rows at a time, in order of wavenumber, to limit memory and nodes."""
    ordered = rows[np.argsort(wavenumbers[rows])]
    return [ordered[part] for part in slices(0, ordered.size, _AT_ONCE)]


def _followed_cuts(law: Law, fastest: float) -> Doubles:
    low, high = size_range(law)
    phases = np.append(_FIRST_PHASES, np.arange(_PANEL_PHASE, fastest * (high - low), _PANEL_PHASE))
    return low + phases / max(fastest, 1.0 / high)


def _mean(values: NDArray[Any], _scatter: Doubles, probabilities: Doubles) -> NDArray[Any]:
    """Return E[X]; one set of probabilities serves all wavenumbers, or each has its own."""
    return values @ probabilities if probabilities.ndim == 1 else np.sum(values * probabilities, axis=-1)


def _spread(values: Complexes, scatter: Doubles, probabilities: Doubles) -> Doubles:
    """Return E[|X|^2] - |E[X]|^2; missing probability belongs to diameters near 0, where X = 0."""
    mean = np.sum(values * probabilities, axis=-1)
    missing = 1.0 - np.sum(probabilities, axis=-1)
    missing = np.where(missing > _ROUNDING, missing, 0.0)
    deviations = np.square(np.abs(values - mean[..., None])) + scatter
    return np.sum(deviations * probabilities, axis=-1) + missing * np.square(np.abs(mean))
