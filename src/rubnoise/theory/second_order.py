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
from functools import lru_cache, partial
from math import ceil, isfinite, log2, pi, sqrt
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles, number_in
from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Law
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory.sizes import longest_life, over_phases, over_sizes, panels, size_range, sizes_of
from rubnoise.theory.unit_pulse import UnitLife, area_life, count_life, energy, from_birth, overlaps
from rubnoise.units import LENGTH

_ROUNDING, _VISIBLE = 1e-12, 1e-26
_MOST_TICKS, _FEW_TICKS, _LAG_PANELS = 512, 64, 32
_AGES, _RARE = 1 << 19, 1e-12
AREA_ITSELF: Final = Fixed(value=1.0)  # the strengths with which force is area


def are_at_random(model: Model) -> bool:
    """Return whether births are a Poisson process."""
    return isinstance(model.births, PoissonBirths)


def need_random_births(model: Model, quantity: str) -> None:
    """Raise Refused unless births are a Poisson process."""
    if not are_at_random(model):
        raise Refused(f"{quantity} is known for Poisson births alone (birth.law)")


@lru_cache(maxsize=16)
class BirthPart:
    """What births that are not at random add to a covariance: lines (rad/um), and the rest from the mean life."""

    def __init__(self, model: Model, life: UnitLife) -> None:
        births, rate, sizes = model.births, model.birth_rate, sizes_of(model.sizes)
        weight = sizes.probability * sizes.diameter**3
        longest = 2.0 * float(sizes.diameter[weight > _RARE * weight.max()].max())
        reach = longest + (births.memory if isfinite(births.memory) else 0.0)
        # A whole number of spacings of a whole number of points, so that lines lie at wavenumbers of the transform.
        spacings = ceil(2.0 * reach * rate)
        self._points = 2 ** ceil(log2(_AGES / spacings)) if 4 * spacings <= _AGES else 1
        equal, regular = is_one_life(model), isinstance(births, RegularBirths)
        spacings = 1 if equal and regular else spacings  # nothing is asked of these between lines
        self._rate, self._step, count = rate, 1.0 / (rate * self._points), spacings * self._points
        mean_life, ages = np.zeros(count), np.arange(min(int(longest / self._step) + 2, count), dtype=np.float64)
        if life.power:
            mean_life[: ages.size] = over_sizes(model, life.mean, life.power, self._step * ages)
        else:  # a count jumps: means over steps hold half of a birth and the right part of a death
            grown = over_sizes(model, life.so_far, 1, self._step * (ages + 0.5))
            mean_life[: ages.size] = np.diff(grown, prepend=0.0) / self._step
        k = np.asarray(2.0 * pi * np.fft.rfftfreq(count, self._step), dtype=np.float64)
        squares = np.square(np.abs(np.fft.rfft(mean_life)) * self._step)
        power, jumps = squares[spacings::spacings], regular and life.power == 0
        if equal:
            d = float(sizes.diameter[0])
            power = np.square(rate * d ** (life.power + 1)) * life.energy(k[spacings::spacings] * d)
        power = power * births.line_share(k[spacings::spacings])
        mean = model.stationary_mean_area if life.power else model.mean_live_junctions
        seen = power > _VISIBLE * mean**2
        self.wavenumber, self.power = k[spacings::spacings][seen], power[seen]
        between = np.fft.irfft(births.excess(k) * squares, count)[: int(reach / self._step) + 3] / (self._step * rate)
        self._between = np.append(between, 0.0)
        self._swing = np.fft.irfft(np.append(0.0, power * seen), self._points) * self._points
        # The square of half a jump is a quarter.
        self._between[0] -= 0.25 * jumps / self._points
        self._swing[0] += 0.25 * jumps / self._points
        # Regular births have a whole number of equal lives, and one more with some probability.
        lives = longest * rate
        one_more = 0.0 if abs(lives - round(lives)) <= 1e-12 * lives else lives % 1.0
        self._one_more = one_more if equal and jumps else None

    def covariance(self, lag: Doubles) -> Doubles:
        """Return the part of births at lags >= 0 in um, lines apart; 0 beyond its reach."""
        return _on_parabolas(self._between, lag / self._step)

    def lines(self, lag: Doubles) -> Doubles:
        """Return 2 sum of power cos(k_n tau) at lags tau >= 0 in um, even and periodic in the spacing."""
        part = np.abs((lag * self._rate + 0.5) % 1.0 - 0.5)
        if self._one_more is None:
            return _on_parabolas(self._swing, part * self._points)
        f = self._one_more
        return np.maximum(0.0, f - part) + np.maximum(0.0, f - 1.0 + part) - f * f


