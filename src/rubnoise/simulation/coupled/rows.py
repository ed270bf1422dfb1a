"""The stored motion: rows uniform in time, landmarks, and the first passage of each birth and death.

Inside a step all values come from the step's own polynomials. The moments of uniform cells do not tell the course of G
inside, so speed and force come from the lives there: u^2 = u_0^2 + (2/m) int (d (k x + c V) - c u - G) dl.
"""

from typing import Final

import numpy as np

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled_within
from rubnoise.simulation.coupled.field import Lives, Part, force_and_integral, force_in_cell
from rubnoise.simulation.coupled.layout import (
    BORN,
    CELL,
    DAMPING,
    DIED,
    DISPLACEMENT,
    DRIVE,
    FRICTION_WORK,
    IN_TIME,
    LANDMARKS,
    MARK_AFTER,
    MARK_BEFORE,
    MARK_DISPLACEMENT,
    MARK_DISTANCE,
    MARK_KIND,
    MARK_TIME,
    MARK_VELOCITY,
    MASS,
    OFFSET,
    OVER,
    PHASE,
    RELATIVE,
    REVERSE_WORK,
    ROW,
    ROW_DISPLACEMENT,
    ROW_DISTANCE,
    ROW_FORCE,
    ROW_PHASE,
    ROW_TIME,
    ROW_VELOCITY,
    ROWS,
    SPACING,
    STIFFNESS,
    VV_TIME,
    X_TIME,
    XX_TIME,
    MotionState,
    Step,
    Workspace,
)
from rubnoise.simulation.coupled.quadrature import LEFT, NODES, RATES, THREE_NODES, THREE_WEIGHTS, WEIGHTS
from rubnoise.simulation.coupled.steps import (
    FORCE,
    PACE,
    PASSED,
    PUSH,
    SPEED,
    TIME,
    clock_at,
    integral_to,
    through_cell,
    value_at,
)

Met = tuple[Lives, int, Integers, Doubles, Doubles]
"""Lives, their shape, their order by death, and the times when births and deaths are first passed (s)."""

_NEWTON: Final = 40


@compiled_within
def write_row(
    whole: Integers, out: Doubles, distance: float, force: float, displacement: float, velocity: float, phase: int
) -> None:
    """Write one row."""
    n = whole[ROWS]
    out[ROW_DISTANCE, n] = distance
    out[ROW_FORCE, n] = force
    out[ROW_DISPLACEMENT, n] = displacement
    out[ROW_VELOCITY, n] = velocity
    out[ROW_PHASE, n] = phase
    whole[ROWS] = n + 1


@compiled_within
def write_landmark(motion: MotionState, marks: Doubles, kind: int, before: float, after: float) -> None:
    """Write a landmark at the state's time and place, where w = 0; before and after: the friction force in uN."""
    whole, numbers, constants = motion
    n = whole[LANDMARKS]
    marks[MARK_TIME, n] = float(whole[ROW]) * constants[ROW_TIME] + numbers[OVER]
    marks[MARK_DISTANCE, n] = float(whole[CELL]) * constants[SPACING] + numbers[OFFSET]
    marks[MARK_KIND, n] = kind
    marks[MARK_DISPLACEMENT, n] = numbers[DISPLACEMENT]
    marks[MARK_VELOCITY, n] = constants[DRIVE]
    marks[MARK_BEFORE, n] = before
    marks[MARK_AFTER, n] = after
    whole[LANDMARKS] = n + 1


@compiled_within
def pass_time(whole: Integers, numbers: Doubles, constants: Doubles, duration: float) -> None:
    """Advance the time: count the whole rows, and keep the rest, which is shorter than one row."""
    over = numbers[OVER] + duration
    passed = int(over / constants[ROW_TIME])
    while over >= float(passed + 1) * constants[ROW_TIME]:
        passed += 1
    while passed > 0 and over < float(passed) * constants[ROW_TIME]:
        passed -= 1
    whole[ROW] += passed
    numbers[OVER] = over - float(passed) * constants[ROW_TIME]


@compiled_within
def _power_integral(powers: Doubles, y: float) -> float:
    """Return int_0^y of a polynomial of five coefficients."""
    return y * (
        powers[0] + y * (powers[1] / 2.0 + y * (powers[2] / 3.0 + y * (powers[3] / 4.0 + y * (powers[4] / 5.0))))
    )


