"""How the kernels are compiled: without fastmath, to machine code that is kept on disk."""

import warnings
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final

from numba import extending, float64, njit
from numba.core.runtime.nrt import rtsys

SOURCES = (
    "compiling.py",
    "contact/plain_deviates.py",
    "simulation/coupled/*.py",
    "simulation/free/*.py",
    "simulation/kernel.py",
    "simulation/linear.py",
    "surface/*.py",
)
"""Files that are compiled into functions of other files."""

_DIVISION: Final = "numpy"
"""A division by zero gives inf, as everywhere else here: a loop that looks out for one can't take several at a time."""

_BARE: Final[dict[str, Any]] = {"_nrt": False}
"""Without numba's runtime, which makes arrays and counts who uses them."""


_WITHIN: Final[dict[str, Any]] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Without what Python and C need to call it."""


def compiled(function: Any) -> Any:
    """Compile a function at its first call, and keep the machine code for later processes if a folder can be written.

    No fastmath: sums keep their order and products their rounding, since the bits are part of the result.
    """
    return _kept(function)


def compiled_bare(function: Any, *, fuse: bool = False) -> Any:
    """Compile a function likewise that makes no arrays; with ``fuse`` the compiler may fuse products with sums.

    This saves counting references to its arrays, which takes as long as some hundred steps of arithmetic.
    """
    return _kept(function, fastmath={"contract"} if fuse else False, **_BARE)


def compiled_within(function: Any) -> Any:
    """Compile a function that makes no arrays for compiled callers alone: to call it from Python is an error.

    What Python would need to call it, and keeping it apart from its callers, takes a fifth of the time to compile them.
    """
    return njit(error_model=_DIVISION, **_BARE, **_WITHIN)(function)


def compiled_into(function: Any) -> Any:
    """Compile a function that makes no arrays as lines of its only caller, whose locals it shares.

    A function is optimized once more with each that calls it; if long ones call each other, that adds up.
    """
    return njit(inline="always", error_model=_DIVISION, **_BARE)(function)


def compiled_for_speed(function: Any) -> Any:
    """Compile a function whose bits are not promised: its sums may be added up in any order."""
    return _kept(function, fastmath={"reassoc", "contract"})


def _kept(function: Any, **how: Any) -> Any:
    """Compile with numba's own cache, which checks a function's own file, and let it check `SOURCES` too."""
    try:
        kernel: Any = njit(cache=True, error_model=_DIVISION, **how)(function)
    except RuntimeError:
        # Installed read-only for a user without a home folder: the code can't be kept, so each process compiles again.
        kernel = njit(error_model=_DIVISION, **how)(function)
        kernel._cache.load_overload = _nothing_kept  # noqa: SLF001  (numba has no public way)
        return kernel
    kept = kernel._cache  # noqa: SLF001
    kept._cache_file._source_stamp = kept._cache_file._source_stamp, _stamp()  # noqa: SLF001
    kept.load_overload = partial(_kept_code, kept)
    kept.save_overload = partial(_keep, kept.save_overload, kept.cache_path)
    return kernel


BEFORE_COMPILING: Final[set[Callable[[], object]]] = set()
"""What is called before a kernel is compiled; if its code is kept, nothing is."""


def _kept_code(kept: Any, signature: Any, context: Any) -> Any:
    """Return the kept code of a function; None if there is none, and the function must be compiled.

    numba's own way begins with loading whatever it can compile, a third of a second that kept code does without.
    """
    rtsys.initialize(context)
    try:
        found = kept._load_overload(signature, context)  # noqa: SLF001
    except Exception:  # noqa: BLE001  (a pickle that was cut off, or that names what is gone, raises almost anything)
        found = None
        with suppress(OSError):
            kept.flush()
    return _nothing_kept() if found is None else found


def _nothing_kept(*_asked: object) -> None:
    for prepare in BEFORE_COMPILING:
        prepare()


class CodeNotKept(UserWarning):
    """Machine code cannot be kept, so each process compiles it again."""


def _keep(save: Callable[[Any, Any], None], folder: str, signature: Any, code: Any) -> None:
    """Keep code for later processes; if the disk fails, this process still uses the code, and warns once."""
    try:
        save(signature, code)
    except OSError as problem:
        if not _NOT_KEPT:
            reason = problem.strerror or problem
            text = f"compiled code cannot be kept, and each process compiles it again: {folder}: {reason}"
            warnings.warn(text, CodeNotKept, stacklevel=1)
        _NOT_KEPT.append(folder)


_NOT_KEPT: Final[list[str]] = []


def is_kept(kernel: Any) -> bool:
    """Whether the code of a function in its present form is kept for later processes."""
    with suppress(Exception):  # an index that was cut off, as above
        return bool(kernel._cache._cache_file._load_index())  # noqa: SLF001
    return False


@cache
def _stamp() -> str:
    """Return a hash of the files whose functions are compiled into those of others."""
    folder = Path(__file__).parent
    files = sorted(path for pattern in SOURCES for path in folder.glob(pattern))
    return blake2b(b"".join(path.read_bytes() for path in files)).hexdigest()


def inlined(function: Any) -> Any:
    """Compile a function that makes no arrays into each of its callers, so that its arguments need not be passed."""
    return njit(forceinline=True, error_model=_DIVISION, **_BARE, **_WITHIN)(function)


intrinsic: Callable[[Any], Any] = extending.intrinsic
"""Let compiled code call a function that gives its types and generates its instructions; no other code may call it."""


@intrinsic
def fused(typing_context: Any, factor: Any, other: Any, term: Any) -> Any:
    """Return factor * other + term, rounded once, by one instruction or else by a slow function with the same bits.

    Except in the kernel, the compiler is not left to choose where to fuse.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        del context, signature
        return builder.fma(*values)

    del typing_context, factor, other, term
    return float64(float64, float64, float64), generate
