"""From event to event through a block: contact made and lost, overlaps that stop growing, and the rows written."""

from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled_bare
from rubnoise.record.rows import ContactKind
from rubnoise.simulation.free.contacts import (
    COLUMNS,
    DRAG,
    GROWTH,
    HEIGHT,
    IMPACT_DAMPING,
    LARGEST,
    LAW,
    MADE,
    NUMBER,
    OWN_DRAG,
    OWN_SPRING,
    PER_LIVE,
    PLACE,
    SHARE,
    SPEED,
    TICK,
    UNLOADED,
    WEIGHT,
    S,
    U,
    W,
    X,
    Z,
    add_up,
    load_of,
    overlap_of,
    rate_of,
    slides_until,
    turned,
)
from rubnoise.simulation.free.series import (
    ORDER,
    TURN,
    bounds,
    motion_series,
    overlap_zero,
    pushed_series,
    rate,
    rate_zero,
    shortened,
    value,
)

COUNT, SLIDING, FRESH, NEXT, LISTED, NEXT_TICK, TOUCHES, MARKS, STEPS, IDLE = range(10)
"""Whole numbers: number of encounters in contact; the one that slides along its step, and the one that has just turned
(-1: none); the next encounter of the pool to be listed, and the number listed; the next tick; rows of touches and of
marks; steps, and how many of the latest took no time."""
WHOLE: Final = 10

POOL_PLACE, POOL_HEIGHT, POOL_SHARE, POOL_NUMBER, ENTRY, LEAVE = range(6)
"""Rows of the pool: encounters in order of the place from which a slider at the bottom would touch them (c)."""
POOL: Final = 6

REACH: Final = 2.0
"""Largest distance of a step (c); encounters are listed that far ahead."""

DONE, FULL, DEEPER, LOST = range(4)
"""Why `advance` returned: the end was reached; space ran out; the separation would fall below the pool's bottom; the
motion stands still."""

TOUCH_NUMBER, TOUCH_MADE, TOUCH_LOST, TOUCH_LARGEST, TOUCH_HEIGHT, TOUCH_SHARE = range(6)
TOUCH_COLUMNS: Final = 6
MARK_PLACE, MARK_KIND, MARK_SPEED, MARK_X, MARK_U = range(5)
MARK_COLUMNS: Final = 5
TICK_Z, TICK_W, TICK_LOAD, TICK_OVERLAP, TICK_SHARED, TICK_LIVE, TICK_X, TICK_U = range(8)
TICK_COLUMNS: Final = 8

CONTACT_LOST, CONTACT_MADE = map(int, ContactKind)

WORK_SERIES, WORK_PUSHED, WORK_SUMS, WORK_SHARES, WORK_POWERS = (
    0,
    ORDER + 1,
    2 * (ORDER + 1),
    2 * ORDER + 6,
    2 * ORDER + 10,
)
WORK: Final = 2 * ORDER + 14

_NOTHING, _TOUCH, _BREAK, _TURN, _SLID = range(5)
_MOST_IDLE: Final = 1000
_CLEAR: Final = 1e-13


@compiled_bare
def _sample(
    contacts: Doubles,
    whole: Integers,
    s: float,
    motion: tuple[float, float, float, float],
    constants: Doubles,
    ticks: Doubles,
) -> None:
    """Write the row of the next tick, at which the slider is at s with z, z', x, x'."""
    z, w, x, u = motion
    n = whole[NEXT_TICK]
    load, overlap, shared = load_of(contacts, whole[COUNT], whole[SLIDING], s, z, w, constants)
    ticks[TICK_Z, n], ticks[TICK_W, n] = z, w
    ticks[TICK_LOAD, n], ticks[TICK_OVERLAP, n], ticks[TICK_SHARED, n] = load, overlap, shared
    ticks[TICK_LIVE, n] = float(whole[COUNT])
    ticks[TICK_X, n], ticks[TICK_U, n] = x, u
    whole[NEXT_TICK] += 1


@compiled_bare
def _mark(whole: Integers, marks: Doubles, kind: int, speed: float, numbers: Doubles) -> None:
    n = whole[MARKS]
    marks[MARK_PLACE, n], marks[MARK_KIND, n], marks[MARK_SPEED, n] = numbers[S], float(kind), speed
    marks[MARK_X, n], marks[MARK_U, n] = numbers[X], numbers[U]
    whole[MARKS] += 1


