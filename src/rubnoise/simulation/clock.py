"""SimPy's environment with a shorter way from one event to the next."""

from heapq import heapify, heappop
from typing import cast

from simpy import Environment, Event

from rubnoise.simulation.process import Wait


class DistanceClock(Environment):
    """An environment whose clock is the sliding distance in um; everything works in it as in any other."""

    def __init__(self, begin: float) -> None:
        """Begin at a distance in um, with an empty queue."""
        super().__init__(begin)
        self._counted = 0

    def run_to(self, end: Event) -> None:
        """Let happen what is in the queue until an event has happened, as ``run`` does step by step.

        Raises the error of a process that failed with nobody waiting for it, and that of ``end`` itself.
        """
        queue = self._queue
        while end.callbacks is not None:
            try:
                self._now, _, _, event = heappop(queue)
            except IndexError:
                raise RuntimeError("no event is left that could end the block") from None
            callbacks, event.callbacks = event.callbacks, None  # type: ignore[assignment]  # SimPy's mark of the past
            for callback in callbacks:
                callback(event)
            if not event._ok and not hasattr(event, "_defused"):
                raise cast(BaseException, event.value)
        if not end.ok:
            raise cast(BaseException, end.value)

    def begin_again(self, begin: float) -> None:
        """Stand at a distance (um) where other junctions take over; events that are not of junctions stay to come."""
        self._queue[:] = [entry for entry in self._queue if not isinstance(entry[3], Wait)]
        heapify(self._queue)
        self._now = begin

    def count(self) -> int:
        """Return how many events have been made since they were counted last."""
        number = next(self._eid)  # SimPy numbers its events, and keeps the number to itself
        made, self._counted = number - self._counted, number + 1
        return made