def _on_parabolas(values: Doubles, place: Doubles) -> Doubles:
    """Return values given at 0, 1, 2 ... at places between, each on a parabola through the next three."""
    piece = np.minimum(place.astype(np.intp), values.size - 3)
    past = np.minimum(place - piece, 2.0)
    here, there, then = (values[piece + n] for n in range(3))
    return np.asarray(here + past * (there - here + 0.5 * (past - 1.0) * (then - 2.0 * there + here)), dtype=np.float64)


@dataclass(frozen=True, kw_only=True, eq=False)
class ShotNoise:
    """The sum over live junctions of psi d^power a(s/d): area in um^2, friction force in uN, or the live count.

    ``square`` is E[psi^2], ``squared_mean`` E[psi]^2. Error some 1e-9 of the variance; of the count of others 1e-6.
    """

    model: Model
    life: UnitLife
    square: float = 1.0
    squared_mean: float = 1.0

    @property
    def mean(self) -> float:
        """The stationary mean."""
        known = self.model.stationary_mean_area if self.life.power else self.model.mean_live_junctions
        return sqrt(self.squared_mean) * known

    def from_empty(self, distance: ArrayLike) -> Doubles:
        """Return the mean at distances in um of any shape after an empty start, E[psi] lam E[int_0^s A ds']."""
        slid = np.maximum(np.asarray(distance, dtype=np.float64), 0.0)
        grown = over_sizes(self.model, self.life.so_far, self.life.power + 1, slid)
        return sqrt(self.squared_mean) * grown * (slid > 0.0)

    def expected_mean(self, distance: float | None = None) -> float:
        """Return the expected mean over a run, or its first ``distance`` um, from the model's start."""
        slid = self.model.distance if distance is None else number_in(distance, "distance", LENGTH, positive=True)
        if self.model.start == "stationary":
            return self.mean
        reach = min(slid, longest_life(self.model))
        place, weight = _graded(reach)
        return float(weight @ self.from_empty(place) + (slid - reach) * self.mean) / slid

    def single(self, lag: Doubles) -> Doubles:
        """Return the covariance of each junction with itself, lam E[int A(s) A(s + tau) ds], at lags >= 0 in um."""
        return over_sizes(self.model, self.life.overlap, 2 * self.life.power + 1, lag)

    def density(self, wavenumber: ArrayLike, *, exact: ArrayLike = True) -> Doubles:
        """Return the two-sided density between lines, k in rad/um; not ``exact``, without the swing of its tail."""
        alone, together = self.parts(np.abs(np.asarray(wavenumber, dtype=np.float64)), exact=exact)
        return self.square * alone + self.squared_mean * together

    def parts(self, wavenumber: Doubles, *, exact: ArrayLike = True) -> tuple[Doubles, Doubles]:
        """Return the parts of single junctions and of births in the density, lam E[|A^|^2], (S_N - lam) |E[A^]|^2."""
        model, pulse = self.model, self.model.pulse
        alone = model.birth_rate * over_phases(model.sizes, wavenumber, partial(energy, pulse), 6, exact).real
        excess = model.births.excess(wavenumber)
        if is_one_life(model) or are_at_random(model):
            return alone, excess * alone
        mean_life = over_phases(model.sizes, wavenumber, partial(from_birth, pulse), 3, exact)
        return alone, model.birth_rate * excess * np.square(np.abs(mean_life))

    def covariance(self, lag: ArrayLike) -> Doubles:
        """Return the covariance at lags in um of any shape; at 0 the variance."""
        lags = np.abs(np.asarray(lag, dtype=np.float64))
        lines = BirthPart(self.model, self.life).lines(lags) if self.lines[1].size else 0.0
        return self.unphased(lags) + self.squared_mean * lines

    def unphased(self, lag: Doubles) -> Doubles:
        """Return the covariance without the lines, at lags >= 0 in um: given the phase of regular births."""
        if are_at_random(self.model):
            return self.square * self.single(lag)
        if is_one_life(self.model) and isinstance(self.model.births, RegularBirths):
            return (self.square - self.squared_mean) * self.single(lag)
        return self.square * self.single(lag) + self.squared_mean * BirthPart(self.model, self.life).covariance(lag)

    def variance_of_mean(self, distance: float | None = None) -> float:
        """Return the variance of the mean over a stationary record of T um, or the model's ticks; see `lag_rule`."""
        # A line keeps (sin(k T/2) / (k T/2))^2 of its power, and over n ticks (sin(n k h/2) / (n sin(k h/2)))^2.
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
        """Wavenumbers k_n = 2 pi n lam (rad/um) and powers, over 1e-26 of the squared mean; as much lies at -k_n."""
        if not self.model.births.line_share(np.zeros(1))[0]:
            return np.empty(0), np.empty(0)
        found = BirthPart(self.model, self.life)
        return found.wavenumber, found.power


