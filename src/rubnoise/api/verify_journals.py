"""The journals of a sweep compared with the files of its runs."""

import json
from collections.abc import Iterator, Mapping
from typing import Any, Final

from rubnoise.analysis.verifying.findings import Check, LeftOut, Notes
from rubnoise.sweep.folder import SweepFolder
from rubnoise.sweep.journal import Entry, numbered

AS_WRITTEN: Final = "as its checksum was taken of it"

Figures = Mapping[str, Mapping[str, Any]]
"""The figures of /summary in the files of runs, by the names of runs."""


def journal_check(folder: SweepFolder, files: Figures, left_out: list[LeftOut]) -> tuple[Check, frozenset[str]]:
    """Return whether every line is whole, and every run that is done has its file and the figures of that.

    Of the lines of a run that one counts which was written last. Returns the runs that are spoken of, too.
    """
    notes = Notes("journals")
    entries = list(_entries(notes, folder, left_out))
    done = {entry.run_id: (place, entry) for place, entry in entries if entry.state == "done"}
    for place, entry in done.values():
        _compare(notes, place, entry, files, folder)
    unwritten = files.keys() - done.keys()
    if unwritten:
        reason = f"{len(unwritten):,} results are there that no journal calls done yet; the same sweep takes them in"
        left_out.append(LeftOut(name="journals", reason=reason))
    return notes.check(), frozenset(entry.run_id for _, entry in entries)


def _entries(notes: Notes, folder: SweepFolder, left_out: list[LeftOut]) -> Iterator[tuple[str, Entry]]:
    """Yield every sound line with its place, and note the others."""
    own, cut = folder.journals(), 0
    for path in own:
        for number, entry in numbered(path):
            place = f"journal/{path.name} line {number}"
            if entry == "cut short":
                cut += 1
                continue
            notes.say(place, found="damaged" if entry == "damaged" else AS_WRITTEN, expected=AS_WRITTEN)
            if isinstance(entry, Entry):
                yield place, entry
    for path in sorted((folder.root / "journal").glob("*")):
        if path not in own and not path.name.startswith("."):
            notes.say(f"journal/{path.name}", found="there", expected="no file of this name")
    if cut:
        reason = f"{cut} cut short by a kill or a power cut, as if never written"
        left_out.append(LeftOut(name="lines of journals", reason=reason))


def _compare(notes: Notes, place: str, entry: Entry, files: Figures, folder: SweepFolder) -> None:
    """Compare a line that says done with the file of its run; a sweep that keeps none has none to compare."""
    row = entry.row
    if row is None or not row.file:
        return
    notes.say(f"{place} file", found=row.file, expected=folder.relative(entry.run_id))
    if entry.run_id not in files:
        there = folder.run(entry.run_id).exists()
        found = "no result that can be read" if there else "missing"
        notes.say(row.file, found=found, expected=f"the result that {place} calls done")
        return
    figures = files[entry.run_id]
    for name in dict.fromkeys([*figures, *row.figures]):
        found, right = (json.dumps(each.get(name, "missing")) for each in (row.figures, figures))
        notes.say(f"{place} {name}", found=found, expected=f"{right} of {row.file}" if found != right else found)
