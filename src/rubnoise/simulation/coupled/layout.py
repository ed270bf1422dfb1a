"""The layout of the flat arrays that compiled functions pass to each other."""

from typing import Final, NamedTuple

from rubnoise.arrays import Doubles, Integers
from rubnoise.record.rows import LandmarkKind, Phase

# Constants of a motion.
MASS, STIFFNESS, DAMPING, DRIVE = range(4)
"""m, k, c and V."""
SPACING, ROW_TIME, LIMIT, BEND_LIMIT, KINK_LIMIT, TOUCH, LONGEST = range(4, 11)
"""Width of a cell (um), time between rows (s), largest error of a step (um); largest relative change of Q in uniform
cells; largest cells^3 of these for each um^2/s^2 of w^2; largest w that counts as 0 if w' = 0; longest step (s)."""
CONSTANTS: Final = 11

# Whole numbers of a state.
CELL, ROW, PHASE, REST_ROW, FRESH, BORN, DIED, ROWS, LANDMARKS = range(9)
"""Cell; last row written; phase; the last row before a stick; whether a breakaway has just happened; within a call:
births and deaths passed, rows and landmarks written."""
WHOLE: Final = 9

# Numbers of a state.
OFFSET, DISPLACEMENT, RELATIVE, OVER, STEP = range(5)
"""Place in the cell (um), x, w, time since the last row (s), the next step in time (s)."""
REST, REST_OVER, REST_PLACE = range(5, 8)
"""Of a stick: its duration, and at its begin the time since the last row, and x."""
TIME_STUCK, X_TIME, XX_TIME, VV_TIME, FRICTION_WORK, REVERSE_WORK = range(8, 14)
"""Time stuck, int x dt, int x^2 dt, int x'^2 dt, int G |ds|, and the last of these over reversals."""
NUMBERS: Final = 14

SLIP, STUCK, REVERSED = map(int, Phase)
"""Phases as whole numbers, for compiled code."""

STICK, BREAKAWAY, REVERSAL, FORWARD = map(int, LandmarkKind)
"""Kinds of landmarks as whole numbers, for compiled code."""

ROW_DISTANCE, ROW_FORCE, ROW_DISPLACEMENT, ROW_VELOCITY, ROW_PHASE = range(5)
ROW_COLUMNS: Final = 5
"""Columns of rows uniform in time."""

MARK_TIME, MARK_DISTANCE, MARK_KIND, MARK_DISPLACEMENT, MARK_VELOCITY, MARK_BEFORE, MARK_AFTER = range(7)
MARK_COLUMNS: Final = 7
"""Columns of landmarks."""

IN_DISTANCE, IN_TIME = range(2)
"""The clock of a step within a cell: distance or time."""


class MotionState(NamedTuple):
    """A slider's state, changed in place, and the constants of its motion."""

    whole: Integers
    numbers: Doubles
    constants: Doubles


class CellStretch(NamedTuple):
    """The cells ``first`` ... ``end`` - 1 with three moments of G; the run ends ``rest`` um into the cell ``last``."""

    moments: Doubles
    first: int
    end: int
    last: int
    rest: float


class RowSpace(NamedTuple):
    """Space for rows and landmarks, one column each."""

    rows: Doubles
    marks: Doubles


class Workspace(NamedTuple):
    """The matrices of collocation, and memory: for steps, powers of a speed, near and far lives of a cell."""

    table: Doubles
    work: Doubles
    powers: Doubles
    near: Doubles
    far: Doubles


class SlipStart(NamedTuple):
    """Where a step in slip begins: ``way`` is +1 forward and -1 in reversal.

    displacement: x (um); speed: u = |w| (um/s); growth, jerk: u' and u'' (um/s^2, um/s^3), for steps in time;
    offset: place in the cell (um).
    """

    way: float
    displacement: float
    speed: float
    growth: float
    jerk: float
    offset: float


class Step(NamedTuple):
    """A step that has been found: direction, size (um), duration (s), clock, and whether that is distance or time."""

    way: float
    size: float
    duration: float
    clock: int
    kind: int
