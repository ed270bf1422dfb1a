"""The joint cumulants of the one-way slider's displacement and velocity: filtered shot noise is not Gaussian.

Read it from above: the free decay of the slider, its response to one junction of unit strength until it is at rest,
and the cumulants of many such junctions.
"""

from dataclasses import dataclass
from functools import cache, lru_cache
from math import ceil, pi

import numpy as np
from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles
from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.model import Model, Slider
from rubnoise.theory.drive import Drive, drive_of
from rubnoise.theory.quadrature import cut_size_rule, panels, size_range
from rubnoise.theory.regular_births import need_random_births
from rubnoise.theory.response import mean_displacement

_SMALL = 1e-2


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeDecay:
    """m x'' + c x' + k x = 0 with a = c/(2m) and r^2 = a^2 - k/m: ``rate`` a and ``square_root`` r^2 in s^-1, s^-2."""

    rate: float
    square_root: float
    natural: float

    @property
    def fastest(self) -> float:
        """The modulus of the faster exponent in 1/s: the natural frequency when it rings, up to 2a when it creeps."""
        return self.natural if self.square_root <= 0.0 else self.rate + float(np.sqrt(self.square_root))

    @property
    def slowest(self) -> float:
        """The rate of the slower decay in 1/s, a or k/m / (a + r)."""
        return self.rate if self.square_root <= 0.0 else self.natural**2 / self.fastest

    def __call__(self, time: Doubles) -> tuple[Doubles, Doubles]:
        """Return exp(-a t) cosh(r t) and exp(-a t) sinh(r t)/r at times in s of either sign, by exponentials or series.

        x(t) = (even + a odd) x(0) + odd x'(0); the impulse response is odd / m.
        """
        if self.square_root < 0.0:
            turns = float(np.sqrt(-self.square_root))
            decay, angle = np.exp(-self.rate * time), turns * time
            even, divided = decay * np.cos(angle), decay * np.sin(angle) / turns
        else:
            root = float(np.sqrt(self.square_root))
            slow, fast = np.exp(-(self.natural**2) / (self.rate + root) * time), np.exp(-(self.rate + root) * time)
            even, divided = 0.5 * (slow + fast), 0.5 * (slow - fast) / (root or 1.0)
        turned = self.square_root * np.square(time)
        few = np.abs(turned) < _SMALL**2
        if not few.any():
            return even, divided
        series = time * np.exp(-self.rate * time) * (1.0 + turned / 6.0 * (1.0 + turned / 20.0))
        return even, np.where(few, series, divided)


def free_motion(slider: Slider) -> FreeDecay:
    """Return the free motion of a slider; its square root is taken as a product, which keeps its digits near 0."""
    rate, natural = slider.damping / (2.0 * slider.mass), slider.natural_angular_frequency
    return FreeDecay(rate=rate, square_root=(rate - natural) * (rate + natural), natural=natural)


Powers = tuple[int, int]

_NODES_OF_PANEL = 16
_PHASE = 1.0  # of the faster exponent on one panel; a fourth power has four times that
_FEWEST, _MOST = 8, 5000
_GONE = 45.0  # decay, as an exponent, after which nothing is left


@dataclass(frozen=True, slots=True, kw_only=True)
class JunctionResponse:
    """Displacement (um) and velocity (um/s) of a slider for a junction of 1 MPa, at nodes in time with weights in s.

    A row a node and a column a diameter. ``life`` spans the junction's life; ``rest`` the decay after it, up to where
    it repeats itself smaller and mirrored: ``repeats`` is that factor, -exp(-a pi / w_d), or 0 if it just dies away.
    """

    life: tuple[Doubles, Doubles, Doubles]
    rest: tuple[Doubles, Doubles, Doubles]
    repeats: float

    def integrals(self, powers: Powers) -> Doubles:
        """Return int y^i y'^j dt over all time, for each diameter; a decay that repeats itself adds up as a series."""
        i, j = powers
        during, after = (np.sum(w * _power(y, i) * _power(v, j), axis=0) for w, y, v in (self.life, self.rest))
        return during + after / (1.0 - self.repeats ** (i + j))


def _power(values: Doubles, exponent: int) -> Doubles | float:
    """Return a power up to the fourth by products, which are much faster than numpy's powers."""
    if exponent < 2:
        return values if exponent else 1.0
    squared = np.square(values)
    return (squared, squared * values, np.square(squared))[exponent - 2]


