"""The figures of the paper, by name, with their titles, scenarios and drawing functions."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from rubnoise.errors import Refused
from rubnoise.figures.paper_junction import draw_fig2, draw_fig3
from rubnoise.figures.paper_sources import Sources
from rubnoise.figures.paper_spectra import draw_fig8, draw_fig9
from rubnoise.figures.paper_spread import draw_fig7
from rubnoise.figures.paper_traces import draw_fig4, draw_fig5, draw_fig6
from rubnoise.figures.style import Format, as_bytes, house_style
from rubnoise.scenario.sweep import load_either

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperFigure:
    """One figure of the paper: title, caption, the scenario files that it needs, and its drawing function."""

    title: str
    caption: str
    scenarios: tuple[str, ...]
    draw: Callable[[Sources], "Figure"]


FIGURES: Final[dict[str, PaperFigure]] = {
    "fig2": PaperFigure(
        title="Geometry of a junction",
        caption=(
            "Two truncated cones with tops of diameter d slide over each other. At a distance s after their first "
            "touch, the tops overlap in a lens (shaded), with the area of Eq. (2)."
        ),
        scenarios=("fig2.toml",),
        draw=draw_fig2,
    ),
    "fig3": PaperFigure(
        title="Life history of a junction",
        caption=(
            "The area rises to πd²/4 at s = d and falls to 0 at s = 2d. Its mean over the life is exactly d²/3; the "
            "paper prints 0.327 d². Rabinowicz's triangle has the same life and peak, and the mean πd²/8."
        ),
        scenarios=("fig3.toml",),
        draw=draw_fig3,
    ),
    "fig4": PaperFigure(
        title="The real contact area as a sum of junctions",
        caption=(
            "Part of the trace (above), and the areas of its junctions (below), from birth to death. The trace is "
            "their sum; one junction and its part are black. The band is the exact standard deviation about the exact "
            "mean."
        ),
        scenarios=("fig4.toml",),
        draw=draw_fig4,
    ),
    "fig5": PaperFigure(
        title="Excitation force and vibration",
        caption=(
            "Friction force, displacement and velocity, each with its exact mean and standard deviation. The lowest "
            "pane enlarges the velocity near zero: for nearly half of the time, the slider is faster than the drive. "
            "One-way coupling assumes a constant sliding speed, so the example breaks its own assumption."
        ),
        scenarios=("fig5.toml",),
        draw=draw_fig5,
    ),
    "fig6": PaperFigure(
        title="Traces for five numbers of junctions",
        caption=(
            "At the same mean area, more and smaller junctions fluctuate less. Each row is a run with its own seed. "
            "The histograms show the whole runs, with the exact densities."
        ),
        scenarios=tuple(f"fig6_n{count}.toml" for count in (10, 20, 30, 40, 50)),
        draw=draw_fig6,
    ),
    "fig7": PaperFigure(
        title="Standard deviation against the number of junctions",
        caption=(
            "Simulated standard deviations with 95 % intervals, and the exact curves. Divided by the mean, all "
            "follow one law, the paper's non-linear decrease: 1.2298/√N for junctions of one size. There, points of "
            "one number stand side by side."
        ),
        scenarios=("fig7.toml",),
        draw=draw_fig7,
    ),
    "fig8": PaperFigure(
        title="Spectral density of the real contact area",
        caption=(
            "Welch's estimate from a run, and the exact density. On linear axes it seems to end in a constant. On "
            "logarithmic axes it oscillates about 4λE[d²]/k⁴, because every pass goes through both centres. The floor "
            "is of the estimate alone: the ratio below shows how aliases of the ticks raise it."
        ),
        scenarios=("fig8.toml",),
        draw=draw_fig8,
    ),
    "fig9": PaperFigure(
        title="Spectral densities for five numbers of junctions",
        caption=(
            "The number of junctions changes the spectrum at low wavenumbers by an order of magnitude, and moves its "
            "corner. Divided by variance and mean life, all spectra follow one curve."
        ),
        scenarios=("fig9.toml",),
        draw=draw_fig9,
    ),
}


def caption(name: str) -> str:
    """Return the one to four sentences below a figure."""
    return FIGURES[name].caption


def chosen(names: Iterable[str]) -> tuple[str, ...]:
    """Return the named figures, in the paper's order; no name or `all` means every one.

    Raises Refused for an unknown name, with those that exist.
    """
    wanted = tuple(names) or ("all",)
    wrong = [name for name in wanted if name not in FIGURES and name != "all"]
    if wrong:
        raise Refused(f"{', '.join(wrong)}: no figure of the paper; there are {', '.join(FIGURES)}, and all")
    return tuple(name for name in FIGURES if name in wanted or "all" in wanted)


def check_sources(names: Iterable[str], folder: Path | None = None) -> None:
    """Read every scenario of some figures, from a folder or from the shipped ones; raises ScenarioRefused."""
    sources = Sources(folder=folder)
    for scenario in dict.fromkeys(scenario for name in names for scenario in FIGURES[name].scenarios):
        load_either(sources.path(scenario))


def paper_figure(name: str, formats: Iterable[Format], sources: Sources) -> dict[Format, bytes]:
    """Return a figure of the paper as the bytes of its files, which are equal at each call.

    Raises ScenarioRefused for its scenarios, PicturesMissing without matplotlib.
    """
    with house_style():
        figure = FIGURES[name].draw(sources)
        # Once for all formats, so that none depends on which others are wanted.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        return {kind: as_bytes(figure, kind) for kind in formats}
