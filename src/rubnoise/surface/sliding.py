"""Two surfaces under a load: exact theory and counted patches side by side, and the scenario of their noise."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, isfinite, log10, pi, sqrt
from typing import Any, Final

import numpy as np
from scipy import ndimage

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused, ScenarioRefused
from rubnoise.scenario import Scenario, loads
from rubnoise.scenario.scenario import RAYLEIGH
from rubnoise.scenario.writing import text_of
from rubnoise.surface.gaussian import GaussianContact, half_width
from rubnoise.surface.height_map import HeightMap
from rubnoise.surface.normal_motion import NormalMotion, gap_slope, normal_motion
from rubnoise.surface.waves import Waves, band_limited, check_wavelengths
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.load import load_motion, overlap_scale
from rubnoise.theory.second_order import autocovariance

LIVES: Final = 1000
"""Mean lives in the scenario's distance, if none is given."""

NEAR: Final = 0.1
"""How far a scenario may be off in spread and correlation length before it is said."""

NEAR_LEVEL: Final = 1.0
"""How far its level of normal motion may be off, in dB."""

_STEPS: Final = 2.0**0.5


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Patches of contact on a map, by their areas in um^2 from the largest on, of so large a map."""

    areas: Doubles = field(repr=False)
    map_area: float

    @property
    def patch_count(self) -> int:
        """Number of patches."""
        return int(self.areas.size)

    @property
    def real_contact_area(self) -> float:
        """Their sum in um^2."""
        return float(self.areas.sum())

    @property
    def largest_share(self) -> float:
        """The area of the largest patch over that of all."""
        return float(self.areas[0]) / self.real_contact_area

    @property
    def mean_diameter(self) -> float:
        """The mean of sqrt(4 A/pi) in um."""
        return float(np.sqrt(self.areas * (4.0 / pi)).mean())

    @property
    def relative_spread(self) -> float:
        """Standard deviation of the areas over their mean; that of exponential areas is 1."""
        return float(self.areas.std() / self.areas.mean())


def patches(heights: Doubles, share: float, spacing: tuple[float, float]) -> Patches:
    """Return the patches of a map above the height that the given share of its points exceeds, spacings in um."""
    count = max(1, round(share * heights.size))
    threshold = np.partition(heights, heights.size - count, axis=None)[heights.size - count]
    labels, _ = ndimage.label(heights >= threshold, _TOUCHING)
    points = np.sort(np.bincount(labels.ravel())[1:])[::-1].astype(np.float64)
    return Patches(points * (spacing[0] * spacing[1]), heights.size * spacing[0] * spacing[1])


@dataclass(frozen=True, eq=False)
class SlidingContact:
    """A slider on a track under a load: ``track`` and ``slider`` are maps without form, their waves cut.

    ``load`` in uN, ``hardness`` in MPa, ``cutoff``, ``longest`` and ``slider_length`` in um. ``gaussian`` is exact for
    Gaussian surfaces with the measured spectra, ``counted`` the patches on the maps, ``refused`` the reasons why
    numbers must not be used.
    """

    track: HeightMap
    slider: HeightMap
    load: float
    hardness: float
    cutoff: float
    longest: float | None
    slider_length: float
    scans: tuple[HeightMap, HeightMap] = field(repr=False)
    """Track and slider with all their waves."""

    @property
    def nominal_area(self) -> float:
        """A0 in um^2: the slider's length times its width."""
        return self.slider_length * self.slider.size[1]

    @property
    def share(self) -> float:
        """A_rm/A0 = W/(H A0): the share of the nominal area in contact."""
        return self.load / (self.hardness * self.nominal_area)

    @cached_property
    def gaussian(self) -> GaussianContact:
        """Exact theory from the two spectra."""
        waves = (Waves.of(self.track), Waves.of(self.slider))
        return GaussianContact(*waves, self.share, self.nominal_area, self.slider_length)

    @cached_property
    def counted(self) -> Patches:
        """Patches of one map pressed against the other at the same share of their area, if both are large enough."""
        laid = self.track.on_grid_of(self.slider)
        slider = self.slider.heights[: laid.shape[0], : laid.shape[1]]
        return patches(laid + slider, self.share, self.slider.spacing)

    @property
    def honesty(self) -> float:
        """Patches counted over those that theory expects on the same area: 1 for Gaussian surfaces."""
        expected = self.gaussian.junction_count * self.counted.map_area / self.nominal_area
        return self.counted.patch_count / expected

    @cached_property
    def refused(self) -> tuple[str, ...]:
        """The reasons why these numbers must not be used, each with a remedy; empty if there are none."""
        return tuple(self._reasons())

    def _reasons(self) -> Iterator[str]:
        if self.share > LARGEST_AREA:
            yield (
                f"{100.0 * self.share:.3g} % of the nominal area is in contact, more than {100.0 * LARGEST_AREA:g} %,"
                " and lives merge there: lower the load, or give a larger hardness"
            )
        if self.counted.patch_count < FEWEST_PATCHES:
            yield (
                f"{self.counted.patch_count} patches are in contact, fewer than {FEWEST_PATCHES}: take a larger scan, a"
                " shorter cut-off, or a larger load"
            )
        if self.counted.largest_share > LARGEST_SHARE:
            yield (
                f"one patch has {100.0 * self.counted.largest_share:.3g} % of the area in contact, more than"
                f" {100.0 * LARGEST_SHARE:g} %: remove the form of the scan (form, longest)"
            )

    def count_over_cutoff(self) -> tuple[Doubles, Doubles]:
        """Cut-offs in um, and N_jm at each at the same share of the area."""
        return count_over_cutoff(*self.scans, share=self.share, longest=self.longest, nominal_area=self.nominal_area)

    @property
    def direction(self) -> str:
        """In words: how the surfaces differ along and across the sliding."""
        along, across = (self.gaussian.track.slopes[i] + self.gaussian.slider.slopes[i] for i in (0, 1))
        return f"rms slopes {sqrt(along):.4g} along and {sqrt(across):.4g} across the sliding"

    def scenario_text(
        self,
        *,
        speed: float | None = None,
        distance: float | None = None,
        mass: float | None = None,
        damping_ratio: float | None = None,
    ) -> str:
        """Return a scenario with the same area and number: parabolic lives, Rayleigh sizes, Poisson births.

        ``speed`` in um/s, ``distance`` in um (1000 mean lives without one); with ``mass`` in kg and
        ``damping_ratio`` the slider also rises and falls on its load, on an area that falls with the gap
        as that of the surfaces does, over sigma Q(u)/phi(u).
        Its text names scans, filters and hashes. Raises Refused for a mass without a speed or a damping ratio, and
        if `refused` has reasons.
        """
        if self.refused:
            raise Refused(f"no scenario is written: {'; '.join(self.refused)}")
        weighs = mass is not None or damping_ratio is not None
        if weighs and (mass is None or damping_ratio is None or speed is None):
            raise Refused("a load that moves needs mass=, damping_ratio= and speed=")
        return "".join(f"# {line}\n" for line in self._provenance()) + text_of(
            self._keys(speed, distance, self._weight(mass, damping_ratio) if weighs else {})
        )

    def _provenance(self) -> Iterator[str]:
        yield "What `rubnoise surface` found of two scans."
        for role, each, scan in zip(("track", "slider"), (self.track, self.slider), self.scans, strict=True):
            yield f"{role}: {each.name}, heights {scan.digest}"
            yield from (f"  {done}" for done in each.history)
        gaussian = self.gaussian
        yield f"nominal area {self.nominal_area:.6g} um^2, level u = {gaussian.level:.6g}"
        yield f"rms height of the sum {gaussian.roughness:.6g} um"
        yield f"patches counted over those of Gaussian surfaces: {self.honesty:.3g}"

    def _weight(self, mass: float | None, damping_ratio: float | None) -> dict[str, Any]:
        scale = f"{self.gaussian.height_scale:.9g} um"
        return {"height_scale": scale, "mass": f"{mass:.9g} kg", "damping_ratio": damping_ratio}

    def _keys(self, speed: float | None, distance: float | None, weight: dict[str, Any]) -> dict[str, Any]:
        gaussian = self.gaussian
        mean_life = 2.0 * sqrt(gaussian.real_contact_area / gaussian.junction_count)
        slid = distance
        if slid is None:
            digit = 10.0 ** (ceil(log10(LIVES * mean_life)) - 2)  # the second one, to which it is rounded up
            slid = digit * ceil(LIVES * mean_life / digit)
        return {
            "format": 1,
            "title": f"{self.slider.name} on {self.track.name}",
            "interface": {
                "load": f"{1e-6 * self.load:.12g} N",
                "hardness": f"{self.hardness:.12g} MPa",
                "mean_junction_count": float(f"{gaussian.junction_count:.9g}"),
                "calibration": "matched",
            },
            "pulse": {"shape": "parabola"},
            "diameter": {"law": "weibull", "spread": f"{RAYLEIGH:.6g} %"},
            "birth": {"law": "poisson"},
            "sliding": {**({} if speed is None else {"speed": f"{speed:.9g} um/s"}), "distance": f"{slid:.9g} um"},
            **({"load": weight} if weight else {}),
        }

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario of the same area and number, even if `refused`: theory compares it with the surfaces.

        Raises Refused for numbers that no scenario can have.
        """
        try:
            return loads(text_of(self._keys(None, None, {})), "surface")
        except ScenarioRefused as refusal:
            gaussian, load = self.gaussian, f"{1e-6 * self.load:.6g} N"
            found = f"{gaussian.junction_count:.3g} junctions of {gaussian.real_contact_area:.3g} um^2 in all"
            raise Refused(f'load="{load}": leaves {found}, which no scenario can have; take another one') from refusal

    @cached_property
    def scenario_relative_std(self) -> float:
        """Standard deviation over mean of the area in the scenario, sqrt(2/N_jm)."""
        area = area_cumulants(self.scenario.model())
        return area.std / area.mean

    @cached_property
    def scenario_correlation_length(self) -> float:
        """The lag in um at which the autocovariance of the scenario's area has fallen to one half."""
        lags = np.linspace(0.0, 2.0, 201) * sqrt(
            4.0 * self.gaussian.real_contact_area / (pi * self.gaussian.junction_count)
        )
        return half_width(lags, autocovariance(self.scenario.model(), lags))

    @cached_property
    def gap_slope(self) -> float:
        """Root mean square of dD/ds at constant load, D the gap, exact to first order from both spectra."""
        return gap_slope(self.gaussian)

    @property
    def scenario_separation_std(self) -> float:
        """The same scenario's std of the gap in um at constant load, to first order: s_0 sqrt(2/N_jm)."""
        return self.gaussian.height_scale * self.scenario_relative_std

    @property
    def scenario_gap_slope(self) -> float:
        """Its root mean square of dD/ds at constant load, to first order: s_0 sqrt(2/N_jm)/c, c^2 = E[d^2]."""
        return self.scenario_separation_std / overlap_scale(self.scenario.model())

    def motions(self, *, speed: float, mass: float, damping_ratio: float) -> tuple[NormalMotion, NormalMotion]:
        """Return the normal motion to first order from both spectra, and that of the scenario, as `scenario_text`."""
        text = text_of(self._keys(speed, None, self._weight(mass, damping_ratio)))
        found = load_motion(loads(text, "surface").model())
        exact = normal_motion(self.gaussian, load=self.load, speed=speed, mass=mass, ratio=damping_ratio)
        return exact, NormalMotion(separation_std=found.separation_std, velocity_std=found.velocity_std)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences with both numbers if the scenario is off: by a tenth in spread or correlation, by 1 dB in level."""
        gaussian = self.gaussian
        pairs = (
            ("standard deviation over mean", self.scenario_relative_std, gaussian.relative_std, ""),
            ("correlation length", self.scenario_correlation_length, gaussian.correlation_length, " um"),
        )
        said = [
            f"{name}: {ours:.4g}{unit} in the scenario, {exact:.4g}{unit} on the surfaces"
            f" ({100.0 * (ours / exact - 1.0):+.0f} %)"
            for name, ours, exact, unit in pairs
            if isfinite(exact) and exact > 0.0 and abs(ours / exact - 1.0) > NEAR
        ]
        if self.gap_slope > 0.0 and abs(louder := 20.0 * log10(self.scenario_gap_slope / self.gap_slope)) > NEAR_LEVEL:
            said.append(
                f"normal motion under a constant load: {self.scenario_gap_slope:.4g} of the speed in the scenario,"
                f" {self.gap_slope:.4g} on the surfaces ({louder:+.1f} dB)"
            )
        return tuple(said)


def slide(
    track: HeightMap,
    slider: HeightMap | None,
    *,
    load: float,
    hardness: float,
    cutoff: float,
    longest: float | None = None,
    slider_length: float | None = None,
) -> SlidingContact:
    """Return the contact of a slider on a track; without a slider the track slides on itself, turned by 180 degrees.

    ``load`` in uN, ``hardness`` in MPa, lengths in um. Raises Refused for cut-offs outside of a scan, for a slider
    shorter than its scan, and for a load above hardness times nominal area.
    """
    own = track.turned() if slider is None else slider
    reach = own.size[0] if slider_length is None else slider_length
    if reach < own.size[0] * (1.0 - 1e-9):
        raise Refused(f"slider_length=: {reach:.6g} um is less than the length of its scan, {own.size[0]:.6g} um")
    most = hardness * reach * own.size[1]
    if load >= most:
        raise Refused(
            f"load=: {load:.6g} uN is not below the hardness times the nominal area, {most:.6g} uN: lower the load, or"
            " take a larger scan"
        )
    limited = [band_limited(each, cutoff, longest) for each in (track, own)]
    return SlidingContact(limited[0], limited[1], load, hardness, cutoff, longest, reach, (track, own))


def count_over_cutoff(
    track: HeightMap,
    slider: HeightMap | None,
    *,
    share: float,
    longest: float | None = None,
    nominal_area: float | None = None,
) -> tuple[Doubles, Doubles]:
    """Return cut-offs in um and N_jm at each, from two points to a quarter of the smaller scan, at a share of the area.

    The number of junctions depends on the cut-off; this curve shows how.
    """
    own = track.turned() if slider is None else slider
    shortest = 2.0 * max(*track.spacing, *own.spacing)
    top = min(*track.size, *own.size) / 4.0
    if longest is not None:
        top = min(top, longest / 2.0)
    if not shortest < top:
        raise Refused(f"{track.name}: has no waves between two points, {shortest:.4g} um, and {top:.4g} um")
    cutoffs = shortest * _STEPS ** np.arange(int(np.log(top / shortest) / np.log(_STEPS)) + 1)
    check_wavelengths(track, float(cutoffs[0]), longest)
    limited = [Waves.of(band_limited(each, float(cutoffs[0]), longest)) for each in (track, own)]
    whole = GaussianContact(limited[0], limited[1], share, nominal_area or own.area, own.size[0])
    return np.asarray(cutoffs, dtype=np.float64), np.array(
        [whole.with_cutoff(float(each)).junction_count for each in cutoffs]
    )


FEWEST_PATCHES: Final = 20
LARGEST_SHARE: Final = 0.3
LARGEST_AREA: Final = 0.05
"""Limits of an answer: fewer patches have no statistics, one patch with more of the area carries all, and with more
of the nominal area in contact lives merge (at 3 % births are 20 % off)."""

_TOUCHING: Final = np.ones((3, 3), dtype=np.int8)
"""Points that touch at a corner are of one patch: of the 2 % in contact few would be parted there otherwise."""
