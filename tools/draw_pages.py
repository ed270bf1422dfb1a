"""Draw the pictures that explain the model: `.venv/bin/python tools/draw_pages.py`, after `tools/dev.py sync`.

Each goes to docs/pictures/drawn as NAME.svg for a light page and NAME-dark.svg for a dark one. Curves are those of the
program: spectra from `rubnoise.exact`, the tree from the groups of a run. All are so narrow that a phone shows their
letters.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle

import rubnoise

FOLDER: Final = Path(__file__).resolve().parent.parent / "docs" / "pictures" / "drawn"
BLUE, ORANGE, GREEN, PALE = "#2f7ed8", "#e07b1a", "#2a9d63", "#8a8f98"
INK: Final = {"": "#1b1f24", "-dark": "#e3e6ea"}
WIDTH: Final = 5.2
"""Of a picture, in inches: 11 points are 10 px on a phone."""
TREE_WIDTH: Final = 4.0


def sketch() -> Figure:
    """Draw two surfaces that touch at junctions, and the slider on its spring and damper."""
    figure, axes = plt.subplots(figsize=(WIDTH, 3.2))
    _bare(axes, (0.2, 15.0), (0.0, 7.9))
    x = np.linspace(0.4, 9.6, 400)
    lower = 1.9 + 0.28 * np.sin(2.1 * x) + 0.12 * np.sin(5.3 * x + 1.0)
    upper = 2.28 + 0.25 * np.sin(2.7 * x + 2.0) + 0.14 * np.sin(6.1 * x)
    axes.fill_between(x, lower, 0.5, color=PALE, alpha=0.45)
    axes.fill_between(x, np.maximum(upper, lower), 4.6, color=BLUE, alpha=0.35)
    touch = upper <= lower
    for run in np.split(np.flatnonzero(touch), np.flatnonzero(np.diff(np.flatnonzero(touch)) > 1) + 1):
        if run.size:
            axes.plot(x[run], lower[run], color=ORANGE, linewidth=4.0, solid_capstyle="round")
    axes.text(5.0, 3.7, "slider, mass $m$", ha="center")
    axes.text(5.0, 0.85, "surface that moves", ha="center")
    pointer = {"arrowstyle": "-", "color": mpl.rcParams["text.color"]}
    axes.annotate("junction", (x[touch][0], lower[touch][0]), (0.4, 5.2), arrowprops=pointer)
    _arrow(axes, (1.0, 0.15), (3.0, 0.15), "$V$", (3.35, 0.02))
    _arrow(axes, (4.0, 5.0), (5.4, 5.0), "$x$", (5.65, 4.88))
    zigzag = np.linspace(9.6, 14.2, 13)
    axes.plot(zigzag, 3.95 + 0.28 * np.array([0, 0, *[1, -1] * 4, 1, 0, 0]), color=GREEN)
    axes.text(11.9, 4.55, "spring $k$", ha="center", color=GREEN)
    axes.plot([9.6, 11.6], [3.0, 3.0], [12.2, 14.2], [3.0, 3.0], color=GREEN)
    axes.plot([12.2, 11.4, 11.4, 12.2], [3.35, 3.35, 2.65, 2.65], color=GREEN)
    axes.plot([11.6, 11.6], [2.8, 3.2], color=GREEN)
    axes.plot([12.2, 12.2], [2.65, 3.35], color=GREEN)
    axes.text(11.9, 1.95, "damper $c$", ha="center", color=GREEN)
    axes.add_patch(Rectangle((14.2, 2.2), 0.4, 2.6, color=PALE))
    axes.text(14.4, 1.5, "wall", ha="center")
    axes.text(
        7.0,
        6.4,
        "friction force $F_s$:\nshear strength $\\psi$ times real contact area $A_r$",
        ha="center",
        color=ORANGE,
    )
    return figure


def life() -> Figure:
    """Draw two circles at five distances of a life, above the area that they share."""
    figure, (stage, curve) = plt.subplots(2, 1, figsize=(WIDTH, 4.0), height_ratios=(1.0, 1.5))
    _bare(stage, (-0.6, 2.6), (-0.42, 0.62))
    stage.set_aspect("auto")
    ratio = 3.2 / 1.04 * (1.0 / WIDTH) / (1.0 / 1.5)
    for s in (0.0, 0.5, 1.0, 1.5, 2.0):
        for centre, colour in ((s + 0.16 * (s - 1.0), BLUE), (s - 0.16 * (s - 1.0), ORANGE)):
            circle = Circle((0.0, 0.0), 0.16, facecolor=colour, alpha=0.4, edgecolor=colour)
            scale = mpl.transforms.Affine2D().scale(1.0, 1.0 / ratio).translate(centre, 0.0)
            circle.set_transform(scale + stage.transData)
            stage.add_patch(circle)
    for s, words in ((0.0, "birth"), (1.0, "mid-life"), (2.0, "death")):
        stage.text(s, 0.5, words, ha="center")
    distance = np.linspace(0.0, 2.0, 201)
    x = np.abs(1.0 - distance)
    area = 0.5 * (np.arccos(x) - x * np.sqrt(1.0 - x * x))
    curve.plot(distance, area, color=BLUE, linewidth=2.0)
    curve.fill_between(distance, area, color=BLUE, alpha=0.2)
    curve.axhline(1.0 / 3.0, color=ORANGE, linestyle="--")
    curve.text(-0.57, 0.36, "mean over\na life $d^2/3$", color=ORANGE)
    curve.text(1.0, 0.06, "area under\nthe curve\n$\\frac{2}{3}\\,d^3$", ha="center")
    curve.set(xlim=(-0.6, 2.6), ylim=(0.0, 0.9), xticks=(0.0, 0.5, 1.0, 1.5, 2.0), yticks=(0.0, np.pi / 4.0))
    curve.set_xticklabels(("0", "$d/2$", "$d$", "$3d/2$", "$2d$"))
    curve.set_yticklabels(("0", "$\\pi d^2/4$"))
    curve.set(xlabel="sliding distance since birth $s$", ylabel="area $A_j$")
    return figure


def family() -> Figure:
    """Draw the spectra of the family's members on the same axes, each over the square of its mean."""
    figure, axes = plt.subplots(figsize=(WIDTH, 5.8))
    k = np.geomspace(0.01, 6.0, 500)
    contact = rubnoise.build(
        {
            "format": 1,
            "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20, "calibration": "exact"},
            "sliding": {"distance": "1 mm"},
        }
    )
    rough = {"pulse.shape": "parabola", "diameter.law": "weibull", "diameter.spread": "52.2723 %"}
    for changes, colour, style, words in (
        ({}, mpl.rcParams["text.color"], "-", "the paper: lenses at random"),
        ({"birth.law": "clustered", "birth.cluster_size": 3, "birth.cluster_width": "2 um"}, ORANGE, "-", "clustered"),
        ({"birth.law": "gamma", "birth.shape": 4}, BLUE, "-", "gamma gaps, shape 4"),
        ({"birth.law": "jittered", "birth.jitter": "30 %"}, GREEN, "-", "jittered"),
        ({"pulse.shape": "triangle"}, PALE, "-", "Rice and Moslehy: triangles at random"),
        (rough | {"interface.calibration": "matched"}, ORANGE, "--", "two rough surfaces: parabolas"),
    ):
        theory = rubnoise.exact(contact.replace(changes))
        level = theory.spectral_density(k) / theory.area.mean**2
        axes.loglog(k, level, color=colour, linestyle=style, label=words)
        if not changes:
            axes.axhline(level[0], color=PALE, linestyle=":", label="Kilburn: white noise")
    axes.annotate(
        "no noise: Bowden and Tabor,\nBlock (mean alone), Rabinowicz,\nGreenwood and Williamson",
        (0.012, 2e-8),
    )
    axes.set(xlabel="wavenumber $k$ (rad/µm)", ylabel="spectrum over mean$^2$ (µm)", ylim=(1e-8, 10.0))
    figure.legend(loc="outside upper left")
    return figure


