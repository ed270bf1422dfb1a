"""Every column of a file held against the hash that is stored beside it."""

from rubnoise.analysis.verifying.findings import Check, Difference
from rubnoise.analysis.verifying.reading import PANEL_ROWS
from rubnoise.errors import RunFileRefused
from rubnoise.storage.reader import RunFile


def hash_check(run: RunFile) -> Check:
    """Return whether every column can be read and has the xxh3_128 that is written beside it."""
    values = sum(run.rows(group) * len(names) for group, names in run.columns.items())
    damaged = run.damaged()
    if not damaged:
        return Check(name="hashes", values=values)
    told = "unreadable" if damaged[0] in unreadable(run) else "not what its hash was taken of"
    first = Difference(place=damaged[0], row=None, found=told, expected="as it was written")
    return Check(name="hashes", values=values, different=len(damaged), first=first)


def unreadable(run: RunFile) -> list[str]:
    """Return the groups and columns whose bytes cannot be read at all, as in a compressed column that is damaged."""
    found = []
    for group, names in run.columns.items():
        for name in names:
            try:
                for first in range(0, run.rows(group), PANEL_ROWS):
                    run.column(group, name, first, first + PANEL_ROWS)
            except RunFileRefused:
                found.append(f"/{group}/{name}")
    return found
