"""How loud a slider is that may leave its contact: level against speed, loss, height and number of contacts.

In the units c, s_0, 1/omega_c: root mean square velocities over seeds, local and secant exponents n of speed, the share
of time apart and contacts made per 1/omega_c. Then n and the exponent m of height by runs in SI units with seeds of
their own, beside m = (1 + n)/2. --speed compares the engine with scipy's solve_ivp and its events.
"""

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import log, sqrt
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from rubnoise.record.memory import MemoryRecord
from rubnoise.scenario import build
from rubnoise.simulation.extent import extent
from rubnoise.simulation.free import motion
from rubnoise.simulation.free.fold import FreeContact, FreeRun
from rubnoise.simulation.run import simulate

SPEEDS = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
LOSSES: tuple[tuple[float, Mapping[str, Any]], ...] = (
    (0.01, {"restitution": 0.7}),
    (0.1, {"restitution": 0.7}),
    (0.1, {"restitution": 0.3}),
    (0.5, {"restitution": 0.7}),
    (2.0, {"restitution": 0.7}),
    (10.0, {"restitution": 0.7}),
    (0.1, {"impact_damping": 0.3}),
)
BETAS = (0.15, 0.3, 0.6)
DISCARDED = 0.2
"""Share of each run in which the start is forgotten."""

HEIGHT = 2.0
"""Factor of height by which m is measured; speed then changes by its root."""


@dataclass(frozen=True, slots=True)
class Level:
    """Mean and standard error over seeds of the velocity, share of time apart, contacts made per 1/omega_c, mean P."""

    velocity: float
    error: float
    apart: float
    hits: float
    load: float


def level(live: float, speed: float, loss: Mapping[str, Any], duration: float, seeds: Sequence[int]) -> Level:
    """Return the level of so many runs of so long (1/omega_c), each over at least 400 c."""
    length = max(duration * speed, 400.0)
    tick = min(0.05, 0.1 * speed)
    contact, ticks = FreeContact(live=live, speed=speed, tick=tick, **loss), int(length / tick)
    kept = [_one(contact, ticks, seed) for seed in seeds]
    values = np.array(kept)
    mean = values.mean(axis=0)
    error = values[:, 0].std(ddof=1) / sqrt(len(seeds))
    return Level(float(mean[0]), float(error), float(mean[1]), float(mean[2]), float(mean[3]))


def _one(contact: FreeContact, ticks: int, seed: int) -> tuple[float, float, float, float]:
    run = FreeRun(contact, seed)
    rows, made = [], 0
    first = int(DISCARDED * ticks)
    for block in run.through(ticks):
        rows.append(block.ticks)
        begin = block.block * run.surface.ticks
        late = (begin + block.marks[motion.MARK_PLACE] / contact.tick) > first
        made += int(np.count_nonzero(late & (block.marks[motion.MARK_KIND] == motion.CONTACT_MADE)))
    kept = np.concatenate(rows, axis=1)[:, first:]
    duration = kept.shape[1] * contact.tick / contact.speed
    velocity = float(np.sqrt(np.mean(np.square(kept[motion.TICK_W]))))
    return velocity, float((kept[motion.TICK_LIVE] == 0).mean()), made / duration, float(kept[motion.TICK_LOAD].mean())


def levels(duration: float, seeds: int) -> None:
    """Print levels and exponents of speed, loss by loss."""
    print("| N | loss | " + " | ".join(f"v = {v:g}" for v in SPEEDS) + " | local n | secant n, 0.3 to 10 |")
    print("|---|---|" + "---|" * (len(SPEEDS) + 2))
    for number, (live, loss) in enumerate(LOSSES):
        found = [level(live, v, loss, duration, range(100 * number, 100 * number + seeds)) for v in SPEEDS]
        local = [_slope(a, b, log(w / v)) for (v, a), (w, b) in _pairs(found)]
        secant, error = _slope(found[1], found[4], log(SPEEDS[4] / SPEEDS[1]))
        ((name, value),) = loss.items()
        cells = " | ".join(f"{each.velocity:.4g}({each.error:.1g})" for each in found)
        slopes = " ".join(f"{n:.2f}" for n, _ in local)
        print(f"| {live:g} | {name} {value:g} | {cells} | {slopes} | {secant:.2f}({error:.2f}) |", flush=True)
        print(
            "  apart:",
            " ".join(f"{each.apart:.3f}" for each in found),
            " hits:",
            " ".join(f"{each.hits:.4f}" for each in found),
            " mean P:",
            " ".join(f"{each.load:.4f}" for each in found),
            flush=True,
        )


def _pairs(found: Sequence[Level]) -> list[tuple[tuple[float, Level], tuple[float, Level]]]:
    known = list(zip(SPEEDS, found, strict=True))
    return list(pairwise(known))


def _slope(first: Level, last: Level, step: float) -> tuple[float, float]:
    """Return d ln velocity over a step of a logarithm, and its standard error."""
    error = sqrt((first.error / first.velocity) ** 2 + (last.error / last.velocity) ** 2)
    return log(last.velocity / first.velocity) / step, error / step


