"""What a child process may be asked about a file, by name."""

from typing import Literal

from rubnoise.storage import inventory, survey
from rubnoise.storage.vetting import Look

LookName = Literal["survey", "inventory"]


def look_of(name: LookName) -> Look:
    """Return the look of a name."""
    return survey.survey if name == "survey" else inventory.inventory
