"""Figures 4 to 6 of the paper: traces of the real contact area, the force, and the vibration."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.api import simulate
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.area import mark_ends
from rubnoise.figures.paper_sources import Sources, envelope
from rubnoise.figures.style import (
    AREA,
    BLUE,
    DISTANCE,
    FAINT,
    INK,
    STUCK,
    VERMILION,
    exact_band,
    legend_above,
    new_figure,
)
from rubnoise.record.rows import Phase
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.distribution import distribution
from rubnoise.theory.exact import exact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rubnoise.model import Model

LIFE_SAMPLES: Final = 41


def draw_fig4(sources: Sources) -> "Figure":
    """Draw A_r over the whole of a short run, below it the area of every junction, and in both one life in black."""
    scenario = sources.scenario("fig4.toml")
    model, record = scenario.model(), simulate(scenario)
    figure = new_figure(7.2, 4.4)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
    exact = area_cumulants(model)
    exact_band(above, exact.mean, exact.std)
    trace = record["trace"]
    above.plot(
        *envelope(trace["distance"], trace["real_contact_area"]),
        color=BLUE,
        lw=1.5,
        label="sum of the junctions, simulated",
    )
    rows = record["junctions"]
    one = int(np.searchsorted(rows["birth_distance"], 0.5 * model.distance))
    _draw_part(above, trace, rows, model, one)
    above.set_ylabel(AREA)
    above.set_ylim(bottom=0.0)
    legend_above(above)
    _draw_junctions(below, rows, model, one)
    mark_ends(below, 0.0, model.distance, rows["birth_distance"], rows["death_distance"])
    legend_above(below)
    below.set_ylabel("junction area (µm²)")
    below.set_xlabel(DISTANCE)
    below.set_xlim(0.0, model.distance)
    return figure


def _draw_part(axes: "Axes", trace: dict[str, Any], rows: dict[str, Any], model: "Model", one: int) -> None:
    """Fill what one junction adds to the sum."""
    birth, death = rows["birth_distance"][one], rows["death_distance"][one]
    lived = (trace["distance"] >= birth) & (trace["distance"] < death)
    distance, total = trace["distance"][lived], trace["real_contact_area"][lived]
    own = model.pulse.area(distance - birth, rows["diameter"][one])
    axes.fill_between(distance, total - own, total, color=INK, lw=0.0, label="the part of one junction")


def _draw_junctions(axes: "Axes", rows: dict[str, Any], model: "Model", chosen: int) -> None:
    """Draw every life, and the chosen one on top so that the eye finds a whole one."""
    births, diameters = rows["birth_distance"], rows["diameter"]
    age = 1.0 - np.cos(np.linspace(0.0, np.pi, LIFE_SAMPLES))
    for row, (birth, diameter) in enumerate(zip(births, diameters, strict=True)):
        one = row == chosen
        axes.plot(
            birth + age * diameter,
            model.pulse.area(age * diameter, diameter),
            color=INK if one else FAINT,
            lw=1.6 if one else 0.5,
            zorder=3 if one else 1,
            label=f"this one of {births.size}" if one else None,
        )
    axes.set_ylim(0.0, 1.1 * float(0.25 * np.pi * diameters.max() ** 2))


SECONDS: Final = 1.0
"""How much is shown: some forty periods of the slider."""

NEAR_SECONDS: Final = 0.2
NEAR_SPEEDS: Final = 6.0
"""How much of the velocity is drawn once more, and up to how many sliding speeds."""

PER_MILLI: Final = 1e-3


def draw_fig5(sources: Sources) -> "Figure":
    """Draw force, displacement and velocity over the first second, each about its exact mean and spread.

    These are exact for one-way coupling. Of a two-way slider, in a reader's scenario, sticks are shaded instead.
    """
    scenario = sources.scenario("fig5.toml")
    model = scenario.model()
    theory = exact(model)
    if theory.force is None or theory.slider is None:
        raise Refused("fig5.toml: the figure needs a strength and a slider")
    motion = simulate(scenario)["slider"]
    shown = slice(0, int(np.searchsorted(motion["time"], SECONDS)) + 1)
    figure = new_figure(7.2, 7.0)
    force, displacement, velocity, near = figure.subplots(4, 1)
    for axes, name, mean, std, scale in (
        (force, "friction_force", theory.force.mean, theory.force.std, PER_MILLI),
        (displacement, "displacement", theory.slider.mean_displacement, theory.slider.displacement_std, 1.0),
        (velocity, "velocity", 0.0, theory.slider.velocity_std, PER_MILLI),
    ):
        if model.is_two_way:
            _shade(axes, motion["time"][shown], motion["phase"][shown] == Phase.STICK, "stick")
        else:
            exact_band(axes, scale * mean, scale * std)
        axes.plot(*envelope(motion["time"][shown], scale * motion[name][shown]), color=BLUE, lw=0.9, label="simulated")
    _label_motion(force, displacement, velocity)
    _draw_near_zero(near, motion, theory.slider.sliding_speed, stuck=model.is_two_way)
    legend_above(force)
    for axes in (force, displacement, velocity):
        axes.set_xlim(0.0, motion["time"][shown][-1])
        axes.tick_params(labelbottom=axes is velocity)
    figure.align_ylabels()
    return figure


def _draw_near_zero(axes: "Axes", motion: dict[str, Any], drive: float, *, stuck: bool) -> None:
    """Draw the velocity once more near zero and the drive's speed, and shade where it is above that, or sticks."""
    known = motion["time"] <= NEAR_SECONDS
    time, velocity, speed = motion["time"][known], PER_MILLI * motion["velocity"][known], PER_MILLI * drive
    if stuck:
        _shade(axes, time, motion["phase"][known] == Phase.STICK, "stick")
    else:
        _shade(axes, time, velocity > speed, "slider faster than the drive")
    axes.plot(time, velocity, color=BLUE, lw=1.2)
    axes.axhline(0.0, color=FAINT, lw=0.8)
    axes.axhline(speed, color=INK, lw=1.2, ls=(0, (5, 2)), label=f"sliding speed, {speed:.3g} mm/s")
    axes.set_xlim(0.0, time[-1])
    axes.set_ylim(-NEAR_SPEEDS * speed, NEAR_SPEEDS * speed)
    axes.set_ylabel("velocity near\nzero (mm/s)")
    axes.set_xlabel("time (s), the beginning of the curves above")
    legend_above(axes)


