"""Records of real contact area drawn from the model's definition, with nothing of the simulator."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model

Doubles = NDArray[np.float64]


def drawn_trace(model: Model, tick: float, count: int, seed: int) -> Doubles:
    """Return A_r at ``count`` ticks of one stationary record; births uniform over it and a longest life before."""
    generator = np.random.default_rng(seed)
    longest = 2.0 * model.sizes.support[1]
    number = generator.poisson(model.birth_rate * (count * tick + longest))
    births = generator.uniform(-longest, count * tick, number)
    diameters = model.sizes.draw(generator.random(number))
    first = np.ceil(births / tick).astype(int)
    trace = np.zeros(count)
    for step in range(int(longest / tick) + 2):
        at = first + step
        inside = (at >= 0) & (at < count)
        areas = model.pulse.area(at[inside] * tick - births[inside], diameters[inside])
        trace += np.bincount(at[inside], areas, minlength=count)
    return trace


def periodograms(segments: Doubles, window: Doubles, tick: float, *, detrend: bool = True) -> Doubles:
    """Return P(k) of each row by the plain definition."""
    held = segments - segments.mean(axis=1, keepdims=True) if detrend else segments
    return tick * np.square(np.abs(np.fft.rfft(window * held, axis=1))) / np.sum(np.square(window))
