"""Spectra of a slider's motion, force and load over frequency, beside the exact ones if theory has them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.landmarks import first_landmark
from rubnoise.analysis.sound import COLUMNS, Heard
from rubnoise.analysis.spectra import Spectrum, WelchSum, hann
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.area_statistics import relative_error
from rubnoise.figures.motion import Group, Motion, labels_of, motions_of
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import (
    BLUE,
    FAINT,
    INK,
    NEAREST,
    VERMILION,
    add_title,
    draw_band,
    draw_ratio,
    legend_above,
    logarithmic,
    new_figure,
)
from rubnoise.model import Model
from rubnoise.theory.ancestors import white_spectrum
from rubnoise.theory.motion import FORCE, density_of, motion_spectrum, need_friction, response
from rubnoise.theory.sampling import through_window

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST_ROWS: Final = 16
FIRST: Final = 2
"""The first bin that is drawn: the mean that is subtracted from each segment changes those before."""

SEGMENTS: Final = 12
PERIODS: Final = 400.0
STICKS: Final = 40.0
"""Natural periods and mean times from stick to stick that a segment holds at most: the rest makes more segments."""

FARTHEST: Final = 40.0
"""Natural frequencies up to which a spectrum is shown."""

POINTS: Final = 1500


@dataclass(frozen=True, slots=True, kw_only=True)
class Audible:
    """A column of a picture: its group, the factor to the unit on the axis, and the exact two-sided density.

    ``white`` is the density for white noise of the same level at low frequency (Kilburn), None if it is unknown.
    ``still`` is the scale of a slider at rest: variations much smaller than it are rounding.
    """

    column: str
    scale: float
    unit: str
    exact: Callable[[Model, Doubles], Doubles]
    still: Callable[[Motion], float]
    white: Callable[[Model, Doubles], Doubles] | None = None
    group: Group = "slider"

    @property
    def density_unit(self) -> str:
        """Unit of the spectrum."""
        return f"({self.unit})²/Hz" if "/" in self.unit else f"{self.unit}²/Hz"


def _exact_force(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F(w/V)/V, the two-sided density of the force in uN^2 per rad/s."""
    need_friction(model)
    if model.strengths is None or model.sliding_speed is None:
        raise Refused("the spectrum of the force over frequency needs [strength] and sliding.speed")
    speed = model.sliding_speed
    return density_of(model, FORCE, angular_frequency / speed) / speed


def _mean_force(motion: Motion) -> float:
    """Return the mean force in uN."""
    if motion.swings is not None:
        return motion.slider.stiffness * _deflection(motion)
    strengths = motion.model.strengths
    return 0.0 if strengths is None else strengths.mean * motion.model.mean_real_contact_area


def _deflection(motion: Motion) -> float:
    """Return the deflection of a slider by the mean force, in um."""
    return response(motion.model).mean_displacement


def _weight(motion: Motion) -> float:
    """Return the load in uN."""
    held = motion.model.held
    return 0.0 if held is None else held.load


QUANTITIES: Final[dict[Heard, Audible]] = {
    "displacement": Audible(
        column=COLUMNS["displacement"],
        scale=1.0,
        unit="µm",
        exact=partial(motion_spectrum, "displacement"),
        white=partial(white_spectrum, "displacement"),
        still=_deflection,
    ),
    "velocity": Audible(
        column=COLUMNS["velocity"],
        scale=1e-3,
        unit="mm/s",
        exact=partial(motion_spectrum, "velocity"),
        white=partial(white_spectrum, "velocity"),
        still=lambda motion: motion.slider.natural_angular_frequency * _deflection(motion),
    ),
    "force": Audible(
        column=COLUMNS["force"],
        scale=1e-3,
        unit="mN",
        exact=_exact_force,
        white=partial(white_spectrum, FORCE),
        still=_mean_force,
    ),
    "normal-velocity": Audible(
        column=COLUMNS["normal-velocity"],
        scale=1e-3,
        unit="mm/s",
        exact=partial(motion_spectrum, "normal_velocity"),
        still=lambda motion: motion.slider.natural_angular_frequency * _weight(motion) / motion.slider.stiffness,
        group="load",
    ),
    "load": Audible(
        column=COLUMNS["load"],
        scale=1e-3,
        unit="mN",
        exact=partial(motion_spectrum, "load"),
        still=_weight,
        group="load",
    ),
}


