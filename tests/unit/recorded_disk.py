"""A disk that writes down every call by which a result reaches it, and makes any moment of it again.

After a kill everything that was called has happened. After a power cut, of what no call had seen onto the disk, any
part may be missing: of the bytes of a file any pages, of the names in a folder the latest.
"""

import os
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

import pytest

from rubnoise.storage import disk

Call = tuple[Any, ...]
"""What was called, on which file by number or path, and with what."""

NAMED = ("create", "rename", "link", "remove")
PAGE = 4096


@dataclass
class Recording:
    """All calls of a stretch of work in one folder; ``moments`` are the numbers of calls after which it may stop."""

    folder: Path
    calls: list[Call] = field(default_factory=list)
    _open: dict[int, int] = field(default_factory=dict)
    _files: dict[str, int] = field(default_factory=dict)

    @property
    def moments(self) -> range:
        """How many calls may have happened."""
        return range(len(self.calls) + 1)

    @contextmanager
    def recording(self) -> Iterator[None]:
        """Write down what is called, and let it happen."""
        with pytest.MonkeyPatch.context() as patch:
            for name in ("create", "reopen"):
                patch.setattr(disk, name, self._opening(name, getattr(disk, name)))
            for name in ("write_all", "resize", "allocate", "sync", "sync_rows"):
                patch.setattr(disk, name, self._changing(name, getattr(disk, name)))
            for name in ("sync_folder", "rename", "link", "remove"):
                patch.setattr(disk, name, self._naming(name, getattr(disk, name)))
            yield

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
            self.calls.append((name, self._open[descriptor], *kept))
            real(descriptor, *given)

        return called

    def _naming(self, name: str, real: Any) -> Any:
        def called(*paths: Path) -> None:
            if name == "remove" and not paths[0].exists():
                return
            self.calls.append((name, *(path.name for path in paths)))
            real(*paths)
            if name in ("rename", "link"):
                self._files[paths[1].name] = self._files[paths[0].name]

        return called

    def after_kill(self, folder: Path, moment: int) -> None:
        """Make a folder as it is after so many calls."""
        _carry_out(folder, list(enumerate(self.calls[:moment])))

    def after_power_cut(self, folder: Path, moment: int, random: Random) -> None:
        """Make a folder as it may be found when the power has gone after so many calls."""
        done = list(enumerate(self.calls[:moment]))
        safe_names = max((n for n, call in done if call[0] == "sync_folder"), default=-1)
        names = [n for n, call in done if call[0] in NAMED and n > safe_names]
        lost = set(names[random.randint(0, len(names)) :])
        _carry_out(folder, list(_left(done, lost, random)))


def _left(done: list[tuple[int, Call]], lost: set[int], random: Random) -> Iterator[tuple[int, Call]]:
    synced = {call[1]: n for n, call in done if call[0] in ("sync", "sync_rows")}
    for n, call in done:
        if call[0] in ("write_all", "resize") and n > synced.get(call[1], -1):
            if call[0] == "write_all":
                yield from ((n, piece) for piece in _pages(call) if random.random() < 0.5)
            elif random.random() < 0.5:
                yield n, call
        elif n not in lost:
            yield n, call


def _pages(call: Call) -> Iterator[Call]:
    _, file, data, offset = call
    start = 0
    while start < len(data):
        end = min(start + PAGE - (offset + start) % PAGE, len(data))
        yield "write_all", file, data[start:end], offset + start
        start = end


def _carry_out(folder: Path, calls: list[tuple[int, Call]]) -> None:
    """Make names and bytes in a folder; a file that was made, but whose name was lost, is nowhere."""
    names: dict[str, int] = {}
    contents: defaultdict[int, bytearray] = defaultdict(bytearray)
    for n, call in calls:
        if call[0] == "create":
            names[call[1]] = n
        elif call[0] in ("write_all", "resize", "allocate"):
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
        case ("allocate" | "resize" as name, _, size):
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
