"""A run, in a file or in memory, compared with theory and verified."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from numbers import Integral, Real
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from rubnoise.api.keywords import shown
from rubnoise.errors import Refused, RunFileRefused
from rubnoise.scenario.reading import stored

if TYPE_CHECKING:
    from rubnoise.analysis.comparing.findings import Comparison
    from rubnoise.analysis.verifying.findings import Verification


@contextmanager
def calculating(source: str) -> Iterator[None]:
    """Say of values that no run has which result holds them, and what says more."""
    try:
        yield
    except (ArithmeticError, ValueError, IndexError) as problem:
        reason = " ".join(str(problem).split())
        raise RunFileRefused(f"{source}: {reason}; run.verify() says which values are wrong") from problem


def compared(reader: Any, source: str, bound: float | None) -> "Comparison":
    """Compare the rows of a run with the theory of its scenario."""
    from rubnoise.analysis.comparison import compare

    if bound is not None and not (isinstance(bound, Real) and 0.0 < float(bound) < inf):
        raise Refused(f"bound=: {shown(bound)} is no bound on |z|; it is a number above 0")
    with calculating(source):
        found = compare(stored(reader.provenance["scenario_resolved"]).model(), reader, bound)
        return replace(found, heading=f"{source}: compared with theory")


def verified(file: Any, source: str, regenerate: int) -> "Verification":
    """Check an open result file."""
    from rubnoise.analysis.verification import verify

    if isinstance(regenerate, bool) or not isinstance(regenerate, Integral) or regenerate < 0:
        raise Refused(f"regenerate=: {shown(regenerate)} is no whole number from 0 on")
    with calculating(source):
        return replace(verify(file, regenerate), heading=f"{source}: verified")


@contextmanager
def saved(record: Any) -> Iterator[Any]:
    """Keep a run from memory in a file for a while, and yield that file, open."""
    from rubnoise.storage.reader import open_run

    with TemporaryDirectory(prefix="rubnoise-") as folder:
        path = Path(folder) / "record.h5"
        record.save(path).close()
        with open_run(path) as file:
            yield file
