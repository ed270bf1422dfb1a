"""How much room a machine has left: on the disk for a result, in memory for the run that makes it."""

import os
import resource
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path, PurePosixPath

BLOCK_BYTES = 512


def disk_room(path: str | os.PathLike[str]) -> int:
    """Return how many bytes may be written at a path: what its disk has free, a file no larger than RLIMIT_FSIZE.

    The space of a part file beside it counts as free, since it is the new result's or is given back. Raises OSError
    where there is no such folder.
    """
    final = Path(path).absolute()
    disk = os.statvfs(final.parent)
    room = disk.f_bavail * disk.f_frsize
    with suppress(FileNotFoundError):
        room += final.with_name(f"{final.name}.part").lstat().st_blocks * BLOCK_BYTES
    largest = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return room if largest == resource.RLIM_INFINITY else min(room, largest)


def memory_in_use(root: Path = Path("/")) -> int:
    """Return the bytes of memory that this process holds, or 0 where the system does not tell."""
    return _kilobytes(root / "proc/self/status").get("VmRSS", 0)


def memory_room(root: Path = Path("/")) -> int | None:
    """Return how many more bytes of memory this process may come to hold, or None where nothing is known.

    The least of what the machine has available, what the control groups of the process leave it (version 1 and 2,
    and the groups around them), and what RLIMIT_AS leaves of its address space. ``root`` is where the system's own
    files are looked for.
    """
    return min([*_available(root), *_left_in_groups(root), *_left_of_address_space(root)], default=None)


def _available(root: Path) -> Iterator[int]:
    available = _kilobytes(root / "proc/meminfo").get("MemAvailable")
    if available is not None:
        yield available
    elif "SC_PHYS_PAGES" in os.sysconf_names:
        yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _left_of_address_space(root: Path) -> Iterator[int]:
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit != resource.RLIM_INFINITY:
        yield max(limit - _kilobytes(root / "proc/self/status").get("VmSize", 0), 0)


def _left_in_groups(root: Path) -> Iterator[int]:
    """Yield what each control group with a limit leaves; the pages of files in it can be dropped at any time."""
    for folder, version in _groups(root):
        limit, used, prefix = _NAMES[version]
        most, now = _number(folder / limit), _number(folder / used)
        if most is not None and now is not None:
            told = _numbers(folder / "memory.stat")
            droppable = told.get(f"{prefix}inactive_file", 0) + told.get(f"{prefix}active_file", 0)
            yield max(most - max(now - droppable, 0), 0)


_NAMES = {
    1: ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_"),
    2: ("memory.max", "memory.current", ""),
}


def _groups(root: Path) -> Iterator[tuple[Path, int]]:
    """Yield the folder and version of every memory group that the process is in, from the innermost outwards."""
    for line in _text(root / "proc/self/cgroup").splitlines():
        _, controllers, name = line.split(":", 2)
        if "memory" in controllers.split(","):
            top, version = root / "sys/fs/cgroup/memory", 1
        elif not controllers:
            top, version = root / "sys/fs/cgroup", 2
        else:
            continue
        # Inside a container the name may be that of the host's tree: what is not there is passed over.
        inner = PurePosixPath(name.lstrip("/"))
        for each in (inner, *inner.parents):
            yield top / each, version


def _kilobytes(path: Path) -> dict[str, int]:
    """Return the entries "Name:   123 kB" of a file, in bytes."""
    entries = (line.split() for line in _text(path).splitlines())
    return {words[0].rstrip(":"): int(words[1]) * 1024 for words in entries if words[2:] == ["kB"]}


def _numbers(path: Path) -> dict[str, int]:
    entries = (line.split() for line in _text(path).splitlines())
    return {words[0]: int(words[1]) for words in entries if len(words) == 2}


def _number(path: Path) -> int | None:
    """Return the number that a file holds; None where it is missing or says "max"."""
    text = _text(path).strip()
    return int(text) if text.isdecimal() else None


def _text(path: Path) -> str:
    with suppress(OSError):
        return path.read_text(encoding="utf-8", errors="replace")
    return ""
