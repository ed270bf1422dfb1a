"""A finished result file, opened for commands that read it row by row."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rubnoise.errors import OutputRefused, Refused, RunFileRefused
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.resume import refusal


@contextmanager
def complete_run(path: Path) -> Iterator[RunFile]:
    """Open a result file; raises RunFileRefused for one that is unfinished or that open_run refuses."""
    with open_run(path) as file:
        if not file.provenance["finished"]:
            raise refusal(path)
        yield file


@contextmanager
def finished_run(path: Path) -> Iterator[RunFile]:
    """Open a result file; what is refused about it is told with its name.

    Raises RunFileRefused for one that is unfinished, that open_run refuses, or whose values cannot be calculated with.
    """
    with complete_run(path) as file:
        try:
            yield file
        except OutputRefused:
            raise
        except Refused as refused:
            if str(refused).startswith((f"{path}: ", "--")):
                raise
            raise type(refused)(f"{path}: {refused}") from refused
        except (ArithmeticError, ValueError, IndexError) as problem:
            # Rows may hold anything: what no run has is nothing to calculate with.
            reason = " ".join(str(problem).split())
            raise RunFileRefused(f"{path}: {reason}; rubnoise verify says whether its values are sound") from problem
