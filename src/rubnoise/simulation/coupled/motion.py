"""Slip, stick and reversal: which step comes next; compiled.

A stick ends after exactly (G - f)/(k V), always forward, with w = w' = 0 and w'' = k V/m. The step that leaves w = 0 is
so short that w is above 0 at its end, and no standstill is searched in it. If |w| has a minimum near 0 inside a step,
the step is made to end there, and the minimum decides whether the slider comes to rest.
"""

from typing import Final

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, compiled_into, compiled_within
from rubnoise.simulation.coupled.field import AGE, GROUP, SIZE, Part, force_in_cell, gather, merged
from rubnoise.simulation.coupled.layout import (
    BEND_LIMIT,
    CELL,
    DAMPING,
    DISPLACEMENT,
    DRIVE,
    FRESH,
    IN_DISTANCE,
    IN_TIME,
    KINK_LIMIT,
    LANDMARKS,
    LIMIT,
    LONGEST,
    MASS,
    OFFSET,
    OVER,
    PHASE,
    RELATIVE,
    REVERSED,
    ROW_TIME,
    ROWS,
    SPACING,
    STEP,
    STIFFNESS,
    STUCK,
    TOUCH,
    CellStretch,
    MotionState,
    RowSpace,
    SlipStart,
    Step,
    Workspace,
)
from rubnoise.simulation.coupled.quadrature import BOTH, LEFT, PLAIN, RIGHT
from rubnoise.simulation.coupled.rest import MOVING, STOPPED, TOUCHING, arrive, first_standstill, land, leave_stick
from rubnoise.simulation.coupled.rows import (
    Met,
    meet_in_cells,
    meet_in_part,
    pass_time,
    sum_part,
    sum_uniform,
    write_cells,
    write_part,
)
from rubnoise.simulation.coupled.steps import (
    PACE,
    WEAK_DRAG,
    WEAK_DRAG_OF_NODES,
    clock_at,
    event_cell,
    integral_to,
    through_cell,
    time_step,
    uniform_cell,
)

MOVED, DONE, AHEAD, BACK, FULL, LOST, UNFIT = range(7)
"""Outcome of a step or a call: moved on; the run is over; cells ahead, or behind, are needed; no space for rows; no
accurate step found; this kind of step does not fit."""

_MOST_TRIES: Final = 200
_HALVINGS: Final = 4
_AT_ONCE: Final = 1e-12
"""Part of a cell: places that are nearer to each other than this count as one."""
_NOWHERE: Final = -(1 << 62)


@compiled_within
def next_border(part: Part, offset: float, way: float, width: float, limit: float) -> tuple[float, int]:
    """Return the place of the next birth, mid-life, death or edge in a gathered cell, and the clock of a step to it.

    limit: where the cell's far edge is (um): at ``width``, or nearer if the run ends in the cell.
    """
    _, _, near, count, _ = part
    size, least = len(near) // 4, _AT_ONCE * width
    border = limit if way > 0.0 else 0.0
    smooth = True
    for n in range(count):
        age, across = near[AGE * size + n], near[SIZE * size + n]
        for half in range(3):
            place = half * across - age
            ahead = way * (place - offset)
            if ahead > least and ahead <= way * (border - offset):
                # Ahead, the area falls like a root (u^1.5) to its end: to the death, or backward to the birth.
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


@compiled_within
def cells_at_once(constants: Doubles, u: float, cell: int, way: float, last: int) -> int:
    """Return how many cells of the grid the speed alone allows to take as one: a power of two, or 0.

    The moments do not describe a kink fully: the error is 7e-4 h (kink h^2/(m u^2)) in the distance, and V/u times that
    in x.
    """
    most = u * u * constants[KINK_LIMIT] * min(u / constants[DRIVE], 1.0)
    cells = GROUP
    while cells > 0:
        aligned = cell % cells == 0 and (way < 0.0 or cell + cells <= last)
        if aligned and float(cells * cells * cells) <= most:
            return cells
        cells //= 2
    return 0