NATURAL: Final[dict[Group, str]] = {
    "slider": "natural frequency",
    "load": "contact resonance",
    "trace": "one per mean life",
}
"""What the frequency of a motion is called."""


def whose(heard: Heard) -> str:
    """Return a quantity in words."""
    return heard.replace("-", " ")


def motion_spectrum_figure(stretch: Stretch, heard: Heard, beside: Stretch | None = None) -> "Figure":
    """Draw the one-sided spectrum of a quantity over frequency in Hz, of another run too if given.

    Raises Refused for runs without that motion, for too short a stretch, and if nothing but rounding varies.
    """
    motions = motions_of(stretch, beside, QUANTITIES[heard].group, QUANTITIES[heard].column)
    found = [spectrum_of(motion, heard) for motion in motions]
    for motion, seen in zip(motions, found, strict=True):
        if seen is None:
            needed = FEWEST_ROWS * (SEGMENTS + 1) / 2 * motion.apart
            raise Refused(f"a spectrum needs {needed:.3g} s of a {whose(heard)} that varies")
    pairs = list(zip(motions, filter(None, found), strict=True))
    compared = next((pair for pair in pairs if is_expected(pair[0], heard)), None)
    figure = new_figure(7.2, 4.4 if compared is None else 5.6)
    add_title(figure, stretch, f"The spectrum of the {whose(heard)}", beside)
    if compared is None:
        draw_spectra(figure.subplots(), pairs, heard)
        return figure
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.6, 1])
    draw_spectra(above, pairs, heard)
    _draw_ratio(below, *compared, heard, above, labels_of(motions)[pairs.index(compared)])
    above.set_xlabel("")
    return figure


def is_expected(motion: Motion, heard: Heard) -> bool:
    """Whether theory knows the spectrum of a motion: one-way, damped, in contact, and not only of lines."""
    if motion.model.is_two_way or motion.model.free is not None:
        return False
    try:
        natural = np.array([2.0 * pi * motion.frequency])
        return bool(QUANTITIES[heard].exact(motion.model, natural).any())
    except Refused:
        return False


def _draw_ratio(axes: "Axes", motion: Motion, seen: Spectrum, heard: Heard, above: "Axes", label: str) -> None:
    """Draw the estimate over its expectation, whose band is drawn in the axes above."""
    last = int(np.searchsorted(seen.wavenumber, 2.0 * pi * above.get_xlim()[1], side="right")) - 1
    exact = partial(QUANTITIES[heard].exact, motion.model)
    expected = through_window(exact, motion.apart, hann(seen.ticks), last)[FIRST:]
    frequency = seen.wavenumber[FIRST : last + 1] / (2.0 * pi)
    error = relative_error(seen)
    draw_ratio(axes, frequency, seen.density[FIRST : last + 1] / expected, error, label)
    draw_band(above, frequency, 2.0 * QUANTITIES[heard].scale ** 2 * expected, error)
    legend_above(above)
    axes.set_xlabel("frequency (Hz)")


