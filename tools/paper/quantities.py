"""The quantities that claims are made of, by name: as measured in one run, and as theory has them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import inf, nan, pi
from typing import Any, Final, NamedTuple

import numpy as np
from scipy.stats import skew, variation

from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles
from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.distributions import Fixed
from rubnoise.inference.signal import autocovariance as sample_autocovariance
from rubnoise.model import Model
from rubnoise.record.rows import ContactKind, Reader
from rubnoise.theory.exact import exact
from rubnoise.theory.moments import area_cumulants, force_cumulants
from rubnoise.theory.motion import response
from rubnoise.theory.second_order import autocovariance, spectral_density

LATE: Final = 0.2
"""The share of a run in which its start is forgotten, for columns that are named late."""

COLUMNS: Final = {
    "area": ("trace", "real_contact_area", 0.0),
    "count": ("trace", "junction_count", 0.0),
    "force": ("trace", "friction_force", 0.0),
    "displacement": ("slider", "displacement", 0.0),
    "velocity": ("slider", "velocity", 0.0),
    "late_count": ("trace", "junction_count", LATE),
    "late_velocity": ("slider", "velocity", LATE),
    "late_load": ("load", "load", LATE),
    "late_separation": ("load", "separation", LATE),
    "late_normal_velocity": ("load", "velocity", LATE),
}
"""The columns that quantities read: group, name, and the share of the run that is left out before it."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run in memory, with the spectra that bands ask it for."""

    model: Model
    record: Reader
    spectra: dict[tuple[str, int], tuple[Doubles, Doubles]] = field(default_factory=dict)

    def __getitem__(self, column: str) -> Doubles:
        group, name, start = COLUMNS[column]
        values: Doubles = self.record.column(group, name)
        return values[int(start * values.size) :]

    def spectrum(self, column: str, ticks: int) -> tuple[Doubles, Doubles]:
        """Return wavenumbers and Welch's estimate of S of a column, in segments of so many ticks."""
        if (column, ticks) not in self.spectra:
            found = welch([self[column]], ticks, self.model.tick)
            self.spectra[column, ticks] = found.wavenumber, found.density
        return self.spectra[column, ticks]


class Quantity(NamedTuple):
    """A quantity of a run and of its model.

    Theory has none where ``exact`` is left out; one that is not ``measured`` is a number of the model alone.
    """

    measured: Callable[[Run], float] | None
    exact: Callable[[Model], float] = lambda _model: nan


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """The mean power of a column in a band of wavenumbers, two-sided, estimated from segments of some length.

    ``segment`` is in um and ``low`` and ``high`` in rad/um, or, ``in_lives``, in mean lives and rad a mean life.
    """

    column: str
    segment: float
    low: float
    high: float
    in_lives: bool = False

    def quantity(self) -> Quantity:
        """Return the power as a quantity."""
        return Quantity(self._measured, self._exact)

    def _unit(self, model: Model) -> float:
        return model.mean_life_distance if self.in_lives else 1.0

    def _ticks(self, model: Model) -> int:
        return round(self.segment * self._unit(model) / model.tick)

    def _inside(self, model: Model, wavenumber: Doubles) -> "np.ndarray[Any, np.dtype[np.bool_]]":
        place = wavenumber * self._unit(model)
        return (place >= self.low) & (place <= self.high)

    def _measured(self, run: Run) -> float:
        wavenumber, density = run.spectrum(self.column, self._ticks(run.model))
        return float(density[self._inside(run.model, wavenumber)].mean())

    def _exact(self, model: Model) -> float:
        """Return the mean of the exact density at the wavenumbers of the estimate."""
        step = 2.0 * pi / (self._ticks(model) * model.tick)
        wavenumber = step * np.arange(1.0, np.ceil(self.high / self._unit(model) / step) + 1.0)
        inside = wavenumber[self._inside(model, wavenumber)]
        gain = 1.0 if self.column == "area" else _velocity_over_area(model, inside)
        return float((gain * spectral_density(model, inside)).mean())


def _velocity_over_area(model: Model, wavenumber: Doubles) -> Doubles:
    """Return the squared gain from the area to the velocity of a one-way slider, over the squared strength."""
    slider, speed = model.slider, model.sliding_speed
    if slider is None or speed is None:
        raise ValueError("the model has no slider that moves in time")
    omega = speed * wavenumber
    return omega**2 / ((slider.stiffness - slider.mass * omega**2) ** 2 + (slider.damping * omega) ** 2)


def _life_mean(run: Run) -> float:
    """Return the mean area over a life, over d^2; lives cut off at the start and at the end balance each other."""
    return float(run["area"].sum() * run.model.tick / (2.0 * _newborn(run) ** 3).sum())


def _newborn(run: Run) -> Doubles:
    diameter, birth = (run.record.column("junctions", name) for name in ("diameter", "birth_distance"))
    diameters: Doubles = diameter[birth >= 0.0]
    return diameters


def _present(run: Run) -> float:
    """Return the mean area of the junctions present, over the mean area of a junction during its life."""
    alive = run["count"] > 0
    over_lives = float(run.model.pulse.life_mean()) * np.square(_newborn(run)).mean()
    return float((run["area"][alive] / run["count"][alive]).mean() / over_lives)


def _exact_present(model: Model) -> float:
    moment = model.sizes.moment
    return moment(3) / (moment(1) * moment(2))


def _exact_relative_std(model: Model) -> float:
    area = area_cumulants(model)
    return area.std / area.mean


