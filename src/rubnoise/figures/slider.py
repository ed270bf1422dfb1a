"""The friction force and the vibration that it excites, and the spectrum of the vibration beside the exact one."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from rubnoise.figures.marks import entitle, exact_band, legend_above, not_too_near
from rubnoise.figures.motion import Motion, motions_of, names_of, naming, shade_sticks
from rubnoise.figures.motion_spectrum import draw_spectra, looks, spectrum_of
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import new_figure
from rubnoise.theory.campbell import force_cumulants
from rubnoise.theory.response import response

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MILLI: Final = 1e-3


def slider_figure(stretch: Stretch, beside: Stretch | None = None) -> "Figure":
    """Draw force and displacement in time, and, of a stretch with rows enough, the displacement's spectrum.

    What is exact is known of one-way coupling alone; where a two-way slider sticks is shaded. Another run is laid over
    the first at the same times. Raises Refused for a run without a slider.
    """
    whole = motions_of(stretch, beside)
    shown = shown_together(stretch, whole)
    seen = [(motion, spectrum) for motion in whole if (spectrum := spectrum_of(motion, "displacement")) is not None]
    figure = new_figure(7.2, 6.6 if seen else 4.2)
    entitle(figure, stretch, "The friction force, and the vibration that it excites", beside)
    heights = [1.0, 1.0, 1.5] if seen else [1.0, 1.0]
    force, place, *below = figure.subplots(len(heights), 1, height_ratios=heights)
    place.sharex(force)
    _draw_in_time(force, shown, "friction_force", MILLI)
    force.set_ylabel("friction force (mN)")
    force.tick_params(labelbottom=False)
    legend_above(force)
    _draw_in_time(place, shown, "displacement", 1.0)
    place.set_ylabel("displacement (µm)")
    place.set_xlabel("time (s)")
    if seen:
        draw_spectra(below[0], seen, "displacement")
    figure.align_ylabels([force, place])
    return figure


def shown_together(stretch: Stretch, motions: Sequence[Motion]) -> list[Motion]:
    """Return the shown parts of motions: by default the beginning, and the same times of all of them.

    Raises Refused where one of them is over before another begins.
    """
    first = motions[0] if stretch.chosen else motions[0].beginning()
    shown = [first]
    for other in motions[1:]:
        with naming(f"--with {other.file.path}"):
            shown.append(other.between(first.begin, first.end))
    return shown


def _draw_in_time(axes: "Axes", motions: Sequence[Motion], name: str, scale: float) -> None:
    first, alone = motions[0], len(motions) == 1
    if alone and not first.model.is_two_way:
        mean, std = _exact(first, name)
        exact_band(axes, scale * mean, scale * std)
    labels = ["simulated"] if alone else names_of(motions)
    for motion, label, look in zip(motions, labels, looks(len(motions)), strict=True):
        time, values = motion.curve(name)
        axes.plot(time, scale * values, label=label, **look)
    shade_sticks(axes, next((motion for motion in motions if motion.model.is_two_way), first))
    axes.set_xlim(first.begin, first.end)
    not_too_near(axes)


def _exact(motion: Motion, name: str) -> tuple[float, float]:
    """Return the exact mean and standard deviation of the force or the displacement in one-way coupling."""
    if name == "friction_force":
        force = force_cumulants(motion.model)
        return force.mean, force.std
    exact = response(motion.model)
    return exact.mean_displacement, exact.displacement_std
