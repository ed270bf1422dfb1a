"""Who makes runs: this process, processes of loky on this machine, a Dask cluster, or an executor of the caller's.

An executor is what has `submit(function, *arguments)` and returns a Future, as those of concurrent.futures do. Every
run of a sweep is tried, and tried again if its worker dies: runs that were lost once are sent again at the end, those
that were lost twice alone, so that a run that always kills its worker fails alone.
"""

import json
import os
import pickle
import signal
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import KW_ONLY, dataclass
from functools import cache, partial
from importlib import import_module
from numbers import Integral
from pathlib import Path
from threading import Thread
from typing import Any, Final, Generic, TypeVar

from rubnoise.errors import Refused, RubnoiseError, RunStopped, needing
from rubnoise.scenario.sweep import Point
from rubnoise.storage.layout import package_version
from rubnoise.storage.schema import FORMAT_VERSION
from rubnoise.streams import STREAM_VERSION


@dataclass(frozen=True, slots=True)
class Workers:
    """What opens an executor, and how many calls it makes at a time.

    ``here``: calls are made in this process when they are submitted.
    """

    start: Callable[[], AbstractContextManager[Any]]
    lanes: Callable[[], int]
    _: KW_ONLY
    here: bool = False


class WorkLost(RubnoiseError):  # noqa: N818  (says what happened)
    """The scheduler of the work has ended, or its workers cannot be used."""


LIBRARIES: Final = ("rubnoise", "numpy", "scipy", "numba")


@cache
def versions() -> Mapping[str, object]:
    """Return the versions that must be equal in all processes that make runs of one sweep."""
    return {name: package_version(name) for name in LIBRARIES} | {"stream": STREAM_VERSION, "format": FORMAT_VERSION}


def in_words(found: object) -> str:
    """Return versions as a text, also for a worker that sends none."""
    known = found.items() if isinstance(found, Mapping) else ()
    return ", ".join(f"{name} {each}" for name, each in known) or "no version that it says"


# This process and others on this machine.
MOST_JOBS: Final = 1024
LIBRARY_THREADS: Final = ("OMP", "OPENBLAS", "MKL", "NUMBA", "VECLIB_MAXIMUM")
ONE_THREAD: Final = {f"{library}_NUM_THREADS": "1" for library in LIBRARY_THREADS}
"""One thread for each worker, since there are as many workers as processors."""

_LOOKS_FOR_PARENT_EVERY: Final = 0.5


def processors() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def local(jobs: Any, runs: int | None = None) -> Workers:
    """Return workers of this machine: by default one for each processor, no more than runs, and one is this process."""
    if jobs is not None and not (isinstance(jobs, Integral) and 1 <= int(jobs) <= MOST_JOBS):
        raise Refused(f"jobs=: {jobs!r:.40} is no number of processes from 1 to {MOST_JOBS}")
    count = min(processors() if jobs is None else int(jobs), MOST_JOBS if runs is None else max(runs, 1))
    if count == 1:
        return Workers(Here, lambda: 1, here=True)
    return Workers(partial(_processes, count), lambda: count)


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
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    warnings.filterwarnings("ignore", "compiled code cannot be kept")  # which each worker would say
    Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_LOOKS_FOR_PARENT_EVERY)
    os._exit(1)  # what it was making stays as a part, which the next one overwrites


# Executors of others.
PATIENCE: Final = 30.0
"""Seconds for a scheduler to answer."""

SCHEDULER_GONE: Final = "the scheduler is gone; the same command resumes the sweep"

_LAST_PORT: Final = 65_535


def opened(executor: Any, jobs: int | None, runs: int | None) -> AbstractContextManager[Workers]:
    """Return the workers of this machine, of an executor, or of a Dask scheduler by its address; see those below."""
    if isinstance(executor, str):
        return cluster(executor)
    return nullcontext(local(jobs, runs) if executor is None else given(executor, jobs))


def given(executor: Any, jobs: int | None) -> Workers:
    """Return an executor of the caller's as workers, or the client of a Dask cluster; raises Refused for neither.

    It gets work for so many calls at a time, by default one for each processor here.
    """
    if hasattr(executor, "get_executor"):
        return of_client(executor)
    if not hasattr(executor, "submit"):
        form = "an executor has submit(function, *arguments), which returns a Future"
        raise Refused(f"executor=: {type(executor).__name__} is no executor; {form}")
    return Workers(lambda: nullcontext(executor), lambda: jobs or processors())


@contextmanager
def cluster(scheduler: str) -> Iterator[Workers]:
    """Find the workers of a Dask scheduler by its address or by the file with it.

    Dask's own configuration decides about TLS. Raises ExtraMissing without the library, and Refused if none answers or
    workers do not suit.
    """
    with needing("cluster", "--cluster"):
        dask = import_module("distributed")
    where = _address(scheduler)
    try:
        client = dask.Client(where, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError, RuntimeError) as problem:
        raise Refused(f"{scheduler}: no scheduler answers there: {problem}") from problem
    with client:
        yield of_client(client)


def of_client(client: Any) -> Workers:
    """Return the workers of a Dask client, which may join and leave; raises Refused if versions differ.

    One thread for each worker process suits the work.
    """
    _check_versions(client)

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


def _check_versions(client: Any) -> None:
    """Raise Refused if a worker has other versions than this process."""
    for worker, theirs in client.run(versions, on_error="return").items():
        if theirs != versions():
            raise Refused(
                f"{worker}: this worker has {in_words(theirs)}, and this process {in_words(versions())}; all runs of a"
                " sweep are made by one version"
            )


