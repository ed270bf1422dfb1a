"""All exact results for one model, in one frozen object."""

from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from math import sqrt

from numpy.typing import ArrayLike

from rubnoise.arrays import Doubles, at_each
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.tables import as_html, fields_as_text, in_short
from rubnoise.theory import moments
from rubnoise.theory.coupling import Coupling, FreeLimits, LoadMotion, coupling, free_motion, load_motion
from rubnoise.theory.motion import Response, response
from rubnoise.theory.sampling import EstimatedSpectrum, estimated_spectrum
from rubnoise.theory.second_order import area_noise, autocovariance, count_noise, spectral_density


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Exact:
    """Exact stationary results: area in um^2, force in uN (None without a strength), slider (None without one).

    ``load`` is the motion under a load that weighs, of first order; ``free`` are the results of free motion, all others
    then those of constant separation.

    >>> import rubnoise
    >>> theory = rubnoise.exact(rubnoise.load("scenarios/paper/fig5.toml"))
    >>> round(theory.area.mean, 4), round(theory.area.std, 4)
    (204.6736, 56.4294)
    >>> abs(round(float(theory.autocovariance(20.0)) / theory.area.variance, 4))
    0.0
    """

    model: Model = field(repr=False)
    area: moments.Cumulants
    count_mean: float
    count_variance: float
    mean_diameter: float
    length_biased_mean_diameter: float
    expected_births: float
    expected_junction_rows: float
    force: moments.Cumulants | None
    slider: Response | None
    load: LoadMotion | None = None
    free: FreeLimits | None = None

    __repr__ = fields_as_text

    def _repr_html_(self) -> str:
        known = ((name, getattr(self, name)) for name in self.__slots__ if name != "model")
        rows = [(name, in_short(value)) for name, value in known if value is not None]
        return as_html("exact results", ("", "value"), rows)

    @property
    def count_std(self) -> float:
        """Standard deviation of the number of live junctions."""
        return sqrt(self.count_variance)

    def spectral_density(self, wavenumber: ArrayLike) -> Doubles:
        """Return the two-sided S(k) of the area in um^4 per rad/um at wavenumbers in rad/um, of any shape."""
        return at_each(partial(spectral_density, self.model), wavenumber, "wavenumber", "rad/um", (0.0, 0.0))

    psd = spectral_density  # the same under the word of other programs

    def autocovariance(self, lag: ArrayLike) -> Doubles:
        """Return R(tau) of the area in um^4 at lags in um, of any shape; Refused at inf if lines swing for ever."""
        swings = area_noise(self.model).lines[1].size > 0
        return at_each(partial(autocovariance, self.model), lag, "lag", "um", None if swings else (0.0, 0.0))

    def distribution(self) -> moments.Distribution:
        """Return the distribution of the area; raises Refused for births that are not Poisson."""
        return moments.distribution(self.model)

    def estimated_spectrum(self, ticks: int | None = None) -> EstimatedSpectrum:
        """Return the expectation of Welch's method for a run, and its standard error; see `estimated_spectrum`."""
        return estimated_spectrum(self.model, ticks)

    def area_from_empty(self, distance: ArrayLike) -> Doubles:
        """Return the mean area in um^2 at distances in um after an empty start, of any shape."""
        return at_each(area_noise(self.model).from_empty, distance, "distance", "um", (0.0, self.area.mean))

    def count_from_empty(self, distance: ArrayLike) -> Doubles:
        """Return the mean number of live junctions at distances in um after an empty start, of any shape."""
        return at_each(count_noise(self.model).from_empty, distance, "distance", "um", (0.0, self.count_mean))

    def expected_mean_area(self, distance: float | None = None) -> float:
        """Return the expected mean of the area in um^2 over a run from its own start, or its first ``distance`` um."""
        return area_noise(self.model).expected_mean(distance)

    def expected_mean_count(self, distance: float | None = None) -> float:
        """Return the expected mean of the live count over a run from its own start, or its first ``distance`` um."""
        return count_noise(self.model).expected_mean(distance)

    def coupling(self) -> Coupling:
        """Return how strongly the slider acts back on the contact; raises Refused without slider, strength or speed."""
        return coupling(self.model)


def exact(model: Model) -> Exact:
    """Return the exact results for a model: cumulants of area and force, the live count, the one-way response."""
    slider = None
    if model.free is None:
        with suppress(Refused):  # what else than friction or a base of equal triangles moves is not known
            slider = response(model)
    return Exact(
        model=model,
        area=moments.area_cumulants(model),
        count_mean=model.mean_live_junctions,
        count_variance=moments.count_variance(model),
        mean_diameter=model.sizes.moment(1),
        length_biased_mean_diameter=model.sizes.moment(2) / model.sizes.moment(1),
        expected_births=model.birth_rate * model.distance,
        expected_junction_rows=moments.expected_junction_rows(model),
        force=None if model.strengths is None else moments.force_cumulants(model),
        load=None if model.separation is None else load_motion(model),
        free=None if model.free is None else free_motion(model),
        slider=slider,
    )
