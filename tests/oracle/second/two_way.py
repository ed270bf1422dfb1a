"""The motion of a two-way slider made again between rows and landmarks, from the junctions that a file has."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.landmarks import first_landmark
from rubnoise.analysis.reading import Ahead
from rubnoise.answer import LeftOut
from rubnoise.arrays import Doubles, Integers
from rubnoise.model import Model, Slider
from rubnoise.record.reader import Rows, chunks
from rubnoise.record.rows import LandmarkKind, Phase
from rubnoise.runs.verification import Check
from tests.oracle.second.notes import Notes
from tests.oracle.second.slips import SHAPES, Contact, Led, Nodes, Oscillator, follow

PHASES: Final = np.array([Phase.STICK, Phase.SLIP, Phase.REVERSAL, Phase.SLIP])
"""The phase that begins at a landmark, by its kind."""

STRETCH: Final = 1024
"""Rows that are integrated one after the other at most, between two of which there may be some that are not."""

MOST: Final = 15_000_000
"""Live junctions, times rows and what happens between two of them, that are integrated again: some seconds."""

FEWEST: Final = 16
"""Stretches that a longer run has at least, but where a single row is a sixteenth of MOST or more."""

STEPS: Final = 10.0
"""Errors of a step, each `slider.tolerance` of the deflection at most, that may add up in a time of 1/omega_0."""

FINEST: Final = 1e-11
"""Tolerance below which rows inside a step, which are read off a polynomial, come no nearer."""

SHARE: Final = 1e-9
"""Of the largest force or velocity in a stretch: what sums over lives and a rounded place may make of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """Rows ``first`` ... ``end`` of /slider with the landmarks between them, in order of time.

    landmark: the number of each landmark, -1 for rows; kind: of each landmark; before: the phase that ends there.
    """

    first: int
    end: int
    nodes: Nodes
    force: Doubles
    after: Doubles
    landmark: Integers
    kind: Integers
    before: Integers


def motion_checks(model: Model, rows: Rows) -> tuple[list[Check], list[LeftOut]]:
    """Return whether rows and landmarks lead to each other, and forces and first passages are those of the junctions.

    Each row or landmark is where the one before it leads, to STEPS (1 + omega_0 dt) times the tolerance and what an
    error of so much grows to on the way; in between w changes its sign nowhere. Sticks begin and end, and the slider
    turns, where f = k x + c V and G say so. Of a long run (see MOST) stretches are taken, spread evenly.
    """
    slider = model.slider
    if slider is None or model.sliding_speed is None or model.strengths is None or rows.rows("slider") < 2:
        return [], []
    motion, passages = Notes("motion"), Notes("passage_times")
    reader, contact, behind, taken = Ahead(rows), Lives(model, rows), 0, 0
    total = rows.rows("slider") - 1
    length, starts = chosen_stretches(model, total)
    for first in starts:
        stretch = stretch_of(reader, first, min(first + length, total))
        taken += stretch.end - first
        distance = stretch.nodes.distance
        lives = contact.between(float(distance.min()), float(distance.max()))
        led = follow(_oscillator(model, slider), lives.contact, stretch.nodes)
        # Who died before a stationary start is not in the file.
        unknown = (distance < -SHARE * model.tick) & (model.start == "stationary")
        unknown[:-1] |= unknown[1:]
        behind += int(np.count_nonzero(unknown))
        _compare(motion, model, slider, stretch, led, unknown)
        _compare_passages(passages, model, slider, stretch, led, lives)
    left_out = []
    if taken < total:
        reason = f"of {total:,} rows {taken:,} were integrated again, in {len(starts)} stretches spread evenly"
        left_out.append(LeftOut(name="motion", reason=reason))
    if behind:
        reason = (
            f"the slider is behind its start at {behind:,} rows or landmarks, where no row says which junctions lived"
        )
        left_out.append(LeftOut(name="motion", reason=reason))
    return [motion, passages], left_out


