"""A quick start: what a short run would wait for longer than it lasts."""

import gc
import sys
from contextlib import suppress
from typing import Any

_BLAS = "scipy.linalg.cython_blas"


def collect_garbage_seldom() -> None:
    """Look for garbage less often: what a command loads stays to the end, and a run makes none that grows."""
    gc.set_threshold(20_000, 50, 50)


def prepare_kernels() -> None:
    """Load numba's array functions without SciPy's linear algebra, which none of our kernels calls.

    Only for a process that is all ours: compiled functions of other people could not multiply matrices in it.
    """
    if "numba.np.arraymath" in sys.modules or _BLAS in sys.modules:
        return
    modules: dict[str, Any] = sys.modules
    modules[_BLAS] = None  # so that its import fails, as where there is no SciPy
    try:
        with suppress(ImportError):
            import numba.np.arraymath  # noqa: F401
    finally:
        del modules[_BLAS]
