"""Workers of a Dask cluster, on any machines that share the folder of the sweep."""

import json
import os
import ssl
import time
from collections.abc import Callable
from concurrent.futures import Future
from importlib import import_module
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

from rubnoise.errors import Refused, needing
from rubnoise.storage.output import reason_of
from rubnoise.sweep.execution import SCHEDULER_GONE, WorkLost, in_words, versions

PATIENCE: Final = 30.0
"""Seconds for a scheduler to answer."""

_COUNTED_EVERY: Final = 1.0


TLS: Final = "tls://"
LAST_PORT: Final = 65_535


def security_of(
    authority: str | os.PathLike[str], certificate: str | os.PathLike[str], key: str | os.PathLike[str] | None
) -> Any:
    """Return a ``distributed.Security`` that accepts only peers with a certificate of this authority.

    All are files in PEM format; the key may be in the file of the certificate. Raises ExtraMissing, and Refused if
    files are missing or do not belong together.
    """
    files = {"tls_ca_file": authority, "tls_client_cert": certificate} | ({"tls_client_key": key} if key else {})
    for option, file in zip(("--tls-ca-file", "--tls-cert", "--tls-key"), files.values(), strict=False):
        _check_readable(option, file)
    security = _library().Security(require_encryption=True, **{name: os.fspath(file) for name, file in files.items()})
    try:
        security.get_connection_args("client")
    except ssl.SSLError as problem:
        reason = (problem.reason or str(problem)).lower().replace("_", " ")
        raise Refused(f"--tls-ca-file, --tls-cert, --tls-key: of no use together: {reason}") from problem
    return security


def _check_readable(option: str, file: str | os.PathLike[str]) -> None:
    try:
        with Path(file).open("rb"):
            return
    except (OSError, ValueError) as problem:
        raise Refused(f"{option}: {file}: {reason_of(problem).lower()}") from problem


def _library() -> Any:
    with needing("cluster", "--cluster"):
        return import_module("distributed")


def _address(scheduler: str, *, encrypted: bool) -> str:
    """Return the address of a scheduler, from the address itself or from the scheduler's file."""
    address = scheduler
    if Path(scheduler).is_file():
        try:
            address = str(json.loads(Path(scheduler).read_bytes())["address"])
        except (OSError, ValueError, KeyError, TypeError) as problem:
            raise Refused(f"{scheduler}: is no file of a scheduler") from problem
    if encrypted and "://" in address and not address.startswith(TLS):
        raise Refused(f"{scheduler}: does not use TLS: its address is {address}")
    return _checked(TLS + address if encrypted and not address.startswith(TLS) else address, scheduler)


def _checked(address: str, scheduler: str) -> str:
    """Return an address in Dask's form; raises Refused if it is not valid, since Dask's client would never end."""
    known = import_module("distributed.comm.addressing")
    try:
        _, port = known.get_address_host_port(known.normalize_address(address), strict=True)
    except ValueError:
        port = 0
    if not 1 <= port <= LAST_PORT:
        raise Refused(f"{scheduler}: is neither the file of a scheduler nor an address such as tcp://10.0.0.1:8786")
    return address


class Cluster:
    """The workers of a scheduler, found by its address or by the file with its address.

    Workers may join and leave during a sweep. One thread for each worker process suits the work.
    """

    ahead = 1
    most = 1_000_000

    def __init__(self, scheduler: str, security: Any = None) -> None:
        """Find the scheduler; raises ExtraMissing without the library, Refused if none answers or workers do not suit.

        ``security``: a ``distributed.Security``, with which all messages use TLS; without it Dask's own configuration
        decides.
        """
        dask = _library()
        where = _address(scheduler, encrypted=security is not None)
        security = security or dask.Security()
        if where.startswith(TLS) and not (security.tls_ca_file and security.tls_client_cert):
            raise Refused(f"{scheduler}: uses TLS; --tls-ca-file, --tls-cert and --tls-key name the files for it")
        try:
            self._client: Any = dask.Client(where, timeout=PATIENCE, set_as_default=False, security=security)
        except (OSError, ValueError) as problem:
            raise Refused(f"{scheduler}: no scheduler answers there: {problem}") from problem
        try:
            self._check_versions()
        except BaseException:
            self._client.close()
            raise
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

    def _check_versions(self) -> None:
        """Raise Refused if a worker has other versions than this process; later workers return work undone."""
        ours = versions()
        for worker, theirs in self._client.run(versions, on_error="return").items():
            if theirs != ours:
                raise Refused(
                    f"{worker}: this worker has {in_words(theirs)}, and this process {in_words(ours)}; all runs of a"
                    " sweep are made by one version"
                )

    @property
    def lanes(self) -> int:
        """The number of threads of all present workers, at least one."""
        now = time.monotonic()
        if now - self._counted >= _COUNTED_EVERY:
            try:
                self._counted, self._lanes = now, max(1, sum(self._client.nthreads().values()))
            except OSError as problem:
                raise WorkLost(SCHEDULER_GONE) from problem
        return self._lanes

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Future[Any]":
        """Call a function of a module on any worker."""
        future: Future[Any] = self._executor.submit(function, *arguments)
        return future
