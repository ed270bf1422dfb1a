"""The three steps in slip. Each goes one way: l is the distance passed, u = |w|, d = +1 forward and -1 in reversal.

    m u' = d (k x + c V) - c u - G        x = x_0 + V t - d l        l' = u

If u is far from 0, l is the better clock: with Q = u^2/2, dQ/dl = u' and dt/dl = 1/u, and G is a function of the clock.
The terms that couple back, k V t and c u, are then weak, so that a few passes over the same nodes are enough.

`uniform_cell`  one or more cells of the grid: three exact moments of G, three Gauss nodes. The rest of G is orthogonal
                to 1, y and y^2, so that Q at the end is exact, and t is exact up to (dQ/Q)^2 of this rest.
`event_cell`    from a birth, mid-life, death or border of the grid to the next: eight Gauss nodes, on a clock in which
                the begin or end of a life is smooth.
`time_step`     eight Gauss nodes in t, for steps that begin or end at w = 0.
"""

from typing import Any, Final

import numpy as np

from rubnoise.arrays import Doubles
from rubnoise.compiling import compiled_bare, compiled_within, inlined
from rubnoise.simulation.coupled.field import Part, force_in_lanes
from rubnoise.simulation.coupled.lanes import fused, larger, load, root, spread, store
from rubnoise.simulation.coupled.layout import DAMPING, DRIVE, MASS, STIFFNESS, SlipStart, Workspace
from rubnoise.simulation.coupled.quadrature import (
    BOTH,
    CLOCKS,
    FIVE_POWERS,
    INTEGRAL,
    LEFT,
    LEGENDRE,
    NODES,
    RATES,
    RIGHT,
    THREE_INTEGRALS,
    THREE_NODES,
    THREE_WEIGHTS,
    WEIGHTS,
)

# Results of a step in ``work``: eight numbers each.
SPEED, PASSED, TIME, FORCE, GROWTH, PUSH, PACE = 16, 24, 32, 40, 48, 56, 64
"""u, l, t, G and u' at the nodes; Legendre coefficients of the rate of u or Q, and of the rate of l or t."""
_SCRATCH: Final = 72
_DRAG: Final = 80
_MATRIX: Final = 88
WORK: Final = 152
"""Length of the scratch memory that steps need."""

_MOST_PASSES: Final = 24
_PASSES: Final = 8
_LEAST: Final = 1e-300
_CONVERGED: Final = 1e-15
_CONVERGED_IN_DRAG: Final = 4e-15

WEAK_DRAG: Final = 0.02
"""Size of a uniform cell over the length m u/c in which drag stops the slider: up to here, passes converge without
Newton's method."""
WEAK_DRAG_OF_NODES: Final = 0.3
"""The same for eight nodes, in length or in time."""

_UP = tuple((2.0 * n + 1.0) / (n + 1.0) for n in range(NODES))
_DOWN = tuple(n / (n + 1.0) for n in range(NODES))
_HALF = tuple(0.5 / (2.0 * n + 1.0) for n in range(NODES))


@inlined
def _times(table: Doubles, matrix: int, work: Doubles, at: int) -> Any:
    """Return a matrix times eight numbers in ``work``, in lanes."""
    total = spread(work[at]) * load(table, matrix)
    for n in range(1, NODES):
        total = fused(spread(work[at + n]), load(table, matrix + NODES * n), total)
    return total


@inlined
def total_of(table: Doubles, work: Doubles, at: int) -> float:
    """Return the integral to 1 of the polynomial through eight values at the nodes."""
    total = 0.0
    for n in range(NODES):
        total += table[WEIGHTS + n] * work[at + n]
    return total


@compiled_within
def _relax(table: Doubles, work: Doubles) -> None:
    """Solve (1 + A diag(g)) y = r for y, in place of r; A: the integrals to the nodes, g: the effect of drag on y.

    The method is Gauss-Jordan elimination, column by column. If r is the residual of a pass, this is Newton's method
    for the terms linear in drag. So a step may be longer than the length, or time, in which drag stops the slider.
    """
    for n in range(NODES):
        store(work, _MATRIX + NODES * n, spread(work[_DRAG + n]) * load(table, INTEGRAL + NODES * n))
        work[_MATRIX + NODES * n + n] += 1.0
    for n in range(NODES):
        column = _MATRIX + NODES * n
        pivot = work[column + n]
        work[column + n] = 0.0
        work[_DRAG + n] = pivot
        factor = load(work, column) / spread(pivot)
        for k in range(n + 1, NODES):
            other = _MATRIX + NODES * k
            store(work, other, load(work, other) - factor * spread(work[other + n]))
        store(work, _SCRATCH, load(work, _SCRATCH) - factor * spread(work[_SCRATCH + n]))
    store(work, _SCRATCH, load(work, _SCRATCH) / load(work, _DRAG))