def _shade(axes: "Axes", time: Doubles, where: NDArray[np.bool_], label: str) -> None:
    across = axes.get_xaxis_transform()
    axes.fill_between(time, 0.0, 1.0, where=where, transform=across, color=STUCK, lw=0.0, zorder=0, label=label)


def _label_motion(force: "Axes", displacement: "Axes", velocity: "Axes") -> None:
    force.set_ylabel("friction force (mN)")
    # A two-way slider that runs back feels the force from the other side.
    force.set_ylim(bottom=min(0.0, force.get_ylim()[0]) if force.dataLim.y0 < 0.0 else 0.0)
    displacement.set_ylabel("displacement (µm)")
    velocity.set_ylabel("velocity (mm/s)")
    velocity.set_xlabel("time (s)")


COUNTS: Final = (10, 20, 30, 40, 50)
SHOWN_DISTANCE: Final = 1000.0
"""How much of each trace is drawn, in um; the histograms are of the whole runs."""

HIGHEST: Final = 560.0
BINS: Final = 56
DENSITY_SAMPLES: Final = 600


def draw_fig6(sources: Sources) -> "Figure":
    """Draw a trace and a histogram for each number of junctions, all on one scale of areas."""
    figure = new_figure(7.2, 7.4)
    rows = figure.subplots(len(COUNTS), 2, sharex="col", sharey=True, width_ratios=[2.6, 1.0])
    densities = []
    for (trace, histogram), count in zip(rows, COUNTS, strict=True):
        scenario = sources.scenario(f"fig6_n{count}.toml")
        record = simulate(scenario)["trace"]
        _draw_trace(trace, record["distance"], record["real_contact_area"])
        densities.append(_draw_histogram(histogram, scenario.model(), record["real_contact_area"]))
        trace.set_title(f"{count} junctions on average")
    rows[-1][1].set_xlim(0.0, 1.05 * max(densities))
    _label_rows(rows)
    figure.supylabel("real contact area (µm²)", fontsize=9.0)
    return figure


def _draw_trace(axes: "Axes", distance: Doubles, area: Doubles) -> None:
    shown = slice(0, int(np.searchsorted(distance, SHOWN_DISTANCE)) + 1)
    axes.plot(*envelope(distance[shown], area[shown]), color=BLUE, lw=0.8)
    axes.set_xlim(0.0, SHOWN_DISTANCE)
    axes.set_ylim(0.0, HIGHEST)


def _draw_histogram(axes: "Axes", model: "Model", area: Doubles) -> float:
    """Draw a histogram and the exact density, and return the highest density."""
    edges = np.linspace(0.0, HIGHEST, BINS + 1)
    share = np.histogram(area, edges)[0] / (area.size * np.diff(edges))
    axes.stairs(share, edges, orientation="horizontal", fill=True, color=BLUE, alpha=0.4, lw=0.0, label="simulated")
    areas = np.linspace(0.0, HIGHEST, DENSITY_SAMPLES)[1:]
    density = distribution(model).density(areas)
    axes.plot(density, areas, color=VERMILION, lw=1.3, label="exact")
    return float(max(share.max(), density.max()))


def _label_rows(rows: "NDArray[np.object_]") -> None:
    rows[0][1].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1, columnspacing=1.0)
    rows[-1][0].set_xlabel("sliding distance (µm)")
    rows[-1][1].locator_params(axis="x", nbins=3)
    rows[-1][1].xaxis.set_major_formatter("{x:g}")
    rows[-1][1].set_xlabel("density (1/µm²)")
