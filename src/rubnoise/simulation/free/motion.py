"""From event to event through a block: contact made and lost, overlaps that stop growing, and the rows written."""

from typing import Any, Final, NamedTuple

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled, compiled_within
from rubnoise.record.rows import ContactKind
from rubnoise.simulation.free.step import (
    LOADS,
    ORDER,
    OVERLAP,
    RATE,
    SHARES,
    TURN,
    Constants,
    Records,
    Series,
    add_up,
    begin_fresh,
    bounds,
    first_zero,
    load_of,
    motion_series,
    overlap_of,
    rate_of,
    shortened,
    slides_until,
    turned,
)
from rubnoise.simulation.series import rate, value

STATE: Final = np.dtype(
    [(name, np.float64) for name in ("s", "z", "w", "x", "u")]
    + [(name, np.int64) for name in ("count", "sliding", "fresh", "next", "listed", "tick", "touches", "marks", "idle")]
)
"""Place from the origin of the block (c), z, z', and x, x' of the slider along the surface; number of encounters in
contact; the one that slides along its step, and the one that has just turned (-1: none); the next encounter of the pool
to be listed, and the number listed; the next tick; rows of touches and of marks; how many of the latest steps took no
time."""

SUMMIT: Final = np.dtype(
    [(name, np.float64) for name in ("place", "height", "share", "entry", "leave")]
    + [("number", np.int64), ("touching", np.int64)]
)
"""An encounter of the pool: entry and leave are the places (c) between which a slider at the bottom touches it."""

TICK: Final = np.dtype([(name, np.float64) for name in ("z", "w", "load", "overlap", "shared", "live", "x", "u")])
"""The motion at a tick, P, sum of overlaps and of overlaps weighted by strength over N, and how many are in contact."""

TOUCH: Final = np.dtype(
    [(name, np.float64) for name in ("made", "lost", "largest", "share")] + [("number", np.int64), ("ago", np.int64)]
)
"""From contact made to contact lost."""

MARK: Final = np.dtype([(name, np.float64) for name in ("place", "speed", "x", "u")] + [("kind", np.int64)])
"""Where the last contact was lost or the first was made."""

REACH: Final = 2.0  # largest distance of a step (c); encounters are listed that far ahead

DONE, FULL, DEEPER, LOST = range(4)
"""Why `advance` returned: the end was reached; space ran out; the separation would fall below the pool's bottom; the
motion stands still."""

CONTACT_LOST, CONTACT_MADE = map(int, ContactKind)

_NOTHING, _TOUCH, _BREAK, _TURN, _SLID = range(5)
_MOST_IDLE: Final = 1000
_CLEAR: Final = 1e-13


class Surface(NamedTuple):
    """The pool of a block in order of entry, memory for the numbers of those near, and its lowest height."""

    pool: Records
    listed: Integers
    bottom: float


class Goal(NamedTuple):
    """Where the motion ends (c, from the block's origin), before which tick rows end, and their distance (c)."""

    place: float
    ticks: int
    tick: float


class Room(NamedTuple):
    """Room for the rows of a block: ticks, touches and marks."""

    ticks: Records
    touches: Records
    marks: Records


@compiled_within
def _sample(
    now: Any, contacts: Records, s: float, moved: tuple[float, float, float, float], law: Constants, ticks: Records
) -> None:
    """Write the row of the next tick, at which the slider is at s with z, z', x, x'."""
    row = ticks[now.tick]
    row.z, row.w, row.x, row.u = moved
    row.load, row.overlap, row.shared = load_of(contacts, now.count, now.sliding, s, row.z, row.w, law)
    row.live = float(now.count)
    now.tick += 1


@compiled_within
def _mark(now: Any, marks: Records, kind: int, speed: float) -> None:
    row = marks[now.marks]
    row.place, row.kind, row.speed, row.x, row.u = now.s, kind, speed, now.x, now.u
    now.marks += 1


@compiled_within
def _touch(now: Any, contacts: Records, summit: Any) -> None:
    """Move an encounter of the pool, whose overlap is 0 and grows, into contact."""
    made = contacts[now.count]
    made.place, made.height, made.share, made.number = summit.place, summit.height, summit.share, summit.number
    made.weight, made.made, made.largest, made.ago = 1.0, now.s, 0.0, 0
    summit.touching = 1
    now.count += 1


