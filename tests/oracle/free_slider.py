"""A slider that bounces over paraboloids, by fixed small steps of Verlet: slow, and nothing shared with the engine."""

import numpy as np

FINER = 512
"""Steps instead of one in which an overlap stops growing or shrinking: where forces jump, Verlet is of first order."""


def bounce(place, height, live, speed, loss, duration, steps, damping_ratio=0.0, finer=FINER):
    """Return z at every tenth step from z = z' = 0; loss: of overlaps and their rates, the share of the force."""
    h = duration / steps

    def overlaps(t, z, w):
        off = speed * t - place
        return np.maximum(height - off * off - z, 0.0), -2.0 * speed * off - w

    def pull(t, z, w):
        overlap, rate = overlaps(t, z, w)
        return float((overlap * loss(rate)).sum()) / live - 1.0 - 2.0 * damping_ratio * w

    def moved(end, h, z, w, a):
        z += h * w + 0.5 * h * h * a
        ahead = w + h * a
        for _ in range(3):
            new = pull(end, z, ahead)
            ahead = w + 0.5 * h * (a + new)
        return z, ahead, new

    def turns(t, before, after):
        """Whether an overlap turns between two ends of a step."""
        (begun, rate), (ended, later) = overlaps(t - h, *before[:2]), overlaps(t, *after[:2])
        return bool(((begun + ended > 0.0) & (rate * later < 0.0)).any())

    now = 0.0, 0.0, pull(0.0, 0.0, 0.0)
    found = [0.0]
    for n in range(1, steps + 1):
        after = moved(n * h, h, *now)
        if turns(n * h, now, after):
            after = now
            for part in range(1, finer + 1):
                after = moved((n - 1 + part / finer) * h, h / finer, *after)
        now = after
        if n % 10 == 0:
            found.append(now[0])
    return np.array(found)
