"""Workers of a Dask cluster, wherever they are, as long as they see the same folder."""

import time
from collections.abc import Callable
from concurrent.futures import Future
from importlib import import_module
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

from rubnoise.errors import Refused, needing

PATIENCE: Final = 30.0
"""Seconds for a scheduler to answer."""

_COUNTED_EVERY: Final = 1.0


class Cluster:
    """The workers of a scheduler, told by its address or by the file in which it wrote that.

    Workers may come and go meanwhile. One thread for each worker process is what suits the work.
    """

    ahead = 1
    most = 1_000_000

    def __init__(self, scheduler: str) -> None:
        """Find the scheduler; raises ExtraMissing without the library, Refused where nobody answers."""
        with needing("cluster", "--cluster"):
            client = import_module("distributed").Client
        where = {"scheduler_file": scheduler} if Path(scheduler).is_file() else {"address": scheduler}
        try:
            self._client: Any = client(**where, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as problem:
            raise Refused(f"{scheduler}: no scheduler answers there: {problem}") from problem
        self._executor: Any = self._client.get_executor(pure=False)
        self._counted = -_COUNTED_EVERY
        self._lanes = 1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._executor.shutdown(wait=False)
        self._client.close()

    @property
    def lanes(self) -> int:
        """The number of threads of all workers there are now; one where there are none yet."""
        now = time.monotonic()
        if now - self._counted >= _COUNTED_EVERY:
            self._counted, self._lanes = now, max(1, sum(self._client.nthreads().values()))
        return self._lanes

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Future[Any]":
        """Have a function of a module called by any worker."""
        future: Future[Any] = self._executor.submit(function, *arguments)
        return future
