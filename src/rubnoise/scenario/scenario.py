"""A checked scenario: its sections in working units, and the physics that follows from its keys."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from fractions import Fraction
from math import fsum, pi, sqrt
from pathlib import Path as FilePath
from typing import Any, Final, cast

from rubnoise.contact.births import BIRTHS
from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.distributions import Law
from rubnoise.contact.laws import LAWS, Spread, law_for
from rubnoise.contact.pulses import pulse_of
from rubnoise.errors import ScenarioRefused, refusing_files
from rubnoise.model import CELLS, FreeSeparation, Model, Separation, Slider
from rubnoise.scenario import document as sections
from rubnoise.scenario.fields import Section, keys_of, ratio_of
from rubnoise.scenario.layers import filled, without
from rubnoise.scenario.text import Layers
from rubnoise.tables import as_html, shortened
from rubnoise.units import LENGTH, RATIO, Quantity


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Scenario(sections.Document):
    """The sections of a scenario file, with values in um, s, kg, uN, MPa, N/m, N s/m and defaults filled in.

    ``text`` is the file as read, ``warnings`` are texts about doubtful values, ``physics`` is the model, ``given`` are
    the keys as given, without defaults, ``files`` are the files that were read for it. ``too_large`` is the reason why
    a run is impossible; it is empty if a run is possible. Its theory is exact in both cases.

    >>> import rubnoise
    >>> scenario = rubnoise.load("paper/fig5")
    >>> scenario.sliding.speed, scenario.slider.stiffness, scenario.run.seed
    (1000.0, 300.0, 1)
    """

    name: str
    text: str
    warnings: tuple[str, ...]
    physics: Model
    too_large: str = field(default="", repr=False, compare=False)
    given: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    files: tuple[str, ...] = field(default=(), repr=False, compare=False)

    def __getattr__(self, name: str) -> Any:
        """Return the value of a key that only one of the scenario's tables has: ``scenario.speed``."""
        tables = [getattr(self, each.name) for each in fields(self) if each.name in sections.SECTIONS]
        homes = [each for each in tables if isinstance(each, Section) and name in keys_of(type(each))]
        if len(homes) == 1:
            return getattr(homes[0], name)
        several = f"{name} is a key of several tables" if homes else f"a scenario has no {name!r}"
        raise AttributeError(f"{several}; right form: scenario.sliding.speed", name=name, obj=self)

    def replace(self, changes: Mapping[str, Any] | None = None, /, **keys: Any) -> "Scenario":
        """Return the scenario with other values of some keys, checked like a file.

        ``replace(seed=3)`` and ``replace({"sliding.speed": "2 mm/s"})``: a key of only one table needs no dots. A value
        is a text with a unit or a quantity of pint; a plain number is for keys without a unit. None removes a key,
        so that its default is used. A mapping as the value of a table, such as ``slider``, replaces the keys that
        it names. Raises ScenarioRefused with every problem.

        >>> import rubnoise
        >>> scenario = rubnoise.load("paper/fig5").replace({"sliding.distance": "5 mm"}, seed=3)
        >>> scenario.run.seed, scenario.sliding.distance, scenario.replace(speed="2 mm/s").sliding.speed
        (3, 5000.0, 2000.0)
        """
        from rubnoise.scenario.reading import replaced

        if changes is not None and not isinstance(changes, Mapping):
            raise ScenarioRefused(f'replace: {changes!r:.40}: keys and values are needed, as in {{"run.seed": 3}}')
        return replaced(self, {**(changes or {}), **keys})

    def to_toml(self) -> str:
        """Return the scenario as the text of a file with every key, which reads back to the same bits.

        >>> import rubnoise
        >>> rubnoise.load("paper/fig5").to_toml().splitlines()[0]
        'format = 1'
        """
        from rubnoise.scenario.text import text_of

        return text_of(self.resolved())

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> FilePath:
        """Write the scenario into a file, completely or not at all, and return its path; see `to_toml`.

        ``force`` allows an existing file to be replaced. Raises ScenarioRefused for a file that cannot be written.
        """
        place = FilePath(path)
        if place.exists() and not force:
            raise ScenarioRefused(f"{place}: exists already; force=True replaces it")
        part = place.with_name(f".{place.name}.part")
        with refusing_files(place, ScenarioRefused, "cannot be written: "):
            part.write_text(self.to_toml(), encoding="utf-8")
            part.replace(place)
        return place

    def model(self) -> Model:
        """Return the physics of the run."""
        return self.physics

    def check_size(self) -> None:
        """Raise ScenarioRefused if a run would have more rows, or more live junctions, than rubnoise can write."""
        if self.too_large:
            raise ScenarioRefused(self.too_large)

    def resolved(self) -> dict[str, Any]:
        """Return every key with its value, also defaults, as a table of texts, numbers and tables that JSON can hold.

        Quantities are written in working units in full; `rubnoise.build` makes the same scenario of it to the last bit.
        """
        tables = {
            name: {
                key: value.as_text()
                if isinstance(value, Quantity)
                else list(value)
                if isinstance(value, tuple)
                else value
                for key in keys_of(type(section))
                if (value := getattr(section, key)) is not None and not (key == "calibration" and self.diameter.mean)
            }
            for name in sections.SECTIONS
            if isinstance(section := getattr(self, name, None), Section)
        }
        return {"format": sections.FORMAT, "title": self.title, **tables}

    to_dict = resolved

    def __repr__(self) -> str:
        tables = {name: table for name, table in self.resolved().items() if isinstance(table, Mapping)}
        lines = [
            f"  {name:<10} " + ", ".join(f"{key} {value}" for key, value in t.items()) for name, t in tables.items()
        ]
        return shortened([f"{self.title or 'a scenario'} ({self.name})", *lines])

    def _repr_html_(self) -> str:
        tables = {name: table for name, table in self.resolved().items() if isinstance(table, Mapping)}
        rows = [(f"{name}.{key}", value) for name, table in tables.items() for key, value in table.items()]
        return as_html(f"{self.title or 'a scenario'} ({self.name})", ("key", "value"), rows, "\n".join(self.warnings))


