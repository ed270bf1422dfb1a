"""Slip, stick and reversal: which step comes next, and what happens where w = 0; compiled.

    at w = 0, f = k x + c V:   |f| <= G: stick      f < -G: into reversal      f > G: forward

A stick ends after exactly (G - f)/(k V), always forward, with w = w' = 0 and w'' = k V/m. The step that leaves w = 0 is
made so short that w is above 0 at its end, so that nothing is looked for in it. Where w' turns upwards inside a step, the
step is made to end there, and its minimum tells whether the slider has arrived.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.compiling import compiled_bare
from rubnoise.simulation.coupled.field import (
    AGE,
    GROUP,
    SIZE,
    Lives,
    force_in_cell,
    gather,
    merged,
)
from rubnoise.simulation.coupled.quadrature import BOTH, CLOCKS, LEFT, NODES, PLAIN, RIGHT
from rubnoise.simulation.coupled.rows import (
    BEND_LIMIT,
    BORN,
    BREAKAWAY,
    CELL,
    DISPLACEMENT,
    FORWARD,
    FRESH,
    KINK_LIMIT,
    LANDMARKS,
    LIMIT,
    LONGEST,
    OFFSET,
    OVER,
    PHASE,
    RELATIVE,
    REST,
    REST_OVER,
    REST_PLACE,
    REST_ROW,
    REVERSAL,
    REVERSED,
    ROW,
    ROW_TIME,
    ROWS,
    SLIP,
    SPACING,
    STEP,
    STICK,
    STUCK,
    TIME_STUCK,
    TOUCH,
    VV_TIME,
    X_TIME,
    XX_TIME,
    pass_time,
    sum_step,
    sum_uniform,
    tell_landmark,
    tell_row,
    tell_step,
    tell_uniform,
)
from rubnoise.simulation.coupled.steps import (
    DAMPING,
    DRIVE,
    GROWTH,
    MASS,
    PACE,
    PUSH,
    SPEED,
    STIFFNESS,
    clock_at,
    event_cell,
    integral_to,
    time_step,
    uniform_cell,
    value_at,
)

Doubles = NDArray[np.float64]
Integers = NDArray[np.int64]

DONE, AHEAD, BACK, FULL, LOST = range(5)
"""Why `advance` returns: the run is over; cells ahead, or behind, are wanted; no room for rows; no step is found."""

_MOST_TRIES: Final = 200
_HALVINGS: Final = 4
_AT_ONCE: Final = 1e-12
"""Of a cell: places that are nearer to each other than this are one."""


@compiled_bare
def next_border(near: Doubles, count: int, offset: float, way: float, width: float) -> tuple[float, int]:
    """Return the next birth, mid-life, death or edge in a gathered cell, and the clock of a step to there."""
    size, least = len(near) // 4, _AT_ONCE * width
    border = width if way > 0.0 else 0.0
    smooth = True
    for n in range(count):
        age, across = near[AGE * size + n], near[SIZE * size + n]
        for half in range(3):
            place = half * across - age
            ahead = way * (place - offset)
            if ahead > least and ahead <= way * (border - offset):
                # Forward a life ends as a root, backward it begins so.
                rooted = half == (2 if way > 0.0 else 0)
                smooth = not rooted and (smooth or place != border)
                border = place
    clock = PLAIN if smooth else RIGHT
    reach = 0.2 * way * (border - offset)
    for n in range(count):
        age, across = near[AGE * size + n], near[SIZE * size + n]
        behind = way * (offset - ((0.0 if way > 0.0 else 2.0 * across) - age))
        if behind >= -least and behind <= reach:
            clock = LEFT if smooth else BOTH
    return border, clock


@compiled_bare
def cells_at_once(constants: Doubles, u: float, cell: int, way: float, last: int) -> int:
    """Return how many cells of the grid may be taken together by a speed alone: a power of two, or 0."""
    # int of what the moments leave of a kink: 7e-4 h (kink h^2 / (m u^2)) in the displacement, V/u times as much in x.
    most = u * u * constants[KINK_LIMIT] * min(u / constants[DRIVE], 1.0)
    cells = GROUP
    while cells > 0:
        aligned = cell % cells == 0 and (way < 0.0 or cell + cells <= last)
        if aligned and float(cells * cells * cells) <= most:
            return cells
        cells //= 2
    return 0


@compiled_bare
def leave_stick(whole: Integers, numbers: Doubles, constants: Doubles, out: Doubles) -> bool:
    """Let the slider ride with the drive, x = x_1 + V (t - t_1), to its breakaway; return whether there was room."""
    step, drive, damping = constants[ROW_TIME], constants[DRIVE], constants[DAMPING]
    stiffness, begin, duration = constants[STIFFNESS], numbers[REST_PLACE], numbers[REST]
    distance = float(whole[CELL]) * constants[SPACING] + numbers[OFFSET]
    while True:
        time = float(whole[ROW] + 1 - whole[REST_ROW]) * step - numbers[REST_OVER]
        if time > duration:
            break
        if whole[ROWS] == out.shape[1]:
            return False
        x = begin + drive * time
        tell_row(whole, out, distance, stiffness * x + damping * drive, x, drive, STUCK)
        whole[ROW] += 1
    numbers[OVER] = max(numbers[REST_OVER] + duration - float(whole[ROW] - whole[REST_ROW]) * step, 0.0)
    end = begin + drive * duration
    numbers[DISPLACEMENT] = end
    numbers[TIME_STUCK] += duration
    numbers[X_TIME] += 0.5 * duration * (begin + end)
    numbers[XX_TIME] += duration * (begin * begin + begin * end + end * end) / 3.0
    numbers[VV_TIME] += duration * drive * drive
    return True


@compiled_bare
def arrive(whole: Integers, numbers: Doubles, constants: Doubles, marks: Doubles, force: float, touched: bool) -> None:
    """Decide what follows at w = 0, where the contact can bear ``force`` uN.

    touched: whether w' = 0, too, which makes f = G: a stick of no length, whatever rounding makes of the difference.
    """
    f = constants[STIFFNESS] * numbers[DISPLACEMENT] + constants[DAMPING] * constants[DRIVE]
    reversed_before = whole[PHASE] == REVERSED
    before = -force if reversed_before else force
    numbers[RELATIVE] = 0.0
    if touched:
        f = min(f, force)
    if f > force:
        if reversed_before:
            tell_landmark(whole, numbers, constants, marks, FORWARD, before, force)
        whole[PHASE] = SLIP
    elif f < -force:
        if not reversed_before:
            tell_landmark(whole, numbers, constants, marks, REVERSAL, before, -force)
        whole[PHASE] = REVERSED
    else:
        tell_landmark(whole, numbers, constants, marks, STICK, before, f)
        whole[PHASE] = STUCK
        whole[REST_ROW] = whole[ROW]
        numbers[REST_OVER] = numbers[OVER]
        numbers[REST_PLACE] = numbers[DISPLACEMENT]
        numbers[REST] = (force - f) / (constants[STIFFNESS] * constants[DRIVE])


@compiled_bare
def first_standstill(
    u: float, growth: float, end: float, clock: int, touch: float, table: Doubles, work: Doubles
) -> float:
    """Return q where u falls to 0 first in a step in time that begins with u > 0, or touches it; 2 if nowhere.

    A minimum below a thousandth of the largest speed is told with a minus sign: the step is to end there, and tell.
    """
    before, slope_before, fastest = 0.0, growth, u
    for n in range(NODES + 1):
        q = table[CLOCKS + n] if n < NODES else 1.0
        speed = work[SPEED + n] if n < NODES else end
        slope = work[GROWTH + n] if n < NODES else value_at(1.0, work, PUSH)
        fastest = max(fastest, speed)
        if slope_before < 0.0 and slope >= 0.0:
            low, high = before, q
            for _ in range(60):
                middle = 0.5 * (low + high)
                if value_at(middle, work, PUSH) < 0.0:
                    low = middle
                else:
                    high = middle
            least = u + integral_to(high, work, PUSH)
            if least > -touch and least < 1e-3 * fastest + touch:
                return -high
            if least <= -touch:
                return standstill_between(u, before, high, work)
        if speed <= 0.0:
            return standstill_between(u, before, q, work)
        before, slope_before = q, slope
    return 2.0


@compiled_bare
def standstill_between(u: float, low: float, high: float, work: Doubles) -> float:
    """Return q where u falls to 0 between two places."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        if u + integral_to(middle, work, PUSH) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@compiled_bare
