"""The births of a run between their being counted, before its first event, and their being played."""

from rubnoise.arrays import Doubles
from rubnoise.model import Model

Births = tuple[Doubles, Doubles]
"""Birth distances and the gaps between them (um)."""

Place = tuple[int, float, int]
"""Where births that are drawn together begin: block, distance (um), and how many blocks they make."""

_MOST = 24
"""Draws that are kept: a few megabytes, in which all of a run of half a million junctions fit."""


class CountedBirths:
    """The first births of the run that was counted last; each is handed out once to be played, and forgotten."""

    def __init__(self) -> None:
        """Know of no run."""
        self._kept: tuple[tuple[Model, int] | None, dict[Place, Births]] = (None, {})

    def look(self, model: Model, seed: int, place: Place) -> Births | None:
        """Return the births of a place, if they are kept."""
        run, births = self._kept
        return births.get(place) if run == (model, seed) else None

    def keep(self, model: Model, seed: int, place: Place, births: Births) -> None:
        """Keep births, unless there are many of this run already; those of another run are given up for them."""
        if self._kept[0] != (model, seed):
            # One assignment: another thread finds either run with its own births.
            self._kept = ((model, seed), {})
        kept = self._kept[1]
        if len(kept) < _MOST:
            kept[place] = births

    def take(self, model: Model, seed: int, place: Place) -> Births | None:
        """Return the births of a place, if they are kept, and keep them no longer."""
        run, births = self._kept
        return births.pop(place, None) if run == (model, seed) else None
