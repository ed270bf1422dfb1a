"""Who makes runs: this process, processes of loky on this machine, a Dask cluster, or an executor of the caller's.

An executor is what has `submit(function, *arguments)` and returns a Future, as those of concurrent.futures do. Every
run of a sweep is tried, and tried again if its worker dies: runs that were lost once are sent again at the end, those
that were lost twice alone, so that a run that always kills its worker fails alone.
"""

import json
import os
import signal
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from functools import cache, partial
from importlib import import_module
from numbers import Integral
from pathlib import Path
from threading import Thread
from typing import Any, Final

from rubnoise.errors import Refused, RubnoiseError, RunStopped, needing
from rubnoise.scenario.sweep import Point
from rubnoise.storage.layout import package_version
from rubnoise.storage.schema import FORMAT_VERSION
from rubnoise.streams import STREAM_VERSION


@dataclass(frozen=True, slots=True)
class Workers:
    """What opens an executor, and how many calls it makes at a time; 0 if this process makes them when submitted."""

    start: Callable[[], AbstractContextManager[Any]]
    lanes: Callable[[], int]


class WorkLost(RubnoiseError):  # noqa: N818  (says what happened)
    """The scheduler of the work has ended, or its workers cannot be used."""


class Failed(str):
    """Why a run has no result."""

    __slots__ = ()


LIBRARIES: Final = ("rubnoise", "numpy", "scipy", "numba")


@cache
def versions() -> str:
    """Return the versions that must be equal in all processes that make runs of one sweep."""
    packages = [f"{name} {package_version(name)}" for name in LIBRARIES]
    return ", ".join([*packages, f"stream {STREAM_VERSION}", f"format {FORMAT_VERSION}"])


# This process and others on this machine.
MOST_JOBS: Final = 1024
ONE_THREAD: Final = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA", "VECLIB_MAXIMUM")}
"""One thread for each worker, since there are as many workers as processors."""


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def local(jobs: Any, runs: int | None = None) -> Workers:
    """Return workers of this machine: by default one for each processor, no more than runs, and one is this process."""
    if jobs is not None and not (isinstance(jobs, Integral) and 1 <= int(jobs) <= MOST_JOBS):
        raise Refused(f"jobs=: {jobs!r:.40} is no number of processes from 1 to {MOST_JOBS}")
    count = min(processors() if jobs is None else int(jobs), MOST_JOBS if runs is None else max(runs, 1))
    return Workers(Here, lambda: 0) if count == 1 else Workers(partial(_processes, count), lambda: count)


class Here(Executor):
    """This process: a call is made when it is submitted, and what it raises is raised there."""

    def submit(self, function: Callable[..., Any], /, *given: Any, **named: Any) -> "Future[Any]":
        """Call a function now."""
        done: Future[Any] = Future()
        done.set_result(function(*given, **named))
        return done


@contextmanager
def _processes(count: int) -> Iterator[Any]:
    """Start processes of loky, which are fresh interpreters and import no main program; after an error kill them."""
    from loky import ProcessPoolExecutor

    executor = ProcessPoolExecutor(count, initializer=_begin_worker, initargs=(os.getpid(),), env=ONE_THREAD)
    finished = False
    try:
        yield executor
        finished = True
    finally:
        executor.shutdown(kill_workers=not finished)


def _begin_worker(parent: int) -> None:
    """Leave the keyboard's signal to the parent, since the keyboard sends it to all, and end when the parent ends."""

    def end_with_parent() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)  # what it was making stays as a part, which the next one overwrites

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.filterwarnings("ignore", "compiled code cannot be kept")  # which each worker would say
    Thread(target=end_with_parent, daemon=True).start()


# Executors of others.
PATIENCE: Final = 30.0  # seconds for a scheduler to answer
SCHEDULER_GONE: Final = "the scheduler is gone; the same command resumes the sweep"


@contextmanager
def opened(executor: Any, jobs: int | None, runs: int | None = None) -> Iterator[Workers]:
    """Yield workers: of this machine, of a Dask scheduler by its address or client, or of an executor.

    The last one gets work for so many calls at a time, by default one for each processor here. Raises Refused for
    something else, if no scheduler answers, and if workers have other versions; ExtraMissing without Dask.
    """
    with _client(executor) if isinstance(executor, str) else nullcontext(executor) as found:
        if found is None:
            yield local(jobs, runs)
        elif hasattr(found, "get_executor"):
            yield _of_client(found)
        elif hasattr(found, "submit"):
            yield Workers(lambda: nullcontext(found), lambda: jobs or processors())
        else:
            form = "an executor has submit(function, *arguments), which returns a Future"
            raise Refused(f"executor=: {type(found).__name__} is no executor; {form}")


