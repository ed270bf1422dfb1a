"""The laws of births along the sliding distance.

Each law is a file with its class and its entry for the registry `BIRTHS`, from which scenario keys, schema and docs
read. Numbers are drawn by inversion, in operations that round the same on every processor.
"""

from typing import Final

from rubnoise.contact.births import gamma, poisson, regular, scattered
from rubnoise.contact.births.gamma import GammaBirths
from rubnoise.contact.births.law import BirthLaw, BirthLawEntry, GapLaw, Key
from rubnoise.contact.births.poisson import PoissonBirths
from rubnoise.contact.births.regular import RegularBirths
from rubnoise.contact.births.scattered import ClusteredBirths, JitteredBirths, ScatteredBirths

__all__ = [
    "BIRTHS",
    "BirthLaw",
    "BirthLawEntry",
    "ClusteredBirths",
    "GammaBirths",
    "GapLaw",
    "JitteredBirths",
    "Key",
    "PoissonBirths",
    "RegularBirths",
    "ScatteredBirths",
]

BIRTHS: Final[dict[str, BirthLawEntry]] = {
    entry.name: entry
    for entry in (poisson.ENTRY, regular.ENTRY, gamma.ENTRY, scattered.CLUSTERED_ENTRY, scattered.JITTERED_ENTRY)
}
"""Every law of births by its name in a scenario."""
