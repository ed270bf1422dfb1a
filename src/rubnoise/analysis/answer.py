"""The answer of `compare` and `verify`: a verdict about a run, with the table behind it."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from rubnoise.errors import needing
from rubnoise.tables import as_html, as_text

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOut:
    """A question that could not be answered for a run, or only in part, and the reason."""

    name: str
    reason: str


class Answer(ABC):
    """A verdict about a run, ``passed``, with the table behind it: ``rows``, ``to_pandas()``.

    It is true if it passed: ``if run.compare(): ...``.
    """

    __slots__ = ()
    heading: str
    names: ClassVar[tuple[str, ...]]

    @property
    @abstractmethod
    def omitted(self) -> Sequence[LeftOut]:
        """The questions that could not be answered, in order."""

    @property
    def left_out(self) -> dict[str, str]:
        """The reasons for the questions that could not be answered, by name."""
        return {each.name: each.reason for each in self.omitted}

    @property
    @abstractmethod
    def failing(self) -> tuple[str, ...]:
        """Names of the rows that failed."""

    @property
    def passed(self) -> bool:
        """Whether no row failed."""
        return not self.failing

    def __bool__(self) -> bool:
        return self.passed

    @property
    @abstractmethod
    def rows(self) -> tuple[Mapping[str, Any], ...]:
        """The rows of the table, each a dictionary with the same names; None is a missing value."""

    def to_pandas(self) -> "pd.DataFrame":
        """Return the table as a pandas DataFrame; raises ExtraMissing without pandas."""
        with needing("analysis", "to_pandas"):
            import pandas as pd
        return pd.DataFrame(list(self.rows), columns=list(self.names))

    @property
    @abstractmethod
    def _counts(self) -> str:
        """The number of comparisons, in words."""

    @property
    def _verdict(self) -> str:
        return f"passed: {self._counts}" if self.passed else f"not passed: {', '.join(self.failing)} ({self._counts})"

    def _cells(self) -> list[tuple[str, ...]]:
        return [tuple(_as_cell(row[name]) for name in self.names) for row in self.rows]

    def __repr__(self) -> str:
        return "\n".join([self.heading, *as_text(self.names, self._cells()), self._verdict])

    def _repr_html_(self) -> str:
        return as_html(self.heading, self.names, self._cells(), self._verdict)


def _as_cell(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
