"""Spectra and autocovariances of records that are uniform in time or distance, of runs and of measurements."""

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import pi
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from rubnoise.analysis.spectra import SEGMENTS, welch
from rubnoise.api.columns import SHORT, Column, Table, with_units
from rubnoise.arrays import number_in
from rubnoise.errors import Refused, advised, did_you_mean
from rubnoise.figures import Figure
from rubnoise.units import LENGTH, TIME

if TYPE_CHECKING:
    from rubnoise.api.run import Run

SI: Final[Mapping[str, tuple[str, float]]] = MappingProxyType(
    {"um": ("m", 1e-6), "um/s": ("m/s", 1e-6), "uN": ("N", 1e-6), "um^2": ("m^2", 1e-12), "MPa": ("Pa", 1e6)}
)
"""The units of spectra over frequency, and how many of them a working unit is."""


class PowerSpectrum(Table):
    """Welch's estimate of a power spectral density, with Hann windows that overlap by half: a table of columns.

    Of a record in time: one-sided, over ``frequency`` in Hz, in SI units such as (m/s)^2/Hz. Of a record along the
    sliding distance: two-sided, over ``wavenumber`` in rad/um, as `rubnoise.exact(...).spectral_density` has it.
    ``density`` and its ``standard_error`` are columns, and so is ``exact``, the exact density, if theory knows it.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     seen = run.psd("velocity")
    >>> seen.frequency.units, seen.density.units, round(float(seen.frequency[seen.density.argmax()]))
    ('Hz', '(m/s)^2/Hz', 39)
    """

    def __init__(self, name: str, columns: Sequence[Column], segments: int) -> None:
        """Take the columns, places first, and the number of segments that the estimate is a mean of."""
        super().__init__(name, columns)
        self.segments = segments

    @property
    def place(self) -> Column:
        """Frequencies or wavenumbers."""
        return self[self.names[0]]

    @property
    def exact(self) -> Column | None:
        """The exact density; None if theory does not know it."""
        return self["exact"] if "exact" in self else None  # noqa: SIM401  (get would promise more)

    def plot(self, name: str | None = None) -> "Figure":
        """Draw a column, or density and exact density on logarithmic axes without a name, and return the figure."""
        from rubnoise.api.pictures import drawn_columns

        if name:
            return super().plot(name)
        curves = {"estimated": self.density[1:]} | ({} if self.exact is None else {"exact": self.exact[1:]})
        shown = [(curves, f"spectral density of {self.name}\n({self.density.units})")]
        return drawn_columns((self.place[1:], self.place.label), shown, logarithmic=True)

    @property
    def _heading(self) -> str:
        sides = "one-sided" if "frequency" in self else "two-sided"
        return f"{sides} spectrum of {self.name} at {len(self):,} points, of {self.segments:,} segments"


class Autocovariance(Table):
    """The autocovariance of a record, a table over ``lag`` from 0 on: ``covariance``, and ``correlation`` to lag 0.

    >>> import rubnoise
    >>> measured = rubnoise.Trace.from_arrays({"time (s)": [0.0, 0.1, 0.2, 0.3], "force (N)": [1.0, 2.0, 1.0, 2.0]})
    >>> measured.acf(longest="0.1 s").correlation.values
    array([ 1.  , -0.75])
    """

    @property
    def _heading(self) -> str:
        return f"autocovariance of {self.name} at {len(self):,} lags"


def power_spectrum(column: Column, step: float, place_units: str, segment: Any = None) -> PowerSpectrum:
    """Return Welch's estimate of a column whose rows are a ``step`` apart.

    Over time G(f) = 2 S(2 pi f), one-sided, in SI; along the distance S(k), two-sided, in working units.
    """
    if segment is None:
        ticks = max(8, 2 * (column.size // (SEGMENTS + 1)))
    else:
        length = number_in(segment, "segment=", TIME if place_units == "s" else LENGTH, positive=True)
        ticks = 2 * (round(length / step) // 2)
    if not 8 <= ticks <= column.size:
        asked = f"a segment of {'8 rows at least' if segment is None else f'{ticks} rows'}"
        needed = "a spectrum needs segments of 8 rows or more"
        raise Refused(f"{column.name}: {asked}, in a record of {column.size:,}; {needed}")
    seen = welch(column.chunks(), ticks, step)
    if place_units == "s":
        shown, scale = SI.get(column.units, (column.units, 1.0))
        factor, per = 2.0 * scale**2, f"{_squared(shown)}/Hz"
        place = with_units(seen.wavenumber / (2.0 * pi), "frequency", "Hz")
    else:
        factor, per = 1.0, f"{_squared(column.units)} per rad/{place_units}"
        place = with_units(seen.wavenumber, "wavenumber", f"rad/{place_units}")
    found = {"density": seen.density, "standard_error": seen.standard_error}
    columns = [with_units(factor * values, name, per) for name, values in found.items()]
    return PowerSpectrum(column.name, [place, *columns], seen.segments)


def spectrum_of(run: "Run", quantity: str, segment: Any = None) -> PowerSpectrum:
    """Return the spectrum of a column of a run, with the exact one if theory knows it (see Run.psd)."""
    from rubnoise.figures.tracks import exact_spectrum

    groups, model = run.groups(), run.model()
    quantity = SHORT.get(quantity, quantity)
    of_slider = groups["slider"].names[2:] if "slider" in groups else ()
    known = dict.fromkeys([*groups["trace"].names[1:], *of_slider])
    if quantity not in known:
        hint = did_you_mean(str(quantity), [*known, *SHORT], quote="'")
        if quantity in ("load", "normal-velocity"):
            hint = f'run.plot("psd", of={quantity!r}) draws it'
        raise KeyError(advised(f"{quantity!r} has no spectrum here; there are {', '.join(known)}", hint))
    if timed := quantity in of_slider:
        seen = power_spectrum(groups["slider"][quantity], model.tick / (model.sliding_speed or 1.0), "s", segment)
    else:
        seen = power_spectrum(groups["trace"][quantity], model.tick, "um", segment)
    turn, factor = (2.0 * pi, 2.0 * 1e-12) if timed else (1.0, 1.0)
    columns = [*seen.values()]
    with suppress(Refused, KeyError):
        if not (timed and model.is_two_way):
            exact = factor * exact_spectrum(model, quantity, turn * seen.place.values, timed=timed)
            columns.append(with_units(exact, "exact", seen.density.units))
    return PowerSpectrum(quantity, columns, seen.segments)


def _squared(unit: str) -> str:
    if powered := re.fullmatch(r"([A-Za-z]+)\^(\d)", unit):
        return f"{powered[1]}^{2 * int(powered[2])}"
    return unit if unit == "1" else f"{unit}^2" if unit.isalpha() else f"({unit})^2"
