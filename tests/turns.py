"""One process at a time compiles kernels; the others wait and load its machine code from the cache."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import RLock
from typing import Any

from numba.core.dispatcher import Dispatcher

from rubnoise import compiling
from rubnoise.cli import progress

WAITING = RLock()
DEPTH = [0]


def take_turns() -> None:
    """Make this process and its copies wait while another process that takes turns compiles."""
    plain = Dispatcher.compile
    # Which test compiles what others then load is a matter of chance; what they print is not.
    progress._say_compiling = lambda: None

    def compile_in_turn(dispatcher: Any, signature: Any) -> Any:
        if _kept(dispatcher, signature):
            return plain(dispatcher, signature)
        with _turn():
            return plain(dispatcher, signature)

    Dispatcher.compile = compile_in_turn


def _kept(dispatcher: Any, signature: Any) -> bool:
    """Return whether the machine code is in the cache, or there is no cache."""
    cache = dispatcher._cache
    if not hasattr(cache, "_cache_file"):
        return True
    dispatcher.targetctx.refresh()
    return cache._index_key(signature, dispatcher.targetctx.codegen()) in cache._cache_file._load_index()


@contextmanager
def _turn() -> Iterator[None]:
    """Hold a lock on a source file; a kernel may compile other kernels while it holds it."""
    with WAITING, Path(compiling.__file__).open("rb") as file:
        if not DEPTH[0]:
            fcntl.flock(file, fcntl.LOCK_EX)
        DEPTH[0] += 1
        try:
            yield
        finally:
            DEPTH[0] -= 1
            if not DEPTH[0]:
                fcntl.flock(file, fcntl.LOCK_UN)  # a copy of this process may still have the file open
