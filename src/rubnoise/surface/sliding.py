"""Two surfaces under a load: exact theory and counted patches side by side, and the scenario of their noise."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil, inf, isfinite, log10, pi, sqrt
from typing import Any, Final

import numpy as np
from scipy import ndimage

from rubnoise.arrays import Doubles
from rubnoise.errors import Refused, ScenarioRefused
from rubnoise.scenario import Scenario, loads
from rubnoise.scenario.scenario import RAYLEIGH
from rubnoise.scenario.text import text_of
from rubnoise.surface.gaussian import GaussianContact, NormalMotion, gap_slope, half_width, normal_motion
from rubnoise.surface.height_map import HeightMap, Waves, band_limited
from rubnoise.theory.coupling import LoadMotion, load_motion, overlap_scale
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.second_order import autocovariance

FEWEST_PATCHES: Final = 20  # fewer have no statistics
LARGEST_SHARE: Final = 0.3  # one patch with more of the area carries all
LARGEST_AREA: Final = 0.05  # with more of the nominal area in contact lives merge (at 3 % births are 20 % off)
LIVES: Final = 1000  # mean lives in the scenario's distance, if none is given
NEAR, NEAR_LEVEL = 0.1, 1.0  # how far off a scenario may be unsaid: in spread and length, and in dB of normal motion


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patches:
    """Patches of contact on a map of so large an area: their ``areas`` in um^2 from the largest on, and their sum.

    ``mean_diameter`` is the mean of sqrt(4 A/pi) in um, ``relative_spread`` the standard deviation of areas over mean.
    """

    areas: Doubles = field(repr=False)
    map_area: float
    patch_count: int
    real_contact_area: float
    largest_share: float
    mean_diameter: float
    relative_spread: float


def patches(heights: Doubles, share: float, spacing: tuple[float, float]) -> Patches:
    """Return the patches of a map above the height that the given share of its points exceeds, spacings in um."""
    count, point = max(1, round(share * heights.size)), spacing[0] * spacing[1]
    threshold = np.partition(heights, heights.size - count, axis=None)[heights.size - count]
    # Points that touch at a corner are of one patch: of the 2 % in contact few would be parted there otherwise.
    labels, _ = ndimage.label(heights >= threshold, np.ones((3, 3)))
    areas = np.sort(np.bincount(labels.ravel())[1:])[::-1].astype(np.float64) * point
    return Patches(
        areas=areas,
        map_area=heights.size * point,
        patch_count=areas.size,
        real_contact_area=float(areas.sum()),
        largest_share=float(areas[0] / areas.sum()),
        mean_diameter=float(np.sqrt(areas * (4.0 / pi)).mean()),
        relative_spread=float(areas.std() / areas.mean()),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class SlidingContact:
    """A slider on a track under a load: ``scans`` are both maps, ``track`` and ``slider`` those with their waves cut.

    ``load`` in uN, ``hardness`` in MPa, ``cutoff``, ``longest`` and ``slider_length`` in um. Raises Refused for
    cut-offs outside of a scan, a slider shorter than its scan, a load above hardness times nominal area.
    """

    scans: tuple[HeightMap, HeightMap] = field(repr=False)
    load: float
    hardness: float
    cutoff: float
    longest: float | None = None
    slider_length: float
    track: HeightMap = field(init=False)
    slider: HeightMap = field(init=False)

    def __post_init__(self) -> None:
        length, width = self.scans[1].size
        if self.slider_length < length * (1.0 - 1e-9):
            scanned = f"less than the length of its scan, {length:.6g} um"
            raise Refused(f"slider_length=: {self.slider_length:.6g} um is {scanned}")
        if self.load >= (most := self.hardness * self.slider_length * width):
            limit = f"the hardness times the nominal area, {most:.6g} uN"
            raise Refused(f"load=: {self.load:.6g} uN is not below {limit}: lower the load, or take a larger scan")
        for role, scan in zip(("track", "slider"), self.scans, strict=True):
            object.__setattr__(self, role, band_limited(scan, self.cutoff, self.longest))

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

    @property
    def heights(self) -> Doubles:
        """The sum of both heights in um where both maps are, at the slider's points."""
        laid = self.track.on_grid_of(self.slider)
        return laid + self.slider.heights[: laid.shape[0], : laid.shape[1]]

    @cached_property
    def counted(self) -> Patches:
        """Patches of one map pressed against the other at the same share of their area, if both are large enough."""
        return patches(self.heights, self.share, self.slider.spacing)

    @property
    def honesty(self) -> float:
        """Patches counted over those that theory expects on the same area: 1 for Gaussian surfaces."""
        expected = self.gaussian.junction_count * self.counted.map_area / self.nominal_area
        return self.counted.patch_count / expected

    @cached_property
    def refused(self) -> tuple[str, ...]:
        """The reasons why these numbers must not be used, each with a remedy; empty if there are none."""
        count, largest = self.counted.patch_count, self.counted.largest_share
        reasons = {
            f"{100.0 * self.share:.3g} % of the nominal area is in contact, more than {100.0 * LARGEST_AREA:g} %,"
            " and lives merge there: lower the load, or give a larger hardness": self.share > LARGEST_AREA,
            f"{count} patches are in contact, fewer than {FEWEST_PATCHES}: take a larger scan, a"
            " shorter cut-off, or a larger load": count < FEWEST_PATCHES,
            f"one patch has {100.0 * largest:.3g} % of the area in contact, more than"
            f" {100.0 * LARGEST_SHARE:g} %: remove the form of the scan (form, longest)": largest > LARGEST_SHARE,
        }
        return tuple(reason for reason, holds in reasons.items() if holds)

    def count_over_cutoff(self) -> tuple[Doubles, Doubles]:
        """Cut-offs in um, from two points to a quarter of the smaller scan, and N_jm at each at the same share."""
        track, slider = self.scans
        shortest = 2.0 * max(*track.spacing, *slider.spacing)
        top = min(0.25 * min(*track.size, *slider.size), 0.5 * (self.longest or inf))
        if not shortest < top:
            raise Refused(f"{track.name}: has no waves between two points, {shortest:.4g} um, and {top:.4g} um")
        steps = np.arange(float(int(2.0 * np.log2(top / shortest)) + 1))
        cutoffs = np.asarray(shortest * 2.0 ** (0.5 * steps), dtype=np.float64)
        whole = replace(self, cutoff=shortest).gaussian
        return cutoffs, np.array([whole.count_at(float(each)) for each in cutoffs])

    @property
    def direction(self) -> str:
        """In words: how the surfaces differ along and across the sliding."""
        _, along, across = np.sqrt(self.gaussian.moments.sum(0))
        return f"rms slopes {along:.4g} along and {across:.4g} across the sliding"

    def scenario_text(
        self,
        *,
        speed: float | None = None,
        distance: float | None = None,
        mass: float | None = None,
        damping_ratio: float | None = None,
    ) -> str:
        """Return a scenario with the same area and number: parabolic lives, Rayleigh sizes, Poisson births.

        ``speed`` in um/s, ``distance`` in um (1000 mean lives without one); with ``mass`` in kg and ``damping_ratio``
        the slider also rises and falls on its load. Raises Refused for a mass without speed or damping ratio, and if
        `refused` has reasons.
        """
        if self.refused:
            raise Refused(f"no scenario is written: {'; '.join(self.refused)}")
        motion = {"speed": speed, "mass": mass, "damping_ratio": damping_ratio}
        if not (mass is None and damping_ratio is None) and None in motion.values():
            raise Refused("a load that moves needs mass=, damping_ratio= and speed=")
        told = ["What `rubnoise surface` found of two scans."]
        for role, each, scan in zip(("track", "slider"), (self.track, self.slider), self.scans, strict=True):
            told += [f"{role}: {each.name}, heights {scan.digest}", *(f"  {done}" for done in each.history)]
        told += [
            f"nominal area {self.nominal_area:.6g} um^2, level u = {self.gaussian.level:.6g}",
            f"rms height of the sum {self.gaussian.roughness:.6g} um",
            f"patches counted over those of Gaussian surfaces: {self.honesty:.3g}",
        ]
        return "".join(f"# {line}\n" for line in told) + self._text(distance, **motion)

    def _text(self, distance: float | None = None, **motion: float | None) -> str:
        lives = LIVES * 2.0 * sqrt(self.gaussian.real_contact_area / self.gaussian.junction_count)
        digit = 10.0 ** (ceil(log10(lives)) - 2)  # the second one, to which it is rounded up
        slid = digit * ceil(lives / digit) if distance is None else distance
        keys: dict[str, Any] = {
            "format": 1,
            "title": f"{self.slider.name} on {self.track.name}",
            "interface": {
                "load": f"{1e-6 * self.load:.12g} N",
                "hardness": f"{self.hardness:.12g} MPa",
                "mean_junction_count": float(f"{self.gaussian.junction_count:.9g}"),
                "calibration": "matched",
            },
            "pulse": {"shape": "parabola"},
            "diameter": {"law": "weibull", "spread": f"{RAYLEIGH:.6g} %"},
            "birth": {"law": "poisson"},
            "sliding": ({"speed": f"{speed:.9g} um/s"} if (speed := motion.get("speed")) else {})
            | {"distance": f"{slid:.9g} um"},
        }
        if mass := motion.get("mass"):
            scale, ratio = f"{self.gaussian.height_scale:.9g} um", motion["damping_ratio"]
            keys["load"] = {"height_scale": scale, "mass": f"{mass:.9g} kg", "damping_ratio": ratio}
        return text_of(keys)

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario of the same area and number, even if `refused`; Refused for numbers that none can have."""
        try:
            return loads(self._text(), "surface")
        except ScenarioRefused as refusal:
            gaussian, load = self.gaussian, f"{1e-6 * self.load:.6g} N"
            found = f"{gaussian.junction_count:.3g} junctions of {gaussian.real_contact_area:.3g} um^2 in all"
            raise Refused(f'load="{load}": leaves {found}, which no scenario can have; take another one') from refusal

    @cached_property
    def in_scenario(self) -> dict[str, float]:
        """What the scenario has of the area and, to first order at constant load, of the gap D, by name.

        Std of the area over mean; lag in um of half its autocovariance; std of D in um; root mean square of dD/ds.
        """
        model = self.scenario.model()
        area, size = area_cumulants(model), overlap_scale(model)
        lags, gap = np.linspace(0.0, 2.0, 201) * size, self.gaussian.height_scale * area.std / area.mean
        return {
            "relative_std": area.std / area.mean,
            "correlation_length": half_width(lags, autocovariance(model, lags)),
            "separation_std": gap,
            "separation_slope": gap / size,
        }

    @cached_property
    def gap_slope(self) -> float:
        """Root mean square of dD/ds at constant load, D the gap, exact to first order from both spectra."""
        return gap_slope(self.gaussian)

    def motions(self, *, speed: float, mass: float, damping_ratio: float) -> tuple[NormalMotion, LoadMotion]:
        """Return the normal motion to first order from both spectra, and that of the scenario, as `scenario_text`."""
        text = self._text(speed=speed, mass=mass, damping_ratio=damping_ratio)
        exact = normal_motion(self.gaussian, load=self.load, speed=speed, mass=mass, ratio=damping_ratio)
        return exact, load_motion(loads(text, "surface").model())

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences with both numbers if the scenario is off: by a tenth in spread or correlation, by 1 dB in level."""
        said = []
        names = {"standard deviation over mean": "relative_std", "correlation length": "correlation_length"}
        for (words, name), unit in zip(names.items(), ("", " um"), strict=True):
            ours, exact = self.in_scenario[name], getattr(self.gaussian, name)
            if isfinite(exact) and exact > 0.0 and abs(ours / exact - 1.0) > NEAR:
                change = f"({100.0 * (ours / exact - 1.0):+.0f} %)"
                said.append(f"{words}: {ours:.4g}{unit} in the scenario, {exact:.4g}{unit} on the surfaces {change}")
        ours, exact = self.in_scenario["separation_slope"], self.gap_slope
        if exact > 0.0 and abs(louder := 20.0 * log10(ours / exact)) > NEAR_LEVEL:
            rates = f"{ours:.4g} of the speed in the scenario, {exact:.4g} on the surfaces ({louder:+.1f} dB)"
            said.append(f"normal motion under a constant load: {rates}")
        return tuple(said)
