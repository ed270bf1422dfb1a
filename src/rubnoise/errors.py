"""Everything rubnoise refuses or fails at, each with the exit code the command line returns for it."""

from collections.abc import Iterator
from contextlib import contextmanager
from shlex import quote


class RubnoiseError(Exception):
    """A failure that is reported as one clear text, without a traceback; exit code 1."""

    exit_code = 1


class Refused(RubnoiseError):  # noqa: N818  (a refusal is what it is; "RefusedError" says it twice)
    """Something refused before the first event: usage, invalid input, an output that cannot be written; exit code 2."""

    exit_code = 2


class ScenarioRefused(Refused):
    """A scenario whose problems are listed in the message, all of them at once."""


class OutputRefused(Refused):
    """An output path that exists already, is no regular file, or cannot be written."""


class RunFileRefused(Refused):
    """A result file that is missing, foreign, damaged or of a newer format."""


class ExtraMissing(Refused):
    """An optional library that something asked for needs and that is not installed."""


class RunOutside(RubnoiseError):  # noqa: N818  (nothing failed: the run is not what theory says it is)
    """A run of which something is outside of what theory allows it; exit code 3."""

    exit_code = 3


class TraceDoubtful(RubnoiseError):  # noqa: N818  (nothing failed: the trace is not of the model, or says too little)
    """A measured trace that does not follow the model, or is too little to tell its junctions; exit code 3."""

    exit_code = 3


class RunDiffers(RubnoiseError):  # noqa: N818  (nothing failed: the file is not what it says it is)
    """A result file in which something is not what it should be; exit code 3."""

    exit_code = 3


class RunStopped(RubnoiseError):  # noqa: N818  (says what happened, which is no error of anybody's)
    """A run that a signal asked to stop; the exit code is 128 plus its number, as a shell has it.

    ``kept`` is the part file from which it can go on, or None where nothing was kept.
    """

    def __init__(self, signal_number: int) -> None:
        """Keep the number of the signal."""
        super().__init__(signal_number)
        self.exit_code = 128 + signal_number
        self.kept: str | None = None

    def __str__(self) -> str:
        """Say what was kept, and how to go on."""
        return f"stopped by a signal; {resume_hint(self.kept) if self.kept else 'nothing was kept'}"


def resume_hint(part: str) -> str:
    """Return the shell command that resumes a part file."""
    return f"rubnoise resume {quote(part)} continues it"


@contextmanager
def needing(extra: str, purpose: str) -> Iterator[None]:
    """Turn a library that cannot be imported here into ExtraMissing, which says how to install its extra."""
    try:
        yield
    except ModuleNotFoundError as problem:
        library = (problem.name or "a library").partition(".")[0]
        raise ExtraMissing(f'{purpose} needs {library}: python -m pip install "rubnoise[{extra}]"') from problem