def land(
    constants: Doubles,
    table: Doubles,
    way: float,
    x: float,
    u: float,
    growth: float,
    jerk: float,
    offset: float,
    duration: float,
    clock: int,
    per_half: float,
    far: Doubles,
    near: Doubles,
    count: int,
    lens: bool,
    work: Doubles,
    lowest: bool,
) -> tuple[float, float, float, bool, bool]:
    """Make a step in time end where w = 0, or where w' = 0 (``lowest``).

    Return the speed, the distance passed, the duration, whether the slider has arrived, and whether such an end is found.
    """
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    longest, after, passed, final = 1.5 * duration, 0.0, 0.0, 0.0
    for _ in range(12):
        after, passed, _, settled = time_step(
            constants, table, way, x, u, growth, jerk, offset, duration, clock, per_half, far, near, count, lens, work
        )
        final = duration
        if not settled:
            return 0.0, 0.0, final, False, False
        force = force_in_cell(offset + way * passed, per_half, far, near, count, lens)
        place = x + drive * duration - way * passed
        slope = (way * (stiffness * place + damping * drive) - damping * after - force) / mass
        change = 0.0
        if lowest:
            # w'' from the last node: good enough to come nearer and nearer to where w' = 0.
            since = duration * (1.0 - clock_at(table[CLOCKS + NODES - 1], clock))
            bend = (slope - work[GROWTH + NODES - 1]) / since
            if bend > 0.0:
                change = slope / bend
        elif slope < 0.0:
            change = after / slope
        duration -= change
        if abs(change) <= (1e-11 if lowest else 4e-16) * final or duration <= 0.0 or duration > longest:
            break
    if not lowest:
        return 0.0, passed, final, True, True
    if after > constants[TOUCH]:
        return after, passed, final, False, True
    touches = after >= -constants[TOUCH]
    return 0.0, passed, final, touches, touches


