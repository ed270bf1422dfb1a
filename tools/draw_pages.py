"""Draw the pictures that pages need beside those of runs: `python3 tools/dev.py generate drawings`.

Each goes to docs/pictures/drawn as NAME.svg for a light page and NAME-dark.svg for a dark one. Curves are those of the
program: spectra from `rubnoise.exact`. All are so narrow that a phone shows their letters. sketch.svg and life.svg hold
no data, and are files of their own.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import rubnoise

FOLDER: Final = Path(__file__).resolve().parent.parent / "docs" / "pictures" / "drawn"
BLUE, ORANGE, GREEN, PALE = "#2f7ed8", "#e07b1a", "#2a9d63", "#8a8f98"
INK: Final = {"": "#1b1f24", "-dark": "#e3e6ea"}
WIDTH: Final = 5.2
"""Of a picture, in inches: 11 points are 10 px on a phone."""


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


PICTURES: Final[dict[str, Callable[[], Figure]]] = {
    "corner": corner,
    "family": family,
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


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
