"""What `compare` and `verify` find about a run, with a verdict and a table."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

from rubnoise.errors import Refused, RunFileRefused, needing
from rubnoise.tables import as_html, as_text

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]

    from rubnoise.analysis.comparing.findings import Comparison as Found
    from rubnoise.analysis.verifying.findings import Verification as Verified

COMPARED: Final = ("part", "figure", "measured", "exact", "standard_error", "z", "within")
CHECKED: Final = ("check", "values", "different", "first_difference")


class Answer(ABC):
    """A verdict about a run, ``passed``, with a table of what it rests on: ``rows``, ``to_pandas()``.

    In a condition it stands for its verdict: ``if run.compare(): ...``.
    """

    passed: bool
    heading: str

    @property
    @abstractmethod
    def rows(self) -> tuple[Mapping[str, Any], ...]:
        """The rows of the table, each a dictionary of the same names; None where there is no value."""

    def to_pandas(self) -> "pd.DataFrame":
        """Return the table as a pandas DataFrame; raises ExtraMissing without pandas."""
        with needing("analysis", "to_pandas"):
            import pandas as pd
        return pd.DataFrame(list(self.rows), columns=list(self._names))

    def __bool__(self) -> bool:
        return self.passed

    @property
    @abstractmethod
    def _names(self) -> tuple[str, ...]: ...

    @property
    @abstractmethod
    def _verdict(self) -> str: ...

    def _cells(self) -> list[tuple[str, ...]]:
        return [tuple(_shown(row[name]) for name in self._names) for row in self.rows]

    def __repr__(self) -> str:
        return "\n".join([self.heading, *as_text(self._names, self._cells()), self._verdict])

    def _repr_html_(self) -> str:
        return as_html(self.heading, self._names, self._cells(), self._verdict)


@dataclass(frozen=True, slots=True, repr=False)
class Comparison(Answer):
    """A run compared with the theory of its scenario: every figure with its exact value, standard error and z.

    ``passed`` is true where all figures keep ``bound`` and all identities hold; ``outside`` names those that do not,
    ``left_out`` names what could not be compared, with the reason.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     answer = run.compare()
    >>> answer.passed, answer.outside, answer.rows[0]["figure"]
    (True, (), 'birth_count')
    """

    heading: str
    found: "Found"

    @property
    def passed(self) -> bool:  # type: ignore[override]
        """Whether nothing is outside of its bound."""
        return not self.found.outside

    @property
    def bound(self) -> float:
        """The largest |z| of a figure that agrees."""
        return self.found.bound

    @property
    def outside(self) -> tuple[str, ...]:
        """Names of the figures beyond the bound, and of the identities that do not hold."""
        return tuple(self.found.outside)

    @property
    def left_out(self) -> dict[str, str]:
        """The reasons for what could not be compared, by name."""
        return {each.name: each.reason for each in self.found.left_out}

    @property
    def rows(self) -> tuple[Mapping[str, Any], ...]:
        """One row per figure; of an identity `measured` is how far it is off and `exact` is 0."""
        outside, rows = set(self.found.outside), []
        for part in self.found.parts:
            for figure in part.figures:
                values = (figure.observed, figure.expected, figure.standard_error, figure.z)
                rows.append((part.heading, figure.name, *values, figure.name not in outside))
            rows += [(part.heading, each.name, each.deviation, 0.0, None, None, each.holds) for each in part.identities]
        return tuple(dict(zip(COMPARED, row, strict=True)) for row in rows)

    @property
    def _names(self) -> tuple[str, ...]:
        return COMPARED

    @property
    def _verdict(self) -> str:
        scored = sum(figure.z is not None for figure in self.found.figures)
        counts = f"{scored} figures and {len(self.found.identities)} identities compared, |z| <= {self.bound:.3g}"
        return f"passed: {counts}" if self.passed else f"not passed: {', '.join(self.outside)} ({counts})"


@dataclass(frozen=True, slots=True, repr=False)
class Verification(Answer):
    """A result checked against its own hashes, rows and scenario, one row per check.

    ``passed`` is true where every value is what it should be; ``left_out`` names what could not be checked, with the
    reason; ``remark`` says what may explain a difference.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     answer = run.verify()
    >>> answer.passed, answer.rows[0]["check"], answer.rows[0]["different"]
    (True, 'hashes', 0)
    """

    heading: str
    found: "Verified"

    @property
    def passed(self) -> bool:  # type: ignore[override]
        """Whether nothing is different."""
        return not self.found.different

    @property
    def left_out(self) -> dict[str, str]:
        """The reasons for what could not be checked, by name."""
        return {each.name: each.reason for each in self.found.left_out}

    @property
    def remark(self) -> str:
        """On which machines rows were made and played again, if only the play contradicts them; else empty."""
        return self.found.remark

    @property
    def rows(self) -> tuple[Mapping[str, Any], ...]:
        """One row per check: how many values it looked at, how many differ, and the first of these."""
        rows = ((each.name, each.values, each.different, str(each.first or "")) for each in self.found.checks)
        return tuple(dict(zip(CHECKED, row, strict=True)) for row in rows)

    @property
    def _names(self) -> tuple[str, ...]:
        return CHECKED

    @property
    def _verdict(self) -> str:
        counts = f"{len(self.found.checks)} checks of {self.found.values:,} values"
        failing = [each.name for each in self.found.different]
        return f"passed: {counts}" if self.passed else f"not passed: {', '.join(failing)} ({counts})"


@contextmanager
def calculating(source: str) -> Iterator[None]:
    """Say of values that no run has which result holds them, and what says more."""
    try:
        yield
    except (ArithmeticError, ValueError, IndexError) as problem:
        reason = " ".join(str(problem).split())
        raise RunFileRefused(f"{source}: {reason}; run.verify() says which values are wrong") from problem


def compared(reader: Any, source: str, bound: float | None) -> Comparison:
    """Compare the rows of a run with the theory of its scenario."""
    from rubnoise.analysis.comparison import compare
    from rubnoise.analysis.stored_model import stored_model

    with calculating(source):
        return Comparison(f"{source}: compared with theory", compare(stored_model(reader), reader, bound))


def verified(file: Any, source: str, regenerate: int) -> Verification:
    """Check an open result file."""
    from rubnoise.analysis.verification import verify

    if regenerate < 0:
        raise Refused(f"regenerate={regenerate}: is no number; it is 0 or more")
    with calculating(source):
        return Verification(f"{source}: verified", verify(file, regenerate))


@contextmanager
def stored(record: Any) -> Iterator[Any]:
    """Keep a run from memory in a file for a while, and yield that file, open."""
    from rubnoise.storage.reader import open_run

    with TemporaryDirectory(prefix="rubnoise-") as folder:
        path = Path(folder) / "record.h5"
        record.save(path).close()
        with open_run(path) as file:
            yield file


def _shown(value: object) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
