"""The slider that pushes back: m x'' + c x' + k x = G(s) sign(w), w = V - x' = ds/dt, from border to border; compiled.

In slip, s - s_0 is a power series in time from one border of the force's cells to the next:

    m s'' = k (x_0 + V t - (s - s_0)) + c (V - s') - sign(w) G(s)

A step ends at a border, or where the series is no longer right, or where w = 0. There f = k x + c V decides: |f| <= G
is a stick, f < -G begins a reversal, f > G goes on forward. A stick lasts (G - f)/(k V), during which x grows at V.
After it w and w' are 0, and w grows as k V t^2/2m.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, Integers
from rubnoise.compiling import compiled, compiled_within
from rubnoise.record.rows import LandmarkKind, Phase
from rubnoise.simulation.area import ForceCells, expand
from rubnoise.simulation.series import rate, rate_of_rate, value, value_and_rate

Records = NDArray[Any]  # an array of records: STATE, ROW or MARK
Moving = Any  # the one record of STATE, changed in place; compiled code knows its fields
ORDER: Final = 8  # highest power of time in a step
CUBIC: Final = 3  # highest power of distance in the force
TOLERANCE: Final = 1e-10  # largest size of the last two terms of a step's series, over the width of a cell
TOUCH: Final = 1e-9  # a least w below this times V is a standstill; f above G by less than this times G is a stick

SLIP, STUCK, REVERSED = map(int, Phase)
STICK, BREAKAWAY, REVERSAL, FORWARD = map(int, LandmarkKind)

REACHED, BACK, FULL = range(3)
"""Why the motion stopped: at its end; before the first cell; because no row or landmark has room."""

INTEGRALS: Final = (
    "time_stuck",
    "displacement_integral",
    "displacement_squared_integral",
    "velocity_squared_integral",
    "friction_work",
    "reverse_work",
)
"""Sums since t = 0: of the time in sticks; x, x^2, x'^2 over time; G over |ds|; the last one over reversals."""

STATE: Final = np.dtype(
    [(name, np.int64) for name in ("cell", "phase", "row", "mark", "fresh", "met")]
    + [(name, np.float64) for name in ("y", "displacement", "relative", "time", *INTEGRALS)]
)
"""State of a slider: its cell, and place y in it over the width; next row; landmarks of this call; whether a breakaway
has just happened; places met in this call; x (um), w (um/s), t (s)."""

ROW: Final = np.dtype(
    [(name, np.float64) for name in ("distance", "friction_force", "displacement", "velocity")] + [("phase", np.uint8)],
    align=True,
)
"""A row uniform in time."""

MARK: Final = np.dtype(
    [("time", np.float64), ("distance", np.float64), ("kind", np.uint8)]
    + [(name, np.float64) for name in ("displacement", "velocity", "force_before", "force_after")],
    align=True,
)
"""A landmark."""


class DrivenSlider(NamedTuple):
    """m, k, c (kg, N/m, N s/m), V (um/s), and the time between rows (s)."""

    mass: float
    stiffness: float
    damping: float
    speed: float
    row_time: float


class StepOutput(NamedTuple):
    """Room for rows from the row ``first`` on, and for landmarks; births and deaths ahead (um), and when they are met.

    A place is met when the slider first gets there.
    """

    first: int
    rows: Records
    marks: Records
    places: Doubles
    times: Doubles


class Stop(NamedTuple):
    """Where the motion is to end: a cell, and the place in it over its width."""

    cell: int
    y: float


_PER_ORDER: Final = tuple(1.0 / ((n + 1) * (n + 2)) for n in range(ORDER - 1))

_GAUSS: Final = tuple(
    (float(0.5 + 0.5 * place), float(0.5 * weight))
    for place, weight in zip(*np.polynomial.legendre.leggauss(3), strict=True)
)


@compiled_within
def fill_series(drive: DrivenSlider, x: float, w: float, way: float, fresh: int, piece: Doubles, work: Doubles) -> None:
    """Fill in the powers of t in s - s_0 (row 0 of ``work``), and in its square and cube (rows 1 and 2)."""
    s, square, cube = work[0], work[1], work[2]
    s[0], s[1] = 0.0, w
    square[0], cube[0], lightness = 0.0, 0.0, 1.0 / drive.mass
    for n in range(ORDER - 1):
        pull = -drive.stiffness * s[n] - drive.damping * (n + 1) * s[n + 1]
        pull -= way * (piece[1] * s[n] + piece[2] * square[n] + piece[3] * cube[n])
        if n == 0:
            pull += drive.stiffness * x + drive.damping * drive.speed - way * piece[0]
            if fresh:
                pull = 0.0
        elif n == 1:
            pull += drive.stiffness * drive.speed
        s[n + 2] = pull * lightness * _PER_ORDER[n]
        second, third = 0.0, 0.0
        for i in range(1, n + 1):
            second += s[i] * s[n + 1 - i]
            third += square[i] * s[n + 1 - i]
        square[n + 1], cube[n + 1] = second, third


