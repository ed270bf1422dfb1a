"""How the kernels are compiled, to machine code that is kept on disk."""

import os
import warnings
from collections.abc import Callable
from functools import cache
from hashlib import blake2b
from pathlib import Path
from shutil import rmtree
from tempfile import NamedTemporaryFile
from typing import Any, Final

from numba import config, njit
from numba.core import event

SOURCES = ("compiling.py", "contact/pulses.py", "record/rows.py", "simulation/**/*.py", "surface/*.py")
"""Among them are all files whose functions or constants are compiled into functions of other files."""

_CONFIG: Final[Any] = config

_HOW: Final[dict[str, Any]] = {"error_model": "numpy", "fastmath": {"contract"}}
"""A division by zero gives inf, as everywhere else here: a loop that looks out for one can't take several at a time.
Products may be fused with sums; sums keep their order, since the bits are part of the result."""


def compiled(function: Any) -> Any:
    """Compile a function at its first call, and keep the code for later processes if a folder can be written.

    numba's folder is ours only meanwhile, since kernels of other packages have theirs.
    """
    folder = _folder()
    if folder is None:
        return compiled_within(function)
    theirs = _CONFIG.CACHE_DIR
    _CONFIG.CACHE_DIR = str(folder)
    try:
        return njit(cache=True, **_HOW)(function)
    finally:
        _CONFIG.CACHE_DIR = theirs


def compiled_within(function: Any) -> Any:
    """Compile a function that compiled ones call, as a part of them."""
    return njit(**_HOW)(function)


class CodeNotKept(UserWarning):
    """Machine code cannot be kept, so each process compiles it again."""


@cache
def _folder() -> Path | None:
    """Return the folder of machine code, made if need be; None, with a warning, if it cannot be written.

    numba sees whether a kernel's own file has changed, but not the functions that are compiled into it. So each state
    of `SOURCES` has its own folder, in that of NUMBA_CACHE_DIR or of the user's caches, and three of them are kept.
    """
    package = Path(__file__).parent
    files = sorted(path for pattern in SOURCES for path in package.glob(pattern))
    state = blake2b(b"".join(path.read_bytes() for path in files), digest_size=8).hexdigest()
    try:
        root = Path(_CONFIG.CACHE_DIR or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        folder = root / "rubnoise-kernels" / state
        folder.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=folder) as file:  # which makes the folder the newest
            file.write(bytes(65_536))  # whether there is room
    except (OSError, RuntimeError) as problem:  # RuntimeError: there is no home
        text = "compiled code cannot be kept, and each process compiles it again: "
        warnings.warn(f"{text}{getattr(problem, 'strerror', None) or problem}", CodeNotKept, stacklevel=1)
        return None
    for old in sorted(folder.parent.glob("[0-9a-f]" * 16), key=lambda path: -path.stat().st_mtime)[3:]:
        rmtree(old, ignore_errors=True)
    return folder


def is_kept(kernel: Any) -> bool:
    """Whether code of a function is kept for later processes."""
    return any(Path(kernel.stats.cache_path or "").glob(f"*.{kernel.__name__}-*.nbi"))


def before_compiling(call: Callable[[], object]) -> None:
    """Call a function whenever a kernel is compiled in this process; kept code is not."""
    listeners: Any = event
    listeners.register("numba:compile", _Compiling(call))


class _Compiling(event.Listener):
    """Calls a function when numba begins to compile."""

    def __init__(self, call: Callable[[], object]) -> None:
        self._call = call

    def on_start(self, event: object) -> None:
        """Call it."""
        del event
        self._call()

    def on_end(self, event: object) -> None:
        """Do nothing."""
