"""SimPy's environment with a shorter way from one event to the next."""

from heapq import heappop
from typing import cast

from simpy import Environment, Event


class DistanceClock(Environment):
    """An environment whose clock is the sliding distance in um; everything works in it as in any other."""

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
