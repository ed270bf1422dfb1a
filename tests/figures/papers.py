"""The scenarios of the paper's figures, made short: what is drawn of them is the same, only rougher."""

from pathlib import Path
from typing import Any

import numpy as np

from tests.architecture.sources import ROOT

PAPER = ROOT / "scenarios" / "paper"
DISTANCES = {"fig2": "500 um", "fig3": "500 um", "fig5": "1.1 mm", "fig7": "300 um", "fig8": "17 mm", "fig9": "17 mm"}
DISTANCES |= {f"fig6_n{count}": "1 mm" for count in (10, 20, 30, 40, 50)}


def short_papers(folder: Path, seed: int = 1) -> Path:
    """Write every scenario of the figures into a folder, each shortened by extending the real one."""
    for path in PAPER.glob("*.toml"):
        distance = DISTANCES.get(path.stem)
        lines = ["format = 1", f'extends = "{path}"', "[run]", f"seed = {seed}"]
        if distance is not None:
            lines += ["[sliding]", f'distance = "{distance}"']
        if path.stem == "fig7":
            lines += ["[sweep]", "replicates = 2", "[sweep.grid]", "interface.mean_junction_count = [10, 30, 50]"]
        if path.stem == "fig9":
            lines += ["[sweep.grid]", "interface.mean_junction_count = [10, 40]"]
        (folder / path.name).write_text("\n".join([*lines, ""]), encoding="utf-8")
    return folder


def of_colour(pixels: np.ndarray, colour: str) -> np.ndarray:
    """Return where an image has a colour."""
    wanted = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    return np.all(np.abs(pixels - wanted) < 0.03, axis=2)


def band_of(axes: Any) -> dict[float, float]:
    """Return two standard errors of each bin of a panel of ratios, by its place."""
    (band,) = (each for each in axes.collections if "std errors" in str(each.get_label()))
    corners = band.get_paths()[0].vertices
    return {float(x): float(np.abs(corners[corners[:, 0] == x][:, 1] - 1.0).max()) for x in np.unique(corners[:, 0])}