def corner() -> Figure:
    """Draw the spectra of the friction force of three contacts of one mean area."""
    figure, axes = plt.subplots(figsize=(WIDTH, 3.6))
    k = np.geomspace(0.02, 6.0, 400)
    strength = 250.0
    for count, colour in ((5, BLUE), (20, ORANGE), (80, GREEN)):
        theory = rubnoise.exact(rubnoise.example("paper/fig5").replace({"interface.mean_junction_count": count}))
        level = strength**2 * theory.spectral_density(k)
        axes.loglog(k, level, color=colour, label=f"{count} junctions of {theory.mean_diameter:.1f} µm")
        at = 2.25 / theory.mean_diameter
        axes.plot([at], [strength**2 * theory.spectral_density(at)], "o", color=colour)
    axes.annotate("level: number and strength", (0.021, 1.7e10), ha="left")
    axes.annotate("corner (dots),\n$k\\,d \\approx 2.25$: size", (0.75, 1e9), ha="left")
    axes.set(xlabel="wavenumber $k$ (rad/µm)", ylabel="spectrum of $F_s$ (µN² µm)", ylim=(1e4, 1e11))
    axes.legend(loc="lower left")
    return figure


def tree() -> Figure:
    """Draw the groups of a result, with the columns of each below its name."""
    run = rubnoise.simulate(rubnoise.example("paper/fig5").replace({"sliding.distance": "60 um"}))
    rows = [(f"/{name}", _wrapped(list(group))) for name, group in run.groups().items()]
    rows += [("/summary", ["what was measured, beside theory"]), ("/provenance", ["how to repeat it"])]
    height = sum(len(lines) + 1.3 for _, lines in rows) + 1.5
    figure, axes = plt.subplots(figsize=(TREE_WIDTH, 0.2 * height))
    _bare(axes, (0.0, 10.0), (height, -1.0))
    axes.text(0.0, 0.0, "fig5.h5", weight="bold")
    y = 1.4
    for name, lines in rows:
        axes.plot([0.15, 0.15, 0.5], [0.5, y, y], color=PALE, linewidth=1.0)
        axes.text(0.65, y, name, color=BLUE, weight="bold", va="center")
        for row, words in enumerate(lines, 1):
            axes.text(0.65, y + row, words, va="center", fontsize=9.5)
        y += len(lines) + 1.3
    return figure


