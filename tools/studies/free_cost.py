"""What free motion costs beside scipy's solve_ivp with its events, on the same summits: `tools/studies free_cost`.

Prints processor times and how far the motions part.
"""

import argparse
import time
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from rubnoise.simulation.free import motion
from rubnoise.simulation.free.fold import FreeContact, FreeRun

LONGER = 20
"""How many times as far the engine goes, to be timed at all."""


def against_scipy(speed: float, live: float, length: float) -> None:
    """Print processor times of the engine and of solve_ivp with an event for each summit, and how far they part."""
    contact = FreeContact(live=live, speed=speed, tick=0.05, restitution=1.0, damping_ratio=0.05)
    ticks = int(length / contact.tick)
    rows = np.concatenate([each.ticks for each in FreeRun(contact, 1).through(ticks)], axis=1)  # compiles, too
    begin = time.process_time()
    sum(each.ticks.shape[1] for each in FreeRun(contact, 1).through(LONGER * ticks))
    own = (time.process_time() - begin) / LONGER
    run = FreeRun(contact, 1)
    around = [run.surface.around(block, 1) for block in range(int(length / run.surface.length) + 1)]
    place = np.concatenate([each.place + n * run.surface.length for n, each in enumerate(around)])
    height = np.concatenate([each.height for each in around])
    _, first = np.unique(np.concatenate([each.number for each in around]), return_index=True)  # blocks overlap
    place, height = place[first], height[first]
    begin = time.process_time()
    moved = _by_events(contact, place, height, rows.shape[1])
    theirs = time.process_time() - begin
    off = np.abs(moved - rows[motion.TICK_Z]).max()
    print(
        f"engine {own:.4g} s, solve_ivp with events {theirs:.4g} s, ratio {theirs / own:.0f}; z apart by {off:.1e} s_0"
    )


def _by_events(contact: FreeContact, place: np.ndarray, height: np.ndarray, ticks: int) -> np.ndarray:
    """Return z at the ticks by DOP853, anew wherever an overlap becomes or ceases to be positive."""
    speed, live, drag = contact.speed, contact.live, 2.0 * contact.damping_ratio
    times = np.arange(ticks) * contact.tick / speed
    z = np.zeros(ticks)
    t, y = 0.0, np.zeros(2)
    touching = height - place * place > 0.0
    while t < times[-1]:
        near = np.flatnonzero(np.abs(place - speed * t) < 9.0)
        inside = near[touching[near]]

        def moves(t: float, y: np.ndarray, inside: np.ndarray = inside) -> list[float]:
            overlap = height[inside] - (speed * t - place[inside]) ** 2 - y[0]
            return [y[1], overlap.sum() / live - 1.0 - drag * y[1]]

        events: list[Any] = []
        for i in near:

            def crossing(t: float, y: np.ndarray, i: int = int(i)) -> float:
                return height[i] - (speed * t - place[i]) ** 2 - y[0]

            events.append(crossing)
            events[-1].terminal, events[-1].direction = True, -1.0 if touching[i] else 1.0
        end = min(t + 1.0 / speed, times[-1])
        wanted = times[(times > t) & (times <= end)]
        solution = solve_ivp(moves, (t, end), y, "DOP853", events=events, rtol=1e-11, atol=1e-12, dense_output=True)
        reached = solution.t[-1]
        done = wanted[wanted <= reached]
        if done.size:
            z[np.searchsorted(times, done)] = solution.sol(done)[0]
        t, y = reached, solution.y[:, -1]
        for i, hit in zip(near, solution.t_events, strict=True):
            if hit.size and abs(hit[-1] - reached) < 1e-12:
                touching[i] = not touching[i]
    return z


def main() -> int:
    """Compare both once."""
    parser = argparse.ArgumentParser(prog="studies free_cost", description=__doc__)
    parser.add_argument("--speed", type=float, default=1.0, help="V/(c omega_c) (1)")
    parser.add_argument("--live", type=float, default=0.5, help="junctions in contact, N (0.5)")
    parser.add_argument("--length", type=float, default=40.0, help="of the way, in c (40)")
    asked = parser.parse_args()
    against_scipy(asked.speed, asked.live, asked.length)
    return 0
