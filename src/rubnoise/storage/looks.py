"""What a child process may be asked about a file, by name."""

from typing import Final, Literal

from rubnoise.storage import inspection, inventory, survey
from rubnoise.storage.vetting import Look

LookName = Literal["survey", "inventory", "inspection"]

_LOOKS: Final[dict[LookName, Look]] = {
    "survey": survey.survey,
    "inventory": inventory.inventory,
    "inspection": inspection.inspect,
}


def look_of(name: LookName) -> Look:
    """Return the look of a name."""
    return _LOOKS[name]
