"""From the keys of a scenario to the physics of a run."""

from collections.abc import Callable
from fractions import Fraction
from math import sqrt
from typing import Literal, cast

from rubnoise.contact.births import BirthLaw, PoissonBirths, RegularBirths
from rubnoise.contact.calibration import calibrated_diameter
from rubnoise.contact.pulses import PULSES
from rubnoise.contact.spread import SizeLawName, Spread, sizes_for
from rubnoise.contact.strengths import StrengthLaw
from rubnoise.contact.strengths_spread import strengths_for
from rubnoise.model import Model, Slider
from rubnoise.scenario import document as sections
from rubnoise.units import LENGTH, RATIO, Quantity

_BIRTHS: dict[str, Callable[..., BirthLaw]] = {"poisson": PoissonBirths, "regular": RegularBirths}


def diameter_of(document: sections.Document) -> float:
    """Return the calibrated diameter d_m in um.

    Raises NoMatchingDiameter where `matched` has no solution, PaperMeansLens for `paper` with another pulse.
    """
    interface = document.interface
    return calibrated_diameter(
        interface.calibration,
        float(interface.mean_real_contact_area),
        interface.mean_junction_count,
        spread_of(document.diameter),
        PULSES[document.pulse.shape],
    )


def spread_of(diameter: sections.Diameter) -> Spread:
    """Return how sizes spread about the mean diameter: by what law, and by a length or a part of the mean."""
    if diameter.law == "fixed":
        return Spread()
    absolute, relative = _absolute_or_relative(diameter.spread)
    return Spread(absolute=absolute, relative=relative, law=cast(SizeLawName, diameter.law))


def _absolute_or_relative(spread: Quantity | None) -> tuple[float | None, float | None]:
    if spread is None:
        return None, None
    return (None, float(spread)) if spread.kind == RATIO else (float(spread), None)


def default_tick(diameter: float) -> Quantity:
    """Return a two-hundredth of the mean life 2 d_m, as the decimal number that a file would give."""
    return Quantity(Fraction(repr(diameter / 100.0)), LENGTH)


def tick_count(distance: Quantity, tick: Quantity) -> int:
    """Return the exact floor of distance over tick as written; floats would lose the last tick now and then."""
    return distance.exact // tick.exact


def model_of(document: sections.Document, diameter: float, tick: Quantity) -> Model:
    """Return the model of a complete document for its calibrated diameter in um and its tick."""
    interface, sliding = document.interface, document.sliding
    return Model(
        mean_real_contact_area=float(interface.mean_real_contact_area),
        mean_junction_count=interface.mean_junction_count,
        calibration=cast(Literal["paper", "exact", "matched"], interface.calibration),
        calibrated_diameter=diameter,
        sizes=sizes_for(diameter, spread_of(document.diameter)),
        births=_BIRTHS[document.birth.law](mean_spacing=2.0 * diameter / interface.mean_junction_count),
        strengths=_strengths(document.strength) if document.strength else None,
        sliding_speed=None if sliding.speed is None else float(sliding.speed),
        distance=float(sliding.distance),
        start=cast(Literal["stationary", "empty"], sliding.start),
        slider=_slider(document.slider) if document.slider else None,
        tick=float(tick),
        tick_count=tick_count(sliding.distance, tick),
        pulse=PULSES[document.pulse.shape],
    )


def strength_std(strength: sections.Strength) -> float:
    """Return the standard deviation in MPa that a scenario gives, 0 where it gives none."""
    absolute, relative = _absolute_or_relative(strength.spread)
    return relative * float(strength.mean) if relative is not None else absolute or 0.0


def _strengths(strength: sections.Strength) -> StrengthLaw:
    return strengths_for(strength.law, float(strength.mean), strength_std(strength))


def _slider(slider: sections.Slider) -> Slider:
    mass, stiffness = float(slider.mass), float(slider.stiffness)
    critical = 2.0 * sqrt(stiffness * mass)
    ratio = slider.damping_ratio
    damping = float(slider.damping or 0.0) if ratio is None else ratio * critical
    start = cast(Literal["equilibrium", "rest"], slider.start)
    return Slider(mass=mass, stiffness=stiffness, damping=damping, start=start)