@compiled_within
def _power_double_integral(powers: Doubles, y: float) -> float:
    """Return int_0^y int_0^y' of a polynomial of five coefficients."""
    rest = powers[2] / 12.0 + y * (powers[3] / 20.0 + y * (powers[4] / 30.0))
    return y * y * (powers[0] / 2.0 + y * (powers[1] / 6.0 + y * rest))


@compiled_within
def _power_value(powers: Doubles, y: float) -> float:
    return powers[0] + y * (powers[1] + y * (powers[2] + y * (powers[3] + y * powers[4])))


@compiled_within
def meet_in_cells(motion: MotionState, met: Met, first: int, width: float, powers: Doubles) -> None:
    """Record the first passages of births and deaths in uniform cells; powers: 1/u as a polynomial of the place."""
    whole, numbers, constants = motion
    lives, _, order, births, deaths = met
    birth, diameter, origin = lives[0], lives[1], float(first) * constants[SPACING]
    now = float(whole[ROW]) * constants[ROW_TIME] + numbers[OVER]
    while birth[whole[BORN]] - origin <= width:
        y = max((birth[whole[BORN]] - origin) / width, 0.0)
        births[whole[BORN]] = now + width * _power_integral(powers, y)
        whole[BORN] += 1
    while whole[DIED] < len(order):
        row = order[whole[DIED]]
        place = (birth[row] - origin) + 2.0 * diameter[row]
        if place > width:
            break
        deaths[row] = now + width * _power_integral(powers, max(place / width, 0.0))
        whole[DIED] += 1


@compiled_within
def write_cells(
    motion: MotionState, met: Met, out: Doubles, step: Step, first: int, after: float, workspace: Workspace
) -> None:
    """Write the rows inside uniform cells that have just been computed; the state is the one before them."""
    whole, numbers, constants = motion
    way, width, duration, powers = step.way, step.size, step.duration, workspace.powers
    lives, shape = met[0], met[1]
    row_time, over, u, x = constants[ROW_TIME], numbers[OVER], abs(numbers[RELATIVE]), numbers[DISPLACEMENT]
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    origin, begin = float(first) * constants[SPACING], 0.0 if way > 0.0 else width
    steady = way * (stiffness * x + damping * drive)
    speeds = powers[5:]
    through_cell(u, after, 1.0, workspace.work, speeds)
    n = 1
    while over + duration >= float(n) * row_time:
        time = min(float(n) * row_time - over, duration)
        y = time / duration
        for _ in range(_NEWTON):
            change = (width * _power_integral(powers, y) - time) / (width * _power_value(powers, y))
            y = min(max(y - change, 0.0), 1.0)
            if abs(change) <= 1e-15:
                break
        length = width * y
        force, integral = force_and_integral(
            lives, shape, origin, begin, begin + way * length, whole[BORN], workspace.work
        )
        energy = steady * length - 0.5 * stiffness * length * length - way * integral
        energy += way * stiffness * drive * width * width * _power_double_integral(powers, y)
        energy -= damping * width * _power_integral(speeds, y)
        speed = np.sqrt(max(u * u + 2.0 / mass * energy, 0.0))
        place = x + drive * time - way * length
        write_row(whole, out, origin + (begin + way * length), way * force, place, drive - way * speed, whole[PHASE])
        n += 1


@compiled_within
def sum_uniform(motion: MotionState, way: float, width: float, mean: float, work: Doubles) -> None:
    """Add the contribution of uniform cells to the integrals over time and over the path."""
    _, numbers, constants = motion
    drive, x = constants[DRIVE], numbers[DISPLACEMENT]
    for n in range(3):
        u, time, y = work[SPEED + n], work[TIME + n], THREE_NODES[n]
        share = THREE_WEIGHTS[n] * width / u
        place = x + drive * time - way * width * y
        velocity = drive - way * u
        numbers[X_TIME] += share * place
        numbers[XX_TIME] += share * (place * place)
        numbers[VV_TIME] += share * (velocity * velocity)
    numbers[FRICTION_WORK] += mean * width
    if way < 0.0:
        numbers[REVERSE_WORK] += mean * width


