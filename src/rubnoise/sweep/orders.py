"""Whether the work of this process is still wanted: asked in the middle of a run, at every panel."""

import os
import signal
import sys
from dataclasses import dataclass
from types import FrameType

from rubnoise.errors import RunStopped


@dataclass(slots=True)
class Orders:
    """What a worker process has been told: to stop by SIGTERM, or without words when its parent is gone."""

    parent: int | None = None
    busy: bool = False
    stopped_by: int | None = None

    def obey(self) -> None:
        """Stop at SIGTERM, and leave SIGINT to the parent: the keyboard sends it to every process of a terminal."""
        self.parent = os.getppid()
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, self._stop)

    def check(self, _distance: float, _junctions: int, _live: int) -> None:
        """Raise RunStopped where the run that goes on is not wanted any more (a Watch of `simulate`)."""
        if self.stopped_by is not None:
            raise RunStopped(self.stopped_by)
        if self.parent is not None and os.getppid() != self.parent:
            raise RunStopped(signal.SIGTERM)

    def _stop(self, number: int, _frame: FrameType | None) -> None:
        """Leave at once between two runs; in one, HDF5 must not be interrupted wherever it is."""
        self.stopped_by = number
        if not self.busy:
            sys.exit(128 + number)


ORDERS = Orders()
"""Those of this process; nobody gives any where runs are made in the process that asks for them."""
