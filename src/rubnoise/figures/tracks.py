"""What a picture draws along a run: quantities with what theory says of them, and the rows of one in a stretch."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.landmarks import Flights, StickSlip, first_landmark
from rubnoise.analysis.sound import COLUMNS
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.figures.stretch import MOST_READ, Stretch, thinned
from rubnoise.figures.style import one_line, shortened
from rubnoise.model import Model, Slider
from rubnoise.record.reader import column_chunks
from rubnoise.theory.ancestors import white_spectrum
from rubnoise.theory.coupling import load_motion
from rubnoise.theory.exact import exact
from rubnoise.theory.moments import area_cumulants, force_cumulants
from rubnoise.theory.motion import FORCE, density_of, motion_spectrum, need_friction, response
from rubnoise.theory.second_order import spectral_density

LIVES, PERIODS, STICKS = 40.0, 20.0, 20
"""Mean lives, natural periods of what swings, and sticks with two-way coupling that are shown by default."""

Group = Literal["trace", "slider", "load"]
Moments = tuple[float, float]
Density = Callable[[Model, Doubles], Doubles]


@dataclass(frozen=True, slots=True)
class Quantity:
    """A column along a run: its group, its unit on an axis, and what theory says of it.

    ``moments`` are its exact mean and standard deviation, ``density`` its exact two-sided spectral density, ``white``
    that of white noise of the same level at low frequency (Kilburn).
    """

    words: str
    group: Group
    column: str
    unit: str
    moments: Callable[[Model], Moments]
    density: Density | None = None
    white: Density | None = None

    @property
    def scale(self) -> float:
        """Factor from the unit of the column to that of the axis."""
        return 1e-3 if self.unit.startswith("m") else 1.0

    @property
    def label(self) -> str:
        """Label of an axis."""
        return f"{self.words} ({self.unit})" if self.unit else self.words


def _exact_force(model: Model, angular_frequency: Doubles) -> Doubles:
    """Return S_F(w/V)/V, the two-sided density of the force in uN^2 per rad/s."""
    need_friction(model)
    if model.strengths is None or model.sliding_speed is None:
        raise Refused("the spectrum of the force over frequency needs [strength] and sliding.speed")
    return density_of(model, FORCE, angular_frequency / model.sliding_speed) / model.sliding_speed


def _of_area(model: Model) -> Moments:
    area = area_cumulants(model)
    return area.mean, area.std


def _of_force(model: Model) -> Moments:
    force = force_cumulants(model)
    return force.mean, force.std


def _of_load(name: str) -> Callable[[Model], Moments]:
    return lambda model: ((model.load or 0.0) * (name == "load_std"), float(getattr(load_motion(model), name)))


def _of_motion(name: str) -> Callable[[Model], Moments]:
    def moments(model: Model) -> Moments:
        found = response(model)
        return found.mean_displacement if name == "displacement_std" else 0.0, float(getattr(found, name))

    return moments


def _of_base(model: Model) -> Moments:
    return response(model).mean_displacement, model.base_per_area * area_cumulants(model).std


_MOVING: Final = ("displacement", "velocity", "normal_velocity", "load")
_density: Final = {name: partial(motion_spectrum, name) for name in _MOVING}
_white: Final = {name: partial(white_spectrum, name) for name in (FORCE, "displacement", "velocity")}
QUANTITIES: Final[Mapping[str, Quantity]] = {
    "area": Quantity("real contact area", "trace", "real_contact_area", "µm²", _of_area, spectral_density),
    "count": Quantity(
        "live junctions", "trace", "junction_count", "", lambda model: (exact(model).count_mean, exact(model).count_std)
    ),
    "force": Quantity("friction force", "slider", COLUMNS["force"], "mN", _of_force, _exact_force, _white[FORCE]),
    "base": Quantity("height of the base", "slider", "base_displacement", "µm", _of_base),
    "displacement": Quantity(
        "displacement",
        "slider",
        "displacement",
        "µm",
        _of_motion("displacement_std"),
        _density["displacement"],
        _white["displacement"],
    ),
    "velocity": Quantity(
        "velocity",
        "slider",
        "velocity",
        "mm/s",
        _of_motion("velocity_std"),
        _density["velocity"],
        _white["velocity"],
    ),
    "load": Quantity("load", "load", "load", "mN", _of_load("load_std"), _density["load"]),
    "separation": Quantity("separation", "load", "separation", "µm", _of_load("separation_std")),
    "normal-velocity": Quantity(
        "normal velocity", "load", "velocity", "mm/s", _of_load("velocity_std"), _density["normal_velocity"]
    ),
}
"""Everything that is drawn along a run, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Track:
    """Rows ``first`` to before ``last`` of a quantity in a stretch, ``step`` um or, with ``timed``, s apart.

    ``swings`` is the oscillator: the mass on its spring, or under a load the mass on its contact; None for a contact.
    """

    stretch: Stretch
    quantity: Quantity
    group: Group
    first: int
    last: int
    step: float
    timed: bool
    swings: Slider | None

    @classmethod
    def of(cls, stretch: Stretch, name: str) -> Self:
        """Return a quantity in a stretch; raises Refused for a run without it, and for fewer than two rows.

        The friction force of a run without a slider is the one that would drive a slider.
        """
        quantity, model, columns = QUANTITIES[name], stretch.model, stretch.file.columns
        group, timed = quantity.group, quantity.group != "trace"
        if name == "force" and model.slider is None and quantity.column in columns["trace"]:
            group = "trace"
        oscillators = {"slider": model.slider, "load": None if model.held is None else model.held.oscillator}
        swings = oscillators.get(group)
        if group == "trace" and timed and model.sliding_speed is None:
            raise Refused("the run has no times; sliding.speed in its scenario would give them")
        if group not in columns or (group != "trace" and (swings is None or model.sliding_speed is None)):
            what = "slider" if group == "slider" else "load that weighs"
            raise Refused(f"the run has no {what} to draw; [{group}] in its scenario would give it one")
        if quantity.column not in columns[group]:
            words = quantity.column.replace("_", " ")
            raise Refused(f"the run has no {words} to draw; [strength] in its scenario would give it one")
        (first, last), step = stretch.rows(group), model.tick / ((timed and model.sliding_speed) or 1.0)
        if last - first < 2:
            ends = f"{stretch.start:g} to {stretch.stop:g} um"
            raise Refused(f"the slider passes {ends} in less than the {step:.3g} s between two rows of /{group}")
        return cls(
            stretch=stretch,
            quantity=quantity,
            group=group,
            first=first,
            last=last,
            step=step,
            timed=timed,
            swings=swings,
        )

    @property
    def model(self) -> Model:
        """The physics of the run."""
        return self.stretch.model

    @property
    def natural(self) -> float:
        """The natural frequency in Hz of what swings; for a contact one per mean life, in 1/um or Hz."""
        speed = self.model.sliding_speed if self.timed else None
        return (speed or 1.0) / self.model.mean_life_distance if self.swings is None else self.swings.natural_frequency

    @property
    def begin(self) -> float:
        """Place of the first row in um, or its time in s."""
        return self.step * self.first

    @property
    def end(self) -> float:
        """Place of the last row in um, or its time in s."""
        return self.step * (self.last - 1)

    def shown(self) -> Self:
        """Return what a curve shows: a stretch that the user chose, else some lives, periods or sticks."""
        if self.stretch.chosen:
            return self
        length = (LIVES if self.swings is None else PERIODS) / self.natural
        if self.group == "slider" and self.model.is_two_way:
            length = max(length, self._until_some_stuck())
        return self.between(self.begin, self.begin + length)

    def _until_some_stuck(self) -> float:
        """Return the time in s until some sticks are over; of fewer all, and 0 if nothing sticks."""
        file = self.stretch.file
        wanted, there = first_landmark(file, self.begin) + 2 * STICKS, file.rows("landmarks")
        if wanted >= there:
            return self.end - self.begin if there else 0.0
        return float(file.column("landmarks", "time", wanted, wanted + 1)[0]) - self.begin

    def between(self, begin: float, end: float) -> Self:
        """Return the rows between two places or times, up to the end of the run; raises Refused for fewer than two."""
        rows = self.stretch.file.rows(self.group)
        first = min(round(begin / self.step), rows)
        last = min(max(round(end / self.step) + 1, first + 2), rows)
        if last - first < 2:
            raise Refused(f"the run is over before {begin:g} {'s' if self.timed else 'um'}")
        return replace(self, first=first, last=last)

    def curve(self) -> tuple[Doubles, Doubles]:
        """Return places or times and values as on the axes; of many rows only the extremes of each few."""
        place, value = thinned(self.stretch.file, self.group, self.quantity.column, self.first, self.last)
        return self.step * place, self.quantity.scale * value

    def chunks(self) -> Iterator[NDArray[Any]]:
        """Yield the values as on the axis in arrays of some rows."""
        for chunk in column_chunks(self.stretch.file, self.group, self.quantity.column, self.first, self.last):
            yield self.quantity.scale * chunk

    def record(self) -> Doubles:
        """Return the values as on the axis, or their beginning if there are more than a picture needs."""
        last = min(self.last, self.first + MOST_READ)
        values = self.stretch.file.column(self.group, self.quantity.column, self.first, last)
        return self.quantity.scale * values.astype(np.float64)

    @property
    def has_theory(self) -> bool:
        """Whether theory may know the quantity: not for free motion, and of the contact alone with two-way coupling."""
        return self.stretch.has_theory and not (self.group == "slider" and self.model.is_two_way)

    def exact_moments(self) -> Moments | None:
        """Return the exact mean and standard deviation as on the axis, None if theory does not know them."""
        if not self.has_theory:
            return None
        mean, std = self.quantity.moments(self.model)
        return self.quantity.scale * mean, self.quantity.scale * std

    def landmarks(self) -> StickSlip | Flights | None:
        """Return sticks and slips, or flights and impacts; None for what does neither. Of very many the first."""
        file, ends = self.stretch.file, (self.begin, self.end)
        if self.timed and self.model.free is not None:
            return Flights.of(file, *ends, MOST_READ)
        return StickSlip.of(file, *ends, MOST_READ) if self.timed and self.model.is_two_way else None