@compiled_within
def couples(constants: Doubles, size: float, u: float, weak: float) -> float:
    """Return k V h^2/(m u^3) + c h/(m u): the factor by which a pass over a step of size h reduces the error.

    If the second term is above ``weak``, Newton's method removes it, and drag makes the first term smaller.
    """
    per_speed = size / (constants[MASS] * u)
    back, drag = per_speed * (constants[STIFFNESS] * constants[DRIVE] * size / (u * u)), per_speed * constants[DAMPING]
    return back + drag if drag <= weak else back / (1.0 + drag)


@compiled_within
def drag_fades(constants: Doubles, u: float, width: float, force: float) -> bool:
    """Return whether uniform cells are fine enough for the decay of u by drag, if m u' is out of balance by ``force``.

    The imbalance (uN) decays as e^-z, z = c l/(m u), and three nodes miss about the part z^4/(z^4 + 15^4) of it. Over
    the length m u/c this makes an error of that part of force/c in the speed, and V/u^2 times as much in x.
    """
    decay = constants[MASS] * u / constants[DAMPING]
    z = width / decay
    share = (z / 15.0) * (z / 15.0) * (z / 15.0) * (z / 15.0)
    late = force / constants[DAMPING] * decay * constants[DRIVE] / (u * u)
    return late * share <= constants[LIMIT] * (1.0 + share)


@compiled_within
def take_cells(motion: MotionState, stretch: CellStretch, met: Met, out: Doubles, workspace: Workspace) -> int:
    """Pass uniform cells from an edge of the grid; return MOVED, FULL or UNFIT."""
    whole, numbers, constants = motion
    way = -1.0 if whole[PHASE] == REVERSED else 1.0
    cell, x, u = whole[CELL], numbers[DISPLACEMENT], abs(numbers[RELATIVE])
    drive, energy = constants[DRIVE], 0.5 * u * u
    pull = way * (constants[STIFFNESS] * x + constants[DAMPING] * drive) - constants[DAMPING] * u
    cells = cells_at_once(constants, u, cell, way, stretch.last)
    while cells > 0:
        begin = cell if way > 0.0 else cell - cells
        width = constants[SPACING] * cells
        mean, slope, bend = merged(stretch.moments, begin - stretch.first, cells)
        gain = width / constants[MASS] * (pull - mean)
        uneven = width / constants[MASS] * (abs(slope) + abs(bend))
        drag = width / constants[MASS] * constants[DAMPING] / u
        fades = True
        if drag > WEAK_DRAG:
            gain, uneven = gain / (1.0 + drag), uneven / (1.0 + drag)
            fades = drag_fades(constants, u, width, abs(pull - mean) + abs(slope) + abs(bend))
        lowest = min(energy, energy + gain)
        even = abs(gain) + uneven <= constants[BEND_LIMIT] * lowest
        kinks = float(cells * cells * cells) <= 2.0 * lowest * constants[KINK_LIMIT]
        if even and kinks and fades and couples(constants, width, u, WEAK_DRAG) <= 0.02:
            start = SlipStart(way, x, u, 0.0, 0.0, 0.0)
            after, duration = uniform_cell(constants, start, width, (mean, way * slope, bend), workspace.work)
            if after > 0.0:
                if numbers[OVER] + duration > float(out.shape[1] - whole[ROWS] - 2) * constants[ROW_TIME]:
                    return FULL
                sum_uniform(motion, way, width, mean, workspace.work)
                through_cell(u, after, -1.0, workspace.work, workspace.powers)
                if way > 0.0:
                    meet_in_cells(motion, met, begin, width, workspace.powers)
                if numbers[OVER] + duration >= constants[ROW_TIME]:
                    step = Step(way, width, duration, PLAIN, IN_DISTANCE)
                    write_cells(motion, met, out, step, begin, after, workspace)
                numbers[DISPLACEMENT] = x + (drive * duration - way * width)
                numbers[RELATIVE] = way * after
                whole[CELL] = cell + (cells if way > 0.0 else -cells)
                pass_time(whole, numbers, constants, duration)
                return MOVED
        cells //= 2
    return UNFIT


