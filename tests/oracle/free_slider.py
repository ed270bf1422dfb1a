"""A slider that bounces over paraboloids, by fixed small steps of Verlet: slow, and nothing shared with the engine."""

import numpy as np


def bounce(place, height, live, speed, loss, duration, steps, damping_ratio=0.0):
    """Return z at every tenth step from z = z' = 0; loss: of overlaps and their rates, the share of the force."""
    h = duration / steps
    z, w, found = 0.0, 0.0, [0.0]

    def pull(t, z, w):
        off = speed * t - place
        overlap = np.maximum(height - off * off - z, 0.0)
        return float((overlap * loss(-2.0 * speed * off - w)).sum()) / live - 1.0 - 2.0 * damping_ratio * w

    a = pull(0.0, z, w)
    for n in range(1, steps + 1):
        z += h * w + 0.5 * h * h * a
        ahead = w + h * a
        for _ in range(3):
            new = pull(n * h, z, ahead)
            ahead = w + 0.5 * h * (a + new)
        w, a = ahead, new
        if n % 10 == 0:
            found.append(z)
    return np.array(found)
