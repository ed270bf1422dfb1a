"""What births that are not at random add to second order: their part in covariances, and their lines.

Lines at k_n = 2 pi n lam are those of regular births, (lam |E[A^(k_n)]|)^2 each, times the share that births keep.
Source: the Fourier series of E[A_r | phase]; Cox and Lewis, The Statistical Analysis of Series of Events (1966).
"""

from functools import cached_property
from math import ceil, floor, isfinite, pi

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.contact.births import RegularBirths
from rubnoise.model import Model
from rubnoise.theory.size_averages import is_one_life, mean_life_energy
from rubnoise.theory.sizes import longest_life, sizes_of
from rubnoise.theory.unit_pulse import Function, amplitude, cubic_spline

_AGES = 1 << 19
_PHASES = 4096
_MOST_LINES = 1 << 18
_RARE = 1e-12
_NO_POWER = 1e-32


class BirthPart:
    """The part of births in a covariance: all of it from the mean life lam E[A(s)] on an even grid of ages."""

    def __init__(self, model: Model, mean_life: Function, *, of_count: bool) -> None:
        self._model, self._of_count = model, of_count
        sizes, memory = sizes_of(model.sizes), model.births.memory
        weight = sizes.probability * sizes.diameter**3
        longest = 2.0 * float(sizes.diameter[weight > _RARE * weight.max()].max())
        self._reach = longest + (memory if isfinite(memory) else 0.0)
        # A whole number of spacings, so that lines lie at wavenumbers of the transform.
        self._spacings = ceil(2.0 * self._reach / model.births.mean)
        self._step = self._spacings * model.births.mean / _AGES
        life = np.zeros(_AGES)
        age = self._step * np.arange(min(int(longest / self._step) + 2, _AGES), dtype=np.float64)
        life[: age.size] = mean_life(age)
        life[0] *= 0.5  # by the trapezoidal rule, for a count that jumps at birth
        self._wavenumber = np.asarray(2.0 * pi * np.fft.rfftfreq(_AGES, self._step), dtype=np.float64)
        self._squares = np.square(np.abs(np.fft.rfft(life)) * self._step)

    @cached_property
    def covariance(self) -> Function:
        """The part of births at lags >= 0 in um, lines apart; 0 beyond its reach."""
        births, rate = self._model.births, self._model.birth_rate
        values = np.fft.irfft(births.excess(self._wavenumber) * self._squares) / (self._step * rate)
        if self._is_regular_count:
            values[0] -= 0.25 * self._step * rate  # of the jump at birth, whose square has half the weight
        kept = int(self._reach / self._step) + 3
        spline = cubic_spline(self._step * np.arange(kept), values[:kept])
        return lambda lag: np.where(lag < self._reach, spline(np.minimum(lag, self._reach)), 0.0)

    @property
    def _is_regular_count(self) -> bool:
        return self._of_count and isinstance(self._model.births, RegularBirths)

    @property
    def line_wavenumber(self) -> Doubles:
        """Wavenumbers k_n = 2 pi n lam of the lines in rad/um."""
        return self._wavenumber[self._spacings :: self._spacings][:_MOST_LINES]

    @cached_property
    def line_power(self) -> Doubles:
        """Power of each line, lam^2 |E[A^(k_n)]|^2 times the share that births keep."""
        k, model = self.line_wavenumber, self._model
        d = float(sizes_of(model.sizes).diameter[0])
        if self._of_count and is_one_life(model):
            power = np.square(2.0 * model.birth_rate * np.sin(k * d) / k)
        elif self._of_count:
            power = self._squares[self._spacings :: self._spacings][: k.size]
        elif is_one_life(model):
            power = np.square(model.birth_rate * d**3 * amplitude(model.pulse, k * d))
            power[power < _NO_POWER * model.stationary_mean_area**2] = 0.0
        else:
            power = np.square(model.birth_rate) * mean_life_energy(model, k)
        return power * model.births.line_share(k)

    @cached_property
    def lines(self) -> Function:
        """2 sum of power cos(k_n tau) at lags tau >= 0 in um, of period one spacing."""
        power, spacing = self.line_power, self._model.births.mean
        if self._is_regular_count:
            if is_one_life(self._model):
                return self._whole_lives
            power = power - self._births_alone
        points = 2 * max(power.size, _PHASES)
        values = np.fft.irfft(np.append(0.0, power), points) * points
        place = np.arange(values.size + 1) / values.size
        spline = cubic_spline(place, np.append(values, values[0]))

        def summed(lag: Doubles) -> Doubles:
            part = (lag / spacing) % 1.0
            # The sum of 2 cos(2 pi n t)/(2 pi n)^2, of births that jump.
            births = 0.5 * (part * part - part + 1.0 / 6.0) if self._is_regular_count else 0.0
            return np.asarray(spline(part) + births, dtype=np.float64)

        return summed

    @property
    def _births_alone(self) -> Doubles:
        """The power lam^2/k^2 of births that jump, as the transform on this grid has it."""
        turn = 0.5 * self._step
        return np.square(self._model.birth_rate * turn / np.tan(turn * self.line_wavenumber))

    def _whole_lives(self, lag: Doubles) -> Doubles:
        """Return the covariance of a whole number of equal lives and one more with probability f."""
        lives = longest_life(self._model) / self._model.births.mean
        f = 0.0 if abs(lives - round(lives)) <= 1e-12 * lives else lives - floor(lives)
        part = (lag / self._model.births.mean) % 1.0
        return np.maximum(0.0, f - part) + np.maximum(0.0, f - 1.0 + part) - f * f