@compiled_bare
def integral_to(q: float, work: Doubles, at: int) -> float:
    """Return the integral from 0 to q of a series sum c_n P_n(2q - 1)."""
    z = 2.0 * q - 1.0
    before, here = 1.0, z
    total = work[at] * q
    for n in range(1, NODES):
        after = _UP[n] * z * here - _DOWN[n] * before
        total += work[at + n] * (_HALF[n] * (after - before))
        before, here = here, after
    return total


@compiled_bare
def value_at(q: float, work: Doubles, at: int) -> float:
    """Return a series sum c_n P_n(2q - 1)."""
    z = 2.0 * q - 1.0
    before, here = 1.0, z
    total = work[at]
    for n in range(1, NODES):
        total += work[at + n] * here
        before, here = here, _UP[n] * z * here - _DOWN[n] * before
    return total


@compiled_bare
def clock_at(q: float, clock: int) -> float:
    """Return y(q) of a clock."""
    if clock == LEFT:
        return q * q
    if clock == RIGHT:
        return q * (2.0 - q)
    if clock == BOTH:
        return q * q * (3.0 - 2.0 * q)
    return q


@inlined
def _weighed(weights: tuple[float, ...], a: float, b: float, c: float) -> float:
    return weights[0] * a + weights[1] * b + weights[2] * c


@inlined
def _known(y: float, net: float, pull: float, slope: float, bend: float) -> float:
    """Return int_0^y of the terms of m u' known beforehand; G is the polynomial with its three moments."""
    return net * y - pull * y * y - y * (y - 1.0) * (3.0 * slope + 5.0 * bend * (2.0 * y - 1.0))


