"""Which runs of a sweep have ended, and no more of them than decisions need."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from rubnoise.scenario.precision import Precision
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.rows import Row

Figures = Mapping[str, float]


@dataclass(slots=True)
class Stock:
    """Runs that are done, with the one figure that a precision asks for, those that failed, those that were begun."""

    quantity: str | None
    done: dict[str, Figures] = field(default_factory=dict)
    failed: dict[str, Figures] = field(default_factory=dict)
    begun: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, folder: SweepFolder, precision: Precision | None) -> Self:
        """Return what the journals say is done, as far as the files that were written then still lie in their places.

        Another file in such a place is to be looked at first. Runs that failed before are not among them either: they
        are to be tried anew.
        """
        stock = cls(None if precision is None else precision.quantity)
        for entry in folder.entries():
            if entry.state == "begun":
                stock.begun.add(entry.run_id)
            if entry.row is not None and folder.holds(entry):
                stock.add(entry.row)
        return stock

    def add(self, row: Row) -> None:
        """Take in a run that is done."""
        known = self.quantity is not None and self.quantity in row.figures
        self.done[row.run_id] = {str(self.quantity): row.figures[str(self.quantity)]} if known else {}
        self.begun.discard(row.run_id)

    def fail(self, run_id: str) -> None:
        """Take in a run that failed, if only after it had seemed to be done."""
        self.done.pop(run_id, None)
        self.failed[run_id] = {}

    @property
    def ended(self) -> dict[str, Figures]:
        """All of them."""
        return self.failed | self.done
