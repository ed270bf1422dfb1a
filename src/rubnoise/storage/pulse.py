"""The shape of the junctions' lives in a run, as the scenario in its file tells it."""

import json
from collections.abc import Mapping

from rubnoise.contact.pulses import LENS, PULSES, Pulse
from rubnoise.errors import RunFileRefused


def pulse_of(scenario: Mapping[str, object]) -> Pulse:
    """Return the pulse of a resolved scenario; one that names none is of the lens.

    Raises RunFileRefused for a shape that is not known.
    """
    section = scenario.get("pulse", {})
    shape = section.get("shape", LENS.shape) if isinstance(section, Mapping) else section
    if not isinstance(shape, str) or shape not in PULSES:
        raise RunFileRefused(f"the scenario in the file has the pulse shape {str(shape)[:40]!r}, which is not known")
    return PULSES[shape]


def stored_pulse(scenario_resolved: object) -> Pulse:
    """Return the pulse of a resolved scenario as /provenance has it; raises RunFileRefused where it is none."""
    try:
        scenario = json.loads(str(scenario_resolved))
    except (ValueError, RecursionError) as problem:
        raise RunFileRefused("the scenario in the file cannot be read") from problem
    if not isinstance(scenario, Mapping):
        raise RunFileRefused("the scenario in the file cannot be read")
    return pulse_of(scenario)