def _address(scheduler: str) -> str:
    """Return the address of a scheduler, from the address itself or from the scheduler's file.

    Raises Refused for an address of another form, with which Dask's client would never end.
    """
    known = import_module("distributed.comm.addressing")
    try:
        address = json.loads(Path(scheduler).read_bytes())["address"] if Path(scheduler).is_file() else scheduler
        _, port = known.get_address_host_port(known.normalize_address(address), strict=True)
        if 1 <= port <= _LAST_PORT:
            return str(address)
    except (OSError, ValueError, KeyError, TypeError):
        pass
    raise Refused(f"{scheduler}: is neither the file of a scheduler nor an address such as tcp://10.0.0.1:8786")


AHEAD: Final = 2
"""Runs that are sent for each lane, one of which waits."""

BETWEEN: Final = 0.1
"""Seconds after which a waiting sweep looks for signals and calls its watch."""

TRIES: Final = 3
"""Workers that a run may cost."""

Result = TypeVar("Result")
Work = Callable[[Point], Result]


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome(Generic[Result]):
    """The outcome of a point: its result, or the error."""

    point: Point
    result: Result | None = None
    problem: Exception | None = None


def attempted(work: Work[Result], point: Point, asked: object) -> Result | Exception:
    """Carry out a point and return its result or its error, since an error that is raised is that of a worker.

    Returns WorkLost, and begins nothing, if ``asked`` has other versions than those of this process.
    """
    if (ours := versions()) != asked:
        return WorkLost(
            f"a worker has {in_words(ours)}, and this process {in_words(asked)}; give it the same versions, and the"
            " same command resumes the sweep"
        )
    try:
        return work(point)
    except RunStopped:
        raise
    except Exception as problem:  # noqa: BLE001  (whatever it is, it is said of this point)
        return _portable(problem)


def _portable(problem: Exception) -> Exception:
    """Return an exception that other processes can build again, its text if this one cannot."""
    try:
        pickle.loads(pickle.dumps(problem))  # noqa: S301  (what was pickled the moment before)
    except Exception:  # noqa: BLE001  (pickling calls code of any kind)
        return RubnoiseError(f"{type(problem).__name__}: {problem}")
    return problem


class Attempts(Generic[Result]):
    """The attempts at the points of a sweep, which can end early."""

    def __init__(
        self,
        points: Iterable[Point],
        work: Work[Result],
        workers: Workers,
        watch: Callable[[], None] = lambda: None,
        more: Callable[[], Iterable[Point]] = tuple,
    ) -> None:
        """Start before the first point; ``watch`` is called at least every BETWEEN seconds, and may raise.

        ``more`` returns further points when all have ended.
        """
        self._waiting = [deque(points), *(deque[Point]() for _ in range(TRIES - 1))]
        self._work, self._workers, self._watch, self._more = work, workers, watch, more
        self._out: dict[Future[Any], tuple[Point, int]] = {}
        self._broken = False

    def outcomes(self) -> Generator[Outcome[Result], None, None]:
        """Yield every point with its outcome as soon as it is known; if the caller leaves, waiting points do not start.

        Raises WorkLost if no worker can take work any more, or one has other versions than this process.
        """
        while any(self._waiting):
            self._broken = False
            with self._workers.start() as executor:
                try:
                    yield from self._until_it_breaks(executor)
                finally:
                    for future in self._out:
                        future.cancel()

    def _until_it_breaks(self, executor: Any) -> Iterator[Outcome[Result]]:
        while self._out or (any(self._waiting) and not self._broken):
            yield from self._handed_out(executor)
            done, _ = wait(self._out, BETWEEN, FIRST_COMPLETED)
            self._watch()
            for future in done:
                yield from self._returned(*self._out.pop(future), future)
            if not self._out and not any(self._waiting):
                self._waiting[0].extend(self._more())

    def _handed_out(self, executor: Any) -> Iterator[Outcome[Result]]:
        """Send points as long as lanes are free; an executor that takes none has lost them."""
        most = 1 if self._workers.here else AHEAD * self._workers.lanes()
        while not self._broken and len(self._out) < most and (taken := self._next()):
            point, lost = taken
            try:
                future = executor.submit(attempted, self._work, point, versions())
            except (RunStopped, Refused):
                raise
            except Exception as problem:  # noqa: BLE001  (whatever it says, it does not take them)
                self._broken = True
                yield from self._lose(point, lost, problem)
            else:
                self._out[future] = taken

    def _next(self) -> tuple[Point, int] | None:
        """Return a point and how many workers it has cost; none that cost too many while others are out."""
        for lost, points in enumerate(self._waiting):
            if points and (lost < TRIES - 1 or not self._out):
                return points.popleft(), lost
        return None

    def _returned(self, point: Point, lost: int, future: "Future[Any]") -> Iterator[Outcome[Result]]:
        try:
            problem = future.exception()
        except CancelledError as cancelled:
            problem = cancelled
        if isinstance(problem, CancelledError):
            raise WorkLost(SCHEDULER_GONE) from problem
        if isinstance(problem, Exception):
            self._broken = self._broken or isinstance(problem, BrokenExecutor)
            yield from self._lose(point, lost, problem)
        elif problem is not None:
            raise problem
        elif isinstance(found := future.result(), WorkLost):
            raise found
        elif isinstance(found, Exception):
            yield Outcome(point=point, problem=found)
        else:
            yield Outcome(point=point, result=found)

    def _lose(self, point: Point, lost: int, problem: Exception) -> Iterator[Outcome[Result]]:
        """Let a point that was lost with its worker wait again, or yield it if it has cost too many."""
        if lost + 1 < TRIES:
            self._waiting[lost + 1].append(point)
        else:
            reason = " ".join(str(problem).split())
            yield Outcome(point=point, problem=RubnoiseError(f"{TRIES} workers died of it: {reason}"))