PICTURES: Final[dict[str, Callable[[], Figure]]] = {
    "sketch": sketch,
    "life": life,
    "corner": corner,
    "family": family,
    "tree": tree,
}


def main(names: list[str]) -> int:
    """Draw the pictures that are named, or all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in names or PICTURES:
        for suffix, ink in INK.items():
            with plt.style.context(_style(ink)):
                figure = PICTURES[name]()
                metadata = {"Date": None, "Creator": None}
                figure.savefig(FOLDER / f"{name}{suffix}.svg", bbox_inches="tight", transparent=True, metadata=metadata)
                plt.close(figure)
        print(f"docs/pictures/drawn/{name}.svg")
    return 0


def _style(ink: str) -> dict[str, Any]:
    colours = ("text.color", "axes.labelcolor", "xtick.color", "ytick.color", "axes.edgecolor", "lines.color")
    return {
        **dict.fromkeys(colours, ink),
        "font.size": 11.0,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "legend.frameon": False,
        "svg.hashsalt": "rubnoise",
        "svg.fonttype": "path",
        "figure.constrained_layout.use": True,
    }


def _bare(axes: Axes, across: tuple[float, float], up: tuple[float, float]) -> None:
    axes.set(xlim=across, ylim=up)
    axes.axis("off")


Place = tuple[float, float]


def _arrow(axes: Axes, start: Place, end: Place, words: str, at: Place) -> None:
    ink = mpl.rcParams["text.color"]
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle="-|>", mutation_scale=14, color=ink))
    axes.text(*at, words)


def _wrapped(names: list[str], width: int = 44) -> list[str]:
    lines = [""]
    for name in names:
        longer = f"{lines[-1]}, {name}" if lines[-1] else name
        lines[-1:] = [longer] if len(longer) <= width else [f"{lines[-1]},", name]
    return lines


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
