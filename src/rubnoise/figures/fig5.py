"""Figure 5: the excitation force, and the vibration of what holds the slider."""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.api import simulate
from rubnoise.errors import Refused
from rubnoise.figures.marks import exact_band, legend_above
from rubnoise.figures.sources import Sources, envelope
from rubnoise.figures.style import BLUE, INK, STUCK, new_figure
from rubnoise.record.rows import Phase
from rubnoise.theory.exact import exact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SECONDS: Final = 1.0
"""How much is shown: some forty periods of the slider."""

PER_MILLI: Final = 1e-3


def draw(sources: Sources) -> "Figure":
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
    figure = new_figure(7.2, 5.4)
    force, displacement, velocity = figure.subplots(3, 1, sharex=True)
    for axes, name, mean, std, scale in (
        (force, "friction_force", theory.force.mean, theory.force.std, PER_MILLI),
        (displacement, "displacement", theory.slider.mean_displacement, theory.slider.displacement_std, 1.0),
        (velocity, "velocity", 0.0, theory.slider.velocity_std, PER_MILLI),
    ):
        if model.is_two_way:
            _shade(axes, motion["time"][shown], motion["phase"][shown] == Phase.STICK)
        else:
            exact_band(axes, scale * mean, scale * std)
        axes.plot(*envelope(motion["time"][shown], scale * motion[name][shown]), color=BLUE, lw=0.9, label="simulated")
    _label(force, displacement, velocity)
    velocity.axhline(PER_MILLI * theory.slider.sliding_speed, color=INK, lw=1.2, label="sliding speed", zorder=5)
    for axes in (force, velocity):
        legend_above(axes)
    velocity.set_xlim(0.0, motion["time"][shown][-1])
    return figure


def _shade(axes: "Axes", time: NDArray[np.float64], stuck: NDArray[np.bool_]) -> None:
    across = axes.get_xaxis_transform()
    axes.fill_between(time, 0.0, 1.0, where=stuck, transform=across, color=STUCK, lw=0.0, zorder=0, label="stick")


def _label(force: "Axes", displacement: "Axes", velocity: "Axes") -> None:
    force.set_ylabel("friction force (mN)")
    # A two-way slider that runs back feels the force from the other side.
    force.set_ylim(bottom=min(0.0, force.get_ylim()[0]) if force.dataLim.y0 < 0.0 else 0.0)
    displacement.set_ylabel("displacement (µm)")
    velocity.set_ylabel("velocity (mm/s)")
    velocity.set_xlabel("time (s)")
    force.figure.align_ylabels([force, displacement, velocity])