_ROUNDING, _STEPS = 1e-14, 300


def diameter_of(document: sections.Document) -> float:
    """Return the calibrated diameter d_m in um.

    Raises Uncalibrated if `matched` has no solution, and for `paper` with another pulse than the lens.
    """
    if document.diameter.mean is not None:
        return float(document.diameter.mean)
    area, count = area_and_count(document)
    pulse = pulse_of(document.pulse.shape, document.pulse.offset)
    return calibrated_diameter(document.interface.calibration, area, count, spread_of(document.diameter), pulse)


def area_and_count(document: sections.Document) -> tuple[float, float]:
    """Return A_rm in um^2 and N_jm: as given, from W/H, the area of one patch or a mean diameter; rounded once."""
    interface = document.interface
    area, load, hardness = interface.mean_real_contact_area, interface.load, interface.hardness
    count, patch = interface.mean_junction_count, interface.patch_area
    if area is None and load is None and count is not None:
        return count * _mean_junction_area(document), count
    whole = area.exact if area is not None else cast(Quantity, load).exact / cast(Quantity, hardness).exact
    if count is None and patch is None:
        return float(whole), float(whole) / _mean_junction_area(document)
    return float(whole), float(whole / cast(Quantity, patch).exact) if count is None else count


def _mean_junction_area(document: sections.Document) -> float:
    """Return the mean area in um^2 of a live junction, c_1 E[d^3] / (L E[d]), of sizes with a mean diameter."""
    pulse, sizes = pulse_of(document.pulse.shape, document.pulse.offset), sizes_of(document, diameter_of(document))
    return pulse.life_integral(1) / pulse.mean_life * sizes.moment(3) / sizes.moment(1)


def sizes_of(document: sections.Document, diameter: float) -> Law:
    """Return the law of sizes about d_m in um; with a mean diameter about a centre that gives it, as drawn."""
    spread, centre = spread_of(document.diameter), diameter
    sizes = law_for(centre, spread)
    for _ in range(_STEPS if document.diameter.mean is not None else 0):
        if abs(sizes.moment(1) / diameter - 1.0) <= _ROUNDING:
            break
        centre *= diameter / sizes.moment(1)
        sizes = law_for(centre, spread)
    return sizes


def spread_of(quantity: sections.Diameter | sections.Strength) -> Spread:
    """Return the law of a quantity about its centre, with an absolute or a relative spread."""
    law = "fixed" if quantity.law == sections.ONE_STRENGTH else quantity.law
    own = {each.name: getattr(quantity, each.name) for each in LAWS[law].parameters}
    if isinstance(quantity, sections.Diameter) and law == "mixture":
        weights = quantity.weights or ()
        own = {"weights": tuple(weight / fsum(weights) for weight in weights)}
        own["parts"] = tuple((LAWS[part["law"]], part["mean"], ratio_of(part)) for part in quantity.parts or ())
    elif isinstance(quantity, sections.Diameter) and law == "empirical":
        own = {"values": quantity.values, "sampled": quantity.sampled or "born"}
    spread = quantity.spread
    size = {} if spread is None else {"relative" if spread.kind == RATIO else "absolute": float(spread)}
    return Spread(law=law, parameters=tuple(own.items()), **size)


def default_tick(diameter: float) -> Quantity:
    """Return a two-hundredth of the mean life 2 d_m, as a decimal number that can be written in a file."""
    return Quantity(Fraction(repr(diameter / 100.0)), LENGTH)


