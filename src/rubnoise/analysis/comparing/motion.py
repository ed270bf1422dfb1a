"""Compare the slider's motion with theory: the exact one-way response; the balance and weak coupling two-way."""

from dataclasses import replace
from math import hypot, log, sqrt
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.balance import Balance, FrictionIntegral
from rubnoise.analysis.comparing.findings import Finding, Identity, judged, judged_mean, tail_of, too_short
from rubnoise.analysis.moments import first_stationary_tick, needed_for_mean
from rubnoise.analysis.reading import checked_chunks
from rubnoise.analysis.summary import FEWEST_DECAYS, slowest_decay
from rubnoise.arrays import Doubles
from rubnoise.errors import RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import Rows
from rubnoise.record.rows import LandmarkKind
from rubnoise.record.tally import Moments
from rubnoise.theory.coupling import weak_motion, weak_motion_errors
from rubnoise.theory.cumulants import force_cumulants
from rubnoise.theory.motion import Response, drive_of, response
from rubnoise.theory.sampling import mean_force_error, motion_errors
from rubnoise.theory.second_order import need_random_births

FORGOTTEN = 1e-3
"""Part of a spread that the start of a motion may leave."""


def motion_findings(model: Model, rows: Rows) -> list[Finding]:
    """Return mean and std of displacement and std of velocity; nothing without a slider.

    The record begins when the start has decayed to a thousandth of the spread and the contact is stationary.
    For a two-way slider the figures are known if coupling is weak. Raises Refused if theory has no motion for the
    model, or no errors.
    """
    if model.slider is None:
        return []
    need_random_births(model, "the standard error of a slider's motion")
    speed, exact = drive_of(model).speed, weak_motion(model) if model.is_two_way else response(model)
    if model.slider.damping == 0.0:
        return [LeftOut(name="displacement", reason="a slider without damping never forgets its start")]
    first = first_tick(model, exact)
    decays = FEWEST_DECAYS * slowest_decay(model.slider) * speed
    needed = first * model.tick + max(decays, needed_for_mean(model))
    if model.distance < needed:
        return [too_short("displacement", needed)]
    return _figures(model, exact, *_moments_from(rows, first * model.tick))


def first_tick(model: Model, exact: Response) -> int:
    """Return the first tick at which the contact is stationary and the slider's start has decayed."""
    return first_stationary_tick(model) + int(_forgetting(model, exact) * drive_of(model).speed / model.tick)


def _forgetting(model: Model, exact: Response) -> float:
    """Return the time in s in which the start decays to a thousandth of the spread."""
    if model.slider is None:
        return 0.0
    away = abs(exact.mean_displacement - model.equilibrium_displacement)
    if model.start == "empty":
        away = exact.mean_displacement
    spread = hypot(exact.displacement_std, exact.velocity_std / model.slider.natural_angular_frequency)
    return slowest_decay(model.slider) * log((1.0 + away / spread) / FORGOTTEN)


def _moments_from(rows: Rows, begin: float) -> tuple[Moments, Moments]:
    """Return the moments of displacement (um) and velocity (um/s) in the rows from a distance (um) on."""
    place, speed = Moments(powers=2), Moments(powers=2)
    for columns in checked_chunks(rows, "slider", ("distance", "displacement", "velocity")):
        forgotten = columns["distance"] >= begin
        place.add(columns["displacement"][forgotten])
        speed.add(columns["velocity"][forgotten])
    return place, speed


def _figures(model: Model, exact: Response, place: Moments, speed: Moments) -> list[Finding]:
    length = place.count * model.tick
    stretch = replace(model, start="stationary", distance=length)
    errors = (weak_motion_errors if model.is_two_way else motion_errors)(stretch, length)
    # A junction pushes with psi d^3, and leaves the energy of as much motion.
    push, energy = tail_of(model, length, 3, 1), tail_of(model, length, 6, 2)
    return [
        judged_mean(
            "displacement_mean",
            place.mean,
            exact.mean_displacement,
            errors.mean_displacement,
            length=length,
            tail=push,
        ),
        judged(
            "displacement_std", place.std, exact.displacement_std, errors.displacement_std, length=length, tail=energy
        ),
        judged("velocity_std", speed.std, exact.velocity_std, errors.velocity_std, length=length, tail=energy),
    ]


FIELD: Final = 1e-11
"""Relative: when a slider hardly moves, the force is a polynomial of a cell's eight nodes."""

_ROUNDING: Final = 2.0**-49
_STEPS: Final = 100.0  # in a diameter, about


