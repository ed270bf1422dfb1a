"""The settings of a scenario for the page of lessons: in working units, with notes on what the page replaces."""

from dataclasses import dataclass
from typing import Any, Final

from rubnoise.contact.births import BirthLaw, PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Law, Normal
from rubnoise.errors import Refused
from rubnoise.model import Model
from rubnoise.scenario import Scenario

LESSON_STRENGTH: Final = 250.0
LESSON_SPEED: Final = 1000.0
LESSON_SLIDER: Final = {"mass": 0.005, "stiffness": 300.0, "damping": 0.05}
"""Strength (MPa), speed (um/s) and slider (kg, N/m, N s/m) of the paper's Figure 5, if a scenario has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LessonSettings:
    """The knobs of the page as a scenario sets them, the distance of its run in um, and where its slider starts.

    ``coupling`` is "one-way" or "two-way": whether the slider pushes back.
    ``borrowed`` names the tables that the scenario lacks and that were taken from the paper's Figure 5.
    """

    world: dict[str, Any]
    distance: float
    slider_start: str
    coupling: str
    borrowed: tuple[str, ...]


def settings_of(scenario: Scenario) -> LessonSettings:
    """Return the settings of a scenario for the page.

    Raises Refused for sizes that are neither equal nor normal, for strengths that differ, for births that are neither
    random nor regular, and for other lives than lenses off the centre line: the page cannot draw them.
    """
    model = scenario.model()
    if model.pulse.offset != "none" and model.pulse.shape != "lens":
        raise Refused("the page of lessons knows passes off the centre line of lenses alone (pulse.offset)")
    lacking = {"strength": model.strengths, "sliding.speed": model.sliding_speed, "slider": model.slider}
    slider = model.slider
    return LessonSettings(
        world={
            "meanArea": model.mean_real_contact_area,
            "meanCount": model.mean_junction_count,
            "spread": _spread(model.sizes),
            "births": _births(model.births),
            "pulse": model.pulse.shape,
            "offset": model.pulse.offset,
            "calibration": model.calibration,
            "speed": model.sliding_speed or LESSON_SPEED,
            "strength": _strength(model),
            **({name: getattr(slider, name) for name in LESSON_SLIDER} if slider else LESSON_SLIDER),
            "seed": scenario.run.seed,
        },
        distance=model.distance,
        slider_start=slider.start if slider else "equilibrium",
        coupling="two-way" if model.is_two_way else "one-way",
        borrowed=tuple(name for name, found in lacking.items() if found is None),
    )


def _births(births: BirthLaw) -> str:
    for name, kind in (("regular", RegularBirths), ("poisson", PoissonBirths)):
        if isinstance(births, kind):
            return name
    raise Refused("the page of lessons knows poisson and regular births alone (birth.law)")


def _spread(sizes: Law) -> float:
    if isinstance(sizes, Fixed):
        return 0.0
    if isinstance(sizes, Normal):
        return sizes.std
    raise Refused("the page of lessons knows fixed and normal diameters alone (diameter.law)")


def _strength(model: Model) -> float:
    if model.strengths is None:
        return LESSON_STRENGTH
    if isinstance(model.strengths, Fixed):
        return model.strengths.mean
    raise Refused("the page of lessons knows equal strengths alone (strength.law)")