def chosen_stretches(model: Model, rows: int) -> tuple[int, list[int]]:
    """Return the rows of a stretch and where stretches begin: all there are, or as many as MOST allows."""
    each = max(model.mean_junction_count, 1.0) * (1.0 + 3.0 * model.tick * model.birth_rate)
    length = min(max(int(MOST / (FEWEST * each)), 1), STRETCH)
    count = -(-rows // length)
    chosen = np.rint(np.linspace(0, count - 1, min(max(int(MOST / (each * length)), 2), count)))
    return length, (np.unique(chosen).astype(np.int64) * length).tolist()


def stretch_of(rows: Ahead, first: int, end: int) -> Stretch:
    """Return rows ``first`` ... ``end`` with the landmarks between them."""
    names = ("time", "distance", "displacement", "velocity")
    of_rows = [rows.column("slider", name, first, end + 1) for name in (*names, "friction_force")]
    begin, stop = (first_landmark(rows, float(of_rows[0][n])) for n in (0, -1))
    kind = rows.column("landmarks", "kind", begin, stop).astype(np.int64)
    of_marks = [rows.column("landmarks", name, begin, stop) for name in (*names, "force_before", "force_after")]
    order = np.argsort(np.concatenate([of_rows[0], of_marks[0]]), kind="stable")
    columns = [np.concatenate([a, b])[order] for a, b in zip(of_rows, of_marks, strict=False)]
    landmark = np.concatenate([np.full(end + 1 - first, -1), np.arange(begin, stop)])[order]
    kinds = np.concatenate([np.full(end + 1 - first, -1), kind])[order]
    here = int(PHASES[rows.column("landmarks", "kind", begin - 1, begin)[0]]) if begin else int(Phase.SLIP)
    last = np.maximum.accumulate(np.where(landmark >= 0, np.arange(order.size), -1))
    phase = np.where(last < 0, here, PHASES[kinds[last]])
    return Stretch(
        first=first,
        end=end,
        nodes=Nodes(columns[0], columns[1], columns[2], columns[3], phase.astype(np.int64)),
        force=columns[4],
        after=np.concatenate([of_rows[4], of_marks[5]])[order],
        landmark=landmark,
        kind=kinds,
        before=np.concatenate([[here], phase[:-1]]).astype(np.int64),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Between:
    """The lives of a stretch, with the row in /junctions and the time (s) stored for each of its births and deaths."""

    contact: Contact
    row: Integers
    name: NDArray[np.str_]
    time: Doubles


class Lives:
    """The junctions of a file, read once from front to back; a slider that runs back is given those behind it."""

    def __init__(self, model: Model, rows: Rows) -> None:
        """Begin before the first row."""
        self._model, self._rows, self._next = model, Ahead(rows), 0
        self._kept = np.empty((6, 0))
        # s = V t - (x - x_0) falls by no more than x rises.
        extremes = [(float(x.min()), float(x.max())) for x in (each["displacement"] for each in chunks(rows, "slider"))]
        lowest, highest = zip(*extremes, strict=True)
        self._back = max(highest) - min(lowest) + model.tick

    def between(self, begin: float, end: float) -> Between:
        """Return who lives somewhere between two distances in um, each stretch lying at the one before it or beyond."""
        kept = [self._kept]
        while self._next < (total := self._rows.rows("junctions")):
            stop = min(self._next + STRETCH, total)
            found = self._read(self._next, stop)
            count = int(np.searchsorted(found[0], end, side="right"))
            kept.append(found[:, :count])
            self._next += count
            if count < stop - (self._next - count):
                break
        rows = np.concatenate(kept, axis=1)
        death = rows[0] + 2.0 * rows[1]
        self._kept = rows[:, death > end - self._back]
        return self._between(rows[:, death > begin])

    def _read(self, first: int, stop: int) -> Doubles:
        names = ("birth_distance", "diameter", "shear_strength", "birth_time", "death_time")
        columns = [self._rows.column("junctions", name, first, stop) for name in names]
        return np.array([*columns, np.arange(first, stop, dtype=np.float64)])

    def _between(self, rows: Doubles) -> Between:
        birth, diameter, strength, birth_time, death_time, number = rows
        death = birth + 2.0 * diameter
        places = np.concatenate([birth, birth + diameter, death])
        order, unknown = np.argsort(places, kind="stable"), np.full(birth.size, np.nan)
        contact = Contact(
            birth=np.ascontiguousarray(birth),
            diameter=np.ascontiguousarray(diameter),
            death=death,
            weight=strength * (diameter * diameter),
            reach=np.maximum.accumulate(death),
            shape=SHAPES[self._model.pulse.shape],
            places=places[order],
            rooted=np.repeat(np.array([1, 0, -1]), birth.size)[order],
        )
        return Between(
            contact=contact,
            row=np.tile(number.astype(np.int64), 3)[order],
            name=np.repeat(np.array(["birth_time", "", "death_time"]), birth.size)[order],
            time=np.concatenate([birth_time, unknown, death_time])[order],
        )


def _scale(model: Model, slider: Slider) -> float:
    """Return the deflection under the mean force in um, of which the tolerance is a share."""
    strength = model.strengths.moment(1) if model.strengths is not None else 0.0
    return strength * model.stationary_mean_area / slider.stiffness


def _oscillator(model: Model, slider: Slider) -> Oscillator:
    omega = slider.natural_angular_frequency
    return Oscillator(
        mass=slider.mass,
        stiffness=slider.stiffness,
        damping=slider.damping,
        drive=model.sliding_speed or 0.0,
        longest=0.5 / omega,
        limit=max(1e-3 * slider.tolerance * _scale(model, slider), 1e-14),
        error=max(slider.tolerance, FINEST) * _scale(model, slider),
    )


def _allowed(model: Model, slider: Slider, stretch: Stretch, led: Led) -> tuple[Doubles, Doubles]:
    """Return what places (um) and velocities (um/s) may be away from where nodes lead.

    The tolerance is that of a place, and steps are as short as rows, so that it is one of velocities times 1/dt, too.
    """
    error, speed = max(slider.tolerance, FINEST) * _scale(model, slider), model.sliding_speed or 0.0
    nodes = stretch.nodes
    rounded = 4.0 * np.spacing(np.abs(nodes.distance) + speed * nodes.time)
    duration = np.maximum(np.append(np.diff(nodes.time), 1.0), 1e-3 * (model.tick_duration or 1.0))
    rate = slider.natural_angular_frequency + 1.0 / duration
    steps = STEPS * (1.0 + slider.natural_angular_frequency * duration)
    place = steps * (error + led.grown) + rounded
    rounded = rounded * rate + 16.0 * np.spacing(speed) + SHARE * np.abs(nodes.velocity).max()
    return place, steps * (error * rate + led.grown_speed) + rounded


def _compare(notes: Notes, model: Model, slider: Slider, stretch: Stretch, led: Led, unknown: NDArray[Any]) -> None:
    """Compare nodes with where those before them lead, and forces with what the junctions bear."""
    nodes, limits = stretch.nodes, _allowed(model, slider, stretch, led)
    led_to = [np.concatenate([found[:1], each[:-1]]) for found, each in zip(nodes[1:4:2], led[:2], strict=True)]
    allowed = [np.concatenate([[0.0], limit[:-1]]) for limit in limits]
    lowest = np.concatenate([[0.0], led.lowest[:-1]])
    skip = np.concatenate([[True], unknown[:-1]])
    way = np.select([nodes.phase == Phase.SLIP, nodes.phase == Phase.REVERSAL], [1.0, -1.0], 0.0)
    came = np.select([stretch.before == Phase.SLIP, stretch.before == Phase.REVERSAL], [1.0, -1.0], 0.0)
    f = slider.stiffness * nodes.displacement + slider.damping * (model.sliding_speed or 0.0)
    force = float(np.abs(stretch.force).max(initial=0.0))
    loose = max(SHARE, 10.0 * slider.tolerance) * force
    bears = np.where(unknown, stretch.after * way, led.force)
    for group, of, first in (
        ("slider", stretch.landmark < 0, stretch.first),
        ("landmarks", stretch.landmark >= 0, int(stretch.landmark.max(initial=0)) + 1),
    ):
        chosen = np.flatnonzero(of)
        row = first if group == "slider" else first - chosen.size
        for name, found, right, limit in zip(("distance", "velocity"), nodes[1:4:2], led_to, allowed, strict=True):
            expected = np.where(skip, found, right)
            notes.near(f"/{group}/{name}", row, found[chosen], expected[chosen], limit[chosen])
        kept = skip | (lowest >= -allowed[1])
        notes.true(f"/{group}/velocity", row, nodes.velocity[chosen], kept[chosen], "of a slip without a turn before")
        if group == "slider":
            expected = np.where(unknown | (way == 0.0), stretch.force, way * led.force)
            notes.near("/slider/friction_force", row, stretch.force[chosen], expected[chosen], loose)
            continue
        kind = stretch.kind
        before = np.where(kind == LandmarkKind.SLIP, f, np.where(unknown, stretch.force, came * led.force))
        notes.near("/landmarks/force_before", row, stretch.force[chosen], before[chosen], loose)
        held = np.where(way == 0.0, f, np.where(unknown, stretch.after, way * led.force))
        notes.near("/landmarks/force_after", row, stretch.after[chosen], held[chosen], loose)
        right = np.select(
            [kind == LandmarkKind.STICK, kind == LandmarkKind.REVERSAL],
            [np.abs(f) <= bears + loose, f <= loose - bears],
            f >= bears - loose,
        )
        notes.true("/landmarks/kind", row, kind[chosen], (unknown | right)[chosen], "what f and G make of w = 0")


def _compare_passages(notes: Notes, model: Model, slider: Slider, stretch: Stretch, led: Led, lives: Between) -> None:
    """Compare first passages stored within the time of a stretch with when its slips pass those places."""
    begin, end = stretch.nodes.time[[0, -1]]
    place, _ = _allowed(model, slider, stretch, led)
    for name in ("birth_time", "death_time"):
        inside = (lives.name == name) & (lives.time > begin) & (lives.time < end)
        for at in np.flatnonzero(inside).tolist():
            slow = float(led.speed[at])
            node = int(np.searchsorted(stretch.nodes.time, lives.time[at], side="right")) - 1
            allowed = float(place[node]) / slow if slow > 0.0 else np.inf
            found, right = lives.time[at : at + 1], led.passed[at : at + 1]
            notes.near(f"/junctions/{name}", int(lives.row[at]), found, right, allowed + 8.0 * np.spacing(end))
