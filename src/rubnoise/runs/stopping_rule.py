"""Decide which runs a sweep with a precision still needs, from the figures of finished runs."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, nan
from typing import Any, Final

from rubnoise.scenario.points import Case, Point, points_of
from rubnoise.scenario.sweep import Sweep
from rubnoise.scenario.sweep_keys import Sweeping

Ended = Mapping[str, Mapping[str, float]]
"""Figures of the runs that have ended, by run id; a failed run has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Unmet:
    """A point that has its largest number of replicates and not its precision."""

    values: Mapping[str, Any]
    replicates: int
    reached: float


class AdaptiveReplicates:
    """The rounds in which a sweep reaches its precision.

    Each point goes from batch to batch of its own replicates, always beginning with the first: its next runs depend
    only on their figures, however often the sweep was interrupted.
    """

    def __init__(self, sweep: Sweep) -> None:
        """Start before the first round."""
        self.settings: Final = sweep.precision
        self._replicates = sweep.replicates
        self._known = [(case, list(points_of([case], sweep.replicates))) for case in sweep.cases]

    def __call__(self, ended: Ended) -> tuple[Point, ...]:
        """Return the needed runs that have not ended; none if every point has its precision or its last replicate."""
        batches = (self._batch(case, known, ended) for case, known in self._known)
        return tuple(point for batch in batches for point in batch if point.run_id not in ended)

    @property
    def points(self) -> tuple[Point, ...]:
        """Every run that was needed so far, those of a point one after another."""
        return tuple(point for _, known in self._known for point in known)

    def unmet(self, ended: Ended) -> list[Unmet]:
        """Return the points whose needed runs have all ended without reaching their precision."""
        found = []
        for case, known in self._known:
            batch = self._batch(case, known, ended)
            if self.settings is None or not _complete(batch, ended):
                continue
            reached = self.settings.reached(_values(self.settings, batch, ended))
            if reached > (self.settings.precision or inf):
                found.append(Unmet(values=case.values, replicates=len(batch), reached=reached))
        return found

    def _batch(self, case: Case, known: list[Point], ended: Ended) -> list[Point]:
        """Return all runs of a point up to the end of the first batch that is not complete, or of the last."""
        batch = known[: self._replicates]
        while self.settings and _complete(batch, ended):
            wanted = self.settings.wanted(_values(self.settings, batch, ended))
            if wanted == len(batch):
                break
            known += points_of([case], wanted, len(known))
            batch = known[:wanted]
        return batch


def _complete(batch: list[Point], ended: Ended) -> bool:
    return all(point.run_id in ended for point in batch)


def _values(settings: Sweeping, batch: list[Point], ended: Ended) -> list[float]:
    return [ended[point.run_id].get(settings.quantity, nan) for point in batch]
