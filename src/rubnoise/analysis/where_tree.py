"""What a condition means: a tree that says of every row whether it is chosen."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from rubnoise.record.sink import Columns

Chosen = NDArray[np.bool_]

COMPARISONS: Final[Mapping[str, Callable[[Any, Any], Any]]] = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}


class Node(Protocol):
    """A part of a condition."""

    @property
    def columns(self) -> frozenset[str]:
        """Names of the columns it looks at."""
        ...

    def chosen(self, rows: Columns) -> Chosen:
        """Return for each row whether it is chosen; ``rows`` holds the columns by name."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Two sides compared: names of columns, or numbers in the column's unit."""

    left: str | float
    operator: str
    right: str | float

    @property
    def columns(self) -> frozenset[str]:
        """Names of the columns compared."""
        return frozenset(side for side in (self.left, self.right) if isinstance(side, str))

    def chosen(self, rows: Columns) -> Chosen:
        """Return for each row whether the comparison holds."""
        left, right = (rows[side] if isinstance(side, str) else side for side in (self.left, self.right))
        verdict: Chosen = COMPARISONS[self.operator](left, right)
        return verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class InState:
    """Rows whose state has a bit, or none at all where ``bit`` is 0."""

    bit: int

    @property
    def columns(self) -> frozenset[str]:
        """The column of states."""
        return frozenset({"state"})

    def chosen(self, rows: Columns) -> Chosen:
        """Return for each row whether it is in the state."""
        state = rows["state"]
        verdict: Chosen = (state & self.bit) != 0 if self.bit else state == 0
        return verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Negation:
    """Rows that a part does not choose."""

    part: Node

    @property
    def columns(self) -> frozenset[str]:
        """Names of the columns of the part."""
        return self.part.columns

    def chosen(self, rows: Columns) -> Chosen:
        """Return the opposite of the part."""
        return ~self.part.chosen(rows)


@dataclass(frozen=True, slots=True, kw_only=True)
class Every:
    """Rows that all parts choose: ``a and b and ...``."""

    parts: tuple[Node, ...]

    @property
    def columns(self) -> frozenset[str]:
        """Names of the columns of all parts."""
        return frozenset().union(*(part.columns for part in self.parts))

    def chosen(self, rows: Columns) -> Chosen:
        """Return for each row whether all parts choose it."""
        verdict: Chosen = np.logical_and.reduce([part.chosen(rows) for part in self.parts])
        return verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class Some:
    """Rows that at least one part chooses: ``a or b or ...``."""

    parts: tuple[Node, ...]

    @property
    def columns(self) -> frozenset[str]:
        """Names of the columns of all parts."""
        return frozenset().union(*(part.columns for part in self.parts))

    def chosen(self, rows: Columns) -> Chosen:
        """Return for each row whether some part chooses it."""
        verdict: Chosen = np.logical_or.reduce([part.chosen(rows) for part in self.parts])
        return verdict
