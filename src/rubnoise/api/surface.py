"""Measured surfaces in Python: read a scan, slide it on another, and keep the scenario of their noise."""

import os
import re
from dataclasses import dataclass, field
from math import nan, sqrt
from pathlib import Path
from typing import Any, Self

import numpy as np

from rubnoise.api import keywords
from rubnoise.api.notebook import Displayed, Overview
from rubnoise.api.trace import with_unit
from rubnoise.arrays import Doubles
from rubnoise.errors import Refused
from rubnoise.storage.output import whole_file
from rubnoise.storage.scan import Scan, Told, from_topography, length_scale, read_scan, write_scan
from rubnoise.surface.height_map import FORMS, HeightMap, Waves, band_limited, check_sense, self_affine, without_form
from rubnoise.surface.sliding import SlidingContact
from rubnoise.units import FORCE, LENGTH, STRESS


@dataclass(frozen=True, slots=True, repr=False, eq=False)
class Surface(Displayed):
    """A map of heights in um, the first index along the sliding, with its form removed.

    `Surface.read` takes a file of an instrument, `Surface.of` an object of SurfaceTopography or an array, and
    `Surface.synthesise` makes a self-affine one from a seed.

    >>> import rubnoise
    >>> track = rubnoise.Surface.synthesise(points=512, cutoff="8 um", rolloff="32 um", seed=1)
    >>> slider = rubnoise.Surface.synthesise(points=512, cutoff="8 um", rolloff="32 um", seed=2)
    >>> contact = track.slide(slider, cutoff="8 um", load="2.5 N", hardness="1 GPa")
    >>> round(contact.gaussian.level, 3), contact.counted.patch_count
    (2.344, 98)
    """

    map: HeightMap = field(repr=False)

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        *,
        form: str = "tilt",
        unit: str | None = None,
        height_unit: str | None = None,
        size: Any = None,
        channel: str | None = None,
        turn: bool = False,
    ) -> Self:
        """Read a map of a file in one of 42 formats, or of text: rows of x, y and z, or a matrix of heights.

        ``form`` is removed: "none", "tilt", "polynomial", "cylinder" or "sphere". ``unit`` is that of all lengths if
        the file names none, ``height_unit`` that of heights, ``size`` that of a matrix, such as "128 um x 64 um", the
        length of its rows first. ``channel`` names one of several maps, ``turn`` slides along the second index.
        Raises Refused for what cannot be read, and for a map longer than 1 m or steeper than 10.
        """
        sides = None if size is None else _two_lengths("size", size)
        told = Told(unit=unit, height_unit=height_unit, size=sides, channel=channel)
        return cls._of_scan(read_scan(Path(path), told), form, turn=turn)

    @classmethod
    def of(
        cls, source: Any, *, spacing: Any = None, unit: str | None = None, form: str = "tilt", name: str = "surface"
    ) -> Self:
        """Take a topography of SurfaceTopography as it is, or an array of heights with a ``spacing``.

        An array is in ``unit``, such as "nm"; one of pint has its unit, or is converted to ``unit``. ``spacing`` is a
        length such as "0.5 um", or two of them, along and across the sliding. Raises Refused for what is no map.
        """
        if hasattr(source, "heights") and hasattr(source, "physical_sizes"):
            return cls._of_scan(from_topography(source, name, Told(unit=unit)), form)
        heights, own = with_unit(source, name, unit or "")
        if spacing is None or not own:
            raise Refused('an array of heights needs spacing= and unit=; right form: spacing="0.5 um", unit="nm"')
        scaled = heights * length_scale(own, name)
        return cls._of_scan({"heights": scaled, "spacing": _two_lengths("spacing", spacing), "name": name}, form)

    @classmethod
    def _of_scan(cls, scan: Scan, form: str, *, turn: bool = False) -> Self:
        whole = HeightMap(**scan)
        check_sense(whole)
        known = str(keywords.choice("form", form, tuple(FORMS)))
        return cls(without_form(whole.transposed() if turn else whole, known))

    @classmethod
    def synthesise(
        cls,
        *,
        points: int = 512,
        spacing: Any = "1 um",
        roughness: Any = "1 um",
        hurst: float = 0.8,
        rolloff: Any = None,
        cutoff: Any = None,
        seed: int = 1,
    ) -> Self:
        """Make a self-affine periodic surface; equal arguments give equal bits.

        ``roughness`` is the rms height, ``hurst`` the exponent H; waves from ``cutoff`` to ``rolloff`` are
        self-affine, those above are equally strong: without them, 5 points and a sixteenth of the side, but two
        cut-offs at least. Raises Refused for a surface that cannot be.
        """
        side, step = keywords.count("points", points, 1 << 20), keywords.needed("spacing", spacing, LENGTH)
        shortest = keywords.quantity("cutoff", cutoff, LENGTH) or 5.0 * step
        made = self_affine(
            points=side,
            spacing=step,
            roughness=keywords.needed("roughness", roughness, LENGTH),
            hurst=float(hurst),
            rolloff=keywords.quantity("rolloff", rolloff, LENGTH) or max(side * step / 16.0, 2.0 * shortest),
            cutoff=shortest,
            seed=keywords.count("seed", seed, 2**53 - 1),
        )
        return cls(made)

    @property
    def heights(self) -> Doubles:
        """Heights in um."""
        return self.map.heights

    def roughness(self, cutoff: Any = None, longest: Any = None) -> dict[str, float]:
        """Return Sa and Sq in um, Ssk and Sku, and rms slopes along and across the sliding, after the cut-offs.

        Sq is the rms height, Sa the mean distance from the mean, Ssk and Sku the third and fourth moments over Sq^3 and
        Sq^4 (ISO 25178-2), nan of a flat map. Slopes are those of the waves, sqrt(sum S (2 pi f)^2).
        """
        limits = (keywords.quantity("cutoff", cutoff, LENGTH), keywords.quantity("longest", longest, LENGTH))
        if limits[0] is None and limits[1] is not None:
            raise Refused(f"longest=: {keywords.shown(longest)}: needs a cutoff= beside it")
        surface = self.map if limits[0] is None else band_limited(self.map, limits[0], limits[1])
        heights = surface.heights - surface.heights.mean()
        rms = sqrt(float(np.square(heights).mean()))
        _, along, across = Waves.of(surface).moments().tolist()
        return {
            "Sa": float(np.abs(heights).mean()),
            "Sq": rms,
            "Ssk": float((heights**3).mean()) / rms**3 if rms > 0.0 else nan,
            "Sku": float((heights**4).mean()) / rms**4 if rms > 0.0 else nan,
            "slope_along": sqrt(along),
            "slope_across": sqrt(across),
        }

    def slide(
        self,
        slider: "Surface | None" = None,
        *,
        cutoff: Any,
        load: Any,
        hardness: Any,
        longest: Any = None,
        slider_length: Any = None,
    ) -> SlidingContact:
        """Slide another surface on this one, or this one on itself turned by 180 degrees, under a load.

        ``cutoff`` and ``longest`` limit the waves, ``load`` such as "0.2 N" and ``hardness`` such as "1 GPa" give
        the real contact area, ``slider_length`` is for a slider longer than its scan. Raises Refused without a
        cut-off, which the number of junctions depends on. Source: docs/surfaces.md.
        """
        if cutoff is None:
            raise Refused('cutoff=: the number of junctions has no value without it; right form: cutoff="5 um"')
        return self._under(
            slider,
            load=keywords.needed("load", load, FORCE),
            hardness=keywords.needed("hardness", hardness, STRESS),
            cutoff=keywords.needed("cutoff", cutoff, LENGTH),
            longest=keywords.quantity("longest", longest, LENGTH),
            slider_length=keywords.quantity("slider_length", slider_length, LENGTH),
        )

    def count_over_cutoff(
        self, slider: "Surface | None" = None, *, share: float = 0.01, longest: Any = None
    ) -> tuple[Doubles, Doubles]:
        """Return cut-offs in um and N_jm at each, at a share of the area in contact."""
        other, limit = self if slider is None else slider, keywords.quantity("longest", longest, LENGTH)
        shortest = 2.0 * max(*self.map.spacing, *other.map.spacing)
        load = share * other.map.area
        return self._under(slider, load=load, hardness=1.0, cutoff=shortest, longest=limit).count_over_cutoff()

    def _under(self, slider: "Surface | None", *, slider_length: float | None = None, **given: Any) -> SlidingContact:
        other = self.map.turned() if slider is None else slider.map
        return SlidingContact(scans=(self.map, other), slider_length=slider_length or other.size[0], **given)

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the map as netCDF, in the form that SurfaceTopography reads; refuses an existing file unless forced."""
        with whole_file(path, force=force) as part:
            write_scan(part, self.heights, self.map.size, periodic=self.map.periodic)

    def _overview(self) -> Overview:
        along, across = self.map.size
        points = " x ".join(map(str, self.map.heights.shape))
        heading = f"{self.map.name}: {points} points over {along:.4g} um x {across:.4g} um"
        rows = [(name, f"{value:.4g}") for name, value in self.roughness().items()]
        return heading, ("", "value"), rows, self.map.history


def _two_lengths(keyword: str, value: Any) -> tuple[float, float]:
    """Return two lengths in um, of "128 um x 64 um", of a pair, or of one length for both."""
    sides = re.split(r" *[x\u00d7] *", value.strip()) if isinstance(value, str) else value
    both = tuple(sides) if isinstance(sides, list | tuple) else (sides,)
    if len(both) not in (1, 2):
        raise Refused(f"{keyword}=: {keywords.shown(value)} is neither one length nor two")
    return keywords.needed(keyword, both[0], LENGTH), keywords.needed(keyword, both[-1], LENGTH)