def is_one_life(model: Model) -> bool:
    """Return whether all lives are equal."""
    return len(set(size_range(model.sizes))) == 1 and model.pulse.offset == "none"


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
    1e-4 far out where sizes end hard. Not ``exact``, and off the centre line from k d = 256 on, the tail has no swing.
    """
    return area_noise(model).density(wavenumber, exact=exact)


def tail(model: Model, wavenumber: ArrayLike) -> Doubles:
    """Return the level about which S(k) falls off, lam c m_(6-p) / k^p, by the kinks of pulses; Refused as above."""
    need_random_births(model, "the tail of the spectrum")
    factor, power = model.pulse.tail
    return model.birth_rate * factor * model.sizes.moment(6 - power) / np.asarray(wavenumber, dtype=np.float64) ** power


def half_power_wavenumber(model: Model) -> float:
    """Return the least k in rad/um with S(k) = S(0)/2: 2.2522/d for lenses of one size; Refused as `tail`."""
    need_random_births(model, "the corner of the spectrum")
    half, low, high = 0.5 * float(spectral_density(model, 0.0)), 0.0, 0.25 / model.sizes.support[1]
    while float(spectral_density(model, high)) > half:
        low, high = high, 1.25 * high
    near = np.polynomial.Chebyshev.interpolate(lambda k: spectral_density(model, k) - half, 15, [low, high])
    roots = (root for root in near.roots().tolist() if not root.imag)
    return float(min((root.real for root in roots), key=lambda k: abs(k - 0.5 * (low + high))))


def joint_cumulant(model: Model, lag: Doubles, i: int, j: int) -> Doubles:
    """Return the joint cumulant of i times A_r(s), j times A_r(s + tau) in um^(2i + 2j), births taken for random."""
    return over_sizes(model, overlaps(model.pulse, min(i, j), max(i, j)), 2 * (i + j) + 1, lag)


def lag_rule(model: Model, distance: float | None = None) -> tuple[Doubles, Doubles]:
    """Return lags in um and weights, so that Var[mean of f(X)] = sum of weight times Cov[f(X(0)), f(X(lag))].

    The mean is over a continuous record of ``distance`` T um, weight (2/T)(1 - tau/T) dtau, or over the model's n ticks
    h apart, weight (2/n)(1 - j/n) at tau = j h and 1/n at 0; many ticks a life count as continuous. Without lines.
    """
    memory = model.births.memory
    ticks, reach = model.tick_count + 1, longest_life(model) + (memory if isfinite(memory) else 0.0)
    within = min(ticks - 1, int(reach / model.tick))
    typical = 2.0 * model.sizes.moment(2) / model.sizes.moment(1)
    few = within <= _MOST_TICKS or (typical < _FEW_TICKS * model.tick and within <= 32 * _MOST_TICKS)
    if distance is None and few:
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