def tracks_of(stretch: Stretch, beside: Stretch | None, name: str) -> list[Track]:
    """Return a quantity in a stretch, and in that of a run drawn over it; raises Refused for runs without it."""
    first = Track.of(stretch, name)
    if beside is None:
        return [first]
    with prefix_refusals(f"--with {beside.file.path}"):
        return [first, Track.of(beside, name)]


def at_the_same(tracks: Sequence[Track]) -> list[Track]:
    """Return the shown part of the first track, and the same times of the others.

    Raises Refused if one of them is over before the first begins.
    """
    first = tracks[0].shown()
    shown = [first]
    for other in tracks[1:]:
        with prefix_refusals(f"--with {other.stretch.file.path}"):
            shown.append(other.between(first.begin, first.end))
    return shown


def labels_of(tracks: Sequence[Track]) -> list[str]:
    """Return labels that distinguish runs: their coupling, or else the names of their files; one needs none."""
    if len(tracks) == 1:
        return ["simulated"]
    couplings = [f"{track.swings.coupling} coupling" for track in tracks if track.swings is not None]
    if len(set(couplings)) == len(tracks):
        return couplings
    return [shortened(one_line(track.stretch.file.path.name)) for track in tracks]


@contextmanager
def prefix_refusals(what: str) -> Iterator[None]:
    """Put a prefix in front of the message of a refusal."""
    try:
        yield
    except Refused as refusal:
        raise type(refusal)(f"{what}: {refusal}") from refusal
