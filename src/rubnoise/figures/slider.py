"""The friction force and the vibration that it excites, and the spectrum of the vibration beside the exact one."""

from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import Spectrum, WelchSum
from rubnoise.errors import Refused
from rubnoise.figures.marks import NEAREST, entitle, exact_band, legend_above, not_too_near
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import BLUE, VERMILION, logarithmic, new_figure
from rubnoise.model import Slider
from rubnoise.theory.campbell import force_cumulants
from rubnoise.theory.response import response
from rubnoise.theory.response_spectrum import displacement_spectrum_per_hertz

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PERIODS: Final = 20.0
"""Natural periods that are shown where nobody chose a stretch."""

FEWEST_TICKS: Final = 16
SEGMENTS: Final = 12
FARTHEST: Final = 40.0
"""Natural frequencies up to which the spectrum is shown."""

POINTS: Final = 1500
MILLI: Final = 1e-3
Doubles = NDArray[np.float64]


def slider_figure(stretch: Stretch) -> "Figure":
    """Draw force and displacement in time, and, of a stretch with ticks enough, the displacement's spectrum.

    Raises Refused for a run without a slider.
    """
    model = stretch.model
    if model.slider is None or model.sliding_speed is None or "slider" not in stretch.file.columns:
        raise Refused("the run has no slider to draw; [slider] in its scenario would give it one")
    if model.is_two_way:
        raise Refused(
            "the picture beside the exact motion is of one-way coupling; rubnoise export and rubnoise.open give /slider"
            " and /landmarks of a two-way run"
        )
    shown = stretch.narrowed(PERIODS * model.sliding_speed / model.slider.natural_frequency)
    seen = _spectrum(stretch)
    figure = new_figure(7.2, 4.2 if seen is None else 6.6)
    entitle(figure, stretch, "The friction force, and the vibration that it excites")
    heights = [1.0, 1.0] if seen is None else [1.0, 1.0, 1.5]
    force, place, *below = figure.subplots(len(heights), 1, height_ratios=heights)
    place.sharex(force)
    exact, motion = force_cumulants(model), response(model)
    _draw_in_time(force, shown, "friction_force", MILLI, (exact.mean, exact.std))
    force.set_ylabel("friction force (mN)")
    force.tick_params(labelbottom=False)
    legend_above(force)
    _draw_in_time(place, shown, "displacement", 1.0, (motion.mean_displacement, motion.displacement_std))
    place.set_ylabel("displacement (µm)")
    place.set_xlabel("time (s)")
    if seen is not None:
        _draw_spectrum(below[0], stretch, model.slider, seen)
    return figure


def _draw_in_time(axes: "Axes", stretch: Stretch, name: str, scale: float, exact: tuple[float, float]) -> None:
    speed = stretch.model.sliding_speed or 1.0
    mean, std = exact
    exact_band(axes, scale * mean, scale * std)
    distance, values = stretch.curve("slider", name)
    axes.plot(distance / speed, scale * values, color=BLUE, lw=0.9, label="simulated")
    axes.set_xlim(stretch.start / speed, stretch.stop / speed)
    not_too_near(axes)


def _draw_spectrum(axes: "Axes", stretch: Stretch, slider: Slider, seen: Spectrum) -> None:
    """Draw one-sided densities over frequency: twice the two-sided ones over w, at w = 2 pi f."""
    lowest, natural = float(seen.wavenumber[1]) / (2.0 * pi), slider.natural_frequency
    highest = min(float(seen.wavenumber[-1]) / (2.0 * pi), max(FARTHEST * natural, 10.0 * lowest))
    shown = seen.wavenumber[1:] <= 2.0 * pi * highest
    label = f"simulated ({seen.segments} segments)"
    axes.plot(seen.wavenumber[1:][shown] / (2.0 * pi), 2.0 * seen.density[1:][shown], color=BLUE, lw=1.0, label=label)
    frequency = np.sort(np.append(np.geomspace(lowest, highest, POINTS), np.linspace(0.8, 1.2, POINTS) * natural))
    frequency = frequency[(lowest <= frequency) & (frequency <= highest)]
    _draw_exact(axes, stretch, frequency)
    for axis in (axes.xaxis, axes.yaxis):
        logarithmic(axis)
    axes.set_xlim(lowest, highest)
    axes.set_xlabel("frequency (Hz)")
    axes.set_ylabel("spectral density\nof displacement (µm²/Hz)")
    legend_above(axes)


def _draw_exact(axes: "Axes", stretch: Stretch, frequency: Doubles) -> None:
    """Draw the exact density where theory knows one, and regular births leave one."""
    try:
        exact = displacement_spectrum_per_hertz(stretch.model, frequency)
    except Refused:
        return
    if exact.any():
        axes.plot(frequency, exact, color=VERMILION, lw=1.0, label="exact")


def _spectrum(stretch: Stretch) -> Spectrum | None:
    """Return the two-sided spectrum of the displacement over w in rad/s.

    None for a stretch of too few ticks, and for a slider that nothing but rounding moves.
    """
    first, last = stretch.rows("slider")
    ticks = 2 * ((last - first) // (SEGMENTS + 1))
    if ticks < FEWEST_TICKS or stretch.model.tick_duration is None:
        return None
    total = WelchSum(ticks, stretch.model.tick_duration)
    for panel in stretch.panels("slider", "displacement"):
        total.add(panel)
    seen = total.spectrum()
    return seen if seen.power > (NEAREST * response(stretch.model).mean_displacement) ** 2 else None
