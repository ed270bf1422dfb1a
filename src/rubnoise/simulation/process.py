"""SimPy with less work for each event: processes, timeouts and an environment whose clock is the sliding distance.

SimPy starts each process with one event and ends it with another. No process waits for a junction, and these two events
would be nearly half of a junction's cost. `PromptProcess` starts its generator in the constructor, and makes its end an
event only if another process waits for it. Interrupts, waiting for a process and conditions work as usual.
`LiveSet` holds the processes of the live junctions.
"""

from dataclasses import replace
from heapq import heapify, heappop, heappush
from typing import Any, cast

import numpy as np
from simpy import Environment, Event, Process
from simpy.events import NORMAL, ProcessGenerator, Timeout

from rubnoise.simulation.state import LiveRows


class Wait(Timeout):
    """A timeout that enters the queue in its constructor; its delay is not checked, so it must not be negative."""

    def __init__(self, env: Environment, delay: float) -> None:
        """Enter the queue to happen after ``delay`` um."""
        self.env = env
        self.callbacks = []
        self._value = None
        self._delay = delay
        self._ok = True
        heappush(env._queue, (env._now + delay, NORMAL, next(env._eid), self))


class PromptProcess(Process):
    """A process that runs to its first ``yield`` at once, in its constructor."""

    def __init__(self, env: Environment, generator: ProcessGenerator) -> None:
        """Start a generator; an error before its first ``yield`` fails the process, as later errors do."""
        self.env = env
        self.callbacks = []
        self._generator = generator
        maker, env._active_proc = env._active_proc, self
        try:
            awaited = generator.send(None)
        except StopIteration as stop:
            self._end(True, stop.value)
        except BaseException as error:  # noqa: BLE001  (the failure belongs to what waits for the process)
            self._end(False, error)
        else:
            if awaited.callbacks is None:
                self._resume(awaited)
            else:
                awaited.callbacks.append(self._resume)
                self._target = awaited
        env._active_proc = maker

    def _resume(self, event: Event) -> None:
        """Run the generator after an event that has happened, until it yields one that has not."""
        env = self.env
        env._active_proc = self
        generator = self._generator
        while True:
            try:
                if event._ok:
                    awaited = generator.send(event._value)
                else:
                    event._defused = True  # as SimPy marks a failure that is handled
                    awaited = generator.throw(event._value)
            except StopIteration as stop:
                self._end(True, stop.value)
                break
            except BaseException as error:  # noqa: BLE001  (the failure belongs to what waits for the process)
                self._end(False, error)
                break
            if awaited.callbacks is not None:
                awaited.callbacks.append(self._resume)
                self._target = awaited
                break
            event = awaited
        env._active_proc = None

    def _end(self, succeeded: bool, value: Any) -> None:
        """Become an event that has happened; enter the queue only if a process waits for it or if it has failed."""
        self._ok, self._value = succeeded, value
        self._target = None  # type: ignore[assignment]  # what SimPy documents for a process that is dead
        if succeeded and not self.callbacks:
            self.callbacks = None  # type: ignore[assignment]  # SimPy's mark of an event that has been processed
        else:
            self.env.schedule(self)


class LifeProcess(PromptProcess):
    """A prompt process whose generator returns nothing, so that its end is found without an exception."""

    def _resume(self, event: Event) -> None:
        """Run the generator to its next ``yield`` or its end; an event with a value takes the general way."""
        if not event._ok or event._value is not None:
            super()._resume(event)
            return
        env = self.env
        env._active_proc = self
        try:
            awaited = next(self._generator, None)
        except BaseException as error:  # noqa: BLE001  (the failure belongs to what waits for the process)
            self._end(False, error)
        else:
            if awaited is None:
                self._end(True, None)
            elif awaited.callbacks is None:
                super()._resume(awaited)
            else:
                awaited.callbacks.append(self._resume)
                self._target = awaited
        env._active_proc = None


class DistanceClock(Environment):
    """An environment whose clock is the sliding distance in um; everything else works as in any SimPy environment."""

    def __init__(self, begin: float) -> None:
        """Begin at a distance in um, with an empty queue."""
        super().__init__(begin)
        self._counted = 0

    def run_to(self, end: Event) -> None:
        """Process the queue until ``end`` has happened, as ``run`` does step by step.

        Raises the error of ``end`` or of a failed process that no other process waits for, and RuntimeError if the
        queue is empty before ``end`` has happened.
        """
        queue = self._queue
        while end.callbacks is not None:
            try:
                self._now, _, _, event = heappop(queue)
            except IndexError:
                raise RuntimeError("no event is left that could end the block") from None
            callbacks, event.callbacks = event.callbacks, None  # type: ignore[assignment]  # SimPy: processed
            for callback in callbacks:
                callback(event)
            if not event._ok and not hasattr(event, "_defused"):
                raise cast(BaseException, event.value)
        if not end.ok:
            raise cast(BaseException, end.value)

    def begin_again(self, begin: float) -> None:
        """Set the clock to a distance (um) and drop the events of the junctions; all other events stay queued."""
        self._queue[:] = [entry for entry in self._queue if not isinstance(entry[3], Wait)]
        heapify(self._queue)
        self._now = begin

    def count(self) -> int:
        """Return the number of events made since the last count."""
        number = next(self._eid)  # SimPy numbers its events, but does not publish the number
        made, self._counted = number - self._counted, number + 1
        return made


class LiveSet:
    """The junctions of a block, and which of them are alive, as their processes report it.

    ``processes`` maps the row number of each live junction to its process, in order of birth; interrupting a process
    ends its junction now.
    """

    def __init__(self, carried: LiveRows, born: LiveRows, begin: float) -> None:
        """Hold the rows of a block that begins at ``begin`` um; no junction has a process yet."""
        self._rows = carried.then(born)
        self._half_life = self._rows.half_life
        self.joined = len(carried)
        self.processes: dict[int, Process] = {}
        self.numbers: list[int] = self._rows.junction.tolist()
        self.departure: list[float] = self._rows.departure.tolist()
        for row in np.flatnonzero(carried.death <= begin).tolist():
            self.departure[row] = float(carried.death[row])

    def birth_and_half_life(self, row: int) -> tuple[float, float]:
        """Return a junction's birth and the distance from birth to mid-life (um)."""
        return float(self._rows.birth[row]), float(self._half_life[row])

    def rows(self) -> LiveRows:
        """Return the junctions that have joined so far, with the departures of those that have left."""
        return replace(self._rows, departure=np.array(self.departure)).part(0, self.joined)

    def alive(self) -> LiveRows:
        """Return the junctions that have a process now, in order of birth."""
        numbers = np.fromiter(self.processes, np.int64, len(self.processes))
        return self._rows.at(np.searchsorted(self._rows.junction, numbers))