@compiled_within
def _relaxed(g: tuple[float, float, float], r: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return the solution of `_relax` for three nodes."""
    (a, b, c), (d, e, f), (h, i, j) = THREE_INTEGRALS
    a, b, c = 1.0 + a * g[0], b * g[1], c * g[2]
    d, e, f = d * g[0], 1.0 + e * g[1], f * g[2]
    h, i, j = h * g[0], i * g[1], 1.0 + j * g[2]
    r0, r1, r2 = r
    part = d / a
    e, f, r1 = e - part * b, f - part * c, r1 - part * r0
    part = h / a
    i, j, r2 = i - part * b, j - part * c, r2 - part * r0
    part = i / e
    r2 = (r2 - part * r1) / (j - part * f)
    r1 = (r1 - f * r2) / e
    return (r0 - b * r1 - c * r2) / a, r1, r2


@compiled_bare
def uniform_cell(
    constants: Doubles, start: SlipStart, width: float, moments: tuple[float, float, float], work: Doubles
) -> tuple[float, float]:
    """Pass one cell, or several as one; return the speed behind it and the time.

    moments: the three of G in the direction of travel (uN). work receives u and t at the three nodes. A speed of 0
    means that this kind of step does not fit the cell.
    """
    way, x, u = start.way, start.displacement, start.speed
    mean, slope, bend = moments
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    energy, per_mass = 0.5 * u * u, width / mass
    net, pull = way * (stiffness * x + damping * drive) - mean, 0.5 * stiffness * width
    back = way * stiffness * drive
    k0 = _known(THREE_NODES[0], net, pull, slope, bend)
    k1 = _known(THREE_NODES[1], net, pull, slope, bend)
    k2 = _known(THREE_NODES[2], net, pull, slope, bend)
    time, old = width / u, 0.0
    u0, u1, u2 = u, u, u
    t0, t1, t2 = time * THREE_NODES[0], time * THREE_NODES[1], time * THREE_NODES[2]
    end = energy
    drag = per_mass * damping
    weak = drag <= WEAK_DRAG * u
    for _ in range(_PASSES):
        r0, r1, r2 = back * t0 - damping * u0, back * t1 - damping * u1, back * t2 - damping * u2
        q0 = energy + per_mass * (k0 + _weighed(THREE_INTEGRALS[0], r0, r1, r2))
        q1 = energy + per_mass * (k1 + _weighed(THREE_INTEGRALS[1], r0, r1, r2))
        q2 = energy + per_mass * (k2 + _weighed(THREE_INTEGRALS[2], r0, r1, r2))
        end = energy + per_mass * ((net - pull) + _weighed(THREE_WEIGHTS, r0, r1, r2))
        if not weak:
            rest = (q0 - 0.5 * u0 * u0, q1 - 0.5 * u1 * u1, q2 - 0.5 * u2 * u2)
            change = _relaxed((drag / u0, drag / u1, drag / u2), rest)
            q0, q1, q2 = 0.5 * u0 * u0 + change[0], 0.5 * u1 * u1 + change[1], 0.5 * u2 * u2 + change[2]
            end = energy
        if min(q0, q1, q2, end) <= 0.25 * energy:
            return 0.0, 0.0
        u0, u1, u2 = np.sqrt(2.0 * q0), np.sqrt(2.0 * q1), np.sqrt(2.0 * q2)
        p0, p1, p2 = width / u0, width / u1, width / u2
        t0 = _weighed(THREE_INTEGRALS[0], p0, p1, p2)
        t1 = _weighed(THREE_INTEGRALS[1], p0, p1, p2)
        t2 = _weighed(THREE_INTEGRALS[2], p0, p1, p2)
        old, time = time, _weighed(THREE_WEIGHTS, p0, p1, p2)
        if abs(time - old) <= 1e-9 * time:
            break
    work[SPEED], work[SPEED + 1], work[SPEED + 2] = u0, u1, u2
    work[TIME], work[TIME + 1], work[TIME + 2] = t0, t1, t2
    # Another half of a pass, for the speed at the end.
    r0, r1, r2 = back * t0 - damping * u0, back * t1 - damping * u1, back * t2 - damping * u2
    end = energy + per_mass * ((net - pull) + _weighed(THREE_WEIGHTS, r0, r1, r2))
    if end <= 0.25 * energy:
        return 0.0, 0.0
    return np.sqrt(2.0 * end), time


@compiled_within
def through_cell(before: float, after: float, power: float, work: Doubles, powers: Doubles) -> None:
    """Fill the coefficients of 1, y, ... y^4 of u^power, power 1 or -1, through both ends and the nodes of a cell."""
    u0, u1, u2 = work[SPEED], work[SPEED + 1], work[SPEED + 2]
    if power < 0.0:
        before, u0, u1, u2, after = 1.0 / before, 1.0 / u0, 1.0 / u1, 1.0 / u2, 1.0 / after
    for n in range(5):
        a, b, c, d, e = FIVE_POWERS[n]
        powers[n] = a * before + b * u0 + c * u1 + d * u2 + e * after


@compiled_bare
def event_cell(
    constants: Doubles, start: SlipStart, length: float, clock: int, part: Part, workspace: Workspace
) -> tuple[float, float, float]:
    """Pass a length (um) of a gathered cell from an offset in it; return the speed behind it, the time, and an error.

    The error (um) is the effect of the last coefficient of the series on the displacement. A speed of 0 means that this
    kind of step does not fit the length.
    """
    way, x, u, offset = start.way, start.displacement, start.speed, start.offset
    table, work = workspace.table, workspace.work
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    energy, per_mass = 0.5 * u * u, length / mass
    passed = spread(length) * load(table, CLOCKS + NODES * clock)
    rate = load(table, RATES + NODES * clock)
    force = force_in_lanes(fused(spread(way), passed, spread(offset)), part)
    known = spread(way * (stiffness * x + damping * drive)) - spread(stiffness) * passed - force
    store(work, FORCE, force)
    store(work, PASSED, passed)
    speed = spread(u)
    time = passed / speed
    back, drag, least = spread(way * stiffness * drive), spread(-damping), spread(_LEAST)
    total, old = length / u, 0.0
    weak = per_mass * damping <= WEAK_DRAG_OF_NODES * u
    converged = _CONVERGED if weak else _CONVERGED_IN_DRAG
    for _ in range(_MOST_PASSES):
        store(work, PUSH, fused(drag, speed, fused(back, time, known)) * rate)
        square = fused(spread(2.0 * per_mass), _times(table, INTEGRAL, work, PUSH), spread(2.0 * energy))
        if not weak:
            store(work, _DRAG, spread(per_mass * damping) * rate / speed)
            store(work, _SCRATCH, square - speed * speed)
            _relax(table, work)
            square = speed * speed + load(work, _SCRATCH)
        speed = root(larger(square, least))
        store(work, PACE, rate / speed)
        time = spread(length) * _times(table, INTEGRAL, work, PACE)
        old, total = total, length * total_of(table, work, PACE)
        if abs(total - old) <= converged * total:
            break
    else:
        return 0.0, 0.0, 0.0
    end = energy + per_mass * total_of(table, work, PUSH)
    store(work, SPEED, speed)
    store(work, TIME, time)
    least_energy = end
    for n in range(NODES):
        least_energy = min(least_energy, 0.5 * work[SPEED + n] * work[SPEED + n])
    if least_energy <= 0.1 * energy:
        return 0.0, 0.0, 0.0
    store(work, _SCRATCH, _times(table, LEGENDRE, work, PUSH))
    store(work, PUSH, load(work, _SCRATCH))
    store(work, _SCRATCH, _times(table, LEGENDRE, work, PACE))
    store(work, PACE, load(work, _SCRATCH))
    # At the same place, an error in t makes one in x that is V times as large.
    late = abs(work[PACE + NODES - 1]) + abs(work[PUSH + NODES - 1]) * per_mass / (2.0 * least_energy * u)
    error = 0.03 * length * max(u, drive) * late
    return np.sqrt(2.0 * end), total, error


@compiled_within
def time_step(
    constants: Doubles, start: SlipStart, duration: float, clock: int, part: Part, workspace: Workspace
) -> tuple[float, float, float, bool]:
    """Step for a duration (s) in a gathered cell; return speed, distance passed, error, and whether passes converged.

    The passes begin with u' and u'' at the start. The error is the same as for an event cell.
    """
    way, x, u, offset = start.way, start.displacement, start.speed, start.offset
    table, work = workspace.table, workspace.work
    mass, stiffness, damping, drive = constants[MASS], constants[STIFFNESS], constants[DAMPING], constants[DRIVE]
    time = spread(duration) * load(table, CLOCKS + NODES * clock)
    rate = spread(duration) * load(table, RATES + NODES * clock)
    per_mass, place, toward = spread(1.0 / mass), spread(offset), spread(way)
    known = fused(spread(way * stiffness * drive), time, spread(way * (stiffness * x + damping * drive)))
    least = _CONVERGED * 4.0 * (abs(stiffness * x) + abs(damping * drive)) / mass
    gain = fused(spread(start.jerk), time, spread(start.growth))
    weak, converged = damping * duration <= WEAK_DRAG_OF_NODES * mass, False
    for _ in range(_MOST_PASSES):
        store(work, GROWTH, gain)
        store(work, PUSH, gain * rate)
        speed = spread(u) + _times(table, INTEGRAL, work, PUSH)
        store(work, PACE, speed * rate)
        passed = _times(table, INTEGRAL, work, PACE)
        force = force_in_lanes(fused(toward, passed, place), part)
        gain = (((known - spread(stiffness) * passed) - spread(damping) * speed) - force) * per_mass
        store(work, _SCRATCH, gain)
        change = 0.0
        for n in range(NODES):
            change = max(change, abs(work[_SCRATCH + n] - work[GROWTH + n]))
        if change <= least:
            converged = True
            break
        if not change < 1e290:
            break
        if not weak:
            store(work, _DRAG, spread(damping / mass) * rate)
            store(work, _SCRATCH, gain - load(work, GROWTH))
            _relax(table, work)
            gain = load(work, GROWTH) + load(work, _SCRATCH)
    store(work, SPEED, speed)
    store(work, PASSED, passed)
    store(work, TIME, time)
    store(work, FORCE, force)
    end = u + total_of(table, work, PUSH)
    distance = total_of(table, work, PACE)
    store(work, _SCRATCH, _times(table, LEGENDRE, work, PUSH))
    store(work, PUSH, load(work, _SCRATCH))
    store(work, _SCRATCH, _times(table, LEGENDRE, work, PACE))
    store(work, PACE, load(work, _SCRATCH))
    error = 0.03 * (abs(work[PACE + NODES - 1]) + duration * abs(work[PUSH + NODES - 1]))
    return end, distance, error, converged
