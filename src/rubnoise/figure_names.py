"""The figures of a summary, in words, with their units and the scenario key that each needs; and names in a sweep."""

from dataclasses import dataclass
from typing import Final

DONE, FAILED, PLANNED = STATES = ("done", "failed", "planned")  # what the index of a sweep says of a run

AREA, COUNT, FORCE = "real contact area", "number of live junctions", "friction force"


@dataclass(frozen=True, slots=True)
class FigureName:
    """A figure in words, broken into lines as on an axis, and its unit, which is empty for a pure number.

    ``needs`` is the table, or the key, that a scenario has if its runs have the figure.
    """

    words: str
    unit: str = ""
    needs: str = ""
    one_way: bool = False


QUANTITIES: Final = {
    "real_contact_area_mean": FigureName(f"mean {AREA}", "um^2"),
    "real_contact_area_std": FigureName(f"standard deviation of the\n{AREA}", "um^2"),
    "real_contact_area_skewness": FigureName(f"skewness of the\n{AREA}"),
    "real_contact_area_excess_kurtosis": FigureName(f"excess kurtosis of the\n{AREA}"),
    "junction_count_mean": FigureName(f"mean {COUNT}"),
    "junction_count_std": FigureName(f"standard deviation of the\n{COUNT}"),
    "friction_force_mean": FigureName(f"mean {FORCE}", "uN", "strength"),
    "friction_force_std": FigureName(f"standard deviation of the\n{FORCE}", "uN", "strength"),
    "displacement_mean": FigureName("mean displacement", "um", "slider"),
    "displacement_std": FigureName("standard deviation of the\ndisplacement", "um", "slider"),
    "velocity_std": FigureName("standard deviation of the\nvelocity", "um/s", "slider"),
    "one_way_validity": FigureName(
        "standard deviation of the\nvelocity over sliding speed", "", "slider", one_way=True
    ),
    "separation_std": FigureName("standard deviation of the\nseparation", "um", "load"),
    "normal_velocity_std": FigureName("standard deviation of the\nnormal velocity", "um/s", "load"),
    "load_mean": FigureName("mean load", "uN", "load"),
    "load_std": FigureName("standard deviation of the\nload", "uN", "load"),
}
"""Those whose precision a sweep may ask for."""

TWO_WAY: Final = {
    "stick_fraction": FigureName("share of the time in which\nthe slider sticks"),
    "sticks_per_s": FigureName("sticks of the slider in a second", "1/s"),
    "slips_longer_than_d_per_s": FigureName("slips longer than a mean diameter\nin a second", "1/s"),
    "reversals_per_s": FigureName("reversals of the slider in a second", "1/s"),
    "energy_residual": FigureName("residual of the balance of energy,\nover the work of the drive"),
    "mean_force_excess": FigureName("mean friction force less\nthat over the distance", "uN"),
}
"""Those that runs with two-way coupling alone may have."""

FIGURE_NAMES: Final = (
    QUANTITIES | {"friction_coefficient": FigureName("coefficient of friction", "", "hardness")} | TWO_WAY
)

_OTHERS: Final = {"separation_mean": "um"}  # units of figures that a comparison alone has


def unit_of(name: str) -> str:
    """Return the unit of a figure of a summary or of a moment in a comparison; empty for a pure number."""
    return FIGURE_NAMES[name].unit if name in FIGURE_NAMES else _OTHERS.get(name, "")
