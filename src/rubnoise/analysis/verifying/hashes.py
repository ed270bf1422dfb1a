"""Every column of a file, and its attributes, compared with their stored hashes."""

from typing import Final

from rubnoise.analysis.reading import CHUNK_ROWS
from rubnoise.analysis.verifying.findings import Check, Difference
from rubnoise.errors import RunFileRefused
from rubnoise.record.reader import HashedReader
from rubnoise.storage.schema import HASH
from rubnoise.storage.seal import seal_of

SEAL: Final = f"/provenance {HASH}"


def hash_check(run: HashedReader) -> Check:
    """Return whether every column can be read and has the xxh3_128 beside it, and all attributes together theirs."""
    values = sum(run.rows(group) * len(names) for group, names in run.columns.items()) + 1
    damaged = run.damaged()
    wrong = [_column_difference(run, damaged[0])] if damaged else []
    wrong += [difference for difference in [_seal_difference(run)] if difference]
    different = len(damaged) + len(wrong) - bool(damaged)
    return Check(name="hashes", values=values, different=different, first=wrong[0] if wrong else None)


def unreadable(run: HashedReader) -> list[str]:
    """Return the groups and columns whose bytes cannot be read at all, as in a compressed column that is damaged."""
    found = []
    for group, names in run.columns.items():
        for name in names:
            try:
                for first in range(0, run.rows(group), CHUNK_ROWS):
                    run.column(group, name, first, first + CHUNK_ROWS)
            except RunFileRefused:
                found.append(f"/{group}/{name}")
    return found


def _column_difference(run: HashedReader, column: str) -> Difference:
    reason = "unreadable" if column in unreadable(run) else "not what its hash was taken of"
    return Difference(place=column, row=None, found=reason, expected="as it was written")


def _seal_difference(run: HashedReader) -> Difference | None:
    there, right = run.seal, seal_of(run.attributes, run.summary, run.provenance)
    if there == right:
        return None
    expected = f"{right}, the hash of the attributes of the root, /summary and /provenance"
    return Difference(place=SEAL, row=None, found=there or "missing", expected=expected)
