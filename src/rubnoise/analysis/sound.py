"""A run as sound: the column, the speed-up, the level, and its samples at another rate, without aliases."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil, floor, inf, log10, pi
from typing import Final, Literal, Self

import numpy as np

from rubnoise.analysis.measured import UNITS
from rubnoise.analysis.moments import forgetting
from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles, slices
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.model import Model
from rubnoise.record.rows import Reader
from rubnoise.scenario.reading import stored
from rubnoise.storage.sound import check_length

Heard = Literal["displacement", "velocity", "force", "normal-velocity", "load"]
"""What of a slider is heard, and has a spectrum over frequency."""

COLUMNS: Final[dict[Heard, str]] = {
    "velocity": "velocity",
    "force": "friction_force",
    "displacement": "displacement",
    "normal-velocity": "velocity",
    "load": "load",
}
_PEAK: Final = 10.0 ** (-3.0 / 20.0)  # how far the loudest sample goes of full scale: 3 dB below it
_SEGMENTS: Final = 8  # of Welch's method
_FEWEST_TICKS, _MOST_TICKS = 16, 1 << 17  # of one
_NOTHING: Final = 1e-9  # of the mean: what varies less is rounding


EAR, COMFORTABLE, LAPTOP = (20.0, 20_000.0), (100.0, 5000.0), (200.0, 4000.0)
"""Frequencies in Hz that the young and healthy hear, that most people hear well, and that a laptop plays."""

_AIM: Final = 300.0  # Hz, to which a suggestion moves the middle of the power


@dataclass(frozen=True, slots=True, kw_only=True)
class Hearing:
    """Shares of a sound's power between 20 Hz and 20 kHz, and in the band of a laptop's loudspeaker.

    ``middle`` is the frequency in Hz below which half of the power lies.
    """

    audible: float
    laptop: float
    middle: float


@dataclass(frozen=True, kw_only=True, eq=False)
class Sound:
    """Rows of a column of a run, from ``first`` on, that are heard as samples, ``rate`` a second.

    Before ``first`` the start of the normal motion under a load decays. ``ratio`` is samples over ticks, and
    ``tick_duration`` the time in s from tick to tick in the run. ``natural`` is the natural frequency in Hz of the
    motion that is heard, None without one.
    """

    file: Reader
    what: Heard
    group: str
    units: str
    first: int
    values: Doubles
    tick_duration: float
    rate: int
    ratio: Fraction
    samples: int
    natural: float | None

    @classmethod
    def of(cls, file: Reader, what: Heard, *, rate: int, speed_up: float) -> Self:
        """Return the sound of an open run without a transient, faster than the run by a factor.

        The velocity of a run with a load that weighs, and without a slider, is its normal velocity. Raises Refused if
        the run has no such column, and for a factor with more than 4096 ticks for a sample or samples for a tick.
        """
        group, model = _group(file, what), stored(file.provenance["scenario_resolved"]).model()
        if model.tick_duration is None:
            raise Refused("the run has no times, so nothing is heard; sliding.speed in its scenario would give them")
        ratio = rate_ratio(speed_up / model.tick_duration, rate)
        if not ratio:
            usual = rate * model.tick_duration
            raise Refused(
                f"--speed-up {speed_up:g}: with a tick every {model.tick_duration:.4g} s and {rate} samples a second"
                f" it goes from {usual / MOST:.3g} to {usual * MOST:.3g}"
            )
        first = _first_row(file, model, group)
        values = file.column(group, COLUMNS[what], first)
        weighed = None if model.separation is None else model.separation.oscillator
        swinging = weighed if group == "load" else model.slider
        return cls(
            file=file,
            what="normal-velocity" if group == "load" and what == "velocity" else what,
            group=group,
            units=UNITS[COLUMNS[what]],
            first=first,
            values=values,
            tick_duration=model.tick_duration,
            rate=rate,
            ratio=ratio,
            samples=output_count(values.size, ratio),
            natural=None if swinging is None else swinging.natural_frequency,
        )

    @property
    def speed_up(self) -> float:
        """How much faster it is than the run: as was wanted, up to the precision of the ratio."""
        return self.rate * self.tick_duration / float(self.ratio)

    @property
    def seconds(self) -> float:
        """How long it is heard."""
        return self.samples / self.rate

    def lasting(self, seconds: float) -> Self:
        """Return the sound up to a time in s from its start; raises Refused beyond its end, or what a file holds."""
        if seconds > self.seconds:
            raise Refused(f"--seconds {seconds:g}: the sound of the whole run lasts {self.seconds:.6g} s")
        samples = max(1, round(seconds * self.rate))
        check_length(samples)
        return replace(self, samples=samples, values=self.values[: ceil((samples - 1) / self.ratio) + 1])

    @property
    def mean(self) -> float:
        """Mean of the rows in the unit of the column."""
        return float(self.values.mean())

    @property
    def varying(self) -> Doubles:
        """The rows less their mean.

        Raises Refused for a column that does not vary, RunFileRefused for values that are no numbers.
        """
        if not np.isfinite(self.values).all():
            raise RunFileRefused(f"/{self.group}/{COLUMNS[self.what]} is damaged: it holds what is no number")
        away = self.values - self.mean
        if np.abs(away).max() <= _NOTHING * abs(self.mean):
            raise Refused(f"the {self.what} does not vary, so there is nothing to hear")
        return away

    @cached_property
    def wave(self) -> Doubles:
        """The samples, less the mean, in the unit of the column."""
        return resampled(self.varying, self.ratio)[: self.samples]

    @property
    def full_scale(self) -> float:
        """The scale that leaves the loudest sample 3 dB below it."""
        return float(np.abs(self.wave).max()) / _PEAK

    def pieces(self, full_scale: float, between: Callable[[], None]) -> Iterator[Doubles]:
        """Yield the samples over a full scale, from -1 to 1, in pieces; ``between`` is called and may raise to stop."""
        for part in slices(0, self.samples):
            between()
            yield self.wave[part] / full_scale

    @cached_property
    def hearing(self) -> Hearing | None:
        """What ears make of the rows, as fast as they are heard; None of a run too short to say."""
        ticks = 2 * min(self.values.size // (_SEGMENTS + 1), _MOST_TICKS)
        if ticks < _FEWEST_TICKS:
            return None
        spectrum = welch([self.varying], ticks, self.tick_duration / self.speed_up)
        frequency, power = spectrum.wavenumber[1:] / (2.0 * pi), spectrum.density[1:] / spectrum.density[1:].sum()
        audible, laptop = (float(power[(frequency >= low) & (frequency <= high)].sum()) for low, high in (EAR, LAPTOP))
        middle = frequency[np.searchsorted(np.cumsum(power), 0.5)]
        return Hearing(audible=audible, laptop=laptop, middle=float(middle))

    def laptop_level(self, full_scale: float) -> float | None:
        """Return the level in dB re a full scale of what a laptop's loudspeaker plays; None if that is not known."""
        if self.hearing is None:
            return None
        power = self.hearing.laptop * float(self.values.var()) / full_scale**2
        return 10.0 * log10(power) if power > 0.0 else -inf

    @property
    def better(self) -> float | None:
        """A speed-up, 1, 2 or 5 times a power of ten, that brings the middle near 300 Hz.

        None if the middle is between 100 Hz and 5 kHz, or not known.
        """
        if self.hearing is None or COMFORTABLE[0] <= self.hearing.middle <= COMFORTABLE[1]:
            return None
        wanted = self.speed_up * _AIM / self.hearing.middle
        power = 10.0 ** floor(log10(wanted))
        return min((factor * power for factor in (1.0, 2.0, 5.0, 10.0)), key=lambda near: abs(log10(near / wanted)))


