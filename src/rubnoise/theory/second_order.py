"""All of second order: the autocovariance, the spectral density and the lines of area, count or force.

With births at the rate lam whose number has the spectral density S_N(k), and A^ taken about the birth,

    R(tau) = lam E[int A(s) A(s + tau) ds] + (1/2 pi) int (S_N - lam) |E[A^]|^2 exp(i k tau) dk,
    S(k) = lam E[|A^(k)|^2] + (S_N - lam) |E[A^(k)]|^2;

births at random have S_N = lam and the first part alone. Strengths psi multiply the first part by E[psi^2], the second
by E[psi]^2. Regular births, and jittered ones, have lines beside S, at k_n = 2 pi n lam, of power (lam |E[A^(k_n)]|)^2
each, times the share that births keep.
Source: Campbell's theorem (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x); Bartlett's spectrum of a point process
(Daley and Vere-Jones 2003, section 8.2); Cox and Lewis, The Statistical Analysis of Series of Events (1966).
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from math import ceil, inf, isfinite, pi, sqrt
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Law
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.real_numbers import real_number
from rubnoise.theory.sizes import (
    longest_life,
    over_phases,
    over_sizes,
    panels,
    size_range,
    sizes_of,
    table_over_sizes,
)
from rubnoise.theory.unit_pulse import UnitLife, area_life, count_life, energy, from_birth, overlaps

_ROUNDING, _VISIBLE = 1e-12, 1e-26
_MOST_TICKS, _FEW_TICKS, _LAG_PANELS = 512, 64, 32
_AGES, _PHASES, _MOST_LINES = 1 << 19, 1 << 16, 1 << 18
_RARE = 1e-12
AREA_ITSELF: Final = Fixed(value=1.0)
"""The strengths with which force is area."""


def are_at_random(model: Model) -> bool:
    """Return whether births are a Poisson process."""
    return isinstance(model.births, PoissonBirths)


def need_random_births(model: Model, quantity: str) -> None:
    """Raise Refused unless births are a Poisson process."""
    if not are_at_random(model):
        raise Refused(f"{quantity} is known for Poisson births alone (birth.law)")


class BirthPart:
    """What births that are not at random add to a covariance: the lines, and the rest by a transform of the mean life.

    ``wavenumber`` (rad/um) and ``power`` are those of the lines; as much power lies at -k_n.
    """

    def __init__(self, model: Model, life: UnitLife) -> None:
        self._model, self._jumps = model, life.power == 0 and isinstance(model.births, RegularBirths)
        sizes, memory, self._spacing = sizes_of(model.sizes), model.births.memory, model.births.mean
        weight = sizes.probability * sizes.diameter**3
        longest = 2.0 * float(sizes.diameter[weight > _RARE * weight.max()].max())
        self._reach = longest + (memory if isfinite(memory) else 0.0)
        # A whole number of spacings, so that lines lie at wavenumbers of the transform.
        spacings = ceil(2.0 * self._reach / self._spacing)
        self._step = spacings * self._spacing / _AGES
        mean_life, ages = np.zeros(_AGES), np.arange(min(int(longest / self._step) + 2, _AGES), dtype=np.float64)
        mean_life[: ages.size] = table_over_sizes(model, life.mean, life.power)(self._step * ages)
        mean_life[0] *= 0.5  # by the trapezoidal rule, for a count that jumps at birth
        self._wavenumber = np.asarray(2.0 * pi * np.fft.rfftfreq(_AGES, self._step), dtype=np.float64)
        self._squares = np.square(np.abs(np.fft.rfft(mean_life)) * self._step)
        lines = slice(spacings, spacings * _MOST_LINES + 1, spacings)
        self.wavenumber, power = self._wavenumber[lines], self._squares[lines]
        if is_one_life(model):
            d = float(sizes.diameter[0])
            power = np.square(model.birth_rate * d ** (life.power + 1) * life.amplitude(self.wavenumber * d))
            if life.power:
                power[power < _VISIBLE * model.stationary_mean_area**2] = 0.0
        self.power = power * model.births.line_share(self.wavenumber)

    def covariance(self, lag: Doubles) -> Doubles:
        """Return the part of births at lags >= 0 in um, lines apart; 0 beyond its reach."""
        piece = np.minimum((lag / self._step).astype(np.intp), self._values.size - 3)
        past = np.minimum(lag / self._step - piece, 2.0)
        here, there, then = (self._values[piece + n] for n in range(3))
        bend = then - 2.0 * there + here
        return np.asarray(here + past * (there - here + 0.5 * (past - 1.0) * bend), dtype=np.float64)

    @cached_property
    def _values(self) -> Doubles:
        births, rate = self._model.births, self._model.birth_rate
        values = np.fft.irfft(births.excess(self._wavenumber) * self._squares) / (self._step * rate)
        values[0] -= 0.25 * self._step * rate * self._jumps  # of births that jump, whose square has half the weight
        return np.append(values[: int(self._reach / self._step) + 3], 0.0)

    def lines(self, lag: Doubles) -> Doubles:
        """Return 2 sum of power cos(k_n tau) at lags tau >= 0 in um; of births that jump lam^2/k^2 has a known sum."""
        part = (lag / self._spacing) % 1.0
        if self._jumps and is_one_life(self._model):
            # A whole number of equal lives, and one more with probability f.
            lives = longest_life(self._model) / self._spacing
            f = 0.0 if abs(lives - round(lives)) <= 1e-12 * lives else lives % 1.0
            return np.maximum(0.0, f - part) + np.maximum(0.0, f - 1.0 + part) - f * f
        known = 0.5 * self._jumps * (part * part - part + 1.0 / 6.0)
        return np.interp(part, np.linspace(0.0, 1.0, self._swing.size), self._swing) + known

    @cached_property
    def _swing(self) -> Doubles:
        turn = 0.5 * self._step
        births = np.square(self._model.birth_rate * turn / np.tan(turn * self.wavenumber)) if self._jumps else 0.0
        points = 2 * max(self.power.size, _PHASES)
        values = np.fft.irfft(np.append(0.0, self.power - births), points) * points
        return np.append(values, values[0])


_birth_part = lru_cache(maxsize=16)(BirthPart)


@dataclass(frozen=True, kw_only=True, eq=False)
class ShotNoise:
    """The sum over live junctions of psi d^power a(s/d): area in um^2, friction force in uN, or the live count.

    ``square`` is E[psi^2], ``squared_mean`` E[psi]^2. Error some 1e-9 of the variance; of a count whose births are not
    at random 1e-6.
    """

    model: Model
    life: UnitLife
    square: float = 1.0
    squared_mean: float = 1.0

    @property
    def mean(self) -> float:
        """The stationary mean."""
        model = self.model
        return sqrt(self.squared_mean) * (model.stationary_mean_area if self.life.power else model.mean_live_junctions)

    def from_empty(self, distance: ArrayLike) -> Doubles:
        """Return the mean at distances in um of any shape after an empty start, E[psi] lam E[int_0^s A ds']."""
        grown = table_over_sizes(self.model, self.life.so_far, self.life.power + 1)
        slid = np.maximum(np.asarray(distance, dtype=np.float64), 0.0)
        return sqrt(self.squared_mean) * grown(slid) * (slid > 0.0)

    def expected_mean(self, distance: float | None = None) -> float:
        """Return the expected mean over a run, or its first ``distance`` um, from the model's start."""
        slid = self.model.distance if distance is None else real_number(distance, "distance", "um")
        if not 0.0 < slid < inf:
            raise Refused(f"a mean over {slid:g} um of sliding: the distance is a number above 0")
        if self.model.start == "stationary":
            return self.mean
        reach = min(slid, longest_life(self.model))
        place, weight = _graded(reach)
        return float(weight @ self.from_empty(place) + (slid - reach) * self.mean) / slid

    def single(self, lag: Doubles) -> Doubles:
        """Return the covariance of each junction with itself, lam E[int A(s) A(s + tau) ds], at lags >= 0 in um."""
        return table_over_sizes(self.model, self.life.overlap, 2 * self.life.power + 1)(lag)

    @property
    def births(self) -> BirthPart:
        """What births that are not at random add."""
        return _birth_part(self.model, self.life)

    def density(self, wavenumber: ArrayLike, *, exact: ArrayLike = True) -> Doubles:
        """Return the two-sided density between lines, k in rad/um; not ``exact``, without the swing of its tail."""
        k = np.abs(np.asarray(wavenumber, dtype=np.float64))
        return self.square * self.alone(k, exact=exact) + self.squared_mean * self.together(k, exact=exact)

    def alone(self, wavenumber: Doubles, *, exact: ArrayLike = True) -> Doubles:
        """Return the part of single junctions in the density, lam E[|A^(k)|^2]."""
        unit = partial(energy, self.model.pulse)
        return self.model.birth_rate * over_phases(self.model.sizes, wavenumber, unit, 6, exact=exact).real

    def together(self, wavenumber: Doubles, *, exact: ArrayLike = True) -> Doubles:
        """Return the part of births in the density, (S_N - lam) |E[A^(k)]|^2; 0 for births at random."""
        if are_at_random(self.model):
            return np.zeros_like(wavenumber)
        if is_one_life(self.model):
            return self.model.births.excess(wavenumber) * self.alone(wavenumber, exact=exact)
        unit = partial(from_birth, self.model.pulse)
        mean_life = np.square(np.abs(over_phases(self.model.sizes, wavenumber, unit, 3, exact=exact)))
        return self.model.birth_rate * self.model.births.excess(wavenumber) * mean_life

    def covariance(self, lag: ArrayLike) -> Doubles:
        """Return the covariance at lags in um of any shape; at 0 the variance."""
        lags = np.abs(np.asarray(lag, dtype=np.float64))
        return self.unphased(lags) + (self.squared_mean * self.births.lines(lags) if self.lines[1].size else 0.0)

    def unphased(self, lag: Doubles) -> Doubles:
        """Return the covariance without the lines, at lags >= 0 in um: given the phase of regular births."""
        if are_at_random(self.model):
            return self.square * self.single(lag)
        if is_one_life(self.model) and isinstance(self.model.births, RegularBirths):
            return (self.square - self.squared_mean) * self.single(lag)
        return self.square * self.single(lag) + self.squared_mean * self.births.covariance(lag)

    def variance_of_mean(self, distance: float | None = None) -> float:
        """Return the variance of the mean over a stationary record of T um, or the model's ticks; see `lag_rule`.

        A line keeps (sin(k T/2) / (k T/2))^2 of its power, and over n ticks h apart (sin(n k h/2) / (n sin(k h/2)))^2.
        """
        lags, weights = lag_rule(self.model, distance)
        k, power = self.lines
        turns = k / (2.0 * pi)
        if distance is None:
            ticks, missed = self.model.tick_count + 1, turns * self.model.tick - np.rint(turns * self.model.tick)
            kept = np.sinc(ticks * missed) / np.sinc(missed)
        else:
            kept = np.sinc(turns * distance)
        return float(weights @ self.unphased(lags)) + 2.0 * self.squared_mean * float(power @ np.square(kept))

    def error_of_mean(self, distance: float | None = None) -> float:
        """Return the root of `variance_of_mean`, or 0 if it is below 1e-12 of the mean, where it is rounding."""
        error = sqrt(max(self.variance_of_mean(distance), 0.0))
        return error if error > _ROUNDING * self.mean else 0.0

    @property
    def lines(self) -> tuple[Doubles, Doubles]:
        """Wavenumbers k_n = 2 pi n lam in rad/um and powers of the lines; as much power lies at -k_n."""
        if not self.model.births.line_share(np.zeros(1))[0]:
            return np.empty(0), np.empty(0)
        return self.births.wavenumber, self.births.power


def is_one_life(model: Model) -> bool:
    """Return whether all lives are equal."""
    low, high = size_range(model.sizes)
    return low == high and model.pulse.offset == "none"


def area_noise(model: Model, strengths: Law = AREA_ITSELF) -> ShotNoise:
    """Return the second order of real contact area, or with strengths of friction force at constant separation."""
    square, squared_mean = strengths.moment(2), strengths.mean**2
    return ShotNoise(model=model, life=area_life(model.pulse), square=square, squared_mean=squared_mean)


def count_noise(model: Model) -> ShotNoise:
    """Return the second order of the live count."""
    return ShotNoise(model=model, life=count_life(model.pulse))


def autocovariance(model: Model, lag: ArrayLike) -> Doubles:
    """Return R(tau) = Cov[A_r(s), A_r(s + tau)] in um^4 for lags in um of any shape; R(0) is the variance."""
    return area_noise(model).covariance(lag)


def spectral_density(model: Model, wavenumber: ArrayLike, *, exact: bool = True) -> Doubles:
    """Return the two-sided S(k) of real contact area in um^4 per rad/um, for k in rad/um of any shape.

    R(tau) = (1/2 pi) int S(k) exp(i k tau) dk. Errors: 1e-8 of S(0) and 1e-6 of the value up to k d = 16, 1e-5 beyond;
    1e-4 far out where sizes end hard, and off the centre line the tail has no swing from k d = 256 on, as without
    ``exact``.
    """
    return area_noise(model).density(wavenumber, exact=exact)


def visible_lines(model: Model) -> tuple[Doubles, Doubles]:
    """Return wavenumbers in rad/um and powers in um^4 of the lines above 1e-26 of the squared mean area."""
    k, power = area_noise(model).lines
    seen = power > _VISIBLE * model.stationary_mean_area**2
    return k[seen], power[seen]


def tail(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return the level about which S(k) falls off, lam c m_(6-p) / k^p in um^4 per rad/um, k > 0 in rad/um.

    c and p are those of the pulse (Watson's lemma for its kinks). Raises Refused unless births are a Poisson process.
    """
    need_random_births(model, "the tail of the spectrum")
    factor, power = model.pulse.tail
    return model.birth_rate * factor * model.sizes.moment(6 - power) / np.asarray(wavenumber, dtype=np.float64) ** power


def half_power_wavenumber(model: Model) -> float:
    """Return the least k in rad/um with S(k) = S(0)/2: 2.2522/d for lenses of one size; Refused as `tail`."""
    from scipy.optimize import brentq

    need_random_births(model, "the corner of the spectrum")
    half = 0.5 * float(spectral_density(model, 0.0))
    low, high = 0.0, 0.25 / model.sizes.support[1]
    while float(spectral_density(model, high)) > half:
        low, high = high, 1.25 * high
    return float(brentq(lambda k: float(spectral_density(model, k)) - half, low, high, xtol=1e-14 * high, rtol=1e-13))


def joint_cumulant(model: Model, lag: Doubles, i: int, j: int) -> Doubles:
    """Return the joint cumulant of i times A_r(s) and j times A_r(s + tau) in um^(2i + 2j), lags >= 0 in um.

    lam E[d^(2i + 2j + 1) q_ij(tau/d)] for births at random (Campbell); for others the part of single junctions.
    """
    return over_sizes(model, overlaps(model.pulse, min(i, j), max(i, j)), 2 * (i + j) + 1, lag)


def lag_rule(model: Model, distance: float | None = None) -> tuple[Doubles, Doubles]:
    """Return lags in um and weights, so that Var[mean of f(X)] = sum of weight times Cov[f(X(0)), f(X(lag))].

    The mean is over a continuous record of ``distance`` T um, weight (2/T)(1 - tau/T) dtau, or over the model's n ticks
    h apart, weight (2/n)(1 - j/n) at tau = j h and 1/n at 0; many ticks a life count as a continuous record of n h.
    Lines are not in it.
    """
    memory = model.births.memory
    ticks, reach = model.tick_count + 1, longest_life(model) + (memory if isfinite(memory) else 0.0)
    within = min(ticks - 1, int(reach / model.tick))
    typical = 2.0 * model.sizes.moment(2) / model.sizes.moment(1)
    if distance is None and (
        within <= _MOST_TICKS or (typical < _FEW_TICKS * model.tick and within <= 32 * _MOST_TICKS)
    ):
        step = np.arange(within + 1, dtype=np.float64)
        return step * model.tick, np.where(step > 0.0, 2.0 / ticks * (1.0 - step / ticks), 1.0 / ticks)
    length = ticks * model.tick if distance is None else distance
    lag, weight = _graded(min(length, reach))
    return lag, weight * (2.0 / length) * (1.0 - lag / length)


def _graded(reach: float) -> tuple[Doubles, Doubles]:
    """Return lags in um and weights of a rule from 0 on, closer there: of lives unlike in length most are short."""
    place, weight = panels(np.linspace(0.0, 1.0, _LAG_PANELS + 1), 10)
    return reach * place**3, 3.0 * reach * place**2 * weight


@lru_cache(maxsize=16)
def covariance_reach(model: Model, part: float) -> float:
    """Return a lag in um beyond which |R| is below a part of the variance: the longest life, halved while it can be."""
    reach, least = longest_life(model), part * float(autocovariance(model, 0.0))
    while np.all(np.abs(autocovariance(model, np.linspace(0.5 * reach, reach, 17))) < least):
        reach *= 0.5
    return reach
