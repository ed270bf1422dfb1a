"""A scenario that has been checked: its sections in working units, its model, and itself with nothing left implicit."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rubnoise.model import Model
from rubnoise.scenario import document as sections
from rubnoise.units import Quantity


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """The sections of a scenario file, with values in um, s, kg, uN, MPa, N/m, N s/m and defaults filled in.

    ``text`` is the file as read, ``warnings`` what is allowed and doubtful, each ready to print, ``physics`` the model.
    """

    title: str
    interface: sections.Interface
    diameter: sections.Diameter
    birth: sections.Birth
    pulse: sections.Pulse
    strength: sections.Strength | None
    sliding: sections.Sliding
    slider: sections.Slider | None
    output: sections.SampledOutput
    run: sections.Run
    name: str
    text: str
    warnings: tuple[str, ...]
    physics: Model

    def model(self) -> Model:
        """Return the physics of the run."""
        return self.physics

    def resolved(self) -> dict[str, Any]:
        """Return every key with its value, defaults too, as a scenario of text, numbers and tables (JSON-able).

        Quantities are written in working units in full; read again, it is the same scenario to the last bit.
        """
        tables = {
            name: _explicit(section)
            for name in sections.Document.model_fields
            if isinstance(section := getattr(self, name, None), sections.Section)
        }
        return {"format": sections.FORMAT, "title": self.title, **tables}


def flattened(resolved: Mapping[str, Any]) -> dict[str, Any]:
    """Return a resolved scenario by its keys with dots; an empty table is a key of its own."""
    found: dict[str, Any] = {}
    for name, value in resolved.items():
        tables = isinstance(value, Mapping) and value
        found |= {f"{name}.{key}": each for key, each in value.items()} if tables else {name: value}
    return found


def _explicit(section: sections.Section) -> dict[str, Any]:
    values = {name: getattr(section, name) for name in type(section).model_fields}
    return {
        name: value.as_text() if isinstance(value, Quantity) else value
        for name, value in values.items()
        if value is not None
    }
