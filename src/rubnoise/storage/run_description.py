"""The description of a run, read back from the attributes of its file."""

import json
from collections.abc import Mapping
from typing import Any, Literal

from rubnoise.errors import RunFileRefused
from rubnoise.record.sink import Extent
from rubnoise.storage.layout import RunDescription
from rubnoise.storage.life_curve import pulse_of
from rubnoise.storage.provenance import Provenance
from rubnoise.storage.reader import RunFile, refusing
from rubnoise.storage.schema import Feature, Scalar
from rubnoise.storage.seal import INTERVENTION

SHOWN = 40
"""Characters of a value that are shown where it is refused."""


def description_of(run: RunFile) -> RunDescription:
    """Return the description from which a run file was made; raises RunFileRefused if it does not say."""
    title, origin = str(run.attributes["title"]), run.provenance
    with refusing(run.path):
        return description(title, origin, run.extent, run.features)


def description(
    title: str, origin: Mapping[str, Scalar], extent: Extent, features: frozenset[Feature]
) -> RunDescription:
    """Return the description that attributes of a file hold; raises RunFileRefused if one is none of ours."""
    scenario = _table(origin, "scenario_resolved")
    pulse_of(scenario)
    return RunDescription(
        title=title,
        extent=extent,
        features=features,
        compression=_compression(scenario),
        scenario_toml=str(origin["scenario_toml"]),
        scenario_resolved=scenario,
        provenance=Provenance(
            software=_table(origin, "software"),
            environment=_table(origin, "environment"),
            seed=_whole(origin, "seed"),
            stream_version=_whole(origin, "stream_version"),
            calibrated_diameter=_number(origin, "calibrated_diameter"),
            propagator_constants=_table(origin, "propagator_constants"),
            command=str(origin["command"]),
            started=str(origin["started"]),
            intervention=str(origin.get(INTERVENTION, "")),
        ),
    )


def _compression(scenario: Mapping[str, Any]) -> Literal["none", "gzip"]:
    output = scenario.get("output", {})
    if not isinstance(output, Mapping):
        raise RunFileRefused(f"/provenance scenario_resolved has {_shown(output)} for output, not a table")
    return "gzip" if output.get("compression") == "gzip" else "none"


def _table(origin: Mapping[str, Scalar], name: str) -> dict[str, Any]:
    """Return what a text says by name, in JSON."""
    try:
        parsed = json.loads(str(origin[name]))
    except (ValueError, RecursionError) as problem:
        raise RunFileRefused(f"/provenance {name} is no JSON that can be read") from problem
    if not isinstance(parsed, dict):
        raise RunFileRefused(f"/provenance {name} is {_shown(parsed)}, not a table of values by name")
    return parsed


def _whole(origin: Mapping[str, Scalar], name: str) -> int:
    value = origin[name]
    if not isinstance(value, int):
        raise RunFileRefused(f"/provenance {name} is {_shown(value)}, not a whole number")
    return value


def _number(origin: Mapping[str, Scalar], name: str) -> float:
    value = origin[name]
    if isinstance(value, str):
        raise RunFileRefused(f"/provenance {name} is {_shown(value)}, not a number")
    return float(value)


def _shown(value: object) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
