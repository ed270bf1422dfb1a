"""What is exact about a model in one picture: distribution, autocovariance, spectrum, and the slider's response."""

from collections.abc import Callable
from contextlib import suppress
from math import pi
from textwrap import fill
from typing import Any, Final

import numpy as np

from rubnoise.errors import Refused
from rubnoise.figures import Axes, Figure, style
from rubnoise.model import Model
from rubnoise.theory.moments import area_cumulants, distribution
from rubnoise.theory.motion import motion_spectrum, response
from rubnoise.theory.second_order import area_noise, autocovariance, covariance_reach, spectral_density, tail

POINTS: Final = 1200
REACH: Final = 4.5
LAGS: Final = 300
LITTLE: Final = 0.01


@style.house_style()
def theory_figure(model: Model, title: str) -> Figure:
    """Draw distribution, autocovariance and spectrum of A_r, and the spectrum of a slider's displacement.

    ``title`` says what the model is from. A pane of what theory does not know says so.
    """
    area = area_cumulants(model)
    figure = style.new_figure(7.6, 5.6)
    moments = f"What is exact: real contact area {area.mean:.5g} ± {area.std:.4g} µm²"
    whose = f"{style.shortened(title)}: {style.contact_label(model)}"
    style.put_title(figure, moments, whose)
    panes: dict[str, Callable[[Axes, Model], None]] = {
        "Distribution": _draw_law,
        "Autocovariance": _draw_covariance,
        "Spectral density of the area, two-sided": _draw_spectrum,
    }
    if model.slider is not None:
        panes[f"One-way displacement, std {response(model).displacement_std:.4g} µm"] = _draw_response
    lower = [*panes][2:]
    layout: Any = [[*panes][:2], lower * (2 // len(lower))]
    for heading, axes in figure.subplot_mosaic(layout).items():
        axes.set_title(heading)
        try:
            panes[heading](axes, model)
            axes.legend()
        except Refused as refusal:
            axes.text(0.5, 0.5, fill(str(refusal), 40), transform=axes.transAxes, ha="center", va="center")
            axes.set(xticks=[], yticks=[])
    return figure


def _draw_law(axes: Axes, model: Model) -> None:
    area = area_cumulants(model)
    if not area.std:
        raise Refused(f"always {area.mean:.5g} µm²")
    law = distribution(model)
    span = np.linspace(max(0.0, area.mean - REACH * area.std), area.mean + REACH * area.std, POINTS)[1:]
    density = law.density(span)
    bell = np.exp(-0.5 * ((span - area.mean) / area.std) ** 2) / (np.sqrt(2.0 * pi) * area.std)
    axes.plot(span, bell, color=style.FAINT, lw=1.0, ls=(0, (4, 2)), label="normal")
    axes.fill_between(span, density, color=style.VERMILION, alpha=0.15, lw=0.0)
    axes.plot(span, density, color=style.VERMILION, lw=1.6, label="exact")
    first = 0.0 if area.mean < 2.0 * REACH * area.std else span[0]
    axes.set(xlabel=style.AREA, ylabel="density (1/µm²)", xlim=(first, span[-1]))
    # A density that is singular at 0 must not flatten the rest.
    axes.set_ylim(0.0, min(1.1 * float(density[np.isfinite(density)].max()), 6.0 * float(bell.max())))


def _draw_covariance(axes: Axes, model: Model) -> None:
    lag = np.linspace(0.0, max(covariance_reach(model, LITTLE), 1.25 * model.mean_life_distance), LAGS)
    axes.axhline(0.0, color=style.FAINT, lw=0.6)
    axes.plot(lag, autocovariance(model, lag), color=style.VERMILION, lw=1.6, label="exact")
    axes.axvline(model.mean_life_distance, color=style.FAINT, lw=0.8, ls=(0, (2, 2)), label="mean life")
    axes.set(xlim=(0.0, lag[-1]), xlabel="lag (µm)", ylabel="covariance (µm⁴)")


def _draw_spectrum(axes: Axes, model: Model) -> None:
    wavenumber = np.geomspace(0.1, 300.0, POINTS) / model.mean_life_distance
    density = spectral_density(model, wavenumber)
    lines, power = area_noise(model).lines
    if not (density.any() or power.size):
        raise Refused("nothing varies")
    if density.any():
        axes.plot(wavenumber, density, color=style.VERMILION, lw=1.6, label="exact")
    if power.size:
        shown = lines <= wavenumber[-1]
        axes.vlines(lines[shown], 1e-3 * power[shown], power[shown], color=style.VERMILION, lw=1.2, label="lines (µm⁴)")
        axes.plot(lines[shown], power[shown], "o", color=style.VERMILION, ms=3.0)
    with suppress(Refused):
        level = tail(model, wavenumber)
        below = level < 5.0 * density[0]
        label = f"tail k{'⁻⁴' if model.pulse.tail[1] == 4 else '⁻⁵'}"
        axes.plot(wavenumber[below], level[below], color=style.INK, lw=0.8, ls=(0, (4, 2)), label=label)
        # Zeros of the triangle's spectrum would stretch the axis to nowhere.
        axes.set_ylim(0.05 * float(level[-1]), 5.0 * density[0])
    style.logarithmic(axes.xaxis, axes.yaxis)
    axes.set(xlim=(wavenumber[0], wavenumber[-1]), xlabel="wavenumber (rad/µm)", ylabel="µm⁴ per rad/µm")


def _draw_response(axes: Axes, model: Model) -> None:
    natural = 0.0 if model.slider is None else model.slider.natural_frequency
    place = np.unique(np.append(np.geomspace(0.02, 30.0, POINTS), np.linspace(0.8, 1.25, POINTS))) * natural
    density = 2.0 * motion_spectrum("displacement", model, 2.0 * pi * place)
    if not density.any():
        raise Refused("no spectrum beside lines")
    axes.plot(place, density, color=style.VERMILION, lw=1.6, label="exact")
    style.logarithmic(axes.xaxis, axes.yaxis)
    axes.set(xlim=(place[0], place[-1]), xlabel="frequency (Hz)", ylabel="µm²/Hz")
