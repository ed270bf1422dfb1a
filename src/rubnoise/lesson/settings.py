"""The settings of a scenario for the page of lessons: in working units, with notes on what the page replaces."""

from dataclasses import dataclass
from typing import Any, Final

from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Normal
from rubnoise.errors import Refused
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
    sizes, strengths, slider = model.sizes, model.strengths, model.slider
    known = {
        "passes off the centre line of lenses alone (pulse.offset)": model.pulse.offset == "none"
        or model.pulse.shape == "lens",
        "poisson and regular births alone (birth.law)": isinstance(model.births, PoissonBirths | RegularBirths),
        "fixed and normal diameters alone (diameter.law)": isinstance(sizes, Fixed | Normal),
        "equal strengths alone (strength.law)": strengths is None or isinstance(strengths, Fixed),
    }
    for what, holds in known.items():
        if not holds:
            raise Refused(f"the page of lessons knows {what}")
    lacking = {"strength": strengths, "sliding.speed": model.sliding_speed, "slider": slider}
    return LessonSettings(
        world={
            "meanArea": model.mean_real_contact_area,
            "meanCount": model.mean_junction_count,
            "spread": sizes.std if isinstance(sizes, Normal) else 0.0,
            "births": "regular" if isinstance(model.births, RegularBirths) else "poisson",
            "pulse": model.pulse.shape,
            "offset": model.pulse.offset,
            "calibration": model.calibration,
            "speed": model.sliding_speed or LESSON_SPEED,
            "strength": LESSON_STRENGTH if strengths is None else strengths.mean,
            **({name: getattr(slider, name) for name in LESSON_SLIDER} if slider else LESSON_SLIDER),
            "seed": scenario.run.seed,
        },
        distance=model.distance,
        slider_start=slider.start if slider else "equilibrium",
        coupling="two-way" if model.is_two_way else "one-way",
        borrowed=tuple(name for name, found in lacking.items() if found is None),
    )