@compiled_into
def try_event_cell(
    constants: Doubles, start: SlipStart, length: float, clock: int, part: Part, workspace: Workspace
) -> tuple[float, float, float, int]:
    """Try an event cell to a border, then half, a quarter ... of it; return speed (0: none fits), size, time, clock."""
    size, u = length, start.speed
    for _ in range(_HALVINGS):
        if size * abs(start.growth) <= 0.3 * u * u and couples(constants, size, u, WEAK_DRAG_OF_NODES) <= 0.3:
            after, duration, error = event_cell(constants, start, size, clock, part, workspace)
            if after > 0.0 and error <= constants[LIMIT]:
                return after, size, duration, clock
        size *= 0.5
        clock = LEFT if clock in (LEFT, BOTH) else PLAIN
    return 0.0, 0.0, 0.0, clock


@compiled_into
def find_time_step(
    constants: Doubles, start: SlipStart, step: float, length: float, clock: int, part: Part, workspace: Workspace
) -> tuple[float, float, float, float, int, bool]:
    """Find a step in time that keeps the tolerance and ends before the border, and at w = 0 if the slider stops.

    Return speed, distance passed, duration, the next step to try, how it ends, and whether one has been found.
    """
    keep = duration = min(step, constants[LONGEST])
    for attempt in range(_MOST_TRIES):
        after, passed, error, converged = time_step(constants, start, duration, clock, part, workspace)
        if not converged or error > constants[LIMIT]:
            duration *= 0.5
            keep = duration
            continue
        if attempt == 0 and error * 500.0 < constants[LIMIT]:
            keep = 1.5 * duration
        q = first_standstill(start, after, constants[TOUCH], workspace) if start.speed > 0.0 else 2.0
        stop = abs(q)
        if stop > 1.0:
            if passed <= length and after > 0.0:
                return after, passed, duration, keep, MOVING, True
            duration *= max(0.7 * length / passed, 0.25) if passed > length else 0.5
        elif integral_to(stop, workspace.work, PACE) > length:
            duration *= 0.7 * clock_at(stop, clock)
        else:
            until = duration * clock_at(stop, clock)
            wanted = TOUCHING if q < 0.0 else STOPPED
            after, passed, duration, ending, found = land(constants, start, until, clock, part, workspace, wanted)
            if found and passed <= length:
                return after, passed, duration, keep, ending, True
            duration *= 0.5
    return 0.0, 0.0, 0.0, keep, MOVING, False


