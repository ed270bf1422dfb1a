"""What a child process may be asked about a file, by name."""

from typing import Literal

from rubnoise.storage import inspection, inventory, survey
from rubnoise.storage.vetting import Look

LookName = Literal["survey", "inventory", "inspection"]


def look_of(name: LookName) -> Look:
    """Return the look of a name."""
    looks: dict[LookName, Look] = {
        "survey": survey.survey,
        "inventory": inventory.inventory,
        "inspection": inspection.inspect,
    }
    return looks[name]
