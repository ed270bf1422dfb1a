"""How many points are handed to a worker at once."""

from dataclasses import dataclass
from typing import Final

SECONDS: Final = 1.0
"""Work that one message brings: the message itself then costs nothing, and little is lost with a worker."""

SHARES: Final = 2
"""Into how many messages for each lane what is left is cut, so that all lanes end at about the same time."""

LONGEST: Final = 256
"""Points of a message, however short they are."""


@dataclass(slots=True)
class Pace:
    """How long points have taken, and how many of them make a message.

    Points of the first message are tried one by one, since nobody knows yet how long one takes.
    """

    points: int = 0
    seconds: float = 0.0

    def took(self, points: int, seconds: float) -> None:
        """Take note of the points of a message; later ones count for more, as points of a sweep differ."""
        self.points = self.points // 2 + points
        self.seconds = 0.5 * self.seconds + seconds

    def size(self, left: int, lanes: int) -> int:
        """Return how many of the points that are left make the next message; at least one."""
        if not self.points:
            return 1
        fitting = SECONDS * self.points / max(self.seconds, 1e-6)
        return max(1, min(int(fitting), -(-left // (SHARES * lanes)), LONGEST))
