"""The form of what only the machine and the moment of a run knew: times, command lines, versions, hashes."""

import json
import re
from datetime import UTC, datetime
from shlex import join, split
from typing import Any, Final

from rubnoise.storage.provenance import TIME

VERSION: Final = re.compile(r"[0-9][0-9A-Za-z.+!_-]*|not installed")
_DIGEST: Final = re.compile(r"[0-9a-f]{32}")


def digits_form(text: str) -> str | None:
    """Return what a hash should be, or None where it is of that form."""
    return None if _DIGEST.fullmatch(text) else "32 hexadecimal digits"


def command_form(text: str) -> str | None:
    """Return what a command line should be, or None where it is of that form."""
    try:
        right = bool(text) and join(split(text)) == text
    except ValueError:
        right = False
    return None if right else "a command line as a shell reads it"


def moment_form(text: str) -> str | None:
    """Return what a time should be, or None where it is of that form."""
    return None if moment(text) else "a time in UTC such as 2026-01-31T12:00:00Z"


def source_form(text: str) -> str | None:
    """Return what the program that wrote a file should be called, or None where it is of that form."""
    name, _, version = text.partition(" ")
    return None if name == "rubnoise" and VERSION.fullmatch(version) else "rubnoise and its version, as rubnoise 1.2.3"


def moment(text: str) -> datetime | None:
    """Return a time as results have it; None for another text."""
    try:
        found = datetime.strptime(text, TIME).replace(tzinfo=UTC)
    except ValueError:
        return None
    return found if found.strftime(TIME) == text else None


def parsed(text: object) -> Any:
    """Return what a JSON text says; None for another text."""
    try:
        return json.loads(str(text))
    except (ValueError, RecursionError):
        return None