def _client(scheduler: str) -> Any:
    """Return a client of a Dask scheduler by its address or the file with it; Dask's own configuration sees to TLS."""
    with needing("cluster", "--cluster"):
        dask = import_module("distributed")
        known = import_module("distributed.comm.addressing")
    try:
        address = json.loads(Path(scheduler).read_bytes())["address"] if Path(scheduler).is_file() else scheduler
        _, port = known.get_address_host_port(known.normalize_address(address), strict=True)
    except (OSError, ValueError, KeyError, TypeError):
        port = 0
    if not 1 <= port < 1 << 16:  # Dask's client would never end
        raise Refused(f"{scheduler}: is neither the file of a scheduler nor an address such as tcp://10.0.0.1:8786")
    try:
        return dask.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError, RuntimeError) as problem:
        raise Refused(f"{scheduler}: no scheduler answers there: {problem}") from problem


def _of_client(client: Any) -> Workers:
    """Return the workers of a Dask client, which may join and leave; one thread for each worker process suits."""
    for worker, theirs in client.run(versions, on_error="return").items():
        if theirs != versions():
            has = theirs if isinstance(theirs, str) else "no version that it says"
            one = "all runs of a sweep are made by one version"
            raise Refused(f"{worker}: this worker has {has}, and this process {versions()}; {one}")

    @contextmanager
    def start() -> Iterator[Any]:
        executor = client.get_executor(pure=False)
        try:
            yield executor
        finally:
            executor.shutdown(wait=False)

    def lanes() -> int:
        try:
            return max(1, sum(client.nthreads().values()))
        except OSError as problem:
            raise WorkLost(SCHEDULER_GONE) from problem

    return Workers(start, lanes)


# What they make.
AHEAD: Final = 2  # runs that are sent for each lane, one of which waits
BETWEEN: Final = 0.1  # seconds after which a waiting sweep looks for signals and calls its watch
TRIES: Final = 3  # workers that a run may cost
Work = Callable[[Point], Any]
Sent = dict["Future[Any]", tuple[Point, int]]
"""Points that are being made, each with the number of workers that it has cost."""


def attempted(work: Work, point: Point, asked: str) -> Any:
    """Return the result of a point, or Failed; raises WorkLost, and begins nothing, if ``asked`` are other versions."""
    if versions() != asked:
        remedy = "give it the same versions, and the same command resumes the sweep"
        raise WorkLost(f"a worker has {versions()}, and this process {asked}; {remedy}")
    try:
        return work(point)
    except RunStopped:
        raise
    except Exception as problem:  # noqa: BLE001  (whatever it is, it is said of this point)
        kind = "" if isinstance(problem, RubnoiseError) else f"{type(problem).__name__}: "
        return Failed(f"{kind}{problem}")


def outcomes(
    points: deque[Point], work: Work, workers: Workers, watch: Callable[[], None] = lambda: None
) -> Generator[tuple[Point, Any], None, None]:
    """Yield every point with its result, or Failed, as soon as it is known; further points may be added meanwhile.

    ``watch`` is called at least every BETWEEN seconds, and may raise; if the caller leaves, waiting points do not
    start. Raises WorkLost if no worker can take work any more, or one has other versions than this process.
    """
    waiting = [points, *(deque[Point]() for _ in range(1, TRIES))]
    while any(waiting):
        sent, sound = Sent(), True
        with workers.start() as executor:
            try:
                while sent or (sound and any(waiting)):
                    sound = sound and _takes_all(executor, work, AHEAD * workers.lanes() or 1, waiting, sent)
                    done, _ = wait(sent, BETWEEN, FIRST_COMPLETED)
                    watch()
                    for future in done:
                        (point, lost), found = sent.pop(future), _result(future)
                        sound = sound and not isinstance(found, BrokenExecutor)
                        if not isinstance(found, Exception):
                            yield point, found
                        elif lost + 1 < TRIES:
                            waiting[lost + 1].append(point)
                        else:
                            yield point, Failed(f"{TRIES} workers died of it: {' '.join(str(found).split())}")
            finally:
                for future in sent:
                    future.cancel()


def _takes_all(executor: Any, work: Work, most: int, waiting: list[deque[Point]], sent: Sent) -> bool:
    """Send points while lanes are free, those that cost many workers alone; return whether the executor took all."""
    while len(sent) < most:
        lost = next((lost for lost, points in enumerate(waiting) if points and (lost < TRIES - 1 or not sent)), None)
        if lost is None:
            break
        point, future = waiting[lost].popleft(), Future[Any]()
        try:
            sent[executor.submit(attempted, work, point, versions())] = point, lost
        except RunStopped:
            raise
        except Exception as problem:  # noqa: BLE001  (whatever it says, it does not take them)
            future.set_exception(problem)
            sent[future] = point, lost
            return False
    return True


def _result(future: "Future[Any]") -> Any:
    """Return the result of a call, or the error with which its worker died."""
    try:
        return future.result()
    except CancelledError as problem:
        raise WorkLost(SCHEDULER_GONE) from problem
    except WorkLost:
        raise
    except Exception as problem:  # noqa: BLE001  (whatever it is, the worker died of it)
        return problem
