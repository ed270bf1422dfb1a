"""Tests that a trace follows the model, whose rates of false alarms add up to less than 5 %.

Spectrum, time reversal, largest line, third cumulant, steadiness of the mean and drift: if one fails, the
estimates are those of a model that the trace does not follow.
"""

from dataclasses import dataclass
from math import erfc, sqrt
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.inference.fitting import RAMP_VARIANCE, Fit
from rubnoise.inference.passes import first_integrals, life_integrals, offsets, passed
from rubnoise.inference.periodogram import Bands, masked_bins
from rubnoise.inference.populations import shot_sizes
from rubnoise.inference.signal import ramp_of

_GROUPS = 14
_LIGHTEST_GROUP = 16.0  # bands' worth: a group of fewer is too skew even for its cube root
_RANK = 1e-6
_BLOCKS = 40
_LAGS = (0.25, 0.5, 1.0)  # of the mean diameter
_NEIGHBOURS = 24
_PARTS = 4
_RUN_IN = (0.125, 0.25, 0.375, 0.5)
_STEADY_AGAIN = 0.05

SPECTRUM: Final = 0.005
REVERSAL: Final = 0.006
LINE: Final = 0.005
THIRD: Final = 0.004
STEADY: Final = 0.004
DRIFT: Final = 0.01
"""Probabilities below which a test speaks; of a right trace one of them does in less than 5 %."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HonestyTest:
    """One test: its name, statistic, probability ``p`` under the model, the ``level`` below which it fails, and words.

    ``flagged`` is whether it fails; ``words`` is the finding, as a sentence.
    """

    name: str
    statistic: float
    p: float
    level: float
    words: str

    @property
    def flagged(self) -> bool:
        """Whether the trace fails the test."""
        return self.p < self.level


def honesty_tests(values: Doubles, level: Doubles, fit: Fit, *, zero_known: bool) -> tuple[HonestyTest, ...]:
    """Return the tests of a trace against a fit; ``level`` is its mean at each sample, or its course if it drifts."""
    return (
        spectrum_test(fit),
        _reversal_test(fit.problem.sensor.mirrored(values), level, fit.contact.diameter),
        _line_test(fit),
        _third_test(values, level, fit, zero_known=zero_known),
        _steadiness_test(values, fit),
        drift_test(values, fit),
    )


def third_cumulant(values: Doubles, level: Doubles) -> float:
    """Return the mean cube of a trace about its mean or its course."""
    return float(np.mean((values - level) ** 3))


def spectrum_test(fit: Fit) -> HonestyTest:
    """Return the chi-square test of relative residuals in log bands, with their covariance after fitting.

    The covariance is Sigma - D (D' Sigma^-1 D)^-1 D', averaged over the bands of a group by their weights.
    """
    from scipy.special import gammaincc

    averaging = _groups(fit.problem.bands) / fit.expected.mean
    left = fit.scatter - fit.expected.by @ fit.covariance @ fit.expected.by.T
    spread, variance = averaging @ left @ averaging.T, (averaging @ fit.scatter @ averaging.T).diagonal()
    # Wilson and Hilferty (1931): the cube root of a mean of energies is normal where the mean itself is still skew.
    value = 3.0 * (np.cbrt(np.maximum(1.0 + averaging @ fit.residual, 0.0)) - 1.0 + variance / 9.0)
    scale = np.sqrt(variance)
    sizes, axes = np.linalg.eigh(spread / np.outer(scale, scale))
    held = sizes > max(_RANK * float(sizes.max()), 1e-4)
    along = axes.T @ (value / scale)
    statistic = float(np.sum(np.square(along[held]) / sizes[held]))
    freedom = int(held.sum())
    p = float(gammaincc(0.5 * freedom, 0.5 * statistic)) if freedom else 1.0
    worst = int(np.argmax(np.abs(value / scale)))
    words = f"the spectrum in {value.size} log bands: chi-square {statistic:.1f} on {freedom}"
    words += f", furthest off by {100.0 * value[worst]:+.0f} % in band {worst + 1}"
    if p < SPECTRUM:
        words += "; the trace may hold no junctions, or others than assumed"
    return HonestyTest(name="spectrum", statistic=statistic, p=p, level=SPECTRUM, words=words)


def _groups(bands: Bands) -> Doubles:
    """Return a matrix that averages bands into groups of equal width in ln k, each worth at least 16 values."""
    place = np.log(bands.wavenumber)
    number = np.searchsorted(np.linspace(place[0], place[-1], _GROUPS + 1)[1:-1], place, side="right")
    owner, worth, last = np.zeros_like(number), np.inf, -1
    for group in np.unique(number):
        if worth >= _LIGHTEST_GROUP:
            last, worth = last + 1, 0.0
        owner[number == group] = last
        worth += float(bands.weight[number == group].sum())
    if last > 0 and worth < _LIGHTEST_GROUP:
        owner[owner == last] = last - 1
    weights = np.where(owner == np.unique(owner)[:, None], bands.weight, 0.0)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True), dtype=np.float64)


def _reversal_test(values: Doubles, level: Doubles, diameter: float) -> HonestyTest:
    """Return Student's test that E[y(s)^2 y(s + tau) - y(s) y(s + tau)^2] is zero, over blocks, at three lags.

    y is the trace about its mean or its course. A life is its own mirror image, so a trace of the model has no
    direction. The largest of the three counts, with three times its probability.
    Source: Ramsey and Rothman (1996), doi:10.2307/2077961.
    """
    from scipy.special import stdtr

    found = dict[float, float]()
    for part in _LAGS:
        lag = max(1, round(part * diameter))
        length = (values.size - lag) // _BLOCKS
        blocks = np.empty(_BLOCKS)
        for number in range(_BLOCKS):  # one after another, to limit memory
            piece = slice(number * length, (number + 1) * length + lag)
            centred = values[piece] - level[piece]
            earlier, later = centred[:-lag], centred[lag:]
            blocks[number] = np.mean(earlier * later * (earlier - later))
        found[part] = float(blocks.mean() / max(blocks.std(ddof=1) / sqrt(_BLOCKS), 1e-300))
    most = max(found, key=lambda part: abs(found[part]))
    largest = found[most]
    p = min(1.0, len(_LAGS) * 2.0 * float(stdtr(_BLOCKS - 1, -abs(largest))))
    words = f"time reversal: {largest:+.1f} standard errors at a lag of {most:g} diameters"
    return HonestyTest(name="time reversal", statistic=largest, p=p, level=REVERSAL, words=words)


def _line_test(fit: Fit) -> HonestyTest:
    """Return the test of the largest bin over its neighbours, in units of the fitted spectrum, against all bins.

    A bin over the mean of 2 m neighbours exceeds x with probability (1 + x / 2 m)^(-2 m), the F distribution of 2 and
    4 m degrees of freedom: Fisher's test in a window. Of several segments both are as many times as large.
    """
    from scipy.ndimage import uniform_filter1d
    from scipy.special import fdtrc

    bands, n = fit.problem.bands, fit.problem.bands.samples
    first, last = int(bands.first[0]), int(bands.last[-1])
    bins = np.arange(first, last + 1)
    middle = 0.5 * (bands.first + bands.last)
    expected = np.exp(np.interp(np.log(bins), np.log(middle), np.log(fit.expected.mean)))
    ratio = bands.power[first : last + 1] / expected
    ratio[masked_bins(bands.masked, n)[first : last + 1]] = float(np.median(ratio))
    wide = 2 * _NEIGHBOURS + 3
    if ratio.size < 2 * wide:
        return HonestyTest(name="line", statistic=0.0, p=1.0, level=LINE, words="largest line: too few bins")
    near = uniform_filter1d(ratio, 3, mode="reflect") * 3.0
    around = (uniform_filter1d(ratio, wide, mode="reflect") * wide - near) / (wide - 3)
    over = ratio / np.maximum(around, 1e-300)
    place = int(np.argmax(over))
    p = float(fdtrc(2.0 * bands.segments, 4.0 * _NEIGHBOURS * bands.segments, over[place]))
    p = min(1.0, p * ratio.size)
    words = f"largest line: {over[place]:.1f} times its neighbours, at {bins[place] / n:.4g} cycles per sample"
    return HonestyTest(name="line", statistic=float(over[place]), p=p, level=LINE, words=words)


def _leans_on(fit: Fit) -> tuple[float, float]:
    """Return the powers of B = lam E[psi^2] and A = lam E[psi] in the third cumulant of a fitted contact.

    B^2 (1 + v)/A with a known mean, B psi (1 + v)^2 with a known strength, and B^3/(A^2 psi) if both together show v.
    """
    if fit.known.mean is None:
        return 1.0, 0.0
    return (2.0, -1.0) if fit.known.strength is None else (3.0, -2.0)


def _third_scatter(values: Doubles, mean: float, fit: Fit) -> float:
    """Return the standard error of the third cumulant given mean and variance, over blocks.

    A large junction raises all three, so their ratio scatters half as much: to first order as the mean of
    y^3 - 3 R(0) y - K3 (b y^2/R(0) + a y/mean), for b and a of `_leans_on`.
    """
    b, a = _leans_on(fit)
    variance = max(1.0 - fit.contact.noise, 1e-12)
    third, length = third_cumulant(values, np.asarray(mean)), values.size // _BLOCKS
    y = values[: _BLOCKS * length].reshape(_BLOCKS, length) - mean
    one, two, three = (np.mean(y**power, axis=1) for power in (1, 2, 3))
    blocks = three - (3.0 + (a * third / mean if a else 0.0)) * one - b * third / variance * two
    return float(blocks.std(ddof=1)) / sqrt(_BLOCKS)


def _third_test(values: Doubles, level: Doubles, fit: Fit, *, zero_known: bool) -> HonestyTest:
    """Return the test of the third cumulant against that of the fitted contact, lam E[psi^3] c_3 E[d^7].

    If neither mean nor strength is known, or if the trace drifts (so that its course is taken off, with a part of it),
    only its sign can be tested. Its error over n samples then has a Gaussian part, 6 int R^3, and one of single
    junctions, lam psi^6 E[(c_3 d^7 - 3 R(0) c_1 d^3)^2]; both are added. Otherwise it is that of blocks, or the part of
    single junctions if that is larger, since a record may lack the largest of them.
    """
    from scipy.special import stdtr

    measured, n = third_cumulant(values, level), values.size
    contact = fit.contact
    psi, pulse, sensor = contact.strength, fit.problem.pulse, fit.problem.sensor
    sizes, probability, _ = shot_sizes(fit.problem.population, contact.shape)
    d = contact.diameter * sizes
    second_passed, third_passed = passed(pulse, sensor, d, probability)
    expected = contact.births * psi**3 * contact.inequality**3 * pulse.life_integral(3) * fit.moment(7)
    expected *= contact.diameter**7 * third_passed
    variance = contact.rate * pulse.life_integral(2) * fit.moment(5) * contact.diameter**5 * second_passed
    cubes = psi**3 * life_integrals(pulse, sensor, d)[1]
    alone = cubes - 3.0 * variance * psi * np.outer(d**3, first_integrals(pulse))
    reach = contact.diameter * fit.moment(6) / fit.moment(5)
    gaussian = 6.0 * (variance**3 * reach + contact.noise * (3.0 * variance**2 + contact.noise**2))
    alike = float(probability @ np.square(alone) @ offsets(pulse)[1])
    error = sqrt(gaussian / n) + sqrt(contact.births * alike / n)
    predicted = (zero_known or fit.known.strength is not None) and fit.problem.walk is None
    if predicted:
        powers = {"births": 1.0, "strength": 3.0, "inequality": 3.0, "diameter": 7.0, "shape": fit.by_shape(7)}
        b, a = _leans_on(fit)
        squares = psi**2 * life_integrals(pulse, sensor, d)[0]
        # Cumulants add up, so that a junction brings its cube alone, less what its share of A and B leads to expect.
        alone = cubes - expected * b * squares / variance
        if fit.known.mean is not None:
            alone -= expected * a * psi * np.outer(d**3, first_integrals(pulse)) / fit.known.mean
        single = sqrt(contact.births * float(probability @ np.square(alone) @ offsets(pulse)[1]) / n)
        scatter = _third_scatter(values, float(level[0]), fit)
        z = (measured - expected) / sqrt(max(scatter, single) ** 2 + (expected * min(fit.error(powers), 1.0)) ** 2)
        p = 2.0 * float(stdtr(_BLOCKS - 1, -abs(z)))
        ratio = measured / max(abs(expected), 1e-300)
        words = f"third cumulant: {ratio:.2f} of that of the contact found, {z:+.1f} standard errors"
        if "inequality" not in fit.known.free:
            words += f"; {_spread_words(ratio, abs(ratio - 1.0) / max(abs(z), 1e-300), fit)}"
    else:
        z = measured / error
        p = 0.5 * erfc(-z / sqrt(2.0))  # the chance of a value as far below zero
        words = f"third cumulant: {z:+.1f} standard errors from zero; junctions make it positive"
    return HonestyTest(name="third cumulant", statistic=z, p=p, level=THIRD, words=words)


def _spread_words(ratio: float, error: float, fit: Fit) -> str:
    """Return the spread of strengths that fits a third cumulant, beside the assumed one.

    The cumulant is proportional to 1 + v, v their squared spread, or to its square (see `_leans_on`).
    """
    power = 1.0 if fit.known.mean is not None else 0.5
    w = fit.known.inequality
    low, middle, high = (
        100.0 * sqrt(max(w * max(ratio + sign * 1.96 * error, 0.0) ** power - 1.0, 0.0)) for sign in (-1.0, 0.0, 1.0)
    )
    given = f"{100.0 * sqrt(w - 1.0):.3g} %"
    return f"as of a spread of strengths of {middle:.0f} % (95 %: {low:.0f} to {high:.0f} %), {given} assumed"


def _steadiness_test(values: Doubles, fit: Fit) -> HonestyTest:
    """Return the chi-square test of the means of four quarters; if it fails, its words name a run-in to cut."""
    statistic, p = _steadiness(values, fit)
    words = f"steadiness: means of four quarters differ by chi-square {statistic:.1f} on {_PARTS - 1}"
    if p < STEADY:
        cuts = (int(part * values.size) for part in _RUN_IN)
        steady = next((cut for cut in cuts if _steadiness(values[cut:], fit)[1] > _STEADY_AGAIN), None)
        words += (
            "; no part of it after a run-in is steady: wear, or a sensor that drifts (drift=True)"
            if steady is None
            else f"; after a run-in of {steady:,} samples they do not: cut these off"
        )
    return HonestyTest(name="steadiness", statistic=statistic, p=p, level=STEADY, words=words)


def drift_test(values: Doubles, fit: Fit) -> HonestyTest:
    """Return the test of the line of least squares through the trace: its rise has the variance 12 S(0)/n.

    A random walk with steps of variance q adds (6/5) q n. For a ramp no other test of a long trace has more power,
    because S(k) is flat at the wavenumbers of the ramp.
    """
    contact, n = fit.contact, values.size
    rise = ramp_of(values)
    variance = RAMP_VARIANCE * fit.problem.longest_waves(contact) / n + 1.2 * contact.drift * n
    z = rise / sqrt(variance)
    words = f"drift: a line through it rises by {rise:+.2f} of its standard deviation, {z:+.1f} standard errors"
    if fit.known.ramp**2 > variance:
        words += "; number and strength allow for a zero that moved so"
    return HonestyTest(name="drift", statistic=z, p=erfc(abs(z) / sqrt(2.0)), level=DRIFT, words=words)


def _steadiness(values: Doubles, fit: Fit) -> tuple[float, float]:
    """Return the chi-square of differences of the four means, and its probability.

    A mean of L samples has the variance S(0) / L; a random walk with steps of variance q adds q L (j + 1/2) to the
    covariance of part j with every later part, and q L (j + 1/3) to the variance of part j itself.
    """
    from scipy.special import gammaincc

    contact = fit.contact
    density = fit.problem.longest_waves(contact)
    length = values.size // _PARTS
    means = values[: length * _PARTS].reshape(_PARTS, length).mean(axis=1)
    number = np.arange(_PARTS)
    walk = np.minimum(number[:, None], number) + np.where(np.eye(_PARTS) > 0.0, 1.0 / 3.0, 0.5)
    total = density / length * np.eye(_PARTS) + contact.drift * length * walk
    between = np.diff(np.eye(_PARTS), axis=0)
    difference = between @ means
    statistic = float(difference @ np.linalg.solve(between @ total @ between.T, difference))
    return statistic, float(gammaincc(0.5 * (_PARTS - 1), 0.5 * statistic))