def model_of(document: sections.Document, diameter: float, tick: Quantity) -> Model:
    """Return the model of a complete document for its calibrated diameter in um and its tick."""
    interface, sliding, strength = document.interface, document.sliding, document.strength
    pulse = pulse_of(document.pulse.shape, document.pulse.offset)
    area, count = area_and_count(document)
    load, held, free = document.load, None, None
    if load is not None:
        held = _separation(load, interface)
        loss = None if load.impact_damping is None else float(load.impact_damping)
        free = FreeSeparation(held=held, restitution=load.restitution, impact_damping=loss)
    births = BIRTHS[document.birth.law]
    own = {each.name: float(getattr(document.birth, each.name)) for each in births.parameters}
    return Model(
        mean_real_contact_area=area,
        mean_junction_count=count,
        calibration=interface.calibration,
        calibrated_diameter=diameter,
        sizes=sizes_of(document, diameter),
        births=births.make(mean_spacing=pulse.mean_life * diameter / count, **own),
        strengths=law_for(float(strength.mean), spread_of(strength)) if strength else None,
        sliding_speed=None if sliding.speed is None else float(sliding.speed),
        distance=float(sliding.distance),
        start=sliding.start,
        slider=_slider(document.slider, diameter) if document.slider else None,
        tick=float(tick),
        tick_count=sliding.distance.exact // tick.exact,  # as written: floats would lose the last tick now and then
        pulse=pulse,
        hardness=None if interface.hardness is None else float(interface.hardness),
        separation=held if load is not None and load.motion == "first-order" else None,
        free=free if load is not None and load.motion == "free" else None,
    )


def _damping(body: sections.Load | sections.Slider, stiffness: float) -> float:
    """Return the damping in N s/m of a mass on a spring, as given or from its ratio."""
    critical = 2.0 * sqrt(stiffness * float(body.mass))
    return float(body.damping or 0.0) if body.damping_ratio is None else body.damping_ratio * critical


def _separation(load: sections.Load, interface: sections.Interface) -> Separation:
    weight, hardness = (float(cast(Quantity, each)) for each in (interface.load, interface.hardness))
    height, mass = float(load.height_scale), float(load.mass)
    damping = _damping(load, weight / height)
    return Separation(load=weight, hardness=hardness, height_scale=height, mass=mass, damping=damping)


def _slider(slider: sections.Slider, diameter: float) -> Slider:
    height, stiffness = slider.asperity_height, float(slider.stiffness)
    return Slider(
        mass=float(slider.mass),
        stiffness=stiffness,
        damping=_damping(slider, stiffness),
        start=slider.start,
        coupling=slider.coupling,
        cells=slider.cells or CELLS,
        excitation=slider.excitation or "friction",
        asperity_height=0.0 if height is None else float(height) / (1.0 if height.kind == RATIO else diameter),
        slope=float(slider.slope or 0.0),
    )


RAYLEIGH: Final = 100.0 * sqrt(4.0 / pi - 1.0)
"""Standard deviation over mean of Rayleigh sizes, in %: with it the Weibull law has the shape 2."""

CONTACT: Final[Mapping[str, Mapping[str, str]]] = {
    "interface": {"calibration": "matched"},
    "diameter": {"law": "weibull", "spread": f"{RAYLEIGH!r} %"},
    "birth": {"law": "poisson"},
    "pulse": {"shape": "parabola", "offset": "none"},
}
"""The contact of exponential heights: paraboloids of Rayleigh sizes that meet at random (Greenwood and Williamson)."""


def sized(layers: Layers) -> Layers:
    """Return layers without what a later layer says in another way: an area, or the mean diameter.

    Beside a count one of them is enough. A load that weighs needs its load, so there the count goes.
    """
    interface = layers.table("interface")
    areas = [key for key in ("mean_real_contact_area", "load", "hardness", "patch_area") if key in interface]
    counted = not interface.keys().isdisjoint({"mean_junction_count", "patch_area"})
    if not (areas and counted and "mean" in layers.table("diameter")):
        return layers
    mean = layers.origin(("diameter", "mean")).layer
    area = max(layers.origin(("interface", key)).layer for key in areas)
    if mean < area:
        return without(layers, ("diameter", "mean"))
    other = ("mean_junction_count", "patch_area") if "load" in layers.data else (*areas, "calibration")
    return layers if mean == area else without(layers, *(("interface", key) for key in other))


def completed(layers: Layers) -> Layers:
    """Return layers with the default contact for a table [load], if the file does not give it."""
    if not isinstance(layers.data.get("load"), dict):
        return layers
    law, contact = CONTACT["diameter"]["law"], dict(CONTACT)
    if "mean" in layers.table("diameter"):
        del contact["interface"]
    if layers.table("diameter").get("law", law) != law:
        del contact["diameter"]
    return filled(layers, contact)