@compiled_within
def time_to(series: Doubles, way: float, length: float, guess: float, limit: float) -> float:
    """Return when a length has been passed, by Newton's method between bounds; it is passed before ``limit``."""
    low, high, time = 0.0, limit, min(guess, limit)
    for _ in range(60):
        moved, speed = value_and_rate(series, ORDER, time)
        beyond, slope = way * moved - length, way * speed
        if beyond > 0.0:
            high = time
        else:
            low = time
        following = time - beyond / slope if slope > 0.0 else low
        if not low <= following <= high:
            following = 0.5 * (low + high)
        if abs(following - time) <= 1e-6 * time:  # the next one would be right to 1e-12
            return following
        time = following
    return time


@compiled_within
def first_guess(series: Doubles, way: float, length: float) -> float:
    """Return when a length has been passed by the first two powers alone; infinite if it is not."""
    speed = way * series[1]
    root = speed * speed + 4.0 * way * series[2] * length
    both = speed + np.sqrt(max(root, 0.0))
    return 2.0 * length / both if root > 0.0 and both > 0.0 else np.inf


@compiled_within
def step_within(series: Doubles, way: float, length: float, tolerance: float) -> tuple[float, bool]:
    """Return when a length has been passed, and True; or for how long the series is right, and False."""
    last, before = abs(series[ORDER]), abs(series[ORDER - 1])
    guess = first_guess(series, way, length)
    limit = 1.25 * guess
    right = guess < np.inf and (last * limit + before) * limit ** (ORDER - 1) <= tolerance
    if not right or way * value(series, ORDER, limit) < length:
        limit = 1.0
        while (last * limit + before) * limit ** (ORDER - 1) <= tolerance and limit < 1e9:
            limit *= 2.0
        while (last * limit + before) * limit ** (ORDER - 1) > tolerance:
            limit *= 0.8
        if way * value(series, ORDER, limit) < length:
            return limit, False
    return time_to(series, way, length, guess, limit), True


@compiled_within
def change(series: Doubles, derivative: int, way: float, high: float) -> float:
    """Return where way times w (derivative 1) or w' (2) is no longer positive, by bisection between 0 and ``high``."""
    low = 0.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if way * (rate(series, ORDER, middle) if derivative == 1 else rate_of_rate(series, ORDER, middle)) > 0.0:
            low = middle
        else:
            high = middle
    return high


@compiled_within
def standstill(series: Doubles, way: float, time: float, touch: float) -> float:
    """Return when w first comes to 0 within a step, or has a least value below ``touch``; infinite if it does not."""
    if way * series[2] < 0.0 and way * rate_of_rate(series, ORDER, time) > 0.0:
        time = change(series, 2, -way, time)
        least = way * rate(series, ORDER, time)
        if least > touch:
            return np.inf
        if least > -touch:
            return time
    elif way * rate(series, ORDER, time) > 0.0:
        return np.inf
    return change(series, 1, way, time)


@compiled_within
def write_rows(
    now: Moving, drive: DrivenSlider, origin: float, end: float, out: StepOutput, piece: Doubles, series: Doubles
) -> bool:
    """Write the rows of a step up to a time (s); return whether there was room."""
    way, held = -1.0 if now.phase == REVERSED else 1.0, held_by(now, drive)
    while now.row * drive.row_time <= end:
        if now.row - out.first == len(out.rows):
            return False
        since = max(now.row * drive.row_time - now.time, 0.0)
        (moved, speed), row = value_and_rate(series, ORDER, since), out.rows[now.row - out.first]
        row.distance = origin + moved
        row.friction_force = way * max(value(piece, CUBIC, moved), 0.0)
        if now.phase == STUCK:
            row.friction_force = held + drive.stiffness * drive.speed * since
        row.displacement = now.displacement + drive.speed * since - moved
        row.velocity = drive.speed - speed
        row.phase = now.phase
        now.row += 1
    return True


@compiled_within
def held_by(now: Moving, drive: DrivenSlider) -> float:
    """Return the force of spring and dashpot at w = 0, k x + c V."""
    return drive.stiffness * now.displacement + drive.damping * drive.speed


@compiled_within
def go_on(now: Moving, drive: DrivenSlider, duration: float, piece: Doubles, series: Doubles) -> None:
    """Add a step to the integrals, and move to its end in time."""
    for node, share in _GAUSS:
        time = node * duration
        moved, speed = value_and_rate(series, ORDER, time)
        x, v = now.displacement + drive.speed * time - moved, drive.speed - speed
        now.displacement_integral += share * duration * x
        now.displacement_squared_integral += share * duration * (x * x)
        now.velocity_squared_integral += share * duration * (v * v)
    moved = value(series, ORDER, duration)
    # the integral of the force; its cubic may be a little below 0 where a life begins
    work = moved * (piece[0] + moved * (piece[1] / 2.0 + moved * (piece[2] / 3.0 + moved * piece[3] / 4.0)))
    work = -work if now.phase == REVERSED else work
    now.friction_work += work
    if now.phase == REVERSED:
        now.reverse_work += work
    if now.phase == STUCK:
        now.time_stuck += duration
    now.time += duration
    now.displacement += drive.speed * duration - moved


