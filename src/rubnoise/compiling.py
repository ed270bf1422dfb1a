"""How the kernels are compiled: without fastmath, to machine code that is kept on disk."""

import pickle
import warnings
from collections.abc import Callable
from functools import cache, partial
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final

from numba import extending, float64, njit
from numba.core.caching import IndexDataCacheFile
from numba.core.runtime.nrt import rtsys
from numba.core.serialize import dumps

SOURCES = (
    "compiling.py",
    "contact/plain_deviates.py",
    "simulation/coupled/*.py",
    "simulation/free/*.py",
    "simulation/kernels/*.py",
    "simulation/slider.py",
    "surface/*.py",
)
"""Files that are compiled into functions of other files."""

UNREADABLE: Final = (
    AttributeError,
    ImportError,
    EOFError,
    pickle.UnpicklingError,
    ValueError,
    TypeError,
    IndexError,
    KeyError,
)
"""What reading a pickle raises that names what is gone."""

SEAL_BYTES: Final = 16

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

    A function is optimized once more with each that calls it; if long ones call each other, that adds up.
    """
    return njit(inline="always", error_model=_DIVISION, **_BARE)(function)


def compiled_for_speed(function: Any) -> Any:
    """Compile a function whose bits are not promised: its sums may be added up in any order."""
    return _kept(function, fastmath={"reassoc", "contract"})


def _kept(function: Any, **how: Any) -> Any:
    try:
        kernel: Any = njit(cache=True, error_model=_DIVISION, **how)(function)
    except RuntimeError:
        # Installed read-only for a user without a home folder: the code can't be kept, so each process compiles again.
        kernel = njit(error_model=_DIVISION, **how)(function)
        kernel._cache.load_overload = _nothing_kept  # noqa: SLF001  (numba has no public way)
        return kernel
    cache = kernel._cache  # noqa: SLF001
    cache.load_overload = partial(_kept_code, cache)
    cache.save_overload = partial(_keep, cache.save_overload, cache.cache_path)
    cache._cache_file = _KeptFile.like(cache._cache_file)  # noqa: SLF001
    return kernel


BEFORE_COMPILING: Final[set[Callable[[], object]]] = set()
"""What is called before a kernel is compiled; if its code is kept, nothing is."""


def _kept_code(cache: Any, signature: Any, context: Any) -> Any:
    """Return the kept code of a function; None if there is none, and the function must be compiled.

    numba's own way begins with loading whatever it can compile, a third of a second that kept code does without.
    """
    rtsys.initialize(context)
    with cache._guard_against_spurious_io_errors():  # noqa: SLF001
        found = cache._load_overload(signature, context)  # noqa: SLF001
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
        if _NOT_KEPT:
            return
        _NOT_KEPT.append(folder)
        reason = problem.strerror or problem
        text = f"compiled code cannot be kept, and each process compiles it again: {folder}: {reason}"
        warnings.warn(text, CodeNotKept, stacklevel=1)


_NOT_KEPT: Final[list[str]] = []


class _KeptFile(IndexDataCacheFile):
    """The files in which numba keeps the code of a function, each after a checksum of its content.

    Numba checks only the function's own file, so it would use code with older versions of other functions in it, and it
    runs code that a disk has damaged. Here code that is damaged, or from another version, is compiled again.
    """

    @classmethod
    def like(cls, file: Any) -> "_KeptFile":
        """Return the files of this class for the files that numba would use."""
        name = file._index_name.removesuffix(".nbi")  # noqa: SLF001
        return cls(file._cache_path, name, (file._source_stamp, _stamp()))  # noqa: SLF001

    def _load_index(self) -> dict[Any, str]:
        try:
            stamp, overloads = self._read(self._index_path)
        except OSError:
            return {}
        return overloads if stamp == self._source_stamp else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, (self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return self._read(str(Path(self._cache_path) / name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(str(Path(self._cache_path) / name), data)

    def _read(self, path: str) -> Any:
        """Return the content as it was written; raises OSError if it is not, which numba takes for missing code."""
        content = Path(path).read_bytes()
        if content[:SEAL_BYTES] != self._seal(content[SEAL_BYTES:]):
            raise OSError(f"{path}: damaged")
        try:
            return pickle.loads(content[SEAL_BYTES:])  # noqa: S301  (it is as this program has written it)
        except UNREADABLE as problem:
            raise OSError(f"{path}: {problem}") from problem

    def _write(self, path: str, what: Any) -> None:
        content: bytes = dumps(what)  # type: ignore[no-untyped-call]
        with self._open_for_write(path) as file:
            file.write(self._seal(content) + content)

    def _seal(self, content: bytes) -> bytes:
        return blake2b(content, digest_size=SEAL_BYTES, key=self._version.encode()).digest()


def is_kept(kernel: Any) -> bool:
    """Whether the code of a function in its present form is kept for later processes."""
    file = getattr(kernel._cache, "_cache_file", None)  # noqa: SLF001
    return file is not None and bool(file._load_index())  # noqa: SLF001


@cache
def _stamp() -> tuple[tuple[str, int, int], ...]:
    """Return the names, sizes and times of the files whose functions are compiled into those of others."""
    folder = Path(__file__).parent
    files = sorted(path for pattern in SOURCES for path in folder.glob(pattern))
    return tuple((path.name, path.stat().st_size, path.stat().st_mtime_ns) for path in files)


def inlined(function: Any) -> Any:
    """Compile a function that makes no arrays into each of its callers, so that its arguments need not be passed."""
    return njit(forceinline=True, error_model=_DIVISION, **_BARE, **_WITHIN)(function)


intrinsic: Callable[[Any], Any] = extending.intrinsic
"""Let compiled code call a function that gives its types and generates its instructions; no other code may call it."""


@intrinsic
def fused(typing_context: Any, factor: Any, other: Any, term: Any) -> Any:
    """Return factor * other + term, rounded once, by one instruction or else by a slow function with the same bits.

    The compiler is never left to choose where to fuse.
    """

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        del context, signature
        return builder.fma(*values)

    del typing_context, factor, other, term
    return float64(float64, float64, float64), generate
