"""How the kernels are compiled: to machine code that is kept, without fastmath."""

from typing import Any

from numba import njit


def compiled(function: Any) -> Any:
    """Compile a function at its first call, and keep the machine code for later processes where a folder allows it.

    No fastmath: sums keep their order and products their rounding, since the bits are part of the result.
    """
    try:
        return njit(cache=True)(function)
    except RuntimeError:
        # Installed read-only for a user without a home: there is nowhere to keep it, so each process compiles anew.
        return njit(function)
