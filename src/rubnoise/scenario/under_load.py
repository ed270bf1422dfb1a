"""What a load that weighs asks of a scenario: the contact for which its theory holds, set if nothing is said."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from math import pi, sqrt
from typing import Any, Final

from rubnoise.scenario.document import Document
from rubnoise.scenario.layers import Layers
from rubnoise.scenario.problems import Path, Problem
from rubnoise.scenario.scenario import area_and_count, is_free
from rubnoise.units import RATIO, Quantity

RAYLEIGH: Final = 100.0 * sqrt(4.0 / pi - 1.0)
"""Standard deviation over mean of Rayleigh sizes, in %: with it the Weibull law has the shape 2."""

CONTACT: Final[dict[Path, str]] = {
    ("interface", "calibration"): "matched",
    ("diameter", "law"): "weibull",
    ("diameter", "spread"): f"{RAYLEIGH!r} %",
    ("birth", "law"): "poisson",
    ("pulse", "shape"): "parabola",
    ("pulse", "offset"): "none",
}
"""The contact of exponential heights: paraboloids of Rayleigh sizes that meet at random (Greenwood and Williamson)."""

FREE_MOTION: Final = ("restitution", "impact_damping")
"""Keys of a slider that leaves its contact."""

MOST_LIVE: Final = 1000.0
"""Junctions in contact up to which motion is worked out from event to event; of so many, each is felt by none."""

_CLOSE: Final = 1e-5  # relative, of a spread that is written in few digits


def completed(layers: Layers) -> Layers:
    """Return layers with the contact set if a table [load] asks for it and nothing is said."""
    if not isinstance(layers.data.get("load"), dict):
        return layers
    data = deepcopy(layers.data)
    for (table, key), value in CONTACT.items():
        given = data.setdefault(str(table), {})
        if isinstance(given, dict) and (key != "spread" or given.get("law") == CONTACT["diameter", "law"]):
            given.setdefault(str(key), value)
    return replace(layers, data=data)


def load_problems(document: Document, layers: Layers) -> Iterator[Problem]:
    """Refuse what contradicts a load that weighs, in a document with one."""
    for path, needed in CONTACT.items():
        if not _agrees(_value(document, path), needed):
            message = f"the theory of [load] is for {_words(path, needed)}"
            hint = f'{path[-1]} = "{needed}", or leave it out: it is set'
            yield Problem(path=path, message=message, place=layers.value_place(path), hint=hint)
    if document.load is not None and is_free(document.load):
        yield from _free_problems(document, layers)
    if document.slider is not None and document.slider.coupling == "two-way":
        path = ("slider", "coupling")
        message = "two-way coupling is known at constant separation alone, not with a table [load]"
        yield Problem(path=path, message=message, place=layers.value_place(path), hint='coupling = "one-way"')


def _free_problems(document: Document, layers: Layers) -> Iterator[Problem]:
    """Refuse what no free motion begins with, and contacts whose slider never leaves them."""
    if document.sliding.start != "stationary":
        path, message = ("sliding", "start"), "free motion begins at rest on the summits that are there"
        yield Problem(path=path, message=message, place=layers.value_place(path), hint='start = "stationary"')
    _, count = area_and_count(document.interface)
    if count > MOST_LIVE:
        path = ("interface", "mean_junction_count" if document.interface.patch_area is None else "patch_area")
        message = f"{count:.3g} junctions in contact: free motion is computed up to {MOST_LIVE:g}"
        hint = 'load.motion = "first-order", which is right for so many'
        yield Problem(path=path, message=message, place=layers.value_place(path), hint=hint)


def _value(document: Document, path: Path) -> Any:
    return getattr(getattr(document, str(path[0])), str(path[1]))


def _agrees(value: Any, needed: str) -> bool:
    if isinstance(value, Quantity):
        return value.kind == RATIO and abs(100.0 * float(value) / RAYLEIGH - 1.0) <= _CLOSE
    return bool(value == needed)


def _words(path: Path, needed: str) -> str:
    table, key = path
    return f"Rayleigh sizes ({needed})" if key == "spread" else f"{table}.{key} {needed}"
