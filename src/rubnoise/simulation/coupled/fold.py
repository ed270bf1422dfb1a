"""A two-way run as a fold: rows of junctions in, columns of the slider out, and a state that can be stored."""

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from math import ceil, floor, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.arrays import Doubles, Integers
from rubnoise.model import Model
from rubnoise.simulation.coupled import layout
from rubnoise.simulation.coupled.field import GROUP, ForceField
from rubnoise.simulation.coupled.motion import DONE, FULL, LOST, advance
from rubnoise.simulation.coupled.quadrature import NODES, TABLE
from rubnoise.simulation.coupled.state import CoupledState
from rubnoise.simulation.coupled.steps import WORK
from rubnoise.simulation.state import LiveRows
from rubnoise.simulation.ticks import coupled_spacing

Earlier = Callable[[float, float], LiveRows]
"""Returns all junctions that live between two distances (um), in order of birth; called if the slider runs far back."""

FINER: Final = 0.125
"""Smallest width of a cell for an over-damped slider, relative to the usual width."""

_CELLS: Final = 131_072
"""Cells of a range: their moments are 3 MB."""

_BEHIND: Final = 1024
"""Cells behind the slider with which a range begins, so that short reversals stay in it."""

_KEPT_ROWS: Final = 65_536
"""Number of carried rows above which the oldest passed rows are dropped."""

_ROOM_FOR_ROWS, _ROOM_FOR_LANDMARKS = 65_536, 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionRows:
    """The output of a part of the motion: at most some ten thousand rows, unless a single step has more.

    slider: columns time, distance, friction_force, displacement, velocity, phase, a row every tick/V from the run's
    row ``first_row`` on; landmarks: time, distance, kind, displacement, velocity, force_before, force_after; births and
    deaths: numbers of junctions, and when the slider first passed their births and deaths (s).
    """

    first_row: int
    slider: dict[str, NDArray[Any]]
    landmarks: dict[str, NDArray[Any]]
    births: tuple[Integers, Doubles]
    deaths: tuple[Integers, Doubles]