@compiled_bare
def advance(
    whole: Integers,
    numbers: Doubles,
    constants: Doubles,
    table: Doubles,
    lens: bool,
    lives: Lives,
    moments: Doubles,
    first: int,
    end: int,
    last: int,
    rest: float,
    order: Integers,
    births: Doubles,
    deaths: Doubles,
    out: Doubles,
    marks: Doubles,
    near: Doubles,
    far: Doubles,
    work: Doubles,
    powers: Doubles,
) -> int:
    """Move until something is wanting, and return what.

    whole, numbers: the state, changed in place. The field's cells are ``first`` ... ``end`` - 1; the run ends ``rest``
    um inside the cell ``last``. births, deaths (s): first passages of the rows, whose deaths come in ``order``. out,
    marks: room for rows and landmarks. near, far, work, powers: room.
    """
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    h, limit = constants[SPACING], constants[LIMIT]
    per_half = 2.0 / h
    gathered, count = -1 - GROUP * (1 << 60), 0
    while True:
        if whole[LANDMARKS] + 2 > marks.shape[1]:
            return FULL
        if whole[PHASE] == STUCK:
            if not leave_stick(whole, numbers, constants, out):
                return FULL
            f = stiffness * numbers[DISPLACEMENT] + damping * drive
            tell_landmark(whole, numbers, constants, marks, BREAKAWAY, f, f)
            whole[PHASE], whole[FRESH] = SLIP, 1
        way = -1.0 if whole[PHASE] == REVERSED else 1.0
        cell, offset = whole[CELL], numbers[OFFSET]
        if way > 0.0:
            if cell > last or (cell == last and offset >= rest):
                return DONE
            if end <= last and (cell // GROUP + 1) * GROUP > end:
                return AHEAD
        else:
            behind = cell - 1 if offset == 0.0 else cell
            if behind // GROUP * GROUP < first:
                return BACK
        x, u = numbers[DISPLACEMENT], abs(numbers[RELATIVE])
        room = float(out.shape[1] - whole[ROWS] - 2) * constants[ROW_TIME]
        # Whole cells of the grid.
        if offset == 0.0 and u > 0.0:
            cells = cells_at_once(constants, u, cell, way, last)
            after, duration, mean, begin = 0.0, 0.0, 0.0, cell
            while cells > 0:
                begin = cell if way > 0.0 else cell - cells
                width = h * cells
                mean, slope, bend = merged(moments, begin - first, cells)
                energy = 0.5 * u * u
                gain = width / mass * (way * (stiffness * x + damping * drive) - damping * u - mean)
                uneven = width / mass * (abs(slope) + abs(bend))
                couples = stiffness * drive * width * width / (mass * u * u * u) + damping * width / (mass * u)
                lowest = min(energy, energy + gain)
                if (
                    abs(gain) + uneven <= constants[BEND_LIMIT] * lowest
                    and couples <= 0.02
                    and float(cells * cells * cells) <= 2.0 * lowest * constants[KINK_LIMIT]
                ):
                    after, duration = uniform_cell(constants, way, x, u, width, mean, way * slope, bend, work)
                    if after > 0.0:
                        break
                cells //= 2
            if cells > 0 and after > 0.0:
                if numbers[OVER] + duration > room:
                    return FULL
                width = h * cells
                sum_uniform(numbers, constants, way, width, mean, work)
                tell_uniform(
                    whole, numbers, constants, lives, lens, order, births, deaths, out, way, begin, cells, after,
                    duration, work, powers,
                )  # fmt: skip
                numbers[DISPLACEMENT] = x + (drive * duration - way * width)
                numbers[RELATIVE] = way * after
                whole[CELL] = cell + (cells if way > 0.0 else -cells)
                pass_time(whole, numbers, constants, duration)
                continue
        # A part of one cell.
        if way < 0.0 and offset == 0.0:
            cell, offset = cell - 1, h
        if cell != gathered:
            count = gather(lives, lens, float(cell) * h, h, table, near, far, work)
            gathered = cell
        border, border_clock = next_border(near, count, offset, way, h)
        if way > 0.0 and cell == last and rest < border:
            border = rest
            border_clock = LEFT if border_clock in (LEFT, BOTH) else PLAIN
        length = way * (border - offset)
        force = force_in_cell(offset, per_half, far, near, count, lens)
        growth = (way * (stiffness * x + damping * drive) - damping * u - force) / mass
        fresh = whole[FRESH] == 1
        jerk = way * stiffness * drive / mass
        if fresh:
            growth = 0.0
        after, passed, size, duration, clock, in_time = 0.0, 0.0, 0.0, 0.0, PLAIN, False
        arrived, touched = False, False
        done, keep = False, numbers[STEP]
        if u > 0.0:
            size, clock = length, border_clock
            for _ in range(_HALVINGS):
                couples = stiffness * drive * size * size / (mass * u * u * u) + damping * size / (mass * u)
                if size * abs(growth) <= 0.3 * u * u and couples <= 0.3:
                    after, duration, error = event_cell(
                        constants, table, way, x, u, offset, size, clock, per_half, far, near, count, lens, work
                    )
                    if after > 0.0 and error <= limit:
                        passed, done = size, True
                        break
                size *= 0.5
                clock = LEFT if clock in (LEFT, BOTH) else PLAIN
        if not done:
            in_time, clock = True, LEFT if border_clock in (LEFT, BOTH) and u > 0.0 else PLAIN
            duration = min(numbers[STEP], constants[LONGEST])
            for attempt in range(_MOST_TRIES):
                after, passed, error, settled = time_step(
                    constants,
                    table,
                    way,
                    x,
                    u,
                    growth,
                    jerk,
                    offset,
                    duration,
                    clock,
                    per_half,
                    far,
                    near,
                    count,
                    lens,
                    work,
                )
                if not settled or error > limit:
                    duration *= 0.5
                    keep = duration
                    continue
                if attempt == 0 and error * 500.0 < limit:
                    keep = 1.5 * duration
                if u > 0.0:
                    q = first_standstill(u, growth, after, clock, constants[TOUCH], table, work)
                    if abs(q) <= 1.0:
                        # It must lie before the border.
                        stop = abs(q)
                        reached = integral_to(stop, work, PACE)
                        if reached <= length:
                            after, passed, duration, arrived, done = land(
                                constants, table, way, x, u, growth, jerk, offset, duration * clock_at(stop, clock),
                                clock, per_half, far, near, count, lens, work, q < 0.0,
                            )  # fmt: skip
                            if done:
                                touched = q < 0.0
                                break
                            duration *= 0.5
                        else:
                            duration *= 0.7 * clock_at(stop, clock)
                        continue
                if passed > length:
                    duration *= max(0.7 * length / passed, 0.25)
                    continue
                if after > 0.0:
                    done = True
                    break
                duration *= 0.5
            if not done:
                return LOST
            size = passed
        if numbers[OVER] + duration > room:
            return FULL
        if in_time:
            numbers[STEP] = keep
        sum_step(numbers, constants, table, way, size, duration, clock, in_time, work)
        tell_step(
            whole, numbers, constants, lives, lens, order, births, deaths, out, way, cell, offset, size, passed,
            duration, clock, in_time, far, near, count, work,
        )  # fmt: skip
        numbers[DISPLACEMENT] = x + (drive * duration - way * passed)
        numbers[RELATIVE] = way * after
        if passed == length:
            offset = border
        else:
            offset += way * passed
        if offset >= h * (1.0 - _AT_ONCE):
            cell, offset = cell + 1, 0.0
        elif offset <= h * _AT_ONCE:
            offset = 0.0
        whole[CELL], numbers[OFFSET] = cell, offset
        whole[FRESH] = 0
        pass_time(whole, numbers, constants, duration)
        if arrived:
            place = offset if cell == gathered else (h if cell > gathered else 0.0)
            force = force_in_cell(place, per_half, far, near, count, lens)
            arrive(whole, numbers, constants, marks, force, touched)
