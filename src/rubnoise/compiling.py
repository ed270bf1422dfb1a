"""How the kernels are compiled: to machine code that is kept, without fastmath."""

from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from pickle import UnpicklingError
from typing import Any, Final

from numba import float64, njit
from numba.core.runtime.nrt import rtsys
from numba.extending import intrinsic

SOURCES = (
    "compiling.py",
    "contact/plain_deviates.py",
    "simulation/coupled/*.py",
    "simulation/kernels/*.py",
)
"""Files that are compiled into functions of other files."""

UNREADABLE: Final = (
    AttributeError,
    ImportError,
    EOFError,
    UnpicklingError,
    ValueError,
    TypeError,
    IndexError,
    KeyError,
)
"""What reading a pickle raises that is damaged, or that names what is gone."""

_DIVISION: Final = "numpy"
"""A division by zero gives inf, as everywhere else here: a loop that looks out for one can't take several at a time."""

_BARE: Final[dict[str, Any]] = {"_nrt": False}
"""Without numba's runtime, which makes arrays and counts who uses them."""


_WITHIN: Final[dict[str, Any]] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Without what Python and C need to call it."""


def compiled(function: Any) -> Any:
    """Compile a function at its first call, and keep the machine code for later processes where a folder allows it.

    No fastmath: sums keep their order and products their rounding, since the bits are part of the result.
    """
    return _kept(function, fastmath=False)


def compiled_bare(function: Any) -> Any:
    """Compile a function likewise that makes no arrays, not even in what is compiled into it.

    This saves counting references to its arrays, which takes as long as some hundred steps of arithmetic.
    """
    return _kept(function, fastmath=False, **_BARE)


def compiled_within(function: Any) -> Any:
    """Compile a function that makes no arrays for compiled callers alone: to call it from Python is an error.

    What Python would need to call it, and keeping it apart from its callers, takes a fifth of the time to compile them.
    """
    return njit(error_model=_DIVISION, **_BARE, **_WITHIN)(function)


def compiled_into(function: Any) -> Any:
    """Compile a function that makes no arrays as lines of its only caller, whose locals it shares.

    A function is optimized once more with each that calls it; where long ones call each other, that adds up.
    """
    return njit(inline="always", error_model=_DIVISION, **_BARE)(function)


def compiled_for_speed(function: Any) -> Any:
    """Compile a function whose bits are not promised: its sums may be added up in any order."""
    return _kept(function, fastmath={"reassoc", "contract"})


def _kept(function: Any, **how: Any) -> Any:
    try:
        kernel: Any = njit(cache=True, error_model=_DIVISION, **how)(function)
    except RuntimeError:
        # Installed read-only for a user without a home: there is nowhere to keep it, so each process compiles again.
        return njit(error_model=_DIVISION, **how)(function)
    # Numba looks at the function's own file alone, and would keep using code into which others have been compiled.
    cache = kernel._cache  # noqa: SLF001  (numba has no public way)
    cache.load_overload = partial(_kept_code, cache)
    kept = cache._cache_file  # noqa: SLF001
    kept._source_stamp = (kept._source_stamp, _stamp())  # noqa: SLF001
    kept._load_index = partial(_index, kept._load_index)  # noqa: SLF001
    kept._load_data = partial(_code, kept._load_data)  # noqa: SLF001
    return kernel


BEFORE_COMPILING: Final[set[Callable[[], object]]] = set()
"""What is called before a kernel is compiled; where its code is kept, nothing is."""


def _kept_code(cache: Any, signature: Any, context: Any) -> Any:
    """Return code that is kept, None where there is none and all is compiled anew.

    numba's own way begins with loading whatever it can compile, a third of a second that kept code does without.
    """
    rtsys.initialize(context)
    with cache._guard_against_spurious_io_errors():  # noqa: SLF001
        found = cache._load_overload(signature, context)  # noqa: SLF001
    if found is None:
        for prepare in BEFORE_COMPILING:
            prepare()
    return found


def _index(load: Callable[[], dict[Any, str]]) -> dict[Any, str]:
    """Return the index of the code that is kept; an empty one where it cannot be read, and all is compiled anew.

    An earlier version of this program may have kept it, with classes that are gone, or a power cut may have cut it off.
    """
    try:
        return load()
    except UNREADABLE:
        return {}


def _code(load: Callable[[str], Any], name: str) -> Any:
    """Return code that is kept; raises OSError, after which it is compiled anew, where it cannot be read."""
    try:
        return load(name)
    except UNREADABLE as problem:
        raise OSError(f"{name}: {problem}") from problem


@cache
def _stamp() -> tuple[tuple[str, int, int], ...]:
    """Return names, sizes and times of the files that are compiled into others."""
    folder = Path(__file__).parent
    files = sorted(path for pattern in SOURCES for path in folder.glob(pattern))
    return tuple((path.name, path.stat().st_size, path.stat().st_mtime_ns) for path in files)


def inlined(function: Any) -> Any:
    """Compile a function that makes no arrays into whatever calls it, so that its own need not be handed over."""
    return njit(forceinline=True, error_model=_DIVISION, **_BARE, **_WITHIN)(function)


def _fused(typing_context: Any, factor: Any, other: Any, term: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        del context, signature
        return builder.fma(*values)

    del typing_context, factor, other, term
    return float64(float64, float64, float64), generate


fused: Any = intrinsic(_fused)
"""factor * other + term, rounded once: one instruction where there is one, else a slow function with the same bits.

Only to be called by what is compiled. The compiler is never left to choose where to fuse.
"""