class Path:
    """The path of a two-way run from its rows: turns and sticks, and int G ds between them."""

    def __init__(self, model: Model, rows: Rows) -> None:
        """Read /balance and /landmarks; raises RunFileRefused for rows that no motion can have."""
        row = {name: rows.column("balance", name) for name in rows.columns["balance"]}
        if any(each.size != 1 or not np.isfinite(each).all() for each in row.values()) or row["time"][0] <= 0.0:
            raise RunFileRefused("/balance is damaged: it has one row of finite numbers, and a time above 0")
        self.balance = Balance.of(model, {name: float(each[0]) for name, each in row.items()})
        self.sticks, self.time_stuck = 0, 0.0
        turns = [self._count_sticks(columns) for columns in _landmark_pairs(rows)]
        self.turns: Doubles = np.concatenate([np.empty((2, 0)), *turns], axis=1)
        self._work = FrictionIntegral(model.pulse, np.maximum([self.balance.distance, *self.turns.ravel()], 0.0))

    def add(self, columns: dict[str, NDArray[Any]]) -> None:
        """Add a chunk of /junctions."""
        self._work.add(columns)

    @property
    def friction_along(self) -> float:
        """Signed int G ds in uN um from the start to the end."""
        return float(self._work.at_places()[0])

    @property
    def reverse_work(self) -> float | None:
        """Int G |ds| in uN um over reversals; None if one goes back behind the start, before the first rows."""
        if (self.turns < -_ROUNDING * self.balance.distance).any():
            return None
        begin, end = self._work.at_places()[1:].reshape(2, -1)
        return float((begin - end).sum())

    def _count_sticks(self, columns: dict[str, NDArray[Any]]) -> Doubles:
        """Count sticks among landmarks, each with the one after it, and return begins and ends of reversals in um."""
        kind, time, distance = columns["kind"][:-1], columns["time"], columns["distance"]
        stuck = np.diff(time)[kind == LandmarkKind.STICK]
        self.sticks += stuck.size
        self.time_stuck += float(stuck.sum())
        back = np.flatnonzero(kind == LandmarkKind.REVERSAL)
        return np.array([distance[back], distance[back + 1]])


def two_way_identities(model: Model, path: Path) -> list[Finding]:
    """Return the identities of every correct two-way run, which hold up to rounding and the tolerance of its steps.

    The travelled distance is V t - (x - x_0); sticks last as long as /landmarks says; friction does the work of the
    lives in /junctions over the path; energy is balanced, so the mean force is int G ds/(V T) plus its excess. The
    allowed deviation is ``slider.tolerance`` of the largest work, plus the rounding of sums over some 100 steps a
    diameter.
    """
    seen = path.balance
    rounding = _ROUNDING * sqrt(max(_STEPS * model.distance / model.calibrated_diameter, 1.0))
    step = seen.slider.tolerance + rounding
    field = max(step, FIELD)
    travelled = seen.speed * seen.time - (seen.displacement - seen.start)
    away = max(abs(travelled - seen.distance), abs(model.distance - seen.distance))
    size = seen.speed * seen.time + abs(seen.displacement) + abs(seen.start)
    over = seen.speed * seen.time
    force = seen.excess_over(path.friction_along) - seen.expected_excess()
    found: list[Finding] = [
        Identity(name="sliding_distance", deviation=away, allowed=rounding * size, units="um"),
        Identity(
            name="time_stuck",
            deviation=abs(seen.time_stuck - path.time_stuck),
            allowed=_ROUNDING * (path.sticks + 1) * seen.time,
            units="s",
        ),
        _work("friction_work", seen.friction_along - path.friction_along, field * seen.scale),
        _work("energy", seen.energy_residual * seen.scale, step * seen.scale),
        Identity(name="mean_force_law", deviation=abs(force), allowed=(step + field) * seen.scale / over, units="uN"),
    ]
    if path.reverse_work is None:
        return [
            *found,
            LeftOut(name="reverse_work", reason="a reversal ends behind the start, where there are no rows"),
        ]
    return [*found, _work("reverse_work", seen.reverse_work - path.reverse_work, field * seen.scale)]


def mean_force_findings(model: Model, path: Path) -> list[Finding]:
    """Return the mean force over time beside its law, int G ds being what Campbell's theorem expects of it.

    <F> = (E[F] s + c int x'^2 dt + 2 int_(w < 0) G |ds| + [E])/(V T); int G ds has the standard error s sqrt(S_F(0)/s),
    exact for every length. Raises Refused unless births are random.
    """
    if model.start != "stationary":
        return []
    need_random_births(model, "the standard error of a mean force")
    needed, seen = needed_for_mean(model), path.balance
    if model.distance < needed:
        return [too_short("mean_force", needed)]
    share = seen.distance / (seen.speed * seen.time)
    expected = force_cumulants(model).mean * share + seen.expected_excess()
    error, tail = mean_force_error(model, model.distance) * share, tail_of(model, model.distance, 3, 1)
    return [judged_mean("mean_force", seen.mean_force, expected, error, length=model.distance, tail=tail)]


def _work(name: str, missing: float, allowed: float) -> Identity:
    return Identity(name=name, deviation=abs(missing), allowed=allowed, units="uN um")


def _landmark_pairs(rows: Rows) -> Any:
    """Yield kind, time (s) and distance (um) of landmarks, chunk by chunk, each chunk with the first of the next."""
    before: dict[str, NDArray[Any]] | None = None
    for columns in checked_chunks(rows, "landmarks", ("kind", "time", "distance")):
        if before is not None:
            yield {name: np.concatenate([before[name], columns[name][:1]]) for name in columns}
        before = columns
    if before is not None:
        yield before
