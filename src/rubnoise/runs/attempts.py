"""The loop over an executor: every run of a sweep is tried, and tried again if its worker dies.

A worker that dies may cost its executor all that it has. Runs that were lost once are sent again one by one, those that
were lost twice alone: so a run that always kills its worker fails alone.
"""

import pickle
import time
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Future, wait
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

from rubnoise.errors import Refused, RubnoiseError, RunStopped
from rubnoise.runs.executors import SCHEDULER_GONE, Versions, Workers, WorkLost, in_words, versions
from rubnoise.scenario.points import Point

SECONDS: Final = 1.0
"""Seconds of work in a message: the cost of the message itself is then small, and so is the loss if a worker dies."""

SHARES: Final = 2
"""Messages for each lane into which the remaining work is divided, so that all lanes end at about the same time."""

LONGEST: Final = 256
"""Most points of a message, however short they are."""

AHEAD: Final = 2
"""Messages for each lane, one of which waits."""

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


@dataclass(slots=True)
class MessageSize:
    """The time that points have taken, from which follows how many make a message.

    The first messages have one point each, since the time of a point is not known yet.
    """

    points: int = 0
    seconds: float = 0.0

    def took(self, points: int, seconds: float) -> None:
        """Add the time of a message's points; later ones count more, since points of a sweep differ."""
        self.points = self.points // 2 + points
        self.seconds = 0.5 * self.seconds + seconds

    def size(self, left: int, lanes: int) -> int:
        """Return how many of the remaining points make the next message; at least one."""
        if not self.points:
            return 1
        fitting = SECONDS * self.points / max(self.seconds, 1e-6)
        return max(1, min(int(fitting), -(-left // (SHARES * lanes)), LONGEST))


@dataclass(frozen=True)
class Attempt(Generic[Result]):
    """The outcomes of the points of a message, in order, the time that it took, and the versions that made it."""

    results: list[Result | Exception]
    seconds: float
    made_by: Versions | None = None


def attempted(work: Work[Result], points: Sequence[Point], asked: Versions) -> Attempt[Result]:
    """Carry out points one after another; after a failed one the others are still tried.

    None is started if ``asked`` has other versions than those of this process.
    """
    began, made_by = time.monotonic(), versions()
    results: list[Result | Exception] = []
    for point in points if made_by == asked else ():
        try:
            results.append(work(point))
        except RunStopped:
            raise
        except Exception as problem:  # noqa: BLE001  (whatever it is, it is said of this point)
            results.append(_portable(problem))
    return Attempt(results, time.monotonic() - began, made_by)


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
        self, points: Iterable[Point], work: Work[Result], workers: Workers, watch: Callable[[], None] = lambda: None
    ) -> None:
        """Start before the first point; ``watch`` is called at least every BETWEEN seconds, and may raise."""
        self._fresh = deque(points)
        self._again: deque[Point] = deque()
        self._alone: deque[Point] = deque()
        self._lost: Counter[str] = Counter()
        self._work, self._workers, self._watch = work, workers, watch
        self._versions = versions()
        self._size = MessageSize()
        self._out: dict[Future[Attempt[Result]], Sequence[Point]] = {}
        self._broken = False

    def outcomes(self) -> Generator[Outcome[Result], None, None]:
        """Yield every point with its outcome as soon as it is known; if the caller leaves, waiting points do not start.

        Raises WorkLost if no worker can take work any more, or one has other versions than this process.
        """
        try:
            while self._out or self._left():
                yield from self._handed_out()
                done, _ = wait(self._out, BETWEEN, FIRST_COMPLETED)
                self._watch()
                for future in done:
                    yield from self._returned(self._out.pop(future), future)
                if self._broken and not self._out:
                    self._workers.renew()
                    self._broken = False
        finally:
            for future in self._out:
                future.cancel()

    def _left(self) -> int:
        return len(self._fresh) + len(self._again) + len(self._alone)

    def _handed_out(self) -> Iterator[Outcome[Result]]:
        """Send messages as long as lanes are free; an executor that takes none has lost them."""
        lanes = self._workers.lanes()
        while not self._broken and (points := self._next(lanes)):
            try:
                future = self._workers.executor.submit(attempted, self._work, points, self._versions)
            except (RunStopped, Refused):
                raise
            except Exception as problem:  # noqa: BLE001  (whatever it says, it does not take them)
                self._broken = True
                yield from self._lose(points, problem)
            else:
                self._out[future] = points

    def _next(self, lanes: int) -> Sequence[Point]:
        """Return the points of the next message; none if all lanes are full or nothing is left for now."""
        if len(self._out) >= (1 if self._workers.here else AHEAD * lanes):
            return ()
        if self._fresh:
            size = 1 if self._workers.here else self._size.size(len(self._fresh), lanes)
            return [self._fresh.popleft() for _ in range(min(size, len(self._fresh)))]
        if self._again:
            return (self._again.popleft(),)
        return (self._alone.popleft(),) if self._alone and not self._out else ()

    def _returned(self, points: Sequence[Point], future: "Future[Attempt[Result]]") -> Iterator[Outcome[Result]]:
        try:
            problem = future.exception()
        except CancelledError as cancelled:
            problem = cancelled
        if isinstance(problem, CancelledError):
            raise WorkLost(SCHEDULER_GONE) from problem
        if problem is None:
            yield from self._outcomes_of(points, future.result())
        elif isinstance(problem, Exception):
            self._broken = self._broken or isinstance(problem, BrokenExecutor)
            yield from self._lose(points, problem)
        else:
            raise problem

    def _outcomes_of(self, points: Sequence[Point], attempt: Attempt[Result]) -> Iterator[Outcome[Result]]:
        if attempt.made_by != self._versions:
            raise WorkLost(
                f"a worker has {in_words(attempt.made_by)}, and this process {in_words(self._versions)}; give it the"
                " same versions, and the same command resumes the sweep"
            )
        self._size.took(len(points), attempt.seconds)
        for point, result in zip(points, attempt.results, strict=True):
            if isinstance(result, Exception):
                yield Outcome(point=point, problem=result)
            else:
                yield Outcome(point=point, result=result)

    def _lose(self, points: Sequence[Point], problem: Exception) -> Iterator[Outcome[Result]]:
        """Put points that were lost with their worker back into a queue, or yield those that cost too many."""
        for point in points:
            self._lost[point.run_id] += 1
            if self._lost[point.run_id] >= TRIES:
                reason = " ".join(str(problem).split())
                yield Outcome(point=point, problem=RubnoiseError(f"{TRIES} workers died of it: {reason}"))
            else:
                (self._again if self._lost[point.run_id] < TRIES - 1 else self._alone).append(point)
