"""How far a finite record errs, from theory alone: standard errors of its figures, Welch's estimate of its spectrum."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import combinations_with_replacement, product
from math import factorial, hypot, inf, pi
from numbers import Integral

import numpy as np

from rubnoise.arrays import Complexes, Doubles
from rubnoise.contact.distributions import Law
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.tables import fields_as_text
from rubnoise.theory import motion, second_order
from rubnoise.theory.moments import area_cumulants, shot_cumulants
from rubnoise.theory.second_order import AREA_ITSELF
from rubnoise.theory.sizes import COARSE, sizes_of
from rubnoise.theory.unit_pulse import energy

SEGMENTS = 64  # about how many, which half overlap, a record has by default
MOST_TICKS = 1 << 18  # of one segment: its errors take some ten seconds and a hundred megabytes
_ORDERS = 5  # 0 to 4
_NOTHING = 1e-12  # of the variance, a covariance that is left out
_LEAKS, _ALIASES = 16, (0, -1, 1, -2, 2)
_LONGEST = 4  # lengths of a segment beyond which a correlation is left out: a record of a few such lives says nothing
_EMPTY_BIN = 1e-13  # of the largest mean: below it a bin holds rounding alone


def mean_force_error(model: Model, distance: float | None = None) -> float:
    """Return the standard error in uN of the mean friction force over a stationary record; Refused without strength."""
    psi = motion.strengths_of(model)
    noise = second_order.area_noise(model, psi)
    if model.separation is None:
        return noise.error_of_mean(distance)
    # Under a load only the deviations of strengths err, and momentum bounds the mean of P.
    deviations = replace(noise, square=max(noise.square - noise.squared_mean, 0.0), squared_mean=0.0)
    drive, slid = motion.contact_drive_of(model), distance or (model.tick_count + 1) * model.tick
    place, velocity = (motion.std_of(model, name) for name in ("separation", "normal_velocity"))
    return deviations.error_of_mean(distance) + psi.mean / drive.gain * _carried_momentum(drive, place, velocity, slid)


def standard_errors(model: Model, distance: float | None = None, strengths: Law = AREA_ITSELF) -> dict[str, float]:
    """Return the standard errors of mean, std, skewness and excess_kurtosis of psi A_r over a stationary record.

    The record is as in `lag_rule`; the errors are of first order in life/distance (from some 100 lives on). Each
    estimate moves with the mean of its influence function of z = (A_r - mean)/std: z; (z^2 - 1)/2; z^3 - g - 3z - (3/2)
    g (z^2 - 1); z^4 - b - 4 g z - 2 b (z^2 - 1), g the skewness and b the kurtosis. Refused unless births are Poisson.
    Source: Hampel (1974), doi:10.1080/01621459.1974.10482962, with shot-noise cumulants.
    """
    second_order.need_random_births(model, "the standard error of a moment")
    cumulants = shot_cumulants(model, strengths)
    lags, weights = second_order.lag_rule(model, distance)
    series = np.zeros((_ORDERS, _ORDERS, lags.size))
    for i, j in combinations_with_replacement(range(_ORDERS), 2):
        if i:
            joint = strengths.moment(i + j) * second_order.joint_cumulant(model, lags, i, j)
        else:
            joint = np.full(lags.size, cumulants.values[j - 1] if j > 1 else 0.0)
        series[i, j] = series[j, i] = joint / (cumulants.std ** (i + j) * factorial(i) * factorial(j))
    moments = _exponential(series)
    covariances = (moments - moments[:, :1] * moments[:1]) @ weights
    scale = np.array([factorial(i) for i in range(_ORDERS)])
    covariances = (covariances * np.outer(scale, scale))[1:, 1:]
    g, b = cumulants.skewness, cumulants.excess_kurtosis + 3.0
    rows = [1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [-3.0, -1.5 * g, 1.0, 0.0], [-4.0 * g, -2.0 * b, 0.0, 1.0]
    influence = np.array(rows)
    errors = np.sqrt(np.diag(influence @ covariances @ influence.T)) * [cumulants.std, cumulants.std, 1.0, 1.0]
    return dict(zip(("mean", "std", "skewness", "excess_kurtosis"), errors.tolist(), strict=True))


def _exponential(series: Doubles) -> Doubles:
    """Return exp of a power series in x and y without a constant: of cumulants over i! j! that gives the moments'."""
    found = term = np.zeros_like(series)
    found[0, 0] = 1.0
    for power in range(1, 2 * _ORDERS - 1):
        longer = np.zeros_like(series)
        for i, j in product(range(_ORDERS), repeat=2):
            longer[i:, j:] += series[i, j] * term[: _ORDERS - i, : _ORDERS - j] / power
        found, term = found + longer, longer
    return found


