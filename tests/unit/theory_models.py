"""Contacts and records for tests of theory: models, wide size laws, regular births, drawn records."""

from dataclasses import dataclass, replace
from math import ceil, exp, lgamma, log

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.distributions import Fixed, Law, Normal
from rubnoise.contact.laws import Spread, law_for
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.model import Model, Slider

# Models for the tests of the theory, built from the laws directly, and the score of a sample variance.
FIG5_SLIDER = Slider(mass=0.005, stiffness=300.0, damping=0.05)


def model_of(
    sizes: Law,
    mean_diameter: float,
    mean_count: float = 20.0,
    slider: Slider | None = None,
    speed: float = 1000.0,
    distance: float = 40_000.0,
    tick: float = 0.05,
    pulse: Pulse = LENS,
) -> Model:
    """Return a model with N_jm/(2 d_m) births per um and a strength of 250 MPa."""
    return Model(
        mean_real_contact_area=200.0,
        mean_junction_count=mean_count,
        calibration="paper",
        calibrated_diameter=mean_diameter,
        sizes=sizes,
        births=PoissonBirths(mean_spacing=2.0 * mean_diameter / mean_count),
        strengths=Fixed(value=250.0),
        sliding_speed=speed,
        distance=distance,
        start="stationary",
        slider=slider,
        tick=tick,
        tick_count=round(distance / tick),
        pulse=pulse,
    )


def paper_model(
    mean_area: float = 200.0,
    mean_count: float = 20.0,
    spread: float = 0.2,
    calibration: str = "paper",
    slider: Slider | None = FIG5_SLIDER,
    speed: float = 1000.0,
) -> Model:
    """Return the model of the paper's Fig. 5, or a neighbour of it."""
    law = Spread(absolute=spread)
    diameter = calibrated_diameter(calibration, mean_area, mean_count, law)
    return model_of(law_for(diameter, law), diameter, mean_count, slider=slider, speed=speed)


def one_size(diameter: float = 5.53, slider: Slider | None = None, speed: float = 1000.0) -> Model:
    """Return a contact of junctions of one diameter."""
    return model_of(Fixed(value=diameter), diameter, slider=slider, speed=speed)


def excess(values: NDArray[np.float64], error: float) -> float:
    """Return z of the sample variance of estimates against error^2, its spread from their own fourth moment."""
    ratio = values.var(ddof=1) / error**2
    kurtosis = np.mean((values - values.mean()) ** 4) / values.var() ** 2
    return float((ratio - 1.0) / np.sqrt((kurtosis - 1.0) / values.size))


# Wide size laws for the tests of the theory, each written from its density and its moments alone.
Doubles = NDArray[np.float64]


@dataclass(frozen=True)
class WideLaw:
    """What the theory asks of a law, without draws."""

    mean: float
    relative_spread: float

    def draw(self, uniform: Doubles) -> Doubles:
        raise AssertionError("the theory draws nothing")

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> Doubles:
        raise AssertionError("the theory draws nothing")


@dataclass(frozen=True)
class LogNormal(WideLaw):
    """log d is normal."""

    @property
    def log_variance(self) -> float:
        return log(1.0 + self.relative_spread**2)

    def moment(self, power: int) -> float:
        return self.mean**power * exp(0.5 * power * (power - 1) * self.log_variance)

    def density(self, diameter: Doubles) -> Doubles:
        z = (np.log(diameter / self.mean) + 0.5 * self.log_variance) / self.log_variance**0.5
        return np.exp(-0.5 * z * z) / (diameter * np.sqrt(2.0 * np.pi * self.log_variance))

    @property
    def support(self) -> tuple[float, float]:
        low, high = (np.exp(-0.5 * self.log_variance + z * self.log_variance**0.5) for z in (-8.3, 8.3))
        return self.mean * float(low), self.mean * float(high)


@dataclass(frozen=True)
class Gamma(WideLaw):
    """A gamma law; with a relative spread of 1 it is exponential, with more its density is singular at 0."""

    @property
    def order(self) -> float:
        return self.relative_spread**-2

    def moment(self, power: int) -> float:
        return (self.mean / self.order) ** power * exp(lgamma(self.order + power) - lgamma(self.order))

    def density(self, diameter: Doubles) -> Doubles:
        x = np.maximum(diameter * (self.order / self.mean), np.finfo(float).tiny)
        return np.exp((self.order - 1.0) * np.log(x) - x - lgamma(self.order)) * (self.order / self.mean)

    @property
    def support(self) -> tuple[float, float]:
        return 0.0, self.mean * (1.0 + 37.0 * self.relative_spread * max(1.0, self.relative_spread))


# Contacts with regular births, and draws from them that know nothing of the theory.
DIAMETER = 5.53


def regular(
    mean_count: float,
    spread: float = 0.0,
    pulse: Pulse = LENS,
    slider: Slider | None = None,
    sizes: Law | None = None,
) -> Model:
    """Return a contact with births at a spacing of one life over the mean count."""
    equal = Fixed(value=DIAMETER) if spread == 0.0 else Normal(centre=DIAMETER, std=spread)
    model = model_of(sizes or equal, DIAMETER, mean_count, pulse=pulse, slider=slider)
    return replace(model, births=RegularBirths(mean_spacing=2.0 * DIAMETER / mean_count))


def drawn(model: Model, lags: list[float], draws: int, generator: np.random.Generator) -> tuple[Doubles, Doubles]:
    """Return friction force per strength drawn (or area) and count, a row each lag, at places of independent phase."""
    spacing, longest = model.births.mean_spacing, 2.0 * model.sizes.support[1]
    phase = generator.uniform(0.0, spacing, draws)
    area, count = np.zeros((len(lags), draws)), np.zeros((len(lags), draws))
    for number in range(-ceil(max(lags) / spacing) - 1, ceil(longest / spacing) + 1):
        diameter = model.sizes.quantile(generator.random(draws))
        strength = 1.0 if model.strengths is None else model.strengths.quantile(generator.random(draws))
        for row, lag in enumerate(lags):
            age = phase + number * spacing + lag
            area[row] += strength * model.pulse.area(age, diameter)
            count[row] += (age >= 0.0) & (age < 2.0 * diameter)
    return area, count


# Records of real contact area drawn from the model's definition, with nothing of the simulator.
def drawn_trace(model: Model, tick: float, count: int, seed: int) -> Doubles:
    """Return A_r at ``count`` ticks of one stationary record; births uniform over it and a longest life before."""
    generator = np.random.default_rng(seed)
    longest = 2.0 * model.sizes.support[1]
    number = generator.poisson(model.birth_rate * (count * tick + longest))
    births = generator.uniform(-longest, count * tick, number)
    diameters = model.sizes.quantile(generator.random(number))
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


# Records whose law is known, for the tests of estimators.
def white(count: int, seed: int) -> Doubles:
    """Return independent unit normals about 3."""
    return 3.0 + np.random.default_rng(seed).standard_normal(count)


def memory(count: int, seed: int, kept: float = 0.9) -> Doubles:
    """Return a stationary Gaussian record of unit variance whose autocorrelation at lag j is kept^j (AR(1))."""
    from scipy.signal import lfilter

    noise = np.random.default_rng(seed).standard_normal(count) * np.sqrt(1.0 - kept**2)
    start = np.random.default_rng(seed + 1).standard_normal()
    found: Doubles = lfilter([1.0], [1.0, -kept], noise, zi=np.array([kept * start]))[0]
    return found