@compiled_within
def _break(now: Any, contacts: Records, which: int, surface: Surface, touches: Records) -> None:
    """Write the row of a touch that ends, and remove its encounter from those in contact."""
    row, lost = touches[now.touches], contacts[which]
    row.number, row.made, row.ago, row.lost = lost.number, lost.made, lost.ago, now.s
    row.largest, row.share = lost.largest, lost.share
    for n in range(now.listed):
        if surface.pool[surface.listed[n]].number == lost.number:
            surface.pool[surface.listed[n]].touching = 0
    now.touches += 1
    now.count -= 1
    for n in range(which, now.count):
        contacts[n] = contacts[n + 1]
    now.sliding = _without(now.sliding, which)
    now.fresh = _without(now.fresh, which)


@compiled_within
def _without(kept: int, which: int) -> int:
    """Return the new place of an encounter if another is removed; -1 if it is that one."""
    if kept == which:
        return -1
    return kept - 1 if kept > which else kept


@compiled_within
def _list(now: Any, surface: Surface) -> None:
    """List the encounters that a step may reach, and remove those behind."""
    kept, pool = 0, surface.pool
    for n in range(now.listed):
        which = surface.listed[n]
        if pool[which].touching or pool[which].leave >= now.s:
            surface.listed[kept] = which
            kept += 1
    while now.next < len(pool) and pool[now.next].entry <= now.s + REACH:
        surface.listed[kept] = now.next
        kept += 1
        now.next += 1
    now.listed = kept


@compiled_within
def _prepare(now: Any, law: Constants, contacts: Records, longest: float, series: Series) -> float:
    """Fill the series of a step and return the step's largest duration, at most ``longest``."""
    sums, step = series.sums, longest
    add_up(contacts, now.count, now.s, now.z, law, sums)
    if now.sliding >= 0:
        series.z[:] = 0.0
        series.z[1], series.z[2] = now.w, -law.speed * law.speed
    else:
        motion_series((0.0, now.w), sums[LOADS], law, (1.0, law.drag, 0.0), law.growth, series, series.z)
        damped = law.drag + law.growth * law.per_live * max(sums[LOADS, 0], 0.0)
        step = min(
            step, 2.0 * TURN / (damped + np.sqrt(damped * damped + 4.0 * law.per_live * sums[LOADS, 3]) + 1e-300)
        )
        step = shortened(series.z, step)
    if law.own_spring > 0.0:
        holds = 0.0, law.own_drag, law.own_spring
        motion_series((now.x, now.u), sums[SHARES], law, holds, 0.0, series, series.x)
        own = law.own_drag
        step = min(step, 2.0 * TURN / (own + np.sqrt(own * own + 4.0 * law.own_spring)))
        step = shortened(series.x, step)
    return step


@compiled_within
def _first_touch(
    now: Any, law: Constants, surface: Surface, bend: float, series: Doubles, step: float
) -> tuple[int, float]:
    """Return which encounter is touched first within a step, -1 if none is, and when."""
    which, when = -1, step
    for n in range(now.listed):
        summit = surface.pool[surface.listed[n]]
        if summit.touching:
            continue
        ahead = summit.place - now.s
        overlap, slope = summit.height - ahead * ahead - now.z, 2.0 * law.speed * ahead - now.w
        if overlap + max(slope, 0.0) * when + 0.5 * max(bend, 0.0) * when * when < 0.0:
            continue
        time = first_zero(OVERLAP, overlap, ahead, law.speed, 1.0, bend, 0.0, series, when)
        if time < when:
            which, when = surface.listed[n], time
    return which, when