def _half_width(run: Run) -> float:
    """Return the lag in um at which the autocovariance of the area has fallen to a half."""
    found = sample_autocovariance(run["area"], round(run.model.mean_life_distance / run.model.tick))
    after = int(np.flatnonzero(found < 0.5 * found[0])[0])
    above, below = float(found[after - 1]), float(found[after])
    return run.model.tick * (after - 1 + (above - 0.5 * float(found[0])) / (above - below))


def _exact_half_width(model: Model) -> float:
    """Return the same for junctions that are born at random."""
    from scipy.optimize import brentq

    at_random = replace(model, births=PoissonBirths(mean_spacing=model.mean_birth_spacing))
    half = 0.5 * float(autocovariance(at_random, 0.0))
    ends = 0.0, 2.0 * model.mean_life_distance
    return float(brentq(lambda lag: float(autocovariance(at_random, lag)) - half, *ends, xtol=1e-9))


def _over_zero(model: Model, phase: float) -> float:
    """Return S over S(0) at the k for which k L_jm is ``phase``."""
    return float(spectral_density(model, phase / model.mean_life_distance)) / float(spectral_density(model, 0.0))


def _half_phase(model: Model) -> float:
    """Return k L_jm at which S is half of S(0)."""
    from scipy.optimize import brentq

    return float(brentq(lambda phase: _over_zero(model, phase) - 0.5, 1.0, 2.0 * pi))


def _of_one_size(model: Model) -> float:
    return area_cumulants(replace(model, sizes=Fixed(value=model.calibrated_diameter))).std


def _impacts(run: Run) -> Doubles:
    """Return the speeds of the impacts after the start."""
    place, speed, kind = (run.record.column("landmarks", name) for name in ("distance", "impact_speed", "kind"))
    late = place > int(LATE * run.model.tick_count) * run.model.tick
    speeds: Doubles = speed[(kind == ContactKind.CONTACT_MADE) & late]
    return speeds


def _shocks(run: Run) -> float:
    """Return the number of impacts a second."""
    return _impacts(run).size / ((1.0 - LATE) * run.model.distance / (run.model.sliding_speed or nan))


def _light_peaks(run: Run) -> float:
    """Return the share of the touches whose largest load is below ten weights."""
    touching, weight = run["late_count"] > 0, run.model.free.held.load if run.model.free else nan
    begun = np.flatnonzero(~touching[:-1] & touching[1:]) + 1
    peaks = np.maximum.reduceat(run["late_load"], begun)[:-1] if begun.size > 1 else np.array([inf])
    return float((peaks < 10.0 * weight).mean())


def _one_way(model: Model, name: str) -> float:
    return nan if model.is_two_way else float(getattr(response(model), name))


def _mean(column: str) -> Callable[[Run], float]:
    return lambda run: float(run[column].mean())


def _std(column: str) -> Callable[[Run], float]:
    return lambda run: float(run[column].std())


QUANTITIES: Final[Mapping[str, Quantity]] = {
    "life_mean": Quantity(_life_mean, lambda model: float(model.pulse.life_mean())),
    "present": Quantity(_present, _exact_present),
    "area_mean": Quantity(_mean("area"), lambda model: exact(model).area.mean),
    "area_std": Quantity(_std("area"), lambda model: area_cumulants(model).std),
    "area_relative_std": Quantity(lambda run: float(variation(run["area"])), _exact_relative_std),
    "area_relative_variance": Quantity(
        lambda run: float(variation(run["area"])) ** 2, lambda model: _exact_relative_std(model) ** 2
    ),
    "area_skewness": Quantity(lambda run: float(skew(run["area"])), lambda model: area_cumulants(model).skewness),
    "area_half_width": Quantity(_half_width, _exact_half_width),
    "count_mean": Quantity(_mean("count"), lambda model: exact(model).count_mean),
    "count_variance": Quantity(lambda run: float(run["count"].var()), lambda model: exact(model).count_variance),
    "force_std": Quantity(_std("force"), lambda model: force_cumulants(model).std),
    "displacement_std": Quantity(_std("displacement"), lambda model: _one_way(model, "displacement_std")),
    "velocity_std": Quantity(_std("velocity"), lambda model: _one_way(model, "velocity_std")),
    "frequency": Quantity(
        lambda run: float(run["velocity"].std() / run["displacement"].std()),
        lambda model: _one_way(model, "velocity_std") / _one_way(model, "displacement_std"),
    ),
    "normal_velocity_std": Quantity(_std("late_normal_velocity")),
    "separation_std": Quantity(_std("late_separation")),
    "apart": Quantity(lambda run: float((run["late_count"] == 0).mean())),
    "shocks": Quantity(_shocks),
    "impact_speed": Quantity(lambda run: float(_impacts(run).mean())),
    "light_peaks": Quantity(_light_peaks),
    "diameter": Quantity(None, lambda model: model.calibrated_diameter),
    "variance_and_life": Quantity(None, lambda model: area_cumulants(model).variance * model.mean_life_distance),
    "area_std_of_one_size": Quantity(None, _of_one_size),
    "density_at_zero": Quantity(None, lambda model: float(spectral_density(model, 0.0))),
    "relative_density_at_zero": Quantity(
        None, lambda model: float(spectral_density(model, 0.0)) / area_cumulants(model).mean ** 2
    ),
    "density_at_one": Quantity(None, lambda model: _over_zero(model, 1.0)),
    "half_phase": Quantity(None, _half_phase),
}
"""Every quantity by name; a ledger adds its bands."""
