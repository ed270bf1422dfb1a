"""What a child process may be asked about a file, by name."""

from typing import Final, Literal

from rubnoise.storage.inventory import inventory
from rubnoise.storage.survey import survey
from rubnoise.storage.vetting import Look

LookName = Literal["survey", "inventory"]

LOOKS: Final[dict[LookName, Look]] = {"survey": survey, "inventory": inventory}
