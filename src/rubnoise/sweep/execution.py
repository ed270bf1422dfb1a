"""Execute the points of a sweep, by workers or one after another: the one loop over scenarios."""

import pickle
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass
from functools import partial
from itertools import islice
from operator import length_hint
from typing import Any, Final, Generic, Protocol, TypeVar, cast

from rubnoise.errors import RubnoiseError, RunStopped
from rubnoise.model import Model
from rubnoise.record.sink import Extent, Sink
from rubnoise.scenario.points import Point
from rubnoise.simulation.extent import Engine, extent
from rubnoise.simulation.run import simulate
from rubnoise.storage.provenance import package_version
from rubnoise.storage.schema import FORMAT_VERSION
from rubnoise.streams import STREAM_VERSION

SECONDS: Final = 1.0
"""Seconds of work in a message: the cost of the message itself is then small, and so is the loss if a worker dies."""

SHARES: Final = 2
"""Messages for each lane into which the remaining work is divided, so that all lanes end at about the same time."""

LONGEST: Final = 256
"""Most points of a message, however short they are."""


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


Result = TypeVar("Result")
BETWEEN: Final = 0.1
"""Seconds after which a waiting sweep looks for signals and calls its watch."""


class Workers(Protocol):
    """The executor of points: this process, a pool of processes, or a cluster.

    A future that raises means that the work is lost: its worker is dead, or gave up.
    """

    @property
    def lanes(self) -> int:
        """Number of messages in work at once."""
        ...

    @property
    def ahead(self) -> int:
        """Number of messages that may wait for each lane."""
        ...

    @property
    def most(self) -> int:
        """Largest number of points of a message."""
        ...

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Future[Any]":
        """Call a function of a module."""
        ...


SCHEDULER_GONE: Final = "the scheduler is gone; the same command resumes the sweep"


class WorkLost(RubnoiseError):  # noqa: N818  (says what happened)
    """The scheduler of the work has ended, or its workers cannot be used."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome(Generic[Result]):
    """The outcome of a point: its result, or the error."""

    point: Point
    result: Result | None = None
    problem: Exception | None = None


Versions = Mapping[str, object]


def versions() -> Versions:
    """Return the versions that must be equal in all processes that make runs of one sweep."""
    return {"rubnoise": package_version("rubnoise"), "stream": STREAM_VERSION, "format": FORMAT_VERSION}


def in_words(found: object) -> str:
    """Return versions as a text, also for a worker that sends none."""
    return (
        ", ".join(f"{name} {each}" for name, each in found.items())
        if isinstance(found, Mapping)
        else "no version that it says"
    )


@dataclass(frozen=True)
class Attempt(Generic[Result]):
    """The outcomes of the points of a message, in order, the time that it took, and the versions that made it."""

    results: list[Result | Exception]
    seconds: float
    made_by: Versions | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the attempt; an exception that other processes cannot build again becomes its text."""
        return Attempt, (
            [_portable(each) if isinstance(each, Exception) else each for each in self.results],
            self.seconds,
            self.made_by,
        )


def _portable(problem: Exception) -> Exception:
    try:
        pickle.loads(pickle.dumps(problem))  # noqa: S301  (what was pickled the moment before)
    except Exception:  # noqa: BLE001  (pickling calls code of any kind)
        return RubnoiseError(f"{type(problem).__name__}: {problem}")
    return problem


def attempted(work: Callable[[Point], Result], points: Sequence[Point], asked: Versions) -> Attempt[Result]:
    """Carry out points one after another; after a failed one the others are still tried.

    None is started if ``asked`` has other versions than those of this process.
    """
    began, made_by = time.monotonic(), versions()
    if made_by != asked:
        return Attempt([], 0.0, made_by)
    results: list[Result | Exception] = []
    for point in points:
        try:
            results.append(work(point))
        except RunStopped:
            raise
        except Exception as problem:  # noqa: BLE001  (whatever it is, it is recorded for this point)
            results.append(problem)
    return Attempt(results, time.monotonic() - began, made_by)