def mean_displacement_error(model: Model, distance: float) -> float:
    """Return an upper bound in um of the standard error of the mean of x over ``distance`` um, exact for long runs."""
    # k mean x = mean F - (m dv + c dx)/T, d the changes over the run; over a base y, k mean y + (c dy - m dv - c dx)/T.
    drive, moves = motion.drive_of(model), motion.response(model)
    change = _carried_momentum(drive, moves.displacement_std, moves.velocity_std, distance)
    if drive.slider.excitation != "base":
        return (mean_force_error(model, distance) + change) / drive.slider.stiffness
    lift, noise = model.base_per_area, second_order.area_noise(model)
    change += 2.0 * drive.slider.damping * lift * area_cumulants(model).std * drive.speed / distance
    return lift * noise.error_of_mean(distance) + change / drive.slider.stiffness


def _carried_momentum(drive: motion.DrivenOscillator, std: float, velocity_std: float, distance: float) -> float:
    """Return a bound in uN of the spread of (m dv + c dx)/T: of stationary motion plus a decaying start."""
    slider, natural = drive.slider, drive.slider.natural_angular_frequency
    start = hypot(std, velocity_std / natural)
    carried = slider.damping * (std + start) + slider.mass * (velocity_std + natural * start)
    return carried * drive.speed / distance


def motion_errors(model: Model, distance: float) -> dict[str, float]:
    """Return standard errors over a run, in um and um/s, inf without damping; Refused unless births are Poisson."""
    drive = motion.drive_of(model)
    second_order.need_random_births(model, "the standard error of the slider's motion")
    names, errors = ("mean_displacement", "displacement_std", "velocity_std"), [inf] * 3
    if drive.slider.damping > 0.0:
        errors = [mean_displacement_error(model, distance), *motion.spread_errors(model, motion.MOTION, distance)]
    return dict(zip(names, errors, strict=True))


@lru_cache(maxsize=8)
def load_errors(model: Model, distance: float) -> dict[str, float]:
    """Return standard errors of the motion under a load over ``distance`` um, in um, um/s and uN.

    Of stds as `spread_errors`; of the mean of P (m dz' + c dz)/T, of stationary motion.
    """
    names = ("separation", "normal_velocity", "load", *((motion.FORCE,) if model.strengths else ()))
    place, velocity, load, *force = motion.spread_errors(model, names, distance)
    std, fast = (motion.std_of(model, name) for name in names[:2])
    drive, noise = motion.contact_drive_of(model), second_order.area_noise(model)
    mean_load = _carried_momentum(drive, std, fast, distance)
    errors = {
        "separation_mean": (drive.gain * noise.error_of_mean(distance) + mean_load) / drive.slider.stiffness,
        "separation_std": place,
        "velocity_std": velocity,
        "load_mean": mean_load,
        "load_std": load,
    }
    return errors | ({"force_mean": mean_force_error(model, distance), "force_std": force[0]} if force else {})


