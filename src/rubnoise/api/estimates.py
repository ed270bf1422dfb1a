"""Spectra and autocovariances of records that are uniform in time or distance, of runs and of measurements."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from math import pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rubnoise.analysis.spectra import SEGMENTS, WelchSum, force_spectrum
from rubnoise.api.column_group import SHORT
from rubnoise.api.columns import Column, Table, with_units
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.real_numbers import number_in
from rubnoise.units import LENGTH, TIME

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rubnoise.api.run import Run

SI: Final[Mapping[str, tuple[str, float]]] = MappingProxyType(
    {"um": ("m", 1e-6), "um/s": ("m/s", 1e-6), "uN": ("N", 1e-6), "um^2": ("m^2", 1e-12), "MPa": ("Pa", 1e6)}
)
"""The units of spectra over frequency, and how many of them a working unit is."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PowerSpectrum(Table):
    """Welch's estimate of a power spectral density, with Hann windows that overlap by half.

    Of a record in time: one-sided, over ``frequency`` in Hz, in SI units such as (m/s)^2/Hz. Of a record along the
    sliding distance: two-sided, over ``wavenumber`` in rad/um, as `rubnoise.exact(...).spectral_density` has it.
    ``exact`` is the exact density there if theory knows it, else None.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     seen = run.psd("velocity")
    >>> seen.units, seen.place_units, bool(seen.density[np.argmin(abs(seen.frequency - 39.0))] > seen.density[-1])
    ('(m/s)^2/Hz', 'Hz', True)
    """

    name: str
    place: Doubles
    place_units: str
    density: Doubles
    units: str
    standard_error: Doubles
    segments: int
    exact: Doubles | None = None

    @property
    def frequency(self) -> Doubles:
        """Frequencies in Hz; raises Refused for a record along the distance, which has wavenumbers."""
        return self._places("frequency")

    @property
    def wavenumber(self) -> Doubles:
        """Wavenumbers in rad/um; raises Refused for a record in time, which has frequencies."""
        return self._places("wavenumber")

    def _places(self, name: str) -> Doubles:
        if self.names[0] != name:
            raise Refused(f"this spectrum is over {self.place_units}: it has .{self.names[0]}")
        return self.place

    @property
    def names(self) -> tuple[str, ...]:
        """Place, density, standard error and, if theory knows it, the exact density."""
        place = "frequency" if self.place_units == "Hz" else "wavenumber"
        return (place, "density", "standard_error", *(["exact"] if self.exact is not None else []))

    def _described(self, name: str) -> Column:
        if name not in self.names:
            raise KeyError(f"this spectrum has {', '.join(self.names)}, not {name!r}")
        units = self.place_units if name == self.names[0] else self.units
        return with_units(getattr(self, name), name, units)

    def plot(self, name: str | None = None) -> "Figure":
        """Draw a column, or density and exact density on logarithmic axes without a name, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        curves = {"estimated": self.density[1:]} | ({} if self.exact is None else {"exact": self.exact[1:]})
        along = self.place[1:], f"{self.names[0]} ({self.place_units})"
        shown = [(curves, f"spectral density of {self.name}\n({self.units})")]
        return Table.plot(self, name) if name else drawn_columns(along, shown, logarithmic=True)

    @property
    def _heading(self) -> str:
        sides = "one-sided" if self.place_units == "Hz" else "two-sided"
        return f"{sides} spectrum of {self.name} at {self.place.size:,} points, of {self.segments:,} segments"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Autocovariance(Table):
    """The autocovariance of a record at lags from 0 on: ``covariance`` in ``units``, ``lag`` in ``lag_units``.

    >>> import rubnoise
    >>> measured = rubnoise.Trace.from_arrays({"time (s)": [0.0, 0.1, 0.2, 0.3], "force (N)": [1.0, 2.0, 1.0, 2.0]})
    >>> measured.acf(longest="0.1 s").correlation
    array([ 1.  , -0.75])
    """

    name: str
    lag: Doubles
    lag_units: str
    covariance: Doubles
    units: str

    @property
    def correlation(self) -> Doubles:
        """The covariance over its value at lag 0, which is the variance."""
        return self.covariance / self.covariance[0]

    @property
    def names(self) -> tuple[str, ...]:
        """Lag, covariance and correlation."""
        return "lag", "covariance", "correlation"

    def _described(self, name: str) -> Column:
        units = {"lag": self.lag_units, "covariance": self.units, "correlation": "1"}
        return with_units(getattr(self, name), name, units[name])

    @property
    def _heading(self) -> str:
        return f"autocovariance of {self.name} at {self.lag.size:,} lags"


def power_spectrum(
    name: str,
    units: str,
    chunks: Iterable[Doubles],
    *,
    rows: int,
    step: float,
    place_units: str,
    segment: Any = None,
) -> PowerSpectrum:
    """Return Welch's estimate from chunks of a column of ``rows`` rows, which are ``step`` apart.

    Over time G(f) = 2 S(2 pi f), one-sided, in SI; along the distance S(k), two-sided, in working units.
    """
    ticks = 2 * (rows // (SEGMENTS + 1)) if segment is None else round(_length(segment, place_units) / step)
    ticks = max(8, 2 * (ticks // 2)) if segment is None else 2 * (ticks // 2)
    if not 8 <= ticks <= rows:
        length = f"{ticks} rows" if segment is not None else "8 rows at least"
        raise Refused(
            f"{name}: a segment of {length}, in a record of {rows:,}; a spectrum needs segments of 8 rows or more"
        )
    total = WelchSum(ticks, step)
    for chunk in chunks:
        total.add(np.asarray(chunk, dtype=np.float64))
    seen = total.spectrum()
    if place_units == "s":
        shown, scale = SI.get(units, (units, 1.0))
        factor = 2.0 * scale**2
        place, over, per = seen.wavenumber / (2.0 * pi), "Hz", f"{_squared(shown)}/Hz"
    else:
        factor, place, over = 1.0, seen.wavenumber, f"rad/{place_units}"
        per = f"{_squared(units)} per {over}"
    return PowerSpectrum(
        name=name,
        place=place,
        place_units=over,
        density=factor * seen.density,
        units=per,
        standard_error=factor * seen.standard_error,
        segments=seen.segments,
    )


def _length(segment: Any, place_units: str) -> float:
    length = number_in(segment, "segment=", TIME if place_units == "s" else LENGTH)
    if not length > 0.0:
        raise Refused(f"segment=: {length:g} is no length; a number is in {place_units}, above 0 and finite")
    return length


def spectrum_of(run: "Run", quantity: str, segment: Any = None) -> PowerSpectrum:
    """Return the spectrum of a column of a run, with the exact one if theory knows it (see Run.psd)."""
    groups, model = run.groups(), run.model()
    quantity = SHORT.get(quantity, quantity)
    slider = "slider" in groups and quantity in groups["slider"] and quantity not in ("time", "distance")
    group = groups["slider" if slider else "trace"]
    if quantity == "distance" or quantity not in group:
        known = dict.fromkeys([*groups["trace"].names[1:], *(groups["slider"].names[2:] if "slider" in groups else ())])
        near = get_close_matches(str(quantity), [*known, *SHORT], n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        if quantity in ("load", "normal-velocity"):
            hint = f'; run.plot("psd", of={quantity!r}) draws it'
        raise KeyError(f"{quantity!r} has no spectrum here; there are {', '.join(known)}{hint}")
    column, step = group[quantity], model.tick
    if slider and model.sliding_speed is not None:
        step = model.tick / model.sliding_speed
    seen = power_spectrum(
        quantity,
        column.units,
        column.chunks(),
        rows=len(column),
        step=step,
        place_units="s" if slider else "um",
        segment=segment,
    )
    return replace(seen, exact=_exact_density(model, quantity, seen))


def _exact_density(model: Model, quantity: str, seen: PowerSpectrum) -> Doubles | None:
    """Return the exact density at the places of a spectrum; None if theory has none."""
    from rubnoise.theory.motion import FORCE, density_of, motion_spectrum
    from rubnoise.theory.second_order import spectral_density

    try:
        if seen.place_units == "rad/um":
            if quantity == "real_contact_area":
                return spectral_density(model, seen.place)
            if quantity == FORCE and model.strengths is not None:
                return density_of(model, FORCE, seen.place)
            return None
        if model.is_two_way:
            return None
        angular = 2.0 * pi * seen.place
        found = force_spectrum(model, angular) if quantity == FORCE else motion_spectrum(quantity, model, angular)
    except (Refused, KeyError):
        return None
    return 2.0 * 1e-12 * found


def _squared(unit: str) -> str:
    if unit == "1":
        return "1"
    powered = re.fullmatch(r"([A-Za-z]+)\^(\d)", unit)
    if powered:
        return f"{powered[1]}^{2 * int(powered[2])}"
    return f"{unit}^2" if unit.isalpha() else f"({unit})^2"