def spectrum_of(motion: Motion, heard: Heard) -> Spectrum | None:
    """Return the two-sided spectrum of a column over w in rad/s, in the square of its unit per rad/s.

    None for too few rows, and if nothing but rounding varies.
    """
    quantity = QUANTITIES[heard]
    rows = 2 * (min(2 * (motion.last - motion.first) // (SEGMENTS + 1), _longest_segment(motion)) // 2)
    if rows < FEWEST_ROWS:
        return None
    total = WelchSum(rows, motion.apart)
    for chunk in motion.chunks(quantity.column):
        total.add(chunk)
    seen = total.spectrum()
    rounding = NEAREST * quantity.still(motion)
    return seen if seen.power > rounding**2 else None


def _longest_segment(motion: Motion) -> int:
    """Return the rows of a long enough segment: many natural periods and, for a slider that sticks, many sticks."""
    duration = PERIODS / motion.frequency
    if motion.model.is_two_way:
        sticks = first_landmark(motion.file, motion.end) - first_landmark(motion.file, motion.begin)
        duration = max(duration, STICKS * 2.0 * (motion.end - motion.begin) / max(sticks, 1))
    return int(duration / motion.apart)


def draw_spectra(axes: "Axes", found: Sequence[tuple[Motion, Spectrum]], heard: Heard) -> None:
    """Draw one-sided densities over frequency, twice the two-sided ones over w at w = 2 pi f, and the exact one.

    The exact density is a line for a one-way slider, and dashes if all sliders are two-way.
    """
    quantity = QUANTITIES[heard]
    natural = found[0][0].frequency
    lowest = min(float(seen.wavenumber[FIRST]) for _, seen in found) / (2.0 * pi)
    fastest = max(float(seen.wavenumber[-1]) for _, seen in found) / (2.0 * pi)
    highest = min(fastest, max(FARTHEST * natural, 10.0 * lowest))
    labels = [f"simulated ({found[0][1].segments} segments)"]
    if len(found) > 1:
        labels = labels_of([motion for motion, _ in found])
    for (_, seen), label, look in zip(found, labels, curve_styles(len(found)), strict=True):
        frequency = seen.wavenumber[FIRST:] / (2.0 * pi)
        shown = frequency <= highest
        density = 2.0 * (2.0 * pi * quantity.scale**2) * seen.density[FIRST:] / (2.0 * pi)
        axes.plot(frequency[shown], density[shown], label=label, **look)
    name = NATURAL[found[0][0].group]
    axes.axvline(natural, color=FAINT, lw=0.8, ls=(0, (1, 2)), zorder=0, label=name)
    _draw_exact(axes, [motion for motion, _ in found], quantity, lowest, highest)
    logarithmic(axes.xaxis, axes.yaxis)
    axes.set_xlim(lowest, highest)
    axes.set_xlabel("frequency (Hz)")
    axes.set_ylabel(f"spectral density\nof {whose(heard)} ({quantity.density_unit})")
    legend_above(axes)


def _draw_exact(axes: "Axes", motions: Sequence[Motion], quantity: Audible, lowest: float, highest: float) -> None:
    """Draw the exact density of one-way coupling, if theory knows it and it is not only of lines."""
    shown = next((motion for motion in motions if not motion.model.is_two_way), motions[0])
    if shown.model.free is not None:
        return
    natural = shown.frequency
    frequency = np.sort(np.append(np.geomspace(lowest, highest, POINTS), np.linspace(0.8, 1.2, POINTS) * natural))
    frequency = frequency[(lowest <= frequency) & (frequency <= highest)]
    try:
        exact = 2.0 * quantity.scale**2 * quantity.exact(shown.model, 2.0 * pi * frequency)
    except Refused:
        return
    if exact.any():
        elsewhere = all(motion.model.is_two_way for motion in motions)
        look: dict[str, Any] = {"ls": (0, (4, 2)), "label": "exact, one-way"} if elsewhere else {"label": "exact"}
        axes.plot(frequency, exact, color=VERMILION, lw=1.0, **look)
        if shown.model.separation is not None or quantity.white is None or shown.swings is None or shown.driven_by_base:
            return
        white = 2.0 * quantity.scale**2 * quantity.white(shown.model, 2.0 * pi * frequency)
        if white.any():
            axes.plot(frequency, white, color=INK, lw=0.8, ls=(0, (1, 1.5)), label="white noise (Kilburn)")


def curve_styles(count: int) -> list[dict[str, Any]]:
    """Return the styles of the curves of one run or two: with two, the first is broad and pale."""
    if count == 1:
        return [{"color": BLUE, "lw": 0.9}]
    return [
        {"color": "#6fb3df", "lw": 1.8, "solid_joinstyle": "round"},
        {"color": "#04213a", "lw": 0.8},
    ]