@compiled_bare
def _touch(whole: Integers, contacts: Doubles, pool: Doubles, which: int, numbers: Doubles) -> None:
    """Move an encounter of the pool, whose overlap is 0 and grows, into contact."""
    n = whole[COUNT]
    contacts[PLACE, n], contacts[HEIGHT, n] = pool[POOL_PLACE, which], pool[POOL_HEIGHT, which]
    contacts[SHARE, n], contacts[NUMBER, n] = pool[POOL_SHARE, which], pool[POOL_NUMBER, which]
    contacts[WEIGHT, n], contacts[MADE, n], contacts[LARGEST, n] = 1.0, numbers[S], 0.0
    whole[COUNT] += 1


@compiled_bare
def _break(whole: Integers, contacts: Doubles, which: int, place: float, touches: Doubles) -> None:
    """Write the row of a touch that ends, and remove its encounter from those in contact."""
    row = whole[TOUCHES]
    touches[TOUCH_NUMBER, row], touches[TOUCH_MADE, row] = contacts[NUMBER, which], contacts[MADE, which]
    touches[TOUCH_LOST, row], touches[TOUCH_LARGEST, row] = place, contacts[LARGEST, which]
    touches[TOUCH_HEIGHT, row], touches[TOUCH_SHARE, row] = contacts[HEIGHT, which], contacts[SHARE, which]
    whole[TOUCHES] += 1
    whole[COUNT] -= 1
    for n in range(which, whole[COUNT]):
        for column in range(COLUMNS):
            contacts[column, n] = contacts[column, n + 1]
    for kept in (SLIDING, FRESH):
        if whole[kept] == which:
            whole[kept] = -1
        elif whole[kept] > which:
            whole[kept] -= 1


@compiled_bare
def _list(whole: Integers, pool: Doubles, touching: Any, listed: Any, s: float) -> None:
    """List the encounters that a step may reach, and remove those behind."""
    kept = 0
    for n in range(whole[LISTED]):
        which = listed[n]
        if touching[which] or pool[LEAVE, which] >= s:
            listed[kept] = which
            kept += 1
    while whole[NEXT] < pool.shape[1] and pool[ENTRY, whole[NEXT]] <= s + REACH:
        listed[kept] = whole[NEXT]
        kept += 1
        whole[NEXT] += 1
    whole[LISTED] = kept


@compiled_bare
def _prepare(
    numbers: Doubles, whole: Integers, constants: Doubles, contacts: Doubles, longest: float, work: Doubles
) -> float:
    """Fill the series of a step and return the step's largest duration, at most ``longest``."""
    series, pushed = work[WORK_SERIES : WORK_SERIES + ORDER + 1], work[WORK_PUSHED : WORK_PUSHED + ORDER + 1]
    sums, shares = work[WORK_SUMS : WORK_SUMS + 4], work[WORK_SHARES : WORK_SHARES + 4]
    powers = work[WORK_POWERS : WORK_POWERS + 4]
    speed, per_live, drag = constants[SPEED], constants[PER_LIVE], constants[DRAG]
    growth = constants[GROWTH] if constants[LAW] == IMPACT_DAMPING else 0.0
    s, z, w = numbers[S], numbers[Z], numbers[W]
    add_up(contacts, whole[COUNT], s, z, speed, growth, sums, shares, powers)
    step = longest
    if whole[SLIDING] >= 0:
        for n in range(ORDER + 1):
            series[n] = 0.0
        series[1], series[2] = w, -speed * speed
    else:
        motion_series(w, sums, powers, per_live, drag, growth, series)
        damped = drag + growth * per_live * max(sums[0], 0.0)
        step = min(step, 2.0 * TURN / (damped + np.sqrt(damped * damped + 4.0 * per_live * sums[3]) + 1e-300))
        step = shortened(series, step)
    if constants[OWN_SPRING] > 0.0:
        own, spring = constants[OWN_DRAG], constants[OWN_SPRING]
        pushed_series(numbers[X], numbers[U], shares, per_live, own, spring, series, pushed)
        step = min(step, 2.0 * TURN / (own + np.sqrt(own * own + 4.0 * spring)))
        step = shortened(pushed, step)
    return step


@compiled_bare
def _begin_fresh(f_slope: float, f_bend: float, third: float, fourth: float, step: float) -> float:
    """Return the time before which the rate of an overlap that has just turned cannot be 0 again."""
    begin = 1e-9 * step
    if f_slope < 0.0 and third > 0.0:
        begin = max(begin, -2.0 * f_slope / third)
    if f_slope <= 0.0 and f_bend < 0.0 and fourth > 0.0:
        begin = max(begin, -3.0 * f_bend / fourth)
    return begin