def junction_response(pulse: Pulse, drive: Drive, diameters: Doubles) -> JunctionResponse:
    """Return the response to junctions of these diameters in um.

    y(t) = int_0^t h(t - u) A(V u; d) du with h the impulse response; s = d (1 - cos phi) makes birth and death smooth,
    panels in phi end at mid-life, and the state at the end of each begins the next. Raises Refused if the slider
    swings or creeps too often in one life to be followed.
    """
    free = free_motion(drive.slider)
    half = panels_of_half_a_life(drive, float(diameters.max()))
    phi, weights = panels(np.linspace(0.0, pi, 2 * half + 1), _NODES_OF_PANEL)
    scale = diameters / drive.speed
    times = 2.0 * np.multiply.outer(np.square(np.sin(0.5 * phi)), scale)
    steps = np.multiply.outer(weights * np.sin(phi), scale)
    area = pulse.area(drive.speed * times, diameters)
    ends = 2.0 * np.multiply.outer(np.square(np.sin(0.25 * pi / half * np.arange(2 * half + 1))), scale)
    swing, surge, last = _driven(free, times, steps, area, ends)
    mass = drive.slider.mass
    life = (steps, swing / mass, (surge - free.rate * swing) / mass)
    return JunctionResponse(life=life, rest=_after(free, last, mass), repeats=_repeats(free))


def panels_of_half_a_life(drive: Drive, diameter: float) -> int:
    """Return the number of panels for a slider's motion to a mid-life; raises Refused if they are too many."""
    count = ceil(0.5 * pi * free_motion(drive.slider).fastest * diameter / drive.speed / _PHASE)
    if count > _MOST:
        raise Refused("the slider swings too often within one junction's life to compute its level crossings")
    return max(_FEWEST, count)


def _driven(
    free: FreeDecay, times: Doubles, steps: Doubles, area: Doubles, ends: Doubles
) -> tuple[Doubles, Doubles, tuple[Doubles, Doubles]]:
    """Return int odd(t - u) A du and int even(t - u) A du at all nodes, and both at the end of the life.

    On one panel odd(t - u) = odd(t) even(-u) + even(t) odd(-u) and even(t - u) = even(t) even(-u) + r^2 odd(t) odd(-u).
    """
    count, sizes = ends.shape[0] - 1, ends.shape[1]
    local = times.reshape(count, _NODES_OF_PANEL, sizes) - ends[:-1, None]
    weights = steps.reshape(count, _NODES_OF_PANEL, sizes)
    lengths = np.diff(ends, axis=0)
    drive = area.reshape(count, _NODES_OF_PANEL, sizes) * weights
    back = [part * drive for part in free(-local)]
    forth, whole = free(local), free(lengths)
    inner = [np.einsum("qp,kps->kqs", _running_integral(), part) for part in back]
    total = [part.sum(axis=1) for part in back]
    begun = np.zeros((2, count + 1, sizes))
    for panel in range(count):
        ended = begun[0, panel] + total[1][panel], begun[1, panel] + total[0][panel]
        begun[:, panel + 1] = _moved(free, (whole[0][panel], whole[1][panel]), ended)
    before = begun[:, :-1, None]
    swing, surge = _moved(free, forth, (before[0] + inner[1], before[1] + inner[0]))
    return swing.reshape(times.shape), surge.reshape(times.shape), (begun[0, -1], begun[1, -1])


def _moved(free: FreeDecay, motion: tuple[Doubles, Doubles], state: tuple[Doubles, Doubles]) -> tuple[Doubles, Doubles]:
    even, odd = motion
    swing, surge = state
    return even * swing + odd * surge, even * surge + free.square_root * odd * swing


