"""The loop over an executor: every run of a sweep is tried, and tried again if its worker dies.

A worker that dies may cost its executor all that it has. Runs that were lost once are sent again at the end, those that
were lost twice alone: so a run that always kills its worker fails alone.
"""

import pickle
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from dataclasses import dataclass
from typing import Any, Final, Generic, TypeVar

from rubnoise.errors import Refused, RubnoiseError, RunStopped
from rubnoise.runs.executors import SCHEDULER_GONE, Workers, WorkLost, in_words, versions
from rubnoise.scenario.points import Point

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