@compiled_bare
def _next_event(  # noqa: C901, PLR0912  (two loops of compiled code, which share the time found so far)
    numbers: Doubles,
    whole: Integers,
    constants: Doubles,
    contacts: Doubles,
    pool: Doubles,
    touching: Any,
    listed: Any,
    bottom: float,
    step: float,
    series: Doubles,
) -> tuple[int, int, float]:
    """Return the first event in a step, its encounter, and its time; -1 if the pool is not deep enough."""
    s, z, w, speed = numbers[S], numbers[Z], numbers[W], constants[SPEED]
    least, most, third, fourth = bounds(series, step)
    event, which, when = _NOTHING, -1, step
    bend = -least - 2.0 * speed * speed
    for n in range(whole[LISTED]):
        i = listed[n]
        if touching[i]:
            continue
        ahead = pool[POOL_PLACE, i] - s
        overlap = pool[POOL_HEIGHT, i] - ahead * ahead - z
        slope = 2.0 * speed * ahead - w
        if overlap + max(slope, 0.0) * when + 0.5 * max(bend, 0.0) * when * when < 0.0:
            continue
        time = overlap_zero(overlap, ahead, speed, 1.0, bend, series, when)
        if time < when:
            event, which, when = _TOUCH, i, time
    turns = constants[LAW] == IMPACT_DAMPING or constants[UNLOADED] < 1.0
    level = -1.0 / constants[GROWTH] if constants[LAW] == IMPACT_DAMPING else 0.0
    bend = most + 2.0 * speed * speed
    for n in range(whole[COUNT]):
        if n == whole[SLIDING]:
            continue
        ahead = contacts[PLACE, n] - s
        overlap = overlap_of(contacts, n, s, z)
        slope = 2.0 * speed * ahead - w
        if overlap + min(slope, 0.0) * when - 0.5 * max(bend, 0.0) * when * when <= 0.0:
            time = overlap_zero(overlap, ahead, speed, -1.0, bend, series, when)
            if time < when:
                event, which, when = _BREAK, n, time
        if not turns or whole[SLIDING] >= 0:
            continue
        way = -1.0 if contacts[WEIGHT, n] == 1.0 else 1.0
        begin, f = 0.0, way * (slope - level)
        f_slope = -way * (2.0 * speed * speed + 2.0 * series[2])
        if n == whole[FRESH]:
            if f < -_CLEAR * (abs(w) + 2.0 * speed * abs(ahead)):
                whole[FRESH] = -1
            else:
                begin = _begin_fresh(f_slope, -6.0 * way * series[3], third, fourth, step)
        if begin == 0.0 and f + max(f_slope, 0.0) * when + 0.5 * third * when * when < 0.0:
            continue
        time = rate_zero(ahead, level, speed, way, third, begin, series, when)
        if time < when:
            event, which, when = _TURN, n, time
    if z + min(w, 0.0) * when + 0.5 * min(least, 0.0) * when * when <= bottom and (
        z <= bottom or overlap_zero(bottom - z, 0.0, 0.0, 1.0, -least, series, when) < np.inf
    ):
        return -1, -1, 0.0
    return event, which, when


@compiled_bare
def _note_largest(
    numbers: Doubles, count: int, speed: float, contacts: Doubles, third: float, series: Doubles, when: float
) -> None:
    """Update the largest overlap of each encounter in contact, also if it stops growing within the step."""
    s, z, w = numbers[S], numbers[Z], numbers[W]
    for n in range(count):
        ahead = contacts[PLACE, n] - s
        first = 2.0 * speed * ahead - w
        last = 2.0 * speed * (ahead - speed * when) - rate(series, when)
        time = when
        if first > 0.0 and last < 0.0:
            time = min(rate_zero(ahead, 0.0, speed, -1.0, third, 0.0, series, when), when)
        overlap = overlap_of(contacts, n, s, z) + speed * time * (2.0 * ahead - speed * time) - value(series, time)
        contacts[LARGEST, n] = max(contacts[LARGEST, n], overlap)