def cross_spectrum(covariance: Doubles, window: Doubles, shift: int) -> Complexes:
    """Return E[X(k) conj X'(k)] in um^4 at the n // 2 + 1 wavenumbers of a segment of n ticks, exactly.

    X(k) = sum_j w_j (x_j - mean x) exp(-2 pi i p j / n), X' the same over a segment that begins ``shift`` >= 0 ticks
    later. C is the covariance by ticks (zero beyond), rho the autocorrelation of the window, W its transform, u and v
    the covariances of a tick with the mean of the other segment, U and V the transforms of w u and w v: sum_tau
    rho(tau) C(shift - tau) exp(-i k tau) - U conj W - W conj V + mean(u) |W|^2.
    """
    n = window.size
    taus = np.arange(1 - n, n)
    steps = np.abs(shift + taus)
    around = np.where(steps < covariance.size, covariance[np.minimum(steps, covariance.size - 1)], 0.0)
    autocorrelation = np.fft.irfft(np.square(np.abs(np.fft.rfft(window, 2 * n))), 2 * n)
    products = autocorrelation[np.abs(taus)] * around[::-1]
    folded = np.append(products[n - 1], products[n:] + products[: n - 1])
    plain: Complexes = np.fft.rfft(folded)
    sums = np.cumsum(np.append(0.0, around))
    later = (sums[n:] - sums[:n]) / n  # of the ticks of the later segment with the mean of the earlier one
    transform, u, v = (np.fft.rfft(window * part) for part in (np.ones(n), later[::-1], later))
    return plain - u * transform.conj() - transform * v.conj() + later.mean() * np.square(np.abs(transform))


def expected_periodogram(model: Model, tick: float, window: Doubles) -> tuple[Doubles, Doubles]:
    """Return wavenumbers k in rad/um and the exact mean of a windowed periodogram of A_r there, in um^4 per rad/um.

    P(k) = h |sum_j w_j (x_j - mean x) exp(-i k j h)|^2 / sum_j w_j^2 over n = len(window) ticks of h = ``tick`` um,
    two-sided like S(k), at k = 2 pi p / (n h), p = 0 ... n // 2: Welch's estimate, with aliases, leakage and the
    removed mean.
    Source: Priestley, Spectral Analysis and Time Series (1981), chapter 6.
    """
    covariance = second_order.autocovariance(model, tick * np.arange(window.size))
    power = cross_spectrum(covariance, window, 0).real
    wavenumber = np.asarray(2.0 * pi * np.fft.rfftfreq(window.size, tick), dtype=np.float64)
    return wavenumber, np.maximum(tick / float(window @ window) * power, 0.0)


def through_window(density: Callable[[Doubles], Doubles], step: float, window: Doubles, last: int) -> Doubles:
    """Return the mean of a windowed periodogram at bins 0 ... ``last`` of a record with the two-sided density S(w).

    E[P(w_p)] = sum_q S_a(w_p - q/2 bins) |W_q|^2 / (2 n sum w^2), W the transform of the window padded to 2 n values,
    S_a(w) = sum_a S(|w + 2 pi a / h|): exact for covariances that end within n values of ``step`` h, to 8 bins of
    leakage and two aliases; a mean that is subtracted changes bins 0 and 1.
    """
    n = window.size
    leaked = np.square(np.abs(np.fft.rfft(window, 2 * n)))[: _LEAKS + 1] / (2.0 * n * float(window @ window))
    kernel = np.concatenate([leaked[:0:-1], leaked])
    places = np.pi / (n * step) * np.arange(1 - leaked.size, 2 * last + leaked.size, dtype=np.float64)
    turn = 2.0 * np.pi / step
    folded = sum((density(np.abs(places + alias * turn)) for alias in _ALIASES), np.zeros(places.size))
    return np.convolve(folded, kernel, "valid")[::2]


def hann(ticks: int) -> Doubles:
    """Return the Hann window sin^2(pi i / n) of n ticks, as an endless record would repeat it (scipy's sym=False)."""
    return np.square(np.sin(np.pi * np.arange(ticks) / ticks))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EstimatedSpectrum:
    """A spectral density as Welch's method shows it, estimated or expected, and the standard error of one estimate.

    ``density`` is the two-sided S(k) in the unit of the record squared per rad/um, for the real contact area um^4 per
    rad/um, with aliases and leakage, at wavenumbers k = 2 pi i / (ticks * tick) >= 0 in rad/um. R(tau) = (1/2 pi) int S
    e^(i k tau) dk over all k: a one-sided density per cycle/um is twice S at k = 2 pi f. ``standard_error`` of what
    theory expects: inf of a bin without power, nan if births are not Poisson or passes off the centre line. ``ticks``
    are those of one of the ``segments``.
    """

    ticks: int
    segments: int
    wavenumber: Doubles
    density: Doubles
    standard_error: Doubles

    __repr__ = fields_as_text