def betas(duration: float, seeds: int) -> None:
    """Print velocities of three impact dampings and their slope."""
    for v in (1.0, 3.0, 10.0):
        found = [level(0.1, v, {"impact_damping": b}, duration, range(2000, 2000 + seeds)) for b in BETAS]
        slope, error = _slope(found[0], found[2], log(BETAS[2] / BETAS[0]))
        cells = " ".join(f"{each.velocity:.4g}({each.error:.1g})" for each in found)
        print(f"beta {BETAS} at v = {v:g}: {cells}; d ln v_rms/d ln beta = {slope:.3f}({error:.3f})", flush=True)


def identity(seeds: int, distance: float) -> None:
    """Print n and m at some speeds from runs in SI units, with seeds of their own."""
    for live, restitution in ((0.1, 0.7), (0.5, 0.3), (5.0, 0.7)):
        for speed in (5.0, 20.0, 100.0):
            root = sqrt(HEIGHT)
            n, n_error = _from_runs(live, restitution, seeds, distance, 0, [(speed / root, 5.0), (speed * root, 5.0)])
            ends = [(speed, 5.0 / HEIGHT), (speed, 5.0 * HEIGHT)]
            m, m_error = _from_runs(live, restitution, seeds, distance, 5000, ends)
            n, n_error = n / log(HEIGHT), n_error / log(HEIGHT)
            m, m_error = m / log(HEIGHT**2), m_error / log(HEIGHT**2)
            off = (m - 0.5 * (1.0 + n)) / sqrt(m_error**2 + 0.25 * n_error**2)
            print(
                f"N {live:g}, e {restitution:g}, {speed:g} mm/s: n = {n:.3f}({n_error:.3f}),"
                f" m = {m:.3f}({m_error:.3f}), (1 + n)/2 = {0.5 * (1.0 + n):.3f}, z = {off:+.2f}",
                flush=True,
            )


def _from_runs(
    live: float, restitution: float, seeds: int, distance: float, first: int, ends: Sequence[tuple[float, float]]
) -> tuple[float, float]:
    """Return ln of the ratio of velocities at two speeds (mm/s) and heights (um), and its error."""
    logs = []
    for place, (speed, height) in enumerate(ends):
        values = [_velocity(live, restitution, speed, height, first + 1000 * place + n, distance) for n in range(seeds)]
        logs.append((log(np.mean(values)), np.std(values, ddof=1) / np.mean(values) / sqrt(seeds)))
    (low, low_error), (high, high_error) = logs
    return float(high - low), float(sqrt(low_error**2 + high_error**2))


def _velocity(live: float, restitution: float, speed: float, height: float, seed: int, distance: float) -> float:
    scenario = build(
        {
            "format": 1,
            "interface": {"load": "0.05 N", "hardness": "1 GPa", "mean_junction_count": live},
            "sliding": {"speed": f"{speed!r} mm/s", "distance": f"{distance / live**0.5!r} um"},
            "load": {"height_scale": height, "mass": "5 g", "motion": "free", "restitution": restitution},
        }
    )
    model = scenario.model()
    record = MemoryRecord(extent(model, seed))
    simulate(model, seed, record, engine="batch")
    velocity = record["load"]["velocity"]
    return float(np.sqrt(np.mean(np.square(velocity[int(DISCARDED * velocity.size) :]))))


def against_scipy(speed: float = 1.0, live: float = 0.5, length: float = 40.0) -> None:
    """Print processor times of the engine and of solve_ivp with an event for each summit, and how far they part."""
    contact = FreeContact(live=live, speed=speed, tick=0.05, restitution=1.0, damping_ratio=0.05)
    ticks = int(length / contact.tick)
    for seed in (1, 1):  # the first compiles
        begin = time.process_time()
        rows = np.concatenate([each.ticks for each in FreeRun(contact, seed).through(ticks)], axis=1)
        own = time.process_time() - begin
    long = replace(contact)
    begin = time.process_time()
    sum(each.ticks.shape[1] for each in FreeRun(long, 1).through(20 * ticks))
    own = (time.process_time() - begin) / 20.0
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
    """Make what is asked for; all of it but the comparison of speeds by default."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--duration", type=float, default=4000.0, help="of a run in 1/omega_c (4000)")
    parser.add_argument("--seeds", type=int, default=4, help="runs of each point (4)")
    parser.add_argument("--distance", type=float, default=20_000.0, help="of runs in SI units with N = 1, in um")
    parser.add_argument("--only", choices=("levels", "betas", "identity", "speed"), help="a part of it")
    asked = parser.parse_args()
    parts = [asked.only] if asked.only else ["levels", "betas", "identity"]
    if "levels" in parts:
        levels(asked.duration, asked.seeds)
    if "betas" in parts:
        betas(asked.duration, asked.seeds)
    if "identity" in parts:
        identity(2 * asked.seeds, asked.distance)
    if "speed" in parts:
        against_scipy()
    return 0