def _after(free: FreeDecay, state: tuple[Doubles, Doubles], mass: float) -> tuple[Doubles, Doubles, Doubles]:
    """Return weights, displacement and velocity at nodes of the decay from a state, up to its first repetition."""
    horizon = _GONE / free.slowest
    if free.square_root < 0.0:
        horizon = min(horizon, pi / float(np.sqrt(-free.square_root)))
    stride = _PHASE / (free.slowest if free.square_root > 0.0 else free.natural)
    octaves = 2.0 ** np.arange(0.0, np.ceil(np.log2(max(stride * free.fastest, 1.0)))) / free.fastest
    edges = np.unique(
        np.concatenate([[0.0], octaves[octaves < horizon], np.arange(stride, horizon, stride), [horizon]])
    )
    time, weights = panels(edges, _NODES_OF_PANEL)
    even, odd = free(time[:, None])
    swing, surge = _moved(free, (even, odd), state)
    return weights[:, None], swing / mass, (surge - free.rate * swing) / mass


def _repeats(free: FreeDecay) -> float:
    """Return the factor of a ringing slider's decay over half a turn, with its sign; 0 if it has died away."""
    if free.square_root >= 0.0:
        return 0.0
    decay = free.rate * pi / float(np.sqrt(-free.square_root))
    return -float(np.exp(-decay)) if decay < _GONE else 0.0


@cache
def _running_integral() -> Doubles:
    """Return the matrix that takes weighted values at the nodes to their running integral at the same nodes."""
    x, w = np.polynomial.legendre.leggauss(_NODES_OF_PANEL)
    values = np.polynomial.legendre.legvander(x, _NODES_OF_PANEL - 1)
    integrals = np.stack(
        [
            np.polynomial.legendre.legval(x, np.polynomial.legendre.legint(row, lbnd=-1))
            for row in np.eye(_NODES_OF_PANEL)
        ],
        axis=1,
    )
    matrix: Doubles = (integrals * (np.arange(_NODES_OF_PANEL) + 0.5)) @ (values.T * w) / w
    return matrix


_NODES = 24
_PANEL_PHASE = 8.0  # of the slider across one panel of diameters; a fourth power has four times that
_AT_ONCE = 20_000
_GROWTH, _LEFT_OUT = 12, 1e-13
"""No average grows faster than this power of the diameter: an impulse grows as d^3, and its fourth power as d^12.

Large diameters that have a smaller share than the second number in the average of this power are left out.
"""
_ASKED: tuple[Powers, ...] = ((2, 0), (0, 2), (3, 0), (1, 2), (0, 3), (4, 0), (2, 2), (0, 4))


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionCumulants:
    """Stationary displacement x (um) and velocity x' (um/s): mean, stds, and cumulants of x/std x and x'/std x'.

    ``ratio(i, j)`` is kappa_ij / (std x^i std x'^j). Those with one x' (kappa_11, kappa_21, kappa_31) vanish.
    """

    mean: float
    displacement_std: float
    velocity_std: float
    ratios: dict[Powers, float]

    @property
    def skewness(self) -> float:
        """Skewness of the displacement."""
        return self.ratios[3, 0]

    @property
    def excess_kurtosis(self) -> float:
        """Excess kurtosis of the displacement."""
        return self.ratios[4, 0]


@lru_cache(maxsize=8)
def motion_cumulants(model: Model) -> MotionCumulants:
    """Return kappa_ij = lam V E[psi^(i+j)] E[int y^i y'^j dt], i + j up to 4, y the response to one junction of 1 MPa.

    Exact to a relative 1e-8 or so. Raises Refused without slider, strength, speed or damping, unless births are a
    Poisson process, and if the slider swings too often in one life (see `junction_response`).
    Source: cumulants of filtered shot noise (Rice 1944, section 1.5, doi:10.1002/j.1538-7305.1944.tb00874.x).
    """
    need_random_births(model, "the joint law of displacement and velocity", centred=True)
    if model.separation is not None:
        raise Refused("the joint law of displacement and velocity is known without a table [load] alone")
    drive = drive_of(model)
    if drive.slider.damping == 0.0:
        raise Refused("without damping the slider's motion is not stationary")
    rate = model.birth_rate * drive.speed
    averages = zip(_ASKED, _averages(model, drive), strict=True)
    values = {(i, j): rate * drive.strengths.moment(i + j) * average for (i, j), average in averages}
    displacement, velocity = values[2, 0] ** 0.5, values[0, 2] ** 0.5
    return MotionCumulants(
        mean=mean_displacement(model),
        displacement_std=displacement,
        velocity_std=velocity,
        ratios={(i, j): value / (displacement**i * velocity**j) for (i, j), value in values.items()},
    )


