"""How much disk and memory this machine leaves to a process."""

import os
import shutil
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from math import inf
from mmap import PAGESIZE
from pathlib import Path, PurePosixPath

BLOCK_BYTES = 512


def free_disk_bytes(path: str | os.PathLike[str]) -> int:
    """Return how many bytes may be written at a path: what its disk has free, a file no larger than RLIMIT_FSIZE.

    The space of a part file beside it, and of rows beside that, counts as free, since it is the new result's or is
    given back. Raises OSError if there is no such folder.
    """
    final = Path(path).absolute()
    room = shutil.disk_usage(final.parent).free
    for beside in (".part", ".part.rows"):
        with suppress(FileNotFoundError):
            about = final.with_name(f"{final.name}{beside}").lstat()
            room += about.st_blocks * BLOCK_BYTES if hasattr(about, "st_blocks") else about.st_size
    return int(min(room, _limit("RLIMIT_FSIZE")))


def _limit(name: str) -> float:
    """Return a limit of this process, inf if it has none or the system knows no limits."""
    try:
        import resource
    except ImportError:
        return inf
    limit = resource.getrlimit(getattr(resource, name))[0]
    return inf if limit == resource.RLIM_INFINITY else limit


def memory_in_use(root: Path = Path("/")) -> int:
    """Return the bytes of memory that this process holds, or 0 if the system does not say."""
    return _pages(root)[1] * PAGESIZE


def free_memory_bytes(root: Path = Path("/")) -> int | None:
    """Return how many more bytes of memory this process may come to hold, or None if nothing is known.

    The least of what the machine has available, what the control groups of the process leave it (version 1 and 2,
    and the groups around them), and what RLIMIT_AS leaves of its address space. ``root`` is where the system's own
    files are looked for.
    """
    return min([*_available(root), *_left_in_groups(root), *_left_of_address_space(root)], default=None)


def _available(root: Path) -> Iterator[int]:
    _, name, after = _text(root / "proc/meminfo").partition("MemAvailable:")
    if name:
        yield int(after.split(maxsplit=1)[0]) * 1024
    elif "SC_PHYS_PAGES" in getattr(os, "sysconf_names", ()):
        yield os.sysconf("SC_PHYS_PAGES") * PAGESIZE


def _left_of_address_space(root: Path) -> Iterator[int]:
    limit = _limit("RLIMIT_AS")
    if limit < inf:
        yield max(int(limit) - _pages(root)[0] * PAGESIZE, 0)


def _left_in_groups(root: Path) -> Iterator[int]:
    """Yield what each control group with a limit leaves; the pages of files in it can be dropped at any time."""
    for folder, version, most in _limits(root):
        _, used, prefix = _NAMES[version]
        now = _number_in_file(folder / used)
        if now is not None:
            counts = _numbers(folder / "memory.stat")
            droppable = counts.get(f"{prefix}inactive_file", 0) + counts.get(f"{prefix}active_file", 0)
            yield max(most - max(now - droppable, 0), 0)


_NO_LIMIT = 1 << 60
_NAMES = {
    1: ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_"),
    2: ("memory.max", "memory.current", ""),
}


@cache
def _limits(root: Path) -> tuple[tuple[Path, int, int], ...]:
    """Return folder, version and limit of the groups that have one; looked for once, as runs of a sweep are many."""
    found = ((folder, version, _number_in_file(folder / _NAMES[version][0])) for folder, version in _groups(root))
    return tuple((folder, version, most) for folder, version, most in found if most is not None and most < _NO_LIMIT)


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


def _pages(root: Path) -> tuple[int, int]:
    """Return the pages of this process's address space, and those of them that are in memory."""
    pages = _text(root / "proc/self/statm").split()
    return (int(pages[0]), int(pages[1])) if pages else (0, 0)


def _numbers(path: Path) -> dict[str, int]:
    entries = (line.split() for line in _text(path).splitlines())
    return {words[0]: int(words[1]) for words in entries if len(words) == 2}


def _number_in_file(path: Path) -> int | None:
    """Return the number that a file holds; None if it is missing or says "max"."""
    text = _text(path).strip()
    return int(text) if text.isdecimal() else None


def _text(path: Path) -> str:
    with suppress(OSError):
        return path.read_text(encoding="utf-8", errors="replace")
    return ""