@compiled_within
def _first_break(
    now: Any, law: Constants, contacts: Records, bend: float, series: Doubles, step: float
) -> tuple[int, float]:
    """Return which contact is lost first within a step, -1 if none is, and when."""
    which, when = -1, step
    for n in range(now.count):
        ahead, overlap = contacts[n].place - now.s, overlap_of(contacts[n], now.s, now.z)
        slope = rate_of(contacts[n], now.s, now.w, law.speed)
        if n == now.sliding or overlap + min(slope, 0.0) * when - 0.5 * max(bend, 0.0) * when * when > 0.0:
            continue
        time = first_zero(OVERLAP, overlap, ahead, law.speed, -1.0, bend, 0.0, series, when)
        if time < when:
            which, when = n, time
    return which, when


@compiled_within
def _first_turn(
    now: Any, law: Constants, contacts: Records, limits: tuple[float, float], series: Doubles, step: float, until: float
) -> tuple[int, float]:
    """Return which overlap stops growing or shrinking first before a time in a step, -1 if none does, and when.

    limits: bounds of |z'''| and |z''''| within the step.
    """
    which, when, (third, fourth) = -1, until, limits
    level = -1.0 / law.growth if law.growth > 0.0 else 0.0
    if now.sliding >= 0 or (law.growth == 0.0 and law.unloaded >= 1.0):
        return which, when
    for n in range(now.count):
        ahead, way = contacts[n].place - now.s, -1.0 if contacts[n].weight == 1.0 else 1.0
        begin, f = 0.0, way * (2.0 * law.speed * ahead - now.w - level)
        f_slope = -way * (2.0 * law.speed * law.speed + 2.0 * series[2])
        if n == now.fresh:
            if f < -_CLEAR * (abs(now.w) + 2.0 * law.speed * abs(ahead)):
                now.fresh = -1
            else:
                begin = begin_fresh(f_slope, -6.0 * way * series[3], third, fourth, step)
        if begin == 0.0 and f + max(f_slope, 0.0) * when + 0.5 * third * when * when < 0.0:
            continue
        time = first_zero(RATE, -level, ahead, law.speed, way, third, begin, series, when)
        if time < when:
            which, when = n, time
    return which, when


@compiled_within
def _next_event(
    now: Any, law: Constants, contacts: Records, surface: Surface, step: float, series: Doubles
) -> tuple[int, int, float]:
    """Return the first event in a step, its encounter, and its time; -1 if the pool is not deep enough."""
    least, most, third, fourth = bounds(series, step)
    square, event = 2.0 * law.speed * law.speed, _NOTHING
    which, when = _first_touch(now, law, surface, -least - square, series, step)
    if which >= 0:
        event = _TOUCH
    lost, at = _first_break(now, law, contacts, most + square, series, when)
    if lost >= 0:
        event, which, when = _BREAK, lost, at
    other, at = _first_turn(now, law, contacts, (third, fourth), series, step, when)
    if other >= 0:
        event, which, when = _TURN, other, at
    z, bottom = now.z, surface.bottom
    if z + min(now.w, 0.0) * when + 0.5 * min(least, 0.0) * when * when <= bottom and (
        z <= bottom or first_zero(OVERLAP, bottom - z, 0.0, 0.0, 1.0, -least, 0.0, series, when) < np.inf
    ):
        return -1, -1, 0.0
    return event, which, when


@compiled_within
def _note_largest(now: Any, law: Constants, contacts: Records, third: float, series: Doubles, when: float) -> None:
    """Update the largest overlap of each encounter in contact, also if it stops growing within the step."""
    speed = law.speed
    for n in range(now.count):
        ahead = contacts[n].place - now.s
        first = 2.0 * speed * ahead - now.w
        last = 2.0 * speed * (ahead - speed * when) - rate(series, ORDER, when)
        time = when
        if first > 0.0 and last < 0.0:
            time = min(first_zero(RATE, 0.0, ahead, speed, -1.0, third, 0.0, series, when), when)
        overlap = overlap_of(contacts[n], now.s, now.z) + speed * time * (2.0 * ahead - speed * time)
        contacts[n].largest = max(contacts[n].largest, overlap - value(series, ORDER, time))