def _group(file: Reader, what: Heard) -> str:
    """Return the group that has a quantity; raises Refused if the run has none."""
    weighs = "load" in file.columns
    if what in ("normal-velocity", "load") or (what == "velocity" and "slider" not in file.columns and weighs):
        if not weighs:
            raise Refused(f"the run has no {what.replace('-', ' ')}; a table [load] in its scenario would give it one")
        return "load"
    if "slider" in file.columns and COLUMNS[what] in file.columns["slider"]:
        return "slider"
    if what != "force":
        raise Refused(
            f"the run has no slider, and so no {what}; --what force is the force that would drive one,"
            " [slider] in the scenario would give it one"
        )
    if COLUMNS[what] not in file.columns["trace"]:
        raise Refused("the run has no friction force to hear; [strength] in its scenario would give it one")
    return "trace"


def _first_row(file: Reader, model: Model, group: str) -> int:
    """Return the first row at which the start is no longer heard; raises Refused if no row is left."""
    if group != "load" or model.separation is None:
        return 0
    first = forgetting(model)["load"]
    if first + 1 >= file.rows(group):
        raise Refused(
            f"the run is too short: the first {first * model.tick:g} um are the transient of the normal motion, which"
            " begins at rest; sliding.distance in its scenario makes it longer"
        )
    return first


