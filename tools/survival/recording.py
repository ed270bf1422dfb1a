"""A disk that writes down every call by which a result reaches it, and makes any moment of it again.

After a kill everything that was called has happened. After a power cut, of what no call had flushed to disk, any
part may be missing: of the bytes of a file any pages, of the names of a file the latest.
"""

import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any
from unittest.mock import patch

from rubnoise.storage import disk

Call = tuple[Any, ...]
"""What was called, on which file by number or path, and with what."""

OPENING = ("create", "reopen")
CHANGING = ("write_all", "resize", "allocate", "sync", "sync_rows")
NAMING = ("sync_folder", "rename", "link", "remove")
SYNCING = ("sync", "sync_rows")
PAGE = 4096


@dataclass
class Recording:
    """All calls of a stretch of work in one folder; ``moments`` are the numbers of calls after which it may stop.

    What is in the folder before has been made, and flushed to disk, by the first calls.
    """

    folder: Path
    calls: list[Call] = field(default_factory=list)
    _before: int = 0
    _open: dict[int, int] = field(default_factory=dict)
    _files: dict[str, int] = field(default_factory=dict)

    @property
    def moments(self) -> range:
        """How many calls may have happened."""
        return range(self._before, len(self.calls) + 1)

    @contextmanager
    def recording(self) -> Iterator[None]:
        """Write down what is called, and let it happen."""
        for path in sorted(self.folder.iterdir()):
            self._find(path)
        self._before = len(self.calls)
        with ExitStack() as patches:
            for names, wrapped in ((OPENING, self._opening), (CHANGING, self._changing), (NAMING, self._naming)):
                for name in names:
                    patches.enter_context(patch.object(disk, name, wrapped(name, getattr(disk, name))))
            yield

    def note(self, what: str, value: int) -> None:
        """Write down something that is known from here on."""
        self.calls.append(("note", what, value))

    def noted(self, what: str, moment: int) -> int:
        """Return the last value that was noted of something up to a moment; -1 for none."""
        values = [call[2] for call in self.calls[:moment] if call[:2] == ("note", what)]
        return values[-1] if values else -1

    def after_kill(self, folder: Path, moment: int, *, torn: bool = False) -> None:
        """Make a folder as it is after so many calls; ``torn``: and in the middle of the next, which writes."""
        done = list(enumerate(self.calls[:moment]))
        if torn:
            name, file, data, offset = self.calls[moment]
            done.append((moment, (name, file, data[: len(data) // 2], offset)))
        _carry_out(folder, done)

    def after_power_cut(self, folder: Path, moment: int, random: Random) -> None:
        """Make a folder as it may be found when the power has gone after so many calls."""
        done = list(enumerate(self.calls[:moment]))
        _carry_out(folder, list(_left(done, _lost_names(done, random), random)))

    def _find(self, path: Path) -> None:
        number = len(self.calls)
        self._files[path.name] = number
        self.calls += [
            ("create", path.name),
            ("write_all", number, path.read_bytes(), 0),
            ("sync", number),
            ("sync_folder", path.parent.name),
        ]

    def _opening(self, name: str, real: Any) -> Any:
        def called(path: Path) -> int:
            descriptor: int = real(path)
            if name == "create":
                self._files[path.name] = len(self.calls)
                self.calls.append(("create", path.name))
            self._open[descriptor] = self._files[path.name]
            return descriptor

        return called

    def _changing(self, name: str, real: Any) -> Any:
        def called(descriptor: int, *given: Any) -> None:
            kept = [bytes(each) if isinstance(each, memoryview) else each for each in given]
            self.calls.append((name, self._open.get(descriptor), *kept))
            real(descriptor, *given)

        return called

    def _naming(self, name: str, real: Any) -> Any:
        def called(*paths: Path) -> None:
            if name == "remove" and not paths[0].exists():
                return
            self.calls.append((name, *(path.name for path in paths)))
            real(*paths)
            if name in {"rename", "link"}:
                self._files[paths[1].name] = self._files[paths[0].name]

        return called


def _lost_names(done: Sequence[tuple[int, Call]], random: Random) -> set[int]:
    """Choose what is lost of the names since the folder was last flushed to disk.

    What happened to one file is lost from some moment on; what happened to different ones, in any order.
    """
    safe = max((n for n, call in done if call[0] == "sync_folder"), default=-1)
    files: dict[str, int] = {}
    changes: defaultdict[int, list[int]] = defaultdict(list)
    for n, call in done:
        if call[0] == "create":
            files[call[1]] = n
        elif call[0] in {"rename", "link"}:
            files[call[2]] = files[call[1]]
        if call[0] in {"create", "rename", "link", "remove"} and call[1] in files and n > safe:
            changes[files[call[1]]].append(n)
    return {n for of_one in changes.values() for n in of_one[random.randint(0, len(of_one)) :]}


def _left(done: Sequence[tuple[int, Call]], lost: set[int], random: Random) -> Iterator[tuple[int, Call]]:
    """Yield what is left; of some files all that was not flushed to disk is gone, of others any pages are."""
    synced = {call[1]: n for n, call in done if call[0] in SYNCING}
    kept = {call[1]: random.choice((0.0, 0.5, 0.95)) for _, call in done if call[0] in CHANGING}
    for n, call in done:
        if call[0] not in CHANGING or n <= synced.get(call[1], -1):
            if n not in lost:
                yield n, call
        elif call[0] == "write_all":
            yield from ((n, piece) for piece in _pages(call) if random.random() < kept[call[1]])
        elif random.random() < kept[call[1]]:
            yield n, call


def _pages(call: Call) -> Iterator[Call]:
    _, file, data, offset = call
    start = 0
    while start < len(data):
        end = min(start + PAGE - (offset + start) % PAGE, len(data))
        yield "write_all", file, data[start:end], offset + start
        start = end


def _carry_out(folder: Path, calls: Sequence[tuple[int, Call]]) -> None:
    """Make names and bytes in a folder; a file that was made, but whose name was lost, is nowhere."""
    names: dict[str, int] = {}
    contents: defaultdict[int, bytearray] = defaultdict(bytearray)
    for n, call in calls:
        if call[0] == "create":
            names[call[1]] = n
        elif call[0] in {"write_all", "resize", "allocate"}:
            _change(contents[call[1]], call)
        else:
            _name(names, call)
    made: dict[int, Path] = {}
    for name, file in names.items():
        if file in made:
            os.link(made[file], folder / name)
        else:
            made[file] = folder / name
            (folder / name).write_bytes(contents[file])


def _change(content: bytearray, call: Call) -> None:
    match call:
        case ("write_all", _, data, offset):
            content.extend(b"\0" * (offset + len(data) - len(content)))
            content[offset : offset + len(data)] = data
        case ("allocate" | "resize" as name, _, size, *_):
            content.extend(b"\0" * (size - len(content)))
            if name == "resize":
                del content[size:]


def _name(names: dict[str, int], call: Call) -> None:
    match call:
        case ("rename", source, target) if source in names:
            names[target] = names.pop(source)
        case ("link", source, target) if source in names:
            names[target] = names[source]
        case ("remove", name):
            names.pop(name, None)