@compiled_bare
def advance(  # noqa: C901, PLR0912, PLR0915  (one loop of compiled code: read from above, a step is a story)
    numbers: Doubles,
    whole: Integers,
    constants: Doubles,
    contacts: Doubles,
    pool: Doubles,
    touching: Any,
    listed: Any,
    bottom: float,
    end: float,
    end_tick: int,
    out: tuple[Doubles, Doubles, Doubles],
    work: Doubles,
) -> int:
    """Move to the place ``end`` (c from the block's origin), and write the ticks before ``end_tick``.

    Return DONE, or the reason for stopping earlier; the state is then that of the last event.
    """
    ticks, touches, marks = out
    series, pushed = work[WORK_SERIES : WORK_SERIES + ORDER + 1], work[WORK_PUSHED : WORK_PUSHED + ORDER + 1]
    speed, tick = constants[SPEED], constants[TICK]
    while numbers[S] < end:
        room = min(touches.shape[1] - whole[TOUCHES], marks.shape[1] - whole[MARKS])
        if min(room, contacts.shape[1] - whole[COUNT]) < 2:
            return FULL
        if whole[IDLE] > _MOST_IDLE:
            return LOST
        s, z, w = numbers[S], numbers[Z], numbers[W]
        _list(whole, pool, touching, listed, s)
        longest = min(end - s, REACH) / speed
        step = _prepare(numbers, whole, constants, contacts, longest, work)
        slid, after = np.inf, 1.0
        if whole[SLIDING] >= 0:
            slid, after = slides_until(contacts, whole[COUNT], whole[SLIDING], s, z, w, constants)
            step = min(step, slid)
        event, which, when = _NOTHING, -1, step
        if step > 0.0:
            event, which, when = _next_event(
                numbers, whole, constants, contacts, pool, touching, listed, bottom, step, series
            )
            if event < 0:
                return DEEPER
            _, _, third, _ = bounds(series, step)
            _note_largest(numbers, whole[COUNT], speed, contacts, third, series, when)
        if event == _NOTHING and when == slid:
            event, which = _SLID, whole[SLIDING]
        whole[IDLE] = 0 if when > 0.0 else whole[IDLE] + 1
        whole[STEPS] += 1
        place = s + speed * when
        if event == _NOTHING and when == longest and end - s <= REACH:
            place = end
        while whole[NEXT_TICK] < end_tick and float(whole[NEXT_TICK]) * tick <= place:
            at = float(whole[NEXT_TICK]) * tick
            time = min(max((at - s) / speed, 0.0), when)
            moved = (z + value(series, time), rate(series, time), numbers[X], numbers[U])
            if constants[OWN_SPRING] > 0.0:
                moved = (moved[0], moved[1], value(pushed, time), rate(pushed, time))
            _sample(contacts, whole, at, moved, constants, ticks)
        numbers[S], numbers[Z], numbers[W] = place, z + value(series, when), rate(series, when)
        if constants[OWN_SPRING] > 0.0:
            numbers[X], numbers[U] = value(pushed, when), rate(pushed, when)
        if whole[SLIDING] >= 0:
            numbers[W] = 2.0 * speed * (contacts[PLACE, whole[SLIDING]] - place)
        if event == _TOUCH:
            if whole[COUNT] == 0:
                _mark(whole, marks, CONTACT_MADE, 2.0 * speed * (pool[POOL_PLACE, which] - place) - numbers[W], numbers)
            _touch(whole, contacts, pool, which, numbers)
            touching[which] = 1
        elif event == _BREAK:
            left, number = -rate_of(contacts, which, place, numbers[W], speed), contacts[NUMBER, which]
            _break(whole, contacts, which, place, touches)
            for n in range(whole[LISTED]):
                if pool[POOL_NUMBER, listed[n]] == number:
                    touching[listed[n]] = 0
            if whole[COUNT] == 0:
                _mark(whole, marks, CONTACT_LOST, left, numbers)
        elif event == _TURN and constants[LAW] == IMPACT_DAMPING:
            contacts[WEIGHT, which] = 1.0 - contacts[WEIGHT, which]
            whole[FRESH] = which
        elif event == _TURN:
            weight = turned(contacts, whole[COUNT], which, place, numbers[Z], numbers[W], constants)
            if weight < 0.0:
                whole[SLIDING], whole[FRESH] = which, -1
                numbers[W] = 2.0 * speed * (contacts[PLACE, which] - place)
            else:
                contacts[WEIGHT, which] = weight
                whole[FRESH] = which
        elif event == _SLID:
            contacts[WEIGHT, which] = after
            whole[FRESH], whole[SLIDING] = which, -1
    while whole[NEXT_TICK] < end_tick and float(whole[NEXT_TICK]) * tick <= numbers[S]:
        moved = (numbers[Z], numbers[W], numbers[X], numbers[U])
        _sample(contacts, whole, numbers[S], moved, constants, ticks)
    return DONE
