"""How the kernels are compiled: to machine code that is kept, without fastmath."""

from typing import Any

from numba import float64, njit
from numba.extending import intrinsic


def compiled(function: Any) -> Any:
    """Compile a function at its first call, and keep the machine code for later processes where a folder allows it.

    No fastmath: sums keep their order and products their rounding, since the bits are part of the result.
    """
    try:
        return njit(cache=True)(function)
    except RuntimeError:
        # Installed read-only for a user without a home: there is nowhere to keep it, so each process compiles anew.
        return njit(function)


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
