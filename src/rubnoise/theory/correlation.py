"""The autocovariance of real contact area: at a lag, and weighted over lags for means of records."""

from math import ceil, isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.arrays import Doubles
from rubnoise.contact.laws import Law
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.theory import off_centre
from rubnoise.theory.birth_noise import excess_of_area, has_noise_of_its_own
from rubnoise.theory.mean_life import mean_life_overlap
from rubnoise.theory.quadrature import cut_size_rule, distinct, hard_ends, is_one_size, longest_life, panels
from rubnoise.theory.regular_births import are_at_random, line_covariance, spectral_lines

Powers = tuple[int, int]

_NODES = 20
_SIZES = 16
_AT_ONCE = 32


def autocovariance(model: Model, lag: ArrayLike) -> Doubles:
    """Return R(tau) = Cov[A_r(s), A_r(s + tau)] in um^4 for lags in um (any shape).

    Poisson births: R(tau) = lam E[int A(s) A(s + |tau|) ds], zero beyond the longest life; R(0) is the variance, and
    the integral of R over all tau is S(0). Regular births: less lam int E[A(s)] E[A(s + |tau|)] ds, which leaves what
    their phase does not fix, and with what it does: 2 sum of power cos(k_n tau) over `spectral_lines`.
    Source: Campbell's theorem (Rice 1944, doi:10.1002/j.1538-7305.1944.tb00874.x), for regular births given the phase.
    """
    return _covariance(model, lag, 1.0, 1.0)


def force_autocovariance(model: Model, strengths: Law, lag: ArrayLike) -> Doubles:
    """Return the autocovariance of friction force in uN^2 for lags in um (any shape), as `autocovariance`.

    Strengths psi (MPa) are independent of sizes: E[psi^2] goes with E[A A], E[psi]^2 with E[A] E[A] and the lines.
    Raises Refused under a load that weighs, where the spectrum has what is known.
    """
    if model.separation is not None:
        raise Refused("the autocovariance of a force under [load] is not known; its spectral density is")
    return _covariance(model, lag, strengths.moment(2), strengths.mean**2)


def unphased_covariance(model: Model, lag: ArrayLike, square: float = 1.0, squared_mean: float = 1.0) -> Doubles:
    """Return the covariance of sum psi A at a lag in um (any shape) without the lines: given the phase of the births.

    E[psi^2] and E[psi]^2 are given; zero beyond the longest life and the memory of births. For Poisson births it is
    the whole covariance.
    """
    lags = np.abs(np.asarray(lag, dtype=np.float64))
    shot = joint_cumulants(model, lags, ((1, 1),))[1, 1]
    if are_at_random(model):
        return square * shot
    if has_noise_of_its_own(model):
        return square * shot + squared_mean * excess_of_area(model).covariance(lags)
    if is_one_size(model.sizes):
        return (square - squared_mean) * shot
    return square * shot - squared_mean * model.birth_rate * mean_life_overlap(model.sizes, model.pulse, lags)


def _covariance(model: Model, lag: ArrayLike, square: float, squared_mean: float) -> Doubles:
    lags = np.abs(np.asarray(lag, dtype=np.float64))
    unphased = unphased_covariance(model, lags, square, squared_mean)
    return unphased if are_at_random(model) else unphased + squared_mean * line_covariance(spectral_lines(model), lags)