@compiled_within
def place_in_step(time: float, step: Step, work: Doubles) -> float:
    """Return q at a time (s) after the begin of an event cell or of a step in time."""
    _, size, duration, clock, kind = step
    share = min(max(time / duration, 0.0), 1.0)
    if kind == IN_TIME:
        return np.sqrt(share) if clock == LEFT else share
    if share in (0.0, 1.0):
        return share
    low, high, q = 0.0, 1.0, share
    for _ in range(_NEWTON):
        beyond = size * integral_to(q, work, PACE) - time
        if beyond > 0.0:
            high = q
        else:
            low = q
        slope = size * value_at(q, work, PACE)
        old = q
        q = q - beyond / slope if slope > 0.0 else low
        if not (q > low and q < high):
            q = 0.5 * (low + high)
        if abs(q - old) <= 2e-16:
            break
    return q


@compiled_within
def meet_in_part(motion: MotionState, met: Met, cell: int, offset: float, step: Step) -> None:
    """Record first passages in a step within a cell: up to rounding they lie at the step's begin or end."""
    whole, numbers, constants = motion
    length, duration = step.size, step.duration
    lives, _, order, births, deaths = met
    birth, diameter, origin = lives[0], lives[1], float(cell) * constants[SPACING]
    now = float(whole[ROW]) * constants[ROW_TIME] + numbers[OVER]
    middle, end = offset + 0.5 * length, offset + length
    while birth[whole[BORN]] - origin <= end:
        births[whole[BORN]] = now + duration if birth[whole[BORN]] - origin > middle else now
        whole[BORN] += 1
    while whole[DIED] < len(order):
        row = order[whole[DIED]]
        place = (birth[row] - origin) + 2.0 * diameter[row]
        if place > end:
            break
        deaths[row] = now + duration if place > middle else now
        whole[DIED] += 1


@compiled_within
def write_part(
    motion: MotionState, out: Doubles, cell: int, offset: float, step: Step, part: Part, work: Doubles
) -> None:
    """Write the rows of an event cell or of a step in time; the state is the one before it."""
    whole, numbers, constants = motion
    way, size, duration, clock, kind = step
    row_time, over, u = constants[ROW_TIME], numbers[OVER], abs(numbers[RELATIVE])
    origin, x, drive = float(cell) * constants[SPACING], numbers[DISPLACEMENT], constants[DRIVE]
    n = 1
    while over + duration >= float(n) * row_time:
        time = min(float(n) * row_time - over, duration)
        q = place_in_step(time, step, work)
        if kind == IN_TIME:
            passed = integral_to(q, work, PACE)
            speed = u + integral_to(q, work, PUSH)
        else:
            passed = size * clock_at(q, clock)
            speed = np.sqrt(max(u * u + 2.0 * size / constants[MASS] * integral_to(q, work, PUSH), 0.0))
        place = offset + way * passed
        displacement = x + drive * time - way * passed
        force = way * force_in_cell(place, part)
        write_row(whole, out, origin + place, force, displacement, drive - way * speed, whole[PHASE])
        n += 1


@compiled_within
def sum_part(motion: MotionState, step: Step, workspace: Workspace) -> None:
    """Add the contribution of an event cell or a step in time to the integrals over time and over the path."""
    _, numbers, constants = motion
    way, size, duration, clock, kind = step
    table, work = workspace.table, workspace.work
    drive, x, work_done = constants[DRIVE], numbers[DISPLACEMENT], 0.0
    for n in range(NODES):
        u, rate = work[SPEED + n], table[WEIGHTS + n] * table[RATES + NODES * clock + n]
        share = duration * rate if kind == IN_TIME else size * rate / u
        place = x + drive * work[TIME + n] - way * work[PASSED + n]
        velocity = drive - way * u
        numbers[X_TIME] += share * place
        numbers[XX_TIME] += share * (place * place)
        numbers[VV_TIME] += share * (velocity * velocity)
        work_done += work[FORCE + n] * (share * u if kind == IN_TIME else size * rate)
    numbers[FRICTION_WORK] += work_done
    if way < 0.0:
        numbers[REVERSE_WORK] += work_done