def _averages(model: Model, drive: Drive) -> list[float]:
    """Return E[int y^i y'^j dt] for some powers, with diameters close enough to follow the slider's phase."""
    low, high = size_range(model.sizes)
    cuts = np.linspace(low, high, 1 + int(drive.resonance * (high - low) / _PANEL_PHASE))[1:-1]
    diameters, probabilities = _sizes_that_count(*cut_size_rule(model.sizes, cuts, _NODES))
    batches = 1 + diameters.size * panels_of_half_a_life(drive, float(diameters.max())) // _AT_ONCE
    total = np.zeros(len(_ASKED))
    for some in np.array_split(np.arange(diameters.size), batches):
        response = junction_response(model.pulse, drive, diameters[some])
        total += [response.integrals(powers) @ probabilities[some] for powers in _ASKED]
    return [float(value) for value in total]


_FAR = 50.0  # standard deviations, beyond which Rice's rate is 0


def crossing_rate(model: Model, level: ArrayLike) -> Doubles:
    """Return how many times a second the displacement passes a level upwards (as often as down), in 1/s.

    nu(a) = int_0^inf v p(a, v) dv with p the joint density of x and x', by its Edgeworth series about Rice's
    nu_0 = (1/2 pi) (std x'/std x) exp(-z^2/2), z = (a - mean)/std x, to second order (cumulants k_ij in standard units,
    He_n Hermite's polynomials of z):
    nu / nu_0 = 1 + k30 He_3/6 + k12 He_1/2 + k40 He_4/24 + k22 He_2/4 - k04/24
                  + k30^2 He_6/72 + k30 k12 He_4/12 - k12^2 He_2/8 + k03^2/24.
    Levels in um, of any shape. Against the exact joint law the error at one size is below 1e-3 of the largest rate up
    to a skewness of x of 0.3, and below 5e-3 up to 0.45; beyond, take it for a guide. It is never below 0. At the
    paper's numbers the skewness is 0.006, and all of it close to Rice's. Raises Refused as `motion_cumulants` does.
    Source: Rice (1945), doi:10.1002/j.1538-7305.1945.tb00453.x; Longuet-Higgins (1963),
    doi:10.1017/S0022112063001452, for the series of a joint density.
    """
    motion = motion_cumulants(model)
    z = (np.asarray(level, dtype=np.float64) - motion.mean) / motion.displacement_std
    return gaussian_crossing_rate(model, level) * np.maximum(_correction(motion.ratios, np.clip(z, -_FAR, _FAR)), 0.0)


def gaussian_crossing_rate(model: Model, level: ArrayLike) -> Doubles:
    """Return Rice's rate nu_0 of upward passages in 1/s, exact for a Gaussian displacement; levels as above."""
    motion = motion_cumulants(model)
    z = (np.asarray(level, dtype=np.float64) - motion.mean) / motion.displacement_std
    return motion.velocity_std / (2.0 * pi * motion.displacement_std) * np.exp(-0.5 * np.square(z))


def _correction(k: dict[Powers, float], z: Doubles) -> Doubles:
    """Return nu / nu_0; sqrt(2 pi) int_0^inf v He_j(v) phi(v) dv is 1, 1, -1, 3 for j = 0, 2, 4, 6, and 0 for 3, 5."""
    first = [0.0, k[1, 2] / 2.0, 0.0, k[3, 0] / 6.0]
    second = [
        k[0, 3] ** 2 / 24.0 - k[0, 4] / 24.0,
        0.0,
        k[2, 2] / 4.0 - k[1, 2] ** 2 / 8.0,
        0.0,
        k[4, 0] / 24.0 + k[3, 0] * k[1, 2] / 12.0,
        0.0,
        k[3, 0] ** 2 / 72.0,
    ]
    return 1.0 + np.polynomial.hermite_e.hermeval(z, first) + np.polynomial.hermite_e.hermeval(z, second)


def _sizes_that_count(diameters: Doubles, probabilities: Doubles) -> tuple[Doubles, Doubles]:
    """Leave out the largest diameters, which take the most time, if all of them together change no average."""
    weights = probabilities * (diameters / diameters.max()) ** _GROWTH
    above = np.cumsum(weights[::-1])[::-1]
    counts = above > _LEFT_OUT * above[0]
    return diameters[counts], probabilities[counts]