def joint_cumulants(
    model: Model, lag: ArrayLike, powers: tuple[Powers, ...], *, sizes: int = _SIZES
) -> dict[Powers, Doubles]:
    """Return kappa_ij(tau), the joint cumulant of i times A_r(s) and j times A_r(s + tau), in um^(2i + 2j).

    kappa_ij = lam E[int A(s)^i A(s + |tau|)^j ds] = lam E[d^(2i + 2j + 1) q_ij(|tau| / d)], for each pair (i, j)
    and lags tau in um (any shape), by ``sizes`` diameters on each panel of the size law. For Poisson births; for others
    it is the part of single junctions, whatever comes before and after them.
    Source: Campbell's theorem for two places at once (Rice 1944, as above).
    """
    lags = np.abs(np.asarray(lag, dtype=np.float64))
    flat = np.empty((len(powers), lags.size))
    for rows in np.array_split(np.arange(lags.size), 1 + lags.size // _AT_ONCE):
        flat[:, rows] = _averages(model, lags.ravel()[rows], powers, sizes)
    return {pair: model.birth_rate * line.reshape(lags.shape) for pair, line in zip(powers, flat, strict=True)}


def _averages(model: Model, lags: Doubles, powers: tuple[Powers, ...], sizes: int) -> Doubles:
    """Return E[d^(2i + 2j + 1) q_ij(tau / d)], a row each pair of powers, the sizes cut at d = tau/2 and tau."""
    diameters, probabilities = cut_size_rule(model.sizes, np.multiply.outer(lags, (0.5, 1.0)), sizes)
    t = lags[:, None] / diameters
    alive = (t < 2.0) & (probabilities > 0.0)
    overlaps = life_overlaps(model.pulse, t[alive], powers)
    averages = np.empty((len(powers), lags.size))
    for line, (i, j) in enumerate(powers):
        terms = np.zeros_like(t)
        terms[alive] = overlaps[i, j] * (probabilities * diameters ** (2 * (i + j) + 1))[alive]
        averages[line] = terms.sum(axis=-1)
    return averages


def life_overlaps(pulse: Pulse, lag: Doubles, powers: tuple[Powers, ...]) -> dict[Powers, Doubles]:
    """Return q_ij(t) = int a(s)^i a(s + t)^j ds for lives of unit diameter, t >= 0 of any shape; zero for t >= 2.

    A life is its own mirror image, so the half up to s = 1 - t/2 is enough, and the other half has i and j exchanged.
    It is cut at s = 1 - t, mid-life of the later factor, and s = 1 - cos(theta) makes the birth at s = 0 smooth. Passes
    off the centre line are averaged over their offsets.
    """
    if pulse.offset != "none":
        return off_centre.overlaps(pulse, lag, powers)
    t = np.minimum(lag, 2.0)
    cuts = np.stack([np.zeros_like(t), np.arccos(np.minimum(t, 1.0)), np.arccos(0.5 * t)], axis=-1)
    theta, weights = panels(cuts, _NODES)
    age = 2.0 * np.square(np.sin(0.5 * theta))
    earlier, later = pulse.area(age, 1.0), pulse.area(age + t[..., None], 1.0)
    weights = weights * np.sin(theta)
    highest = max(max(pair) for pair in powers)
    first, second = _powers(earlier, highest), _powers(later, highest)
    return {(i, j): np.sum(weights * (first[i] * second[j] + first[j] * second[i]), axis=-1) for i, j in powers}


def _powers(values: Doubles, highest: int) -> list[Doubles]:
    """Return values to the power 0 ... highest, by products, which cost a fraction of a general power."""
    found = [np.ones_like(values)]
    for _ in range(highest):
        found.append(found[-1] * values)
    return found


_PANELS = 8
_MOST_PANELS, _FEW_PANELS = 2**15, 2**10
_LAG_NODES = 10
_FEW_TICKS = 64
_MOST_TICKS = 512
_WIDE = 2.0  # longest over typical life of a law whose lags are taken in octaves
_FINEST = 2.0**-6  # of a typical life


def _reach(model: Model) -> float:
    """Return the lag in um beyond which covariances are zero: the longest life, plus the memory of births."""
    return longest_life(model) + (model.births.memory if isfinite(model.births.memory) else 0.0)


def lag_rule(model: Model, distance: float | None = None) -> tuple[Doubles, Doubles]:
    """Return lags in um and weights, so that Var[mean of f(X)] = sum of weight times Cov[f(X(0)), f(X(lag))].

    The mean is over a continuous record of ``distance`` T um, weight (2/T)(1 - tau/T) dtau, or, without a distance,
    over the model's n = tick_count + 1 ticks h apart, weight (2/n)(1 - j/n) at tau = j h and 1/n at tau = 0. Lags end
    with the longest life. Many ticks a life are equivalent to a continuous
    record of n h, and are treated as one; so are the lags of few ticks a life beyond the 512th.
    """
    if distance is not None:
        return _continuous(model, 0.0, distance)
    ticks = model.tick_count + 1
    reach = min(ticks - 1, int(_reach(model) / model.tick))
    if reach > _FEW_TICKS and _typical_life(model) > _FEW_TICKS * model.tick:
        return _continuous(model, 0.0, ticks * model.tick)
    steps = np.arange(min(reach, _MOST_TICKS) + 1, dtype=np.float64)
    weights = (2.0 / ticks) * (1.0 - steps / ticks)
    weights[0] = 1.0 / ticks
    if reach <= _MOST_TICKS:
        return steps * model.tick, weights
    far, far_weights = _continuous(model, (_MOST_TICKS + 0.5) * model.tick, ticks * model.tick)
    return np.concatenate([steps * model.tick, far]), np.concatenate([weights, far_weights])


def _continuous(model: Model, start: float, distance: float) -> tuple[Doubles, Doubles]:
    end = min(distance, _reach(model))
    edges = distinct(np.clip(lag_edges(model, end), start, end))
    lags, weights = panels(edges, _LAG_NODES)
    return lags, weights * (2.0 / distance) * (1.0 - lags / distance)


def lag_edges(model: Model, end: float) -> Doubles:
    """Return edges in um of panels from 0 to an end: equal, or, for a wide law, in octaves beyond two typical lives.

    The shortest life of a law whose density jumps there is an edge too: covariances turn at it.
    """
    typical = _typical_life(model)
    parts: list[NDArray[Any]] = [np.linspace(0.0, min(end, _WIDE * typical), _PANELS + 1)]
    if 0.0 < model.births.memory < np.inf:
        parts += _as_fine_as_births(end, min(typical, 2.0 * model.births.memory))
    if end > _WIDE * typical:
        parts += [typical * 2.0 ** np.arange(np.log2(_FINEST), np.log2(end / typical)), np.array([end])]
    shortest = hard_ends(model.sizes)[0]
    if shortest is not None and 2.0 * shortest < end:
        parts.append(np.array([2.0 * shortest]))
    return distinct(np.concatenate(parts))


def _as_fine_as_births(end: float, width: float) -> list[NDArray[Any]]:
    """Return edges in um up to an end, as narrow as the memory of births; wider, if too many, beyond ``width``.

    So short a memory matters only at lag 0.
    """
    count = ceil(_PANELS * end / width)
    if count <= _MOST_PANELS:
        return [np.linspace(0.0, end, count)]
    return [np.linspace(0.0, width, _PANELS + 1), np.linspace(0.0, end, _FEW_PANELS)]


def _typical_life(model: Model) -> float:
    """Return the longest life in um of a junction of the mean diameter found alive, 2 m_2/m_1."""
    return 2.0 * model.sizes.moment(2) / model.sizes.moment(1)


_PLACES = 17


def covariance_reach(model: Model, part: float) -> float:
    """Return a lag in um beyond which |R| is below a part of the variance: the longest life, or half of it, or less.

    A size law with a long tail has very rare lives of up to hundreds of mean lives, and most lags up to them show
    nothing. If R never falls so far, as with regular births of one size, it is the longest life.
    """
    reach, least = longest_life(model), part * float(autocovariance(model, 0.0))
    while np.all(np.abs(autocovariance(model, np.linspace(0.5 * reach, reach, _PLACES))) < least):
        reach *= 0.5
    return reach
