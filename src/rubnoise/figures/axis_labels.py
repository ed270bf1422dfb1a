"""What the figures of runs and the keys of scenarios are called on the axes of a picture."""

from typing import Final

AREA, COUNT, FORCE = "real contact area", "number of live junctions", "friction force"

QUANTITIES: Final[dict[str, tuple[str, str]]] = {
    "real_contact_area_mean": (f"mean {AREA}", "µm²"),
    "real_contact_area_std": (f"standard deviation of the\n{AREA}", "µm²"),
    "real_contact_area_skewness": (f"skewness of the\n{AREA}", ""),
    "real_contact_area_excess_kurtosis": (f"excess kurtosis of the\n{AREA}", ""),
    "junction_count_mean": (f"mean {COUNT}", ""),
    "junction_count_std": (f"standard deviation of the\n{COUNT}", ""),
    "friction_force_mean": (f"mean {FORCE}", "µN"),
    "friction_force_std": (f"standard deviation of the\n{FORCE}", "µN"),
    "displacement_mean": ("mean displacement", "µm"),
    "displacement_std": ("standard deviation of the\ndisplacement", "µm"),
    "velocity_std": ("standard deviation of the\nvelocity", "µm/s"),
    "one_way_validity": ("standard deviation of the\nvelocity over sliding speed", ""),
    "separation_std": ("standard deviation of the\nseparation", "µm"),
    "normal_velocity_std": ("standard deviation of the\nnormal velocity", "µm/s"),
    "load_mean": ("mean load", "µN"),
    "load_std": ("standard deviation of the\nload", "µN"),
}
"""Figures of a run as a label has them, and their units."""

TWO_WAY: Final[dict[str, tuple[str, str]]] = {
    "stick_fraction": ("share of the time in which\nthe slider sticks", ""),
    "sticks_per_s": ("sticks of the slider in a second", "1/s"),
    "slips_longer_than_d_per_s": ("slips longer than a mean diameter\nin a second", "1/s"),
    "reversals_per_s": ("reversals of the slider in a second", "1/s"),
    "energy_residual": ("residual of the balance of energy,\nover the work of the drive", ""),
    "mean_force_excess": ("mean friction force less\nthat over the distance", "µN"),
}
"""Those that runs with two-way coupling alone may have."""

ALL: Final = QUANTITIES | {"friction_coefficient": ("coefficient of friction", "")} | TWO_WAY


def quantity_label(name: str) -> str:
    """Return the label of a figure's axis."""
    words, unit = ALL[name]
    return f"{words} ({unit})" if unit else words


def quantity_words(name: str) -> str:
    """Return a figure in words, on one line."""
    return ALL[name][0].replace("\n", " ")


def key_label(key: str, unit: str) -> str:
    """Return the label of a swept key's axis: its name in words, and the unit that its column has."""
    return f"{key_words(key)} ({shown_unit(unit)})" if unit not in {"", "1"} else key_words(key)


def key_words(key: str) -> str:
    """Return a key in words; of one whose name is nothing without its table, that too."""
    table, _, name = key.rpartition(".")
    words = name.replace("_", " ")
    return f"{table} {words}" if name in {"law", "spread", "mean", "start", "shape", "speed"} else words


def shown_unit(unit: str) -> str:
    """Return a unit as it is printed."""
    return unit.replace("um", "µm").replace("uN", "µN").replace("^2", "²").replace("*", " ")