MOST: Final = 4096  # numerator and denominator of a ratio of sample rates at most
CROSSINGS: Final = 64
"""Zero crossings of the filter on each side, at the lower of the two rates."""

PASSED: Final = 0.9
"""Share of the lower rate's half that passes within `RIPPLE`; what would fold is held down to `RIPPLE`."""

RIPPLE: Final = 2e-5
_SHAPE: Final = 10.06  # Kaiser's beta for 100 dB, 0.1102 (100 - 8.7)


def rate_ratio(source: float, target: float) -> Fraction:
    """Return target over source as a fraction of two numbers up to 4096; 0 if the ratio is beyond 1/4096 ... 4096.

    The fraction is within 1 part in 4096, and exact if the ratio is such a fraction.
    """
    ratio = target / source
    if not 1.0 / MOST <= ratio <= MOST:
        return Fraction(0)
    if ratio >= 1.0:
        return Fraction(ratio).limit_denominator(max(1, int(MOST / ceil(ratio))))
    return 1 / rate_ratio(target, source)


def resampled(values: Doubles, ratio: Fraction) -> Doubles:
    """Return a record at ``ratio`` times its rate.

    y_n = sum_j x_j h(n q - j p), ratio = p/q. h is a sinc under a Kaiser window over 64 zero crossings on each side:
    up to 0.9 of the lower rate's half amplitudes are kept to 2e-5, from that half on they are held down to it. Output 0
    lies at input 0, the last at or before the last input; beyond its ends the record is taken as constant.
    Source: Oppenheim and Schafer, Discrete-Time Signal Processing (1989), chapters 3 and 7.
    """
    from scipy.signal import resample_poly

    up, down = ratio.numerator, ratio.denominator
    wide = resample_poly(values, up, down, window=_taps(up, down), padtype="edge")
    return np.asarray(wide[: output_count(values.size, ratio)], dtype=np.float64)


def _taps(up: int, down: int) -> Doubles:
    """Return the filter at p times the rate of the inputs, whose sum is one."""
    half = CROSSINGS * max(up, down)
    edge = 0.5 * (1.0 + PASSED) / max(up, down)
    taps = np.sinc(edge * np.arange(-half, half + 1)) * np.kaiser(2 * half + 1, _SHAPE)
    return np.asarray(taps / taps.sum(), dtype=np.float64)


def output_count(inputs: int, ratio: Fraction) -> int:
    """Return the number of outputs for a number of inputs."""
    return 0 if inputs == 0 else int((inputs - 1) * ratio) + 1
