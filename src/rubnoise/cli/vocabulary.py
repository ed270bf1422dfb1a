"""The words of answers: the unit of each, and what there is to say beside it."""

from collections.abc import Mapping
from typing import Any, Final

from rubnoise.answer import Row
from rubnoise.figure_names import FIGURE_NAMES

_WORDS: Final = {
    "um": "calibrated_diameter mean_diameter mean_life_distance mean_birth_spacing needed_distance diameter"
    " life_distance lateral_offset mean_displacement amplitude base_mean base_std first_order_separation_std cutoff"
    " longest slider_length mean_life correlation_length height_scale spacing lag distance separation displacement"
    " Sa Sq",
    "um^2": "area_mean fast_area_mean max_area area real_contact_area nominal_area map_area",
    "um/s": "first_order_velocity_std slowest fastest velocity normal_velocity",
    "uN": "load force_mean mean_force force friction_force",
    "s": "period time",
    "1/s": "upcrossing_rate",
    "1/um": "birth_rate",
    "rad/um": "wavenumber",
    "Hz": "natural_frequency contact_resonance frequency",
    "dB": "velocity_level",
    "MPa": "shear_strength",
    "N*s/m": "border",
    "uN^2*s": "force_density",
    "B": "bytes disk_needed peak_memory working_memory",
}
UNITS: Final = {name: figure.unit for name, figure in FIGURE_NAMES.items()} | {
    word: unit for unit, words in _WORDS.items() for word in words.split()
}
"""The unit of each number by its name, those of a summary among them; numbers of other names have none."""

NOTES: Final = {
    "mean_life_distance": "L_jm",
    "mean_birth_spacing": "s_jm",
    "one_way_validity": "std of velocity over sliding speed",
    "coupling_strength": "Pi; weak below 0.03",
    "stick_number": "theta; a slow slider sticks above 1",
    "expected_change": "std of displacement, two-way over one-way",
    "load_variation": "of the load that it takes, std over mean",
    "relative_speed": "V over c omega_c",
    "relative_frequency": "omega_0 over omega_c",
    "velocity_level": "re 50 nm/s",
    "fast_area_mean": "at high speeds",
    "live": "N, mean number of junctions in contact at rest",
    "impact_damping": "times s_0 omega_c",
    "suppression": "of the excitation at constant separation",
    "bytes": "before compression, if any",
    "working_memory": "without the program's",
}
"""What there is to say beside a number."""


def named(part: str, known: Mapping[str, Any], notes: Mapping[str, str] = NOTES) -> list[Row]:
    """Return what is known by name as rows of a part, with units and notes; None is left out."""
    return [
        Row(part=part, name=name, value=value, unit=UNITS.get(name, ""), note=notes.get(name, ""))
        for name, value in known.items()
        if value is not None
    ]


def fields_of(source: Any, names: str) -> dict[str, Any]:
    """Return attributes by their names, which stand between spaces."""
    return {name: getattr(source, name) for name in names.split()}