class Execution(Generic[Result]):
    """The execution of the points of a sweep, which can end early."""

    def __init__(
        self,
        points: Iterable[Point],
        work: Callable[[Point], Result],
        workers: Workers,
        *,
        recover: Callable[[Point], Result | None] = lambda _point: None,
        watch: Callable[[], None] = lambda: None,
    ) -> None:
        """Start before the first point.

        ``recover`` finds the result of a point whose worker died after it was done; ``watch`` is called at least every
        BETWEEN seconds, and may raise.
        """
        self._fresh = iter(points)
        self._work = work
        self._versions = versions()
        self._workers = workers
        self._recover = recover
        self._watch = watch
        self._again: deque[Point] = deque()
        self._tried: set[str] = set()
        self._pace = MessageSize()
        self._out: dict[Future[Attempt[Result]], Sequence[Point]] = {}

    def outcomes(self) -> Iterator[Outcome[Result]]:
        """Yield every point with its outcome as soon as it is known; if the caller leaves, waiting points do not start.

        A point whose worker dies is tried once more, alone. Raises WorkLost if no worker can take work any more, or one
        has other versions than this process.
        """
        try:
            self._hand_out()
            while self._out:
                done, _ = wait(self._out, timeout=BETWEEN, return_when=FIRST_COMPLETED)
                self._watch()
                for future in done:
                    yield from self._returned(future)
                self._hand_out()
        finally:
            for future in self._out:
                future.cancel()

    def _hand_out(self) -> None:
        lanes = self._workers.lanes
        while len(self._out) < lanes * (1 + self._workers.ahead) and (points := self._next(lanes)):
            self._out[self._workers.submit(attempted, self._work, points, self._versions)] = points

    def _next(self, lanes: int) -> tuple[Point, ...]:
        if self._again:
            return (self._again.popleft(),)
        size = self._pace.size(length_hint(self._fresh, 1), lanes)
        return tuple(islice(self._fresh, min(size, self._workers.most)))

    def _returned(self, future: "Future[Attempt[Result]]") -> Iterator[Outcome[Result]]:
        points = self._out.pop(future)
        try:
            attempt = future.result()
        except CancelledError as problem:
            raise WorkLost(SCHEDULER_GONE) from problem
        except Exception as problem:  # noqa: BLE001  (whatever it says, the worker did not come back)
            yield from self._lost(points, problem)
            return
        if attempt.made_by != self._versions:
            raise WorkLost(
                f"a worker has {in_words(attempt.made_by)}, and this process {in_words(self._versions)}; give it the"
                " same version, and the same command resumes the sweep"
            )
        self._pace.took(len(points), attempt.seconds)
        for point, result in zip(points, attempt.results, strict=True):
            if isinstance(result, Exception):
                yield Outcome(point=point, problem=result)
            else:
                yield Outcome(point=point, result=result)

    def _lost(self, points: Sequence[Point], problem: Exception) -> Iterator[Outcome[Result]]:
        for point in points:
            if (found := self._recover(point)) is not None:
                yield Outcome(point=point, result=found)
            elif point.run_id in self._tried:
                yield Outcome(point=point, problem=problem)
            else:
                self._tried.add(point.run_id)
                self._again.append(point)


class Here:
    """This process as executor: a call is made at once when it is submitted, and its errors are raised there."""

    lanes = 1
    ahead = 0
    most = 1

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> "Future[Any]":
        """Call a function now."""
        done: Future[Any] = Future()
        done.set_result(function(*arguments))
        return done


Kept = TypeVar("Kept", bound=Sink)


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement(Generic[Kept, Result]):
    """A measurement of a run: ``sink`` takes its rows as they come, ``read`` returns the result at the end.

    Nothing else is kept of a run. Both must be functions of a module, which other processes can import.
    """

    sink: Callable[[Extent], Kept]
    read: Callable[[Model, Kept], Result]


def run_points(points: Iterable[Point], measure: Measurement[Kept, Result]) -> Iterator[tuple[Point, Result]]:
    """Run points in their order, and yield each with its result as soon as it is known."""
    for outcome in Execution(points, partial(measured, measure=measure), Here()).outcomes():
        if outcome.problem is not None:
            raise outcome.problem
        yield outcome.point, cast(Result, outcome.result)


def measured(point: Point, measure: Measurement[Kept, Result]) -> Result:
    """Run one point and return its result, which does not depend on the process or the time."""
    model = point.scenario.model()
    sink = measure.sink(extent(model, point.seed))
    simulate(model, point.seed, sink, engine=cast(Engine, point.scenario.run.engine))
    return measure.read(model, sink)