@compiled_into
def take_part(
    motion: MotionState,
    cell: int,
    offset: float,
    limit: float,
    met: Met,
    output: RowSpace,
    part: Part,
    workspace: Workspace,
) -> int:
    """Pass a gathered cell or a part of it, not beyond ``limit`` um in it; return MOVED, FULL or LOST."""
    whole, numbers, constants = motion
    out = output.rows
    way = -1.0 if whole[PHASE] == REVERSED else 1.0
    x, u, h, drive = numbers[DISPLACEMENT], abs(numbers[RELATIVE]), constants[SPACING], constants[DRIVE]
    border, border_clock = next_border(part, offset, way, h, limit)
    length = way * (border - offset)
    growth = 0.0
    if whole[FRESH] == 0:
        pull = way * (constants[STIFFNESS] * x + constants[DAMPING] * drive) - constants[DAMPING] * u
        growth = (pull - force_in_cell(offset, part)) / constants[MASS]
    start = SlipStart(way, x, u, growth, way * constants[STIFFNESS] * constants[DRIVE] / constants[MASS], offset)
    kind, ending, keep = IN_DISTANCE, MOVING, numbers[STEP]
    after, size, duration, clock = 0.0, 0.0, 0.0, border_clock
    if u > 0.0:
        after, size, duration, clock = try_event_cell(constants, start, length, border_clock, part, workspace)
    if after == 0.0:
        kind, clock = IN_TIME, LEFT if border_clock in (LEFT, BOTH) and u > 0.0 else PLAIN
        after, size, duration, keep, ending, found = find_time_step(
            constants, start, numbers[STEP], length, clock, part, workspace
        )
        if not found:
            return LOST
    if numbers[OVER] + duration > float(out.shape[1] - whole[ROWS] - 2) * constants[ROW_TIME]:
        return FULL
    numbers[STEP] = keep
    step = Step(way, size, duration, clock, kind)
    sum_part(motion, step, workspace)
    if way > 0.0:
        meet_in_part(motion, met, cell, offset, step)
    write_part(motion, out, cell, offset, step, part, workspace.work)
    numbers[DISPLACEMENT] = x + (drive * duration - way * size)
    numbers[RELATIVE] = way * after
    offset = border if size == length else offset + way * size
    force = force_in_cell(offset, part) if ending != MOVING else 0.0
    if offset >= h * (1.0 - _AT_ONCE):
        cell, offset = cell + 1, 0.0
    elif offset <= h * _AT_ONCE:
        offset = 0.0
    whole[CELL], numbers[OFFSET], whole[FRESH] = cell, offset, 0
    pass_time(whole, numbers, constants, duration)
    if ending != MOVING:
        arrive(motion, output.marks, force, ending)
    return MOVED


@compiled_within
def wanting(motion: MotionState, stretch: CellStretch) -> int:
    """Return AHEAD or BACK if the slider needs cells outside the stretch, DONE if the run is over, or else MOVED.

    Cells come in groups, so that the number of cells that one step takes does not depend on where a range ends.
    """
    whole, numbers, _ = motion
    _, first, end, last, rest = stretch
    cell, offset = whole[CELL], numbers[OFFSET]
    if whole[PHASE] == REVERSED:
        behind = cell - 1 if offset == 0.0 else cell
        return BACK if behind // GROUP * GROUP < first else MOVED
    if cell > last or (cell == last and offset >= rest):
        return DONE
    return AHEAD if end <= last and (cell // GROUP + 1) * GROUP > end else MOVED


@compiled_bare
def advance(motion: MotionState, stretch: CellStretch, met: Met, output: RowSpace, workspace: Workspace) -> int:
    """Move until something is missing or the run is over; return DONE, AHEAD, BACK, FULL or LOST.

    met: the lives in the stretch, and their first passages.
    """
    whole, numbers, constants = motion
    near, far = workspace.near, workspace.far
    h = constants[SPACING]
    lives, shape = met[0], met[1]
    gathered, count = _NOWHERE, 0
    while True:
        no_room = whole[LANDMARKS] + 2 > output.marks.shape[1]
        if no_room or (whole[PHASE] == STUCK and not leave_stick(motion, output)):
            return FULL
        outcome = wanting(motion, stretch)
        if outcome != MOVED:
            return outcome
        outcome = UNFIT
        if numbers[OFFSET] == 0.0 and numbers[RELATIVE] != 0.0:
            outcome = take_cells(motion, stretch, met, output.rows, workspace)
        if outcome == MOVED:
            continue
        if outcome == FULL:
            return outcome
        cell, offset = whole[CELL], numbers[OFFSET]
        if whole[PHASE] == REVERSED and offset == 0.0:
            cell, offset = cell - 1, h
        if cell != gathered:
            count = gather(lives, shape, float(cell) * h, h, workspace.table, near, far, workspace.work)
            gathered = cell
        part = (2.0 / h, far, near, count, shape)
        limit = stretch.rest if cell == stretch.last else h
        outcome = take_part(motion, cell, offset, limit, met, output, part, workspace)
        if outcome != MOVED:
            return outcome
