"""What one junction of unit strength does to the one-way slider, from its birth until the slider rests."""

from dataclasses import dataclass
from functools import cache
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.pulses import Pulse
from rubnoise.errors import Refused
from rubnoise.theory.drive import Drive
from rubnoise.theory.free_motion import FreeMotion, free_motion
from rubnoise.theory.quadrature import panels

Doubles = NDArray[np.float64]
Powers = tuple[int, int]

_NODES = 16
_PHASE = 1.0  # of the faster exponent on one panel; a fourth power has four times that
_FEWEST, _MOST = 8, 5000
_GONE = 45.0  # decay, as an exponent, after which nothing is left


@dataclass(frozen=True, slots=True, kw_only=True)
class JunctionResponse:
    """Displacement (um) and velocity (um/s) of a slider for a junction of 1 MPa, at nodes in time with weights in s.

    A row a node and a column a diameter. ``life`` spans the junction's life; ``rest`` the decay after it, up to where
    it repeats itself smaller and mirrored: ``repeats`` is that factor, -exp(-a pi / w_d), or 0 where it just dies away.
    """

    life: tuple[Doubles, Doubles, Doubles]
    rest: tuple[Doubles, Doubles, Doubles]
    repeats: float

    def integrals(self, powers: Powers) -> Doubles:
        """Return int y^i y'^j dt over all time, for each diameter; a decay that repeats itself adds up as a series."""
        i, j = powers
        during, after = (np.sum(w * y**i * v**j, axis=0) for w, y, v in (self.life, self.rest))
        return during + after / (1.0 - self.repeats ** (i + j))


def junction_response(pulse: Pulse, drive: Drive, diameters: Doubles) -> JunctionResponse:
    """Return the response to junctions of these diameters in um.

    y(t) = int_0^t h(t - u) A(V u; d) du with h the impulse response; s = d (1 - cos phi) makes birth and death smooth,
    panels in phi end at mid-life, and the state at the end of each begins the next. Raises Refused where the slider
    swings or creeps too often in one life to be followed.
    """
    free = free_motion(drive.slider)
    half = panels_of_half_a_life(drive, float(diameters.max()))
    phi, weights = panels(np.linspace(0.0, pi, 2 * half + 1), _NODES)
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
    """Return how many panels follow a slider up to a junction's mid-life; raises Refused where they are too many."""
    count = ceil(0.5 * pi * free_motion(drive.slider).fastest * diameter / drive.speed / _PHASE)
    if count > _MOST:
        raise Refused("the slider swings too often within one junction's life to compute its level crossings")
    return max(_FEWEST, count)


def _driven(
    free: FreeMotion, times: Doubles, steps: Doubles, area: Doubles, ends: Doubles
) -> tuple[Doubles, Doubles, tuple[Doubles, Doubles]]:
    """Return int odd(t - u) A du and int even(t - u) A du at all nodes, and both at the end of the life.

    On one panel odd(t - u) = odd(t) even(-u) + even(t) odd(-u) and even(t - u) = even(t) even(-u) + r^2 odd(t) odd(-u).
    """
    count, sizes = ends.shape[0] - 1, ends.shape[1]
    local = times.reshape(count, _NODES, sizes) - ends[:-1, None]
    weights = steps.reshape(count, _NODES, sizes)
    lengths = np.diff(ends, axis=0)
    drive = area.reshape(count, _NODES, sizes) * weights
    back = [part * drive for part in free(-local)]
    forth, whole = free(local), free(lengths)
    inner = [np.einsum("qp,kps->kqs", _running_integral(), part) for part in back]
    total = [part.sum(axis=1) for part in back]
    swing, surge = np.empty_like(local), np.empty_like(local)
    state = (np.zeros(sizes), np.zeros(sizes))
    for panel in range(count):
        moved = _moved(free, (forth[0][panel], forth[1][panel]), state)
        added = _moved(free, (forth[0][panel], forth[1][panel]), (inner[1][panel], inner[0][panel]))
        swing[panel], surge[panel] = moved[0] + added[0], moved[1] + added[1]
        ended = (state[0] + total[1][panel], state[1] + total[0][panel])
        state = _moved(free, (whole[0][panel], whole[1][panel]), ended)
    return swing.reshape(times.shape), surge.reshape(times.shape), state


def _moved(
    free: FreeMotion, motion: tuple[Doubles, Doubles], state: tuple[Doubles, Doubles]
) -> tuple[Doubles, Doubles]:
    even, odd = motion
    swing, surge = state
    return even * swing + odd * surge, even * surge + free.square_root * odd * swing


def _after(free: FreeMotion, state: tuple[Doubles, Doubles], mass: float) -> tuple[Doubles, Doubles, Doubles]:
    """Return weights, displacement and velocity at nodes of the decay from a state, over what does not repeat."""
    horizon = _GONE / free.slowest
    if free.square_root < 0.0:
        horizon = min(horizon, pi / float(np.sqrt(-free.square_root)))
    stride = _PHASE / (free.slowest if free.square_root > 0.0 else free.natural)
    octaves = 2.0 ** np.arange(0.0, np.ceil(np.log2(max(stride * free.fastest, 1.0)))) / free.fastest
    edges = np.unique(
        np.concatenate([[0.0], octaves[octaves < horizon], np.arange(stride, horizon, stride), [horizon]])
    )
    time, weights = panels(edges, _NODES)
    even, odd = free(time[:, None])
    swing, surge = _moved(free, (even, odd), state)
    return weights[:, None], swing / mass, (surge - free.rate * swing) / mass


def _repeats(free: FreeMotion) -> float:
    """Return what half a turn leaves of a ringing slider, with its sign; 0 where it is gone by then."""
    if free.square_root >= 0.0:
        return 0.0
    decay = free.rate * pi / float(np.sqrt(-free.square_root))
    return -float(np.exp(-decay)) if decay < _GONE else 0.0


@cache
def _running_integral() -> Doubles:
    """Return the matrix that takes weighted values at the nodes to their running integral at the same nodes."""
    x, w = np.polynomial.legendre.leggauss(_NODES)
    values = np.polynomial.legendre.legvander(x, _NODES - 1)
    integrals = np.stack(
        [np.polynomial.legendre.legval(x, np.polynomial.legendre.legint(row, lbnd=-1)) for row in np.eye(_NODES)],
        axis=1,
    )
    matrix: Doubles = (integrals * (np.arange(_NODES) + 0.5)) @ (values.T * w) / w
    return matrix