@compiled_within
def meet(now: Moving, out: StepOutput, origin: float, reached: float, duration: float, series: Doubles) -> None:
    """Note when the births and deaths up to a distance are met in a step forward."""
    while now.met < len(out.places) and out.places[now.met] <= reached:
        length = max(out.places[now.met] - origin, 0.0)
        guess = min(first_guess(series, 1.0, length), duration) if length > 0.0 else 0.0
        out.times[now.met] = now.time + time_to(series, 1.0, length, guess, duration)
        now.met += 1


@compiled_within
def write_mark(
    now: Moving, drive: DrivenSlider, width: float, out: StepOutput, kind: int, before: float, after: float
) -> None:
    """Write a landmark at the present time and place, where w = 0."""
    mark = out.marks[now.mark]
    mark.time, mark.distance = now.time, (now.cell + now.y) * width
    mark.kind = kind
    mark.displacement, mark.velocity = now.displacement, drive.speed
    mark.force_before, mark.force_after = before, after
    now.mark += 1


@compiled_within
def arrive(now: Moving, drive: DrivenSlider, width: float, force: float, out: StepOutput) -> None:
    """Decide what follows at w = 0, where the contact can bear a force."""
    bears, before = max(force, 0.0), -force if now.phase == REVERSED else force
    held, kind, phase, after = held_by(now, drive), STICK, STUCK, 0.0
    now.relative = 0.0
    if abs(held) <= bears * (1.0 + TOUCH):
        after = min(max(held, -bears), bears)
    elif held > bears:
        kind, phase, after = FORWARD, SLIP, bears
    else:
        kind, phase, after = REVERSAL, REVERSED, -bears
    if phase != now.phase:
        write_mark(now, drive, width, out, kind, before, after)
    now.phase = phase


@compiled_within
def ride(now: Moving, drive: DrivenSlider, width: float, out: StepOutput, piece: Doubles, series: Doubles) -> bool:
    """Write the rows of a stick and break away; return False if there was no room for all rows."""
    force = piece[0]
    wait = max((force - held_by(now, drive)) / (drive.stiffness * drive.speed), 0.0)
    series[:] = 0.0
    if not write_rows(now, drive, (now.cell + now.y) * width, now.time + wait, out, piece, series):
        return False
    go_on(now, drive, wait, piece, series)
    write_mark(now, drive, width, out, BREAKAWAY, force, force)
    now.phase, now.relative, now.fresh = SLIP, 0.0, 1
    return True


@compiled_within
def slip(
    now: Moving, drive: DrivenSlider, cells: ForceCells, border: float, out: StepOutput, piece: Doubles, work: Doubles
) -> bool:
    """Take a step in slip, not beyond a border; return False, and change nothing but the next row, without room."""
    way, series, width = -1.0 if now.phase == REVERSED else 1.0, work[0], cells.width
    fill_series(drive, now.displacement, now.relative, way, now.fresh, piece, work)
    origin = (now.cell + now.y) * width
    duration, at_border = step_within(series, way, way * (border - now.y) * width, TOLERANCE * width)
    halt = standstill(series, way, duration, TOUCH * drive.speed)
    if halt <= duration:
        duration, at_border = halt, False
    if not write_rows(now, drive, origin, now.time + duration, out, piece, series):
        return False
    moved, speed = value_and_rate(series, ORDER, duration)
    if way > 0.0:
        meet(now, out, origin, (now.cell + border) * width if at_border else origin + moved, duration, series)
    go_on(now, drive, duration, piece, series)
    now.relative, now.fresh = speed, 0
    now.y = border if at_border else min(max(now.y + moved / width, 0.0), 1.0)
    if halt <= duration:
        arrive(now, drive, width, value(piece, CUBIC, moved), out)
    return True


@compiled
def advance(state: Records, drive: DrivenSlider, cells: ForceCells, stop: Stop, out: StepOutput, work: Doubles) -> int:
    """Move through cells until something is missing or the end is reached; return REACHED, BACK or FULL.

    state (1,): changed in place; work (4, ORDER + 1): memory for powers of a step and of the force.
    """
    now, piece = state[0], work[3]
    while now.mark + 2 <= len(out.marks):
        way = -1.0 if now.phase == REVERSED else 1.0
        if way > 0.0 and now.y == 1.0:
            now.cell, now.y = now.cell + 1, 0.0
        elif way < 0.0 and now.y == 0.0:
            now.cell, now.y = now.cell - 1, 1.0
        if way > 0.0 and (now.cell > stop.cell or (now.cell == stop.cell and now.y >= stop.y)):
            return REACHED
        if now.cell < cells.first:
            return BACK
        border = expand(cells, now.cell, now.y, way, piece)
        if way > 0.0 and now.cell == stop.cell:
            border = min(border, stop.y)
        if now.phase == STUCK:
            room = ride(now, drive, cells.width, out, piece, work[0])
        else:
            room = slip(now, drive, cells, border, out, piece, work)
        if not room:
            return FULL
    return FULL


def columns_of(table: Records, count: int) -> dict[str, Doubles | Integers]:
    """Return the columns of the first rows."""
    return {name: np.ascontiguousarray(table[name][:count]) for name in table.dtype.names or ()}
