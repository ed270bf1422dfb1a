"""Panels of wavenumber fine enough for the resonance, the spectrum's swing and its corner, whichever is sharpest."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.theory.drive import Drive
from rubnoise.theory.pulse_energy import largest_swinging_wavenumber
from rubnoise.theory.quadrature import panels, size_range

Doubles = NDArray[np.float64]
Rule = tuple[Doubles, Doubles]

_NODES = 16
_SWING = 8.0  # phase k d of a panel that still follows the swing, which has period pi
_RESOLVED = 4000.0  # phase to which every swing is followed; beyond it the swing holds less than 1e-8 of any integral
_SETTLED = 256.0  # the same for a slider too slow for such phases, by which it has nearly come to rest
_ABOVE = 100.0  # and for a faster one so many times its last corner; what is not followed there is below 1e-12
_AROUND = 2000.0  # phase on either side of a far and sharp resonance to which the swing is followed
_SHARP = 30.0  # half-width of the resonance, as a phase, above which it averages over the swing by itself


def response_rules(model: Model, drive: Drive) -> tuple[Rule, Rule]:
    """Return nodes and weights over k > 0 in rad/um: where panels follow the swing of S(k), where they average over it.

    Panels grow by octaves from far below to far above every corner, by octaves of distance from the resonance
    (beginning at half its half-width), and never exceed a phase of 8 where the swing counts.
    """
    edges = response_edges(model, drive)
    follows = np.diff(edges) * size_range(model.sizes)[1] <= 1.001 * _SWING
    nodes, weights = (part.reshape(-1, _NODES) for part in panels(edges, _NODES))
    return (nodes[follows].ravel(), weights[follows].ravel()), (nodes[~follows].ravel(), weights[~follows].ravel())


def response_edges(model: Model, drive: Drive) -> Doubles:
    """Return the ends of all panels in rad/um, in order, from 0 on."""
    reach = size_range(model.sizes)[1]
    swinging = largest_swinging_wavenumber(model.sizes)
    breadth = max(1.0, 2.0 * drive.slider.damping_ratio)
    settled = max(_SETTLED, _ABOVE * drive.resonance * breadth * reach)
    resolved = min(min(_RESOLVED, settled) / reach, swinging)
    lowest = 1e-3 * min(1.0 / reach, drive.resonance / breadth)
    highest = 1e4 * max(resolved, drive.resonance * breadth)
    parts = [
        np.zeros(1),
        _octaves(lowest, highest),
        np.arange(0.0, resolved, _SWING / reach),
        _around_resonance(drive),
    ]
    half_width = drive.slider.damping_ratio * drive.resonance
    if resolved < drive.resonance < swinging and half_width * reach < _SHARP:
        parts.append(drive.resonance + np.arange(-_AROUND, _AROUND, _SWING) / reach)
    return np.unique(np.concatenate(parts))


def _octaves(lowest: float, highest: float) -> Doubles:
    return lowest * 2.0 ** np.arange(0.0, np.ceil(np.log2(highest / lowest)) + 1.0)


def _around_resonance(drive: Drive) -> Doubles:
    half_width = drive.slider.damping_ratio * drive.resonance
    if half_width >= drive.resonance:
        return np.array([drive.resonance])
    distances = np.minimum(_octaves(0.5 * half_width, drive.resonance), drive.resonance)
    return np.concatenate([drive.resonance - distances, [drive.resonance], drive.resonance + distances])
