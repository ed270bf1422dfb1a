"""The motion at w = 0: how a step is made to end there, what follows, and the stick in closed form; compiled.

f = k x + c V:   |f| <= G: stick      f < -G: into reversal      f > G: forward
"""

from typing import Final

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_within
from rubnoise.simulation.coupled.field import Part, force_in_cell
from rubnoise.simulation.coupled.layout import (
    BREAKAWAY,
    CELL,
    DAMPING,
    DISPLACEMENT,
    DRIVE,
    FORWARD,
    FRESH,
    MASS,
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
    STICK,
    STIFFNESS,
    STUCK,
    TIME_STUCK,
    TOUCH,
    VV_TIME,
    X_TIME,
    XX_TIME,
    MotionState,
    RowSpace,
    SlipStart,
    Workspace,
)
from rubnoise.simulation.coupled.quadrature import CLOCKS, NODES
from rubnoise.simulation.coupled.rows import write_landmark, write_row
from rubnoise.simulation.coupled.steps import GROWTH, PUSH, SPEED, clock_at, integral_to, time_step, value_at

MOVING, STOPPED, TOUCHING = range(3)
"""How a step in time ends: with w > 0; at w = 0; at w = 0 and w' = 0."""

_BISECTIONS: Final = 60
_LANDINGS: Final = 12


@compiled_within
def leave_stick(motion: MotionState, output: RowSpace) -> bool:
    """Move the stuck slider with the drive, x = x_1 + V (t - t_1), until f = G; return whether space was enough."""
    whole, numbers, constants = motion
    step, drive, damping = constants[ROW_TIME], constants[DRIVE], constants[DAMPING]
    stiffness, begin, duration = constants[STIFFNESS], numbers[REST_PLACE], numbers[REST]
    distance = float(whole[CELL]) * constants[SPACING] + numbers[OFFSET]
    while True:
        time = float(whole[ROW] + 1 - whole[REST_ROW]) * step - numbers[REST_OVER]
        if time > duration:
            break
        if whole[ROWS] == output.rows.shape[1]:
            return False
        x = begin + drive * time
        write_row(whole, output.rows, distance, stiffness * x + damping * drive, x, drive, STUCK)
        whole[ROW] += 1
    numbers[OVER] = max(numbers[REST_OVER] + duration - float(whole[ROW] - whole[REST_ROW]) * step, 0.0)
    end = begin + drive * duration
    numbers[DISPLACEMENT] = end
    numbers[TIME_STUCK] += duration
    numbers[X_TIME] += 0.5 * duration * (begin + end)
    numbers[XX_TIME] += duration * (begin * begin + begin * end + end * end) / 3.0
    numbers[VV_TIME] += duration * drive * drive
    f = stiffness * end + damping * drive
    write_landmark(motion, output.marks, BREAKAWAY, f, f)
    whole[PHASE], whole[FRESH] = SLIP, 1
    return True


@compiled_within
def arrive(motion: MotionState, marks: Doubles, force: float, ending: int) -> None:
    """Decide what follows at w = 0, if the contact can bear ``force`` uN.

    ending: STOPPED or TOUCHING. TOUCHING means f = G, a stick of no length; rounding must not make f greater.
    """
    whole, numbers, constants = motion
    f = constants[STIFFNESS] * numbers[DISPLACEMENT] + constants[DAMPING] * constants[DRIVE]
    before = -force if whole[PHASE] == REVERSED else force
    numbers[RELATIVE] = 0.0
    if ending == TOUCHING:
        f = min(f, force)
    phase, kind, after = STUCK, STICK, f
    if f > force:
        phase, kind, after = SLIP, FORWARD, force
    elif f < -force:
        phase, kind, after = REVERSED, REVERSAL, -force
    if phase != whole[PHASE]:
        write_landmark(motion, marks, kind, before, after)
    whole[PHASE] = phase
    if phase == STUCK:
        whole[REST_ROW] = whole[ROW]
        numbers[REST_OVER] = numbers[OVER]
        numbers[REST_PLACE] = numbers[DISPLACEMENT]
        numbers[REST] = (force - f) / (constants[STIFFNESS] * constants[DRIVE])


@compiled_within
def standstill_between(u: float, low: float, high: float, work: Doubles) -> float:
    """Return q at which u falls to 0 between two places of a step in time."""
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if u + integral_to(middle, work, PUSH) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@compiled_within
def lowest_between(low: float, high: float, work: Doubles) -> float:
    """Return q at which u has its minimum between two places of a step in time."""
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if value_at(middle, work, PUSH) < 0.0:
            low = middle
        else:
            high = middle
    return high


@compiled_within
def first_standstill(start: SlipStart, end: float, touch: float, workspace: Workspace) -> float:
    """Return q at which u first falls to 0 in a step in time that begins with u > 0; 2 if it does not.

    If u only has a minimum below a thousandth of the largest speed, return minus its q: the step must end there.
    """
    table, work, u = workspace.table, workspace.work, start.speed
    before, slope_before, fastest = 0.0, start.growth, u
    for n in range(NODES + 1):
        q = table[CLOCKS + n] if n < NODES else 1.0
        speed = work[SPEED + n] if n < NODES else end
        slope = work[GROWTH + n] if n < NODES else value_at(1.0, work, PUSH)
        fastest = max(fastest, speed)
        if slope_before < 0.0 and slope >= 0.0:
            lowest = lowest_between(before, q, work)
            least = u + integral_to(lowest, work, PUSH)
            if least <= -touch:
                return standstill_between(u, before, lowest, work)
            if least < 1e-3 * fastest + touch:
                return -lowest
        if speed <= 0.0:
            return standstill_between(u, before, q, work)
        before, slope_before = q, slope
    return 2.0


@compiled_within
def land(
    constants: Doubles, start: SlipStart, duration: float, clock: int, part: Part, workspace: Workspace, ending: int
) -> tuple[float, float, float, int, bool]:
    """Make a step in time end at w = 0 (STOPPED) or at w' = 0 (TOUCHING), by Newton's method for its duration.

    Return the speed, the distance passed, the duration, how the step ends, and whether such an end has been found.
    """
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    way, table, work = start.way, workspace.table, workspace.work
    longest, after, passed, final = 1.5 * duration, 0.0, 0.0, 0.0
    for _ in range(_LANDINGS):
        after, passed, _, converged = time_step(constants, start, duration, clock, part, workspace)
        final = duration
        if not converged:
            return 0.0, 0.0, final, MOVING, False
        force = force_in_cell(start.offset + way * passed, part)
        place = start.displacement + drive * duration - way * passed
        slope = (way * (stiffness * place + damping * drive) - damping * after - force) / mass
        change = 0.0
        if ending == TOUCHING:
            # w'' from the last node: accurate enough for the passes to converge to w' = 0.
            since = duration * (1.0 - clock_at(table[CLOCKS + NODES - 1], clock))
            bend = (slope - work[GROWTH + NODES - 1]) / since
            if bend > 0.0:
                change = slope / bend
        elif slope < 0.0:
            change = after / slope
        duration -= change
        if abs(change) <= (1e-11 if ending == TOUCHING else 4e-16) * final or duration <= 0.0 or duration > longest:
            break
    if ending == STOPPED:
        return 0.0, passed, final, STOPPED, True
    if after > constants[TOUCH]:
        return after, passed, final, MOVING, True
    return 0.0, passed, final, TOUCHING, after >= -constants[TOUCH]
