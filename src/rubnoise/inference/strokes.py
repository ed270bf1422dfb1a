"""Strokes to and fro: cut at the reversals, turned one way, and joined; every cut is reported."""

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.inference.signal import Signal, half_width_of, two_levels

_SHORTEST: Final = 0.9
"""Part of the median stroke below which a stroke is left out: the first and the last are often cut short."""
_LEAST_WIDTHS: Final = 10.0  # half widths of the correlation in a stroke: chance crosses a level after one or two
_NAMED: Final = 6


def reversals(values: Doubles) -> list[int]:
    """Return the samples at which strokes begin, from the first sample on, and the number of samples at the end.

    The force is on one side of the middle of two levels, and a third of the way to the next level beyond it. A reversal
    lies half-way between the last sample of one side and the first of the other.
    """
    middle, half_gap = two_levels(values)
    side = (values > middle + half_gap).astype(np.int8) - (values < middle - half_gap).astype(np.int8)
    beyond = np.flatnonzero(side)
    turns = np.flatnonzero(np.diff(side[beyond]))
    places = (beyond[turns] + beyond[turns + 1] + 1) // 2
    return [0, *places.tolist(), values.size]


def joined(signal: Signal, left_out: float, first: int = 0) -> Signal:
    """Return a signal whose strokes are turned one way, without ``left_out`` of each stroke at either end.

    The force is half the difference of the mean levels of both ways, and the zero of the sensor is half their sum,
    which is subtracted. All strokes keep as many samples as the shortest, from their middle. The signal reports that,
    and counts samples from ``first`` on. Raises Refused if a trace has no strokes both ways.
    """
    values = signal.values
    edges = reversals(values)
    middle = two_levels(values)[0]
    lengths = np.diff(edges)
    whole = lengths >= _SHORTEST * float(np.median(lengths))
    signs = [1.0 if values[begin:end].mean() > middle else -1.0 for begin, end in pairwise(edges)]
    kept = [number for number in range(lengths.size) if whole[number]]
    ways = [sum(signs[number] == sign for number in kept) for sign in (1.0, -1.0)]
    if min(ways) == 0 or np.median(lengths) < _LEAST_WIDTHS * _width(values, edges, signs):
        raise Refused("strokes=: the force leaps between two levels nowhere: the trace is one stroke")
    each = min(int(lengths[number]) - 2 * round(left_out * int(lengths[number])) for number in kept)
    if each < 1:
        raise Refused("strokes=: nothing is left of the strokes; less than 50 % of each end can be left out")
    parts = [_middle(values, edges[number], edges[number + 1], each) for number in kept]
    levels = [
        float(np.mean([part.mean() for part, number in zip(parts, kept, strict=True) if signs[number] == sign]))
        for sign in (1.0, -1.0)
    ]
    zero = 0.5 * (levels[0] + levels[1])
    turned = np.concatenate([signs[number] * (part - zero) for part, number in zip(parts, kept, strict=True)])
    turns = _listed([first + edge + 1 for edge in edges[1:-1]])
    short = [
        f"left out: a stroke from sample {first + edges[number] + 1:,} to {first + edges[number + 1]:,}, too short"
        for number in range(lengths.size)
        if not whole[number]
    ]
    said = [
        f"{len(kept)} strokes fitted together, {ways[0]} one way and {ways[1]} the other, turned at samples {turns}",
        f"zero of the sensor: {zero:.4g} {signal.unit}, in the middle of {levels[0]:.4g} and {levels[1]:.4g}",
        f"left out: {100.0 * left_out:.3g} % of each stroke at either end; {each:,} samples of each stay",
        *short,
        f"left out of all strokes: {values.size - turned.size:,} of {values.size:,} samples",
    ]
    return replace(signal, values=turned, ways=(ways[0], ways[1]), left_out=(*signal.left_out, *said))


def _width(values: Doubles, edges: list[int], signs: list[float]) -> float:
    """Return the half width of the correlation of the force, turned one way stroke by stroke."""
    middle = two_levels(values)[0]
    turned = [sign * (values[begin:end] - middle) for sign, (begin, end) in zip(signs, pairwise(edges), strict=True)]
    return half_width_of(np.concatenate(turned))


def _middle(values: Doubles, begin: int, end: int, samples: int) -> Doubles:
    first = begin + (end - begin - samples) // 2
    return values[first : first + samples]


def _listed(samples: list[int]) -> str:
    shown = ", ".join(f"{sample:,}" for sample in samples[:_NAMED])
    return shown if len(samples) <= _NAMED else f"{shown} and {len(samples) - _NAMED} more"
