"""Where the rows of a run come from: protocols between those who keep a run and those who look at it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from rubnoise.record.sink import Extent

Attributes = Mapping[str, float | int | str]


class Rows(Protocol):
    """The columns of a run, in a file or elsewhere, named and in the units of a result file."""

    @property
    def columns(self) -> Mapping[str, Sequence[str]]:
        """Names of the columns of each group."""
        ...

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        ...

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        """Return rows ``start`` to ``stop`` (to the end when None) of a column."""
        ...


class Reader(Rows, Protocol):
    """A run with what it says of itself beside its rows."""

    @property
    def path(self) -> Path:
        """Where it lies."""
        ...

    @property
    def extent(self) -> Extent:
        """How many rows it has."""
        ...

    @property
    def attributes(self) -> Attributes:
        """Format, title, source and the formula of a junction's area."""
        ...

    @property
    def summary(self) -> Attributes:
        """Measured and exact figures by name."""
        ...

    @property
    def provenance(self) -> Attributes:
        """Scenario, software, seed, command and times."""
        ...


class HashedReader(Reader, Protocol):
    """A run that keeps hashes of its columns and of what it says of itself."""

    @property
    def seal(self) -> str | None:
        """The hash of the attributes; None if there is none."""
        ...

    def damaged(self) -> tuple[str, ...]:
        """Return the columns that are unreadable or do not have the hash written beside them."""
        ...
