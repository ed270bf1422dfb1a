"""The spectra of the points of a sweep one above the other, each beside the exact one."""

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Final

import numpy as np

from rubnoise.analysis.sound import Heard
from rubnoise.api.sweep_result import SweepResult
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.area_statistics import UNIT, area_spectrum
from rubnoise.figures.axis_labels import key_words, shown_unit
from rubnoise.figures.motion import Motion
from rubnoise.figures.motion_spectrum import FARTHEST, FIRST, QUANTITIES, is_expected, spectrum_of, whose
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import (
    BLUE,
    INK,
    VERMILION,
    legend_above,
    logarithmic,
    new_figure,
    one_line,
    put_title,
    shortened,
)
from rubnoise.theory.second_order import spectral_density

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_CURVES: Final = 12
APART: Final = 10.0
"""Factor between neighbours: each curve is drawn a decade above the one before."""

LONGEST_LABEL: Final = 24
POINTS: Final = 400
"""Points of an exact curve, and as many about the natural frequency."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """The spectrum of one run over ``place``, and the exact one as places and densities; None without theory."""

    label: str
    place: Doubles
    density: Doubles
    exact: tuple[Doubles, Doubles] | None


def waterfall_figure(sweep: SweepResult, heard: Heard | None = None) -> "Figure":
    """Draw the spectrum of the first finished run of each point, a decade above the one before, with the exact one.

    The points are those along the key with the most values; every other key has its first value. ``heard`` is whose
    spectrum is drawn over Hz; None draws that of the real contact area over wavenumber. Raises Refused for a sweep
    without results of its runs, and for runs that have no such spectrum.
    """
    key, points = _chosen(sweep)
    curves = [_curve(sweep, point, key, heard) for point in points]
    figure = new_figure(6.4, 1.6 + 0.5 * len(curves))
    axes = figure.subplots()
    for row, curve in enumerate(curves):
        _draw(axes, curve, APART**row, named=row == 0)
    logarithmic(axes.xaxis, axes.yaxis)
    axes.set_xlim(min(curve.place[0] for curve in curves), max(curve.place[-1] for curve in curves))
    axes.set_xlabel("wavenumber (rad/µm)" if heard is None else "frequency (Hz)")
    words, unit = ("real contact area", UNIT) if heard is None else (whose(heard), QUANTITIES[heard].density_unit)
    axes.set_ylabel(f"spectral density of {words}\n({unit}), times 1, 10, 100, ...")
    legend_above(axes)
    name = shortened(one_line(sweep.path.resolve().name))
    put_title(figure, f"Spectra over {key_words(key)}", f"sweep {name}{_others(sweep, key, points[0])}")
    return figure


def _chosen(sweep: SweepResult) -> tuple[str, list[int]]:
    """Return the key with the most values and the points along it; of very many points some, evenly spread."""
    counts = {key: len({str(values[key]) for values in sweep.values}) for key in sweep.keys}
    key = max(sweep.keys, key=lambda each: counts[each])
    along = {key} if key in sweep.grid else set(sweep.side_by_side)
    first = sweep.values[0]
    fixed = [each for each in sweep.keys if each not in along]
    points = [n for n, values in enumerate(sweep.values) if all(values[each] == first[each] for each in fixed)]
    places = np.linspace(0, len(points) - 1, min(len(points), MOST_CURVES)).round().astype(int)
    return key, [points[place] for place in places.tolist()]


def _others(sweep: SweepResult, key: str, point: int) -> str:
    """Return what the other swept keys are in all curves, as the end of a title."""
    along = {key} if key in sweep.grid else set(sweep.side_by_side)
    texts = [
        f"{key_words(each)} {shown_unit(str(sweep.values[point][each]))}" for each in sweep.keys if each not in along
    ]
    return f", {one_line(', '.join(texts))}" if texts else ""


def _curve(sweep: SweepResult, point: int, key: str, heard: Heard | None) -> Curve:
    label = shortened(one_line(shown_unit(str(sweep.values[point][key]))), LONGEST_LABEL)
    runs, states = sweep.runs["run_id"][:], sweep.runs["state"][:]
    done = np.flatnonzero((sweep.runs["point"][:] == point) & (states == "done"))
    if not done.size:
        raise Refused(f"spectra: the point {key_words(key)} {label} has no finished run")
    with sweep.run(str(runs[done[0]])) as run:
        stretch = Stretch.of(run.reader())
        return (
            _of_area(stretch, label)
            if heard is None
            else _of_motion(Motion.of(stretch, QUANTITIES[heard].group, QUANTITIES[heard].column), heard, label)
        )


def _of_area(stretch: Stretch, label: str) -> Curve:
    seen = area_spectrum(stretch)
    place = seen.wavenumber[1:]
    fine = np.geomspace(place[0], place[-1], POINTS)
    exact = spectral_density(stretch.model, fine)
    known = stretch.model.free is None and exact.any()  # of free motion there is no such theory
    return Curve(label=label, place=place, density=seen.density[1:], exact=(fine, exact) if known else None)


def _of_motion(motion: Motion, heard: Heard, label: str) -> Curve:
    seen = spectrum_of(motion, heard)
    if seen is None:
        raise Refused(f"spectra: the run at {label} is too short, or its {heard} does not vary")
    quantity, natural = QUANTITIES[heard], 2.0 * pi * motion.frequency
    last = int(np.searchsorted(seen.wavenumber, FARTHEST * natural))
    angular, density = seen.wavenumber[FIRST:last], seen.density[FIRST:last]
    scale = 2.0 * quantity.scale**2
    exact = None
    if is_expected(motion, heard):
        fine = np.sort(
            np.append(np.geomspace(angular[0], angular[-1], POINTS), natural * np.linspace(0.8, 1.2, POINTS))
        )
        exact = fine / (2.0 * pi), scale * quantity.exact(motion.model, fine)
    return Curve(label=label, place=angular / (2.0 * pi), density=scale * density, exact=exact)


def _draw(axes: "Axes", curve: Curve, factor: float, *, named: bool) -> None:
    axes.plot(curve.place, factor * curve.density, color=BLUE, lw=0.7, label="simulated" if named else None)
    if curve.exact is not None:
        place, density = curve.exact
        axes.plot(place, factor * density, color=VERMILION, lw=1.1, label="exact" if named else None)
    at = (curve.place[-1], factor * curve.density[-1])
    axes.annotate(curve.label, at, xytext=(4, 0), textcoords="offset points", va="center", fontsize="small", color=INK)