@compiled_within
def _follow(
    now: Any,
    law: Constants,
    contacts: Records,
    surface: Surface,
    event: int,
    which: int,
    after: float,
    out: Room,
) -> None:
    """Change what an event changes: who is in contact, and with which weight."""
    if event == _TOUCH:
        summit = surface.pool[which]
        if now.count == 0:
            _mark(now, out.marks, CONTACT_MADE, 2.0 * law.speed * (summit.place - now.s) - now.w)
        _touch(now, contacts, summit)
    elif event == _BREAK:
        left = -rate_of(contacts[which], now.s, now.w, law.speed)
        _break(now, contacts, which, surface, out.touches)
        if now.count == 0:
            _mark(now, out.marks, CONTACT_LOST, left)
    elif event == _SLID:
        contacts[which].weight = after
        now.fresh, now.sliding = which, -1
    elif event == _TURN:
        weight = 1.0 - contacts[which].weight
        if law.growth == 0.0:
            weight = turned(contacts, now.count, which, now.s, now.z, now.w, law)
        if weight < 0.0:
            now.sliding, now.fresh = which, -1
            now.w = 2.0 * law.speed * (contacts[which].place - now.s)
        else:
            contacts[which].weight = weight
            now.fresh = which


@compiled_within
def _write_ticks(
    now: Any, law: Constants, contacts: Records, goal: Goal, place: float, when: float, ticks: Records, series: Series
) -> None:
    """Write the ticks up to a place that a step reaches after a time."""
    while now.tick < goal.ticks and now.tick * goal.tick <= place:
        at, x, u = now.tick * goal.tick, now.x, now.u
        time = min(max((at - now.s) / law.speed, 0.0), when)
        if law.own_spring > 0.0:
            x, u = value(series.x, ORDER, time), rate(series.x, ORDER, time)
        _sample(
            now, contacts, at, (now.z + value(series.z, ORDER, time), rate(series.z, ORDER, time), x, u), law, ticks
        )


@compiled_within
def _step(now: Any, law: Constants, contacts: Records, surface: Surface, goal: Goal, out: Room, series: Series) -> bool:
    """Move to the next event; return False, and do not move, if the pool is not deep enough."""
    _list(now, surface)
    longest = min(goal.place - now.s, REACH) / law.speed
    step = _prepare(now, law, contacts, longest, series)
    slid, after = np.inf, 1.0
    if now.sliding >= 0:
        slid, after = slides_until(contacts, now.count, now.sliding, now.s, now.z, now.w, law)
        step = min(step, slid)
    event, which, when = _NOTHING, -1, step
    if step > 0.0:
        event, which, when = _next_event(now, law, contacts, surface, step, series.z)
        if event < 0:
            return False
        _note_largest(now, law, contacts, bounds(series.z, step)[2], series.z, when)
    if event == _NOTHING and when == slid:
        event, which = _SLID, now.sliding
    now.idle = 0 if when > 0.0 else now.idle + 1
    place = now.s + law.speed * when
    if event == _NOTHING and when == longest and goal.place - now.s <= REACH:
        place = goal.place
    _write_ticks(now, law, contacts, goal, place, when, out.ticks, series)
    now.s, now.z, now.w = place, now.z + value(series.z, ORDER, when), rate(series.z, ORDER, when)
    if law.own_spring > 0.0:
        now.x, now.u = value(series.x, ORDER, when), rate(series.x, ORDER, when)
    if now.sliding >= 0:
        now.w = 2.0 * law.speed * (contacts[now.sliding].place - place)
    _follow(now, law, contacts, surface, event, which, after, out)
    return True


@compiled
def advance(
    state: Records, law: Constants, contacts: Records, surface: Surface, goal: Goal, out: Room, series: Series
) -> int:
    """Move to the goal, and write the ticks before it; state (1,) and the contacts are changed in place.

    Return DONE, or the reason for stopping earlier; the state is then that of the last event.
    """
    now = state[0]
    while now.s < goal.place:
        room = min(len(out.touches) - now.touches, len(out.marks) - now.marks, len(contacts) - now.count)
        if room < 2:
            return FULL
        if now.idle > _MOST_IDLE:
            return LOST
        if not _step(now, law, contacts, surface, goal, out, series):
            return DEEPER
    while now.tick < goal.ticks and now.tick * goal.tick <= now.s:
        _sample(now, contacts, now.s, (now.z, now.w, now.x, now.u), law, out.ticks)
    return DONE