class CoupledMotion:
    """A moving two-way slider; ``state`` is its present state."""

    def __init__(
        self,
        model: Model,
        constants: Doubles,
        state: CoupledState,
        earlier: Earlier,
        cells: int = _CELLS,
    ) -> None:
        """Start from a state; ``earlier``: returns junctions behind the carried ones; ``cells``: cells of a range."""
        self._model = model
        self._constants = constants
        self._earlier = earlier
        self._cells = max(cells // GROUP * GROUP, 2 * _BEHIND)
        self.state = state
        self.finished = False
        self._out = np.empty((layout.ROW_COLUMNS, _ROOM_FOR_ROWS))
        self._marks = np.empty((layout.MARK_COLUMNS, _ROOM_FOR_LANDMARKS))
        width = float(constants[layout.SPACING])
        self._last = floor(model.distance / width)
        while float(self._last) * width > model.distance:
            self._last -= 1
        self._rest = model.distance - float(self._last) * width

    def through(self, born: LiveRows, known: float) -> Iterator[MotionRows]:
        """Move until the field is needed beyond ``known`` (um) or the run is over, and yield the rows.

        born: junctions in order of birth; those of earlier calls are ignored. Every birth before ``known`` must be in
        this or an earlier call. ``state`` is that of the end only after everything has been yielded.
        """
        self._take(born)
        end = self._end_of(known)
        while not (self.finished or self._waits(end)):
            begin, stop = self._range(end)
            code = yield from self._move_in(begin, stop)
            self.finished = code == DONE
        self._forget()

    def _waits(self, end: int) -> bool:
        """Return whether the slider needs the next group of cells ahead, which is not known yet."""
        ahead = (int(self.state.whole[layout.CELL]) // GROUP + 1) * GROUP
        return self.state.phase != layout.REVERSED and ahead > end and end <= self._last

    def _take(self, born: LiveRows) -> None:
        state = self.state
        newest = int(state.rows.junction[-1]) if len(state.rows) else -1
        new = born.part(int(np.searchsorted(born.junction, newest, side="right")), len(born))
        if not len(new):
            return
        times = np.where(np.signbit(new.birth), -np.inf, np.nan)
        self.state = replace(
            state,
            rows=state.rows.then(new),
            birth_time=np.concatenate([state.birth_time, times]),
            death_time=np.concatenate([state.death_time, np.full(len(new), np.nan)]),
        )

    def _end_of(self, known: float) -> int:
        """Return the cell before which all births are known: a multiple of GROUP, rounded up at the end of the run."""
        if known >= self._model.distance:
            return (self._last // GROUP + 1) * GROUP
        width = float(self._constants[layout.SPACING])
        end = floor(known / width)
        while float(end) * width > known:
            end -= 1
        return end // GROUP * GROUP

    def _range(self, end: int) -> tuple[int, int]:
        """Return the first cell and the end of the next range, around the slider."""
        cell = int(self.state.whole[layout.CELL])
        back = self.state.phase == layout.REVERSED
        needed = (cell - back) // GROUP * GROUP
        wished = needed - (self._cells // 2 if back else _BEHIND)
        carried = ceil(max(self.state.covered / float(self._constants[layout.SPACING]), -1e18) / GROUP) * GROUP
        # Junctions are drawn again only for cells that are needed now.
        begin = min(max(wished, carried), needed) if carried <= needed else wished
        return begin, min(begin + self._cells, end)

    def _move_in(self, begin: int, end: int) -> Generator[MotionRows, None, int]:
        """Move within a range of cells, yield the rows, and return the code of why the motion stopped."""
        state, constants = self.state, self._constants
        width = float(constants[layout.SPACING])
        living, births, deaths = self._living(float(begin) * width, float(end) * width)
        field = ForceField.over(self._model.pulse.shape, living, begin, end, width)
        order = np.argsort(living.birth + 2.0 * living.diameter, kind="stable")
        whole, numbers = state.whole.copy(), state.numbers.copy()
        whole[layout.BORN] = len(living) - np.count_nonzero(np.isnan(births))
        whole[layout.DIED] = len(living) - np.count_nonzero(np.isnan(deaths))
        met = (field.lives, field.shape, order, births, deaths)
        motion = layout.MotionState(whole, numbers, constants)
        stretch = layout.CellStretch(field.moments, begin, end, self._last, self._rest)
        workspace = layout.Workspace(
            TABLE, np.zeros(WORK), np.zeros(10), np.empty(4 * (len(living) + 1)), np.empty(NODES)
        )
        code = FULL
        while code == FULL:
            before = whole.copy()
            code = advance(motion, stretch, met, layout.RowSpace(self._out, self._marks), workspace)
            if code == LOST:
                place = f"{state.distance(constants):g} um, {state.time(constants):g} s"
                raise ArithmeticError(f"no step of the slider is right to its tolerance near {place}")
            if code == FULL and whole[layout.ROWS] == 0 and whole[layout.LANDMARKS] == 0:
                self._out = np.empty((layout.ROW_COLUMNS, 2 * self._out.shape[1]))
            passed = slice(before[layout.BORN], whole[layout.BORN])
            gone = order[before[layout.DIED] : whole[layout.DIED]]
            yield MotionRows(
                first_row=int(before[layout.ROW]) + 1,
                slider=self._rows(int(before[layout.ROW]) + 1, int(whole[layout.ROWS])),
                landmarks=self._landmarks(int(whole[layout.LANDMARKS])),
                births=(living.junction[passed], births[passed].copy()),
                deaths=(living.junction[gone], deaths[gone]),
            )
            whole[layout.ROWS] = whole[layout.LANDMARKS] = 0
        self._note(living, births, deaths)
        self.state = replace(self.state, whole=whole, numbers=numbers)
        return int(code)

    def _rows(self, first: int, count: int) -> dict[str, NDArray[Any]]:
        number = np.arange(first, first + count)
        distance, force, displacement, velocity, phase = self._out[:, :count].copy()
        return {
            "time": number * self._model.tick / float(self._constants[layout.DRIVE]),
            "distance": distance,
            "friction_force": force,
            "displacement": displacement,
            "velocity": velocity,
            "phase": phase.astype(np.uint8),
        }

    def _landmarks(self, count: int) -> dict[str, NDArray[Any]]:
        time, distance, kind, displacement, velocity, before, after = self._marks[:, :count].copy()
        return {
            "time": time,
            "distance": distance,
            "kind": kind.astype(np.uint8),
            "displacement": displacement,
            "velocity": velocity,
            "force_before": before,
            "force_after": after,
        }

    def _living(self, begin: float, end: float) -> tuple[LiveRows, Doubles, Doubles]:
        """Return the junctions that live between two distances, and the known first passages of births and deaths."""
        state = self.state
        carried = state.rows
        found, births, deaths = carried, state.birth_time, state.death_time
        if begin < state.covered:
            before = self._earlier(begin, end)
            before = before.at(np.flatnonzero(~np.isin(before.junction, carried.junction)))
            together = before.then(carried)
            by_birth = np.argsort(together.birth, kind="stable")
            # A junction that is no longer carried has been passed before.
            long_ago = np.full(len(before), -np.inf)
            found = together.at(by_birth)
            births = np.concatenate([long_ago, births])[by_birth]
            deaths = np.concatenate([long_ago, deaths])[by_birth]
        wanted = np.flatnonzero((found.birth < end) & (found.birth + 2.0 * found.diameter > begin))
        return found.at(wanted), births[wanted], deaths[wanted]

    def _note(self, living: LiveRows, births: Doubles, deaths: Doubles) -> None:
        """Store first passages with the carried rows."""
        state = self.state
        place = np.searchsorted(state.rows.junction, living.junction)
        here = np.flatnonzero(place < len(state.rows))
        here = here[state.rows.junction[place[here]] == living.junction[here]]
        birth_time, death_time = state.birth_time.copy(), state.death_time.copy()
        birth_time[place[here]], death_time[place[here]] = births[here], deaths[here]
        self.state = replace(state, birth_time=birth_time, death_time=death_time)

    def _forget(self) -> None:
        """Drop rows that lie so far behind that the slider will hardly come back to them."""
        state, model = self.state, self._model
        passed = ~np.isnan(state.death_time)
        death = state.rows.birth + 2.0 * state.rows.diameter
        old = passed & (death < state.distance(self._constants) - look_back(model))
        kept = np.flatnonzero(passed & ~old)
        old[kept[: max(len(old) - np.count_nonzero(old) - _KEPT_ROWS, 0)]] = True
        if not old.any():
            return
        rest = np.flatnonzero(~old)
        self.state = replace(
            state,
            rows=state.rows.at(rest),
            birth_time=state.birth_time[rest],
            death_time=state.death_time[rest],
            covered=max(state.covered, float(death[old].max())),
        )


def look_back(model: Model) -> float:
    """Return how far behind the slider junctions are carried (um): 4 psi A_rm/k + 2 V/omega_0, A_rm the exact mean.

    The slider loses energy when it goes back, so s cannot fall by more than sqrt(2 E/k) - x, a few times the
    deflection.
    """
    slider = model.slider
    if slider is None or model.strengths is None or model.sliding_speed is None:
        return 0.0
    deflection = model.strengths.moment(1) * model.stationary_mean_area / slider.stiffness
    return 4.0 * deflection + 2.0 * model.sliding_speed / slider.natural_angular_frequency


def constants(model: Model, tolerance: float) -> Doubles:
    """Return the numbers that stay the same in a whole run, at the places in `layout`."""
    slider, strengths, speed = model.slider, model.strengths, model.sliding_speed
    if slider is None or strengths is None or speed is None:
        raise ValueError("a slider moves where there is a strength and a sliding speed")
    scale = strengths.moment(1) * model.stationary_mean_area / slider.stiffness
    error = tolerance * scale
    width = coupled_spacing(model)
    if slider.damping_ratio > 1.0:
        # It always slides at about V, so cells are made fine enough to be uniform at this speed.
        finest = width * FINER
        while width > finest and speed * speed * _kink_limit(model, error, width) < 1.0:
            width *= 0.5
    # At a tolerance of 1e-9, Q may change by a fifth in uniform cells; their error goes as its sixth power.
    bend = 0.4
    while _sixth_power(bend / 0.2) > tolerance / 1e-9:
        bend *= 0.9375
    found = np.zeros(layout.CONSTANTS)
    found[:4] = slider.mass, slider.stiffness, slider.damping, speed
    found[layout.SPACING] = width
    found[layout.ROW_TIME] = model.tick / speed
    found[layout.LIMIT] = 0.3 * error
    found[layout.BEND_LIMIT] = bend
    found[layout.KINK_LIMIT] = _kink_limit(model, error, width)
    found[layout.TOUCH] = min(found[layout.LIMIT] * slider.natural_angular_frequency, 1e-3 * speed)
    found[layout.LONGEST] = 1.0 / slider.natural_angular_frequency
    return found


def _kink_limit(model: Model, error: float, width: float) -> float:
    """Return the largest cells^3 of uniform cells for each um^2/s^2 of w^2: 0.3 error m/(7e-4 kink h^3)."""
    slider, strengths = model.slider, model.strengths
    if slider is None or strengths is None:
        raise ValueError("a slider moves where there is a strength")
    crowd = sqrt(max(1.0, 4.0 * width * model.birth_rate))
    kink = 3.0 * strengths.moment(1) * model.calibrated_diameter * crowd
    return 0.3 * error * slider.mass / (7e-4 * kink * width * width * width)


def _sixth_power(number: float) -> float:
    cube = number * number * number
    return cube * cube