def estimated_spectrum(model: Model, ticks: int | None = None) -> EstimatedSpectrum:
    """Return the expectation of Welch's method for a record of the model: every tick from 0 to its distance.

    Segments of ``ticks`` values half overlap, under the Hann window sin^2(pi j / n), each less its own mean; without
    ``ticks`` there are about 64. Raises Refused for a segment longer than the record or 262 144 ticks.
    """
    record = model.tick_count + 1
    length = min(max(2, 2 * (record // (SEGMENTS + 1))), MOST_TICKS) if ticks is None else ticks
    if isinstance(length, bool) or not isinstance(length, Integral):
        raise Refused(f"ticks: {length!r:.40}: a segment has a whole number of ticks, such as 256")
    if not 2 <= length <= min(record, MOST_TICKS):
        raise Refused(f"a segment of {length} ticks: it has 2 to {min(record, MOST_TICKS)}, of a record of {record}")
    window, step = hann(int(length)), max(1, int(length) // 2)
    count = (record - int(length)) // step + 1
    wavenumber, density = expected_periodogram(model, model.tick, window)
    errors = np.full(density.size, np.nan)
    if second_order.are_at_random(model) and model.pulse.offset == "none":
        errors = np.where(density > 0.0, density, 1.0) * welch_errors(model, window, count, step)
    return EstimatedSpectrum(
        ticks=int(length), segments=count, wavenumber=wavenumber, density=density, standard_error=errors
    )


def welch_errors(model: Model, window: Doubles, count: int, step: int) -> Doubles:
    """Return the standard error of a Welch estimate over its own mean, ``count`` segments ``step`` ticks apart.

    Var[P] / E[P]^2 is the sum over pairs of segments of |E[X conj X']|^2 / E[|X|^2]^2, of |E[X X']|^2 / E[|X|^2]^2,
    which counts at the ends of the axis and is taken from the window alone, and of the fourth cumulant E[|A^|^4]/(lam
    E[|A^|^2]^2) times sum_j w_j^2 w'_j^2 / (h (sum w^2)^2). inf of empty bins. Refused unless births are Poisson.
    Source: Welch (1967), doi:10.1109/TAU.1967.1161901; Isserlis's theorem; Rice (1944).
    """
    second_order.need_random_births(model, "the error of a spectrum")
    if model.pulse.offset != "none":
        raise Refused("the error of a spectrum is known for passes through both centres alone (pulse.offset)")
    n, energy_of_window = window.size, float(window @ window)
    lags = min(2 + int(second_order.covariance_reach(model, _NOTHING) / model.tick), _LONGEST * n)
    covariance = second_order.autocovariance(model, model.tick * np.arange(lags))
    mean = cross_spectrum(covariance, window, 0).real
    held = mean > _EMPTY_BIN * mean.max()
    variance, shared = np.where(held, 0.0, np.inf), 0.0
    for apart in range(min(count, 1 + (n + lags) // step)):
        shift, weight = apart * step, (2.0 if apart else 1.0) / count * (1.0 - apart / count)
        product = np.zeros(n)
        product[shift:] = window[shift:] * window[: max(n - shift, 0)]
        ordinary = cross_spectrum(covariance, window, shift)[held] / mean[held]
        turned = np.fft.fft(product)[2 * np.arange(mean.size) % n][held] / energy_of_window
        variance[held] += weight * (np.square(np.abs(ordinary)) + np.square(np.abs(turned)))
        shared += weight * float(product @ product) / energy_of_window**2
    scatter = _scatter(model, 2.0 * pi * np.fft.rfftfreq(n, model.tick)[held])
    variance[held] += shared / (model.birth_rate * model.tick) * scatter
    return np.sqrt(variance)


def _scatter(model: Model, wavenumber: Doubles) -> Doubles:
    """Return E[|A^|^4] / E[|A^|^2]^2 at each wavenumber."""
    sizes, mean, fourth = sizes_of(model.sizes, COARSE), np.zeros(wavenumber.size), np.zeros(wavenumber.size)
    for diameter, share in zip(sizes.diameter.tolist(), sizes.probability.tolist(), strict=True):
        own = diameter**6 * energy(model.pulse, wavenumber * diameter)
        mean, fourth = mean + share * own, fourth + share * np.square(own)
    return fourth / np.square(mean)
