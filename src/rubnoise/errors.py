"""The errors of rubnoise, each with the exit code that the command line returns for it."""

import os
import re
import shlex
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from typing import Final


class RubnoiseError(Exception):
    """An error that is reported as one clear message, without a traceback; exit code 1.

    >>> import rubnoise
    >>> issubclass(rubnoise.Refused, rubnoise.RubnoiseError)
    True
    """

    exit_code = 1


LONGEST: Final = 1500  # characters of a refusal at most: a name or a cell of a file may have any number
_END: Final = 300


def in_few(text: str) -> str:
    """Return a text of at most LONGEST characters, in the middle of which some are left out."""
    return text if len(text) <= LONGEST else f"{text[: LONGEST - _END - 5]} ... {text[-_END:]}"


class Refused(RubnoiseError):  # noqa: N818  (a refusal is what it is; "RefusedError" says it twice)
    """Wrong usage, invalid input, or an output that cannot be written, refused before the first event; exit code 2.

    >>> import rubnoise
    >>> try:
    ...     rubnoise.example("paper/fig10")
    ... except rubnoise.Refused as refused:
    ...     print(str(refused).partition(";")[0])
    paper/fig10: no scenario of rubnoise's
    """

    exit_code = 2

    def __str__(self) -> str:
        """Return the message; the middle of a long one is left out, because the remedy is at the end."""
        return in_few(super().__str__())


class NoColumn(Refused):
    """A file does not have the requested column or dataset."""


class ScenarioRefused(Refused):
    """A scenario with problems; the message lists all of them."""

    def __str__(self) -> str:
        return Exception.__str__(self)


class OutputRefused(Refused):
    """An output path that already exists, is not a regular file, or cannot be written."""


class RunFileRefused(Refused):
    """A result file that is missing, damaged, in a newer format, or not from rubnoise."""


class ExtraMissing(Refused):
    """An optional library is needed and not installed."""


class NotPassed(RubnoiseError):  # noqa: N818  (nothing failed: what was looked at is not what it should be)
    """An answer that does not pass: a run outside of theory or unlike its file, a doubtful trace; exit code 3."""

    exit_code = 3


class RunStopped(RubnoiseError):  # noqa: N818  (says what happened, which is no error of anybody's)
    """A run was stopped by a signal; the exit code is 128 plus the signal's number, as in a shell."""

    def __init__(self, signal_number: int) -> None:
        super().__init__(signal_number)
        self.exit_code = 128 + signal_number

    def __str__(self) -> str:
        """Return what is left, and what makes the run again."""
        return "stopped by a signal; nothing was kept, and the same command begins again"


_CALL: Final = re.compile(r"\brubnoise\.([a-z]+)\(\.\.\., ([^()]*)\)")
_KEYWORD: Final = re.compile(
    r"""(?<![\w.=/\\'"-])([a-z]+(?:_[a-z]+)*_?)=     # speed=, and no part of the name of a file
    (?:"([^"\n]*)"|(True|\d+(?![^\s;,)])|(?![^\s:;,)])))  # with a text, with a number, or alone""",
    re.VERBOSE,
)


def in_shell(text: str) -> str:
    """Return a message with keywords as command-line options: `speed=` becomes `--speed`, `drift=True` `--drift`.

    A keyword is recognised by its equals sign, so no list of keywords is needed.
    """
    return _KEYWORD.sub(_option, _CALL.sub(r"rubnoise \1 \2", text))


def _option(found: re.Match[str]) -> str:
    name, words, number = found.groups()
    option = "--" + {"beside": "with"}.get(name, name.rstrip("_").replace("_", "-"))  # one has another word
    if words is not None:
        return f"{option} {words}" if re.fullmatch(r"[\w./]+", words) else f'{option} "{words}"'
    return option if number in ("", "True") else f"{option} {number}"


def did_you_mean(word: str, known: Iterable[str], meant: Sequence[str] = (), *, most: int = 1, quote: str = "") -> str:
    """Return advice on an unknown word: what is ``meant`` by it, or the nearest known words; empty without any."""
    near = meant or get_close_matches(word[:40].lower(), list(known), most)
    return f"did you mean {' or '.join(f'{quote}{each}{quote}' for each in near)}?" if near else ""


def advised(message: str, advice: str) -> str:
    """Return a message with advice, if there is some."""
    return f"{message}; {advice}" if advice else message


EXTRAS_OF_SYNC: Final = ("analysis", "plot")  # what `tools/dev.py sync` installs; `sync all` installs the others too


def how_to_install(extra: str) -> str:
    """Return the command that installs an extra here: the project's tool in a checkout, otherwise pip."""
    tool = Path(__file__).parents[2] / "tools" / "dev.py"
    if tool.is_file():
        shown = shlex.quote(os.path.relpath(tool))
        return f"python3 {shown} sync" + ("" if extra in EXTRAS_OF_SYNC else " all")
    return f'python -m pip install "rubnoise[{extra}]"'


@contextmanager
def needing(extra: str, purpose: str) -> Iterator[None]:
    """Raise ExtraMissing, which says how to install the extra, if a library cannot be imported in this context."""
    try:
        yield
    except ModuleNotFoundError as problem:
        library = (problem.name or "a library").partition(".")[0]
        raise ExtraMissing(f"{purpose} needs {library}: {how_to_install(extra)}") from problem


def reason_of(problem: Exception) -> str:
    """Return why the system did not do it, in its own words if it has any."""
    reason = getattr(problem, "strerror", None) or str(problem)
    return f"{reason[:1].lower()}{reason[1:]}"


@contextmanager
def refusing_files(path: object, kind: type[RubnoiseError] = Refused, words: str = "") -> Iterator[None]:
    """Turn an OSError about a file into an error of a kind that names the file; ``words`` stand before the reason."""
    try:
        yield
    except OSError as problem:
        raise kind(f"{path}: {words}{reason_of(problem)}") from problem


@contextmanager
def naming(name: object) -> Iterator[None]:
    """Put a name in front of the message of a refusal, unless it names that, an option or an output of its own."""
    try:
        yield
    except Refused as refused:
        if isinstance(refused, OutputRefused) or re.match(rf"{re.escape(f'{name}:')}|--|[a-z_]+=[:\"]", str(refused)):
            raise
        raise type(refused)(f"{name}: {refused}") from refused
