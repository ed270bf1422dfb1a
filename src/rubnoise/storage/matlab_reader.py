"""Vectors of a MATLAB 5 file, read within the limits of the sandbox."""

import json
import os
from typing import Any, Final

import numpy as np

MOST_VALUES: Final = 10_000_000
"""Of a vector: a file says how many it has before they are unpacked."""

_PIECE_VALUES: Final = 1 << 21
_NUMBERS: Final = frozenset(
    ["double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))]
)


def read_matlab(descriptor: int, name: str, first: int = 0) -> bytes:
    """Return a line of JSON and a piece of a vector as doubles, or the names of all vectors, or a refusal."""
    from scipy.io import loadmat, whosmat

    os.lseek(descriptor, 0, os.SEEK_SET)
    try:
        with os.fdopen(descriptor, "rb", closefd=False) as stream:
            shapes = {each: shape for each, shape, kind in whosmat(stream) if kind in _NUMBERS}
            vectors = [
                each for each, shape in shapes.items() if sum(side != 1 for side in shape) == 1 and 0 not in shape
            ]
            if not name:
                sizes = ", ".join(f"{each} {'x'.join(map(str, shape))}" for each, shape in list(shapes.items())[:12])
                none = f"has no vector of real numbers; it has {sizes or 'no numbers'}"
                return json.dumps({"names": vectors} if vectors else {"refused": none}).encode()
            count = int(np.prod([float(side) for side in shapes[name]]))
            if count > MOST_VALUES:
                return _no(f"{name} has {count:,} values; up to {MOST_VALUES:,} are read; save it as CSV or HDF5")
            os.lseek(descriptor, 0, os.SEEK_SET)
            stream.seek(0)
            found: Any = loadmat(stream, squeeze_me=True, variable_names=[name])[name]
            if not isinstance(found, np.ndarray) or found.dtype.kind not in "fiu" or found.shape != (count,):
                return _no(f"{name} is no vector of real numbers")
            piece = found[first : first + _PIECE_VALUES]
            return json.dumps({"count": count}).encode() + b"\n" + piece.astype("<f8").tobytes()
    except MemoryError:
        return json.dumps({"refused": "", "unseen": True}).encode()
    except Exception as problem:  # noqa: BLE001  (what a damaged file raises is whatever it raises)
        return _no(f"is no MATLAB 5 file that can be read: {str(problem)[:200]}; save it with -v6 or -v7")


def _no(reason: str) -> bytes:
    return json.dumps({"refused": reason}).encode()
