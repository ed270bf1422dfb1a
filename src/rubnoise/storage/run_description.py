"""Read the description of a run back from the attributes of its file, and compare the file's structure with it."""

import json
import os
from collections.abc import Iterator, Mapping
from functools import lru_cache
from itertools import islice
from typing import Any, Final, Literal

from rubnoise.errors import RunFileRefused
from rubnoise.record.sink import Extent
from rubnoise.storage import disk
from rubnoise.storage.inventory import OF_HDF5, Inventory, expected_inventory
from rubnoise.storage.layout import ByteRange, Name, RunDescription, between, digest_of
from rubnoise.storage.life_curve import pulse_of
from rubnoise.storage.provenance import Provenance
from rubnoise.storage.reader import RunFile, refusing
from rubnoise.storage.run_structure import INTERVENTION
from rubnoise.storage.schema import HASH, Feature, Scalar

SHOWN = 40
"""Characters of a value that are shown when it is refused."""


def description_of(run: RunFile) -> RunDescription:
    """Return the description from which a run file was made; raises RunFileRefused if the file does not have it."""
    title, origin = str(run.attributes["title"]), run.provenance
    with refusing(run.path):
        return description(title, origin, run.extent, run.features)


def description(
    title: str, origin: Mapping[str, Scalar], extent: Extent, features: frozenset[Feature]
) -> RunDescription:
    """Return the description in the attributes of a file; raises RunFileRefused if one is not as we write it."""
    scenario = _json_table(origin, "scenario_resolved")
    pulse_of(scenario)
    return RunDescription(
        title=title,
        extent=extent,
        features=features,
        compression=_compression(scenario),
        scenario_toml=str(origin["scenario_toml"]),
        scenario_resolved=scenario,
        provenance=Provenance(
            software=_json_table(origin, "software"),
            environment=_json_table(origin, "environment"),
            seed=_whole(origin, "seed"),
            stream_version=_whole(origin, "stream_version"),
            calibrated_diameter=_real(origin, "calibrated_diameter"),
            propagator_constants=_json_table(origin, "propagator_constants"),
            command=str(origin["command"]),
            started=str(origin["started"]),
            intervention=str(origin.get(INTERVENTION, "")),
        ),
    )


def _compression(scenario: Mapping[str, Any]) -> Literal["none", "gzip"]:
    output = scenario.get("output", {})
    if not isinstance(output, Mapping):
        raise RunFileRefused(f"/provenance scenario_resolved has {_shortened_json(output)} for output, not a table")
    return "gzip" if output.get("compression") == "gzip" else "none"


def _json_table(origin: Mapping[str, Scalar], name: str) -> dict[str, Any]:
    """Return the table in a JSON text."""
    try:
        parsed = json.loads(str(origin[name]))
    except (ValueError, RecursionError) as problem:
        raise RunFileRefused(f"/provenance {name} is no JSON that can be read") from problem
    if not isinstance(parsed, dict):
        raise RunFileRefused(f"/provenance {name} is {_shortened_json(parsed)}, not a table of values by name")
    return parsed


def _whole(origin: Mapping[str, Scalar], name: str) -> int:
    value = origin[name]
    if not isinstance(value, int):
        raise RunFileRefused(f"/provenance {name} is {_shortened_json(value)}, not a whole number")
    return value


def _real(origin: Mapping[str, Scalar], name: str) -> float:
    value = origin[name]
    if isinstance(value, str):
        raise RunFileRefused(f"/provenance {name} is {_shortened_json(value)}, not a number")
    return float(value)


def _shortened_json(value: object) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


ELSEWHERE: Final = frozenset({"/ attribute source", f"/provenance attribute {HASH}"})
"""Attributes that say which version of the program began a run, and the hash that goes with them: checked by value."""


def check_structure(run: RunFile) -> None:
    """Raise RunFileRefused if anything in a part's structure is missing, additional, or not as the program makes it.

    A part may be damaged, or made by anybody, where no row and no hash shows it: units, names, meanings, links between
    columns, an additional group.
    Its ``structure`` is read before the inspection, so that any later change is seen.
    """
    _ = rest_digest(run)
    ending = None
    if finished := str(run.provenance["finished"]):
        names = [(group, name) for group, columns in run.columns.items() for name in columns]
        ending = {each: run.digest(*each) for each in names}, run.summary, finished
    expected = expected_inventory(description_of(run), compressed=run.is_compressed, ending=ending)
    with refusing(run.path):
        if wrong := list(islice(_differences(run.inventory(), expected), 3)):
            raise RunFileRefused(f"damaged: {'; '.join(wrong)}")


STRUCTURE_LIMIT: Final = 8 * 1024**2
"""Bytes that are no rows, at most: a part has some 100 kB of them, and the texts of its scenario."""


def places_of(run: RunFile) -> dict[Name, ByteRange]:
    """Return the places of the columns of a file; compressed columns have no place of their own."""
    return {
        (group, name): ByteRange(offset=place.offset, rows=place.rows, dtype=place.dtype)
        for group, columns in run.stored.items()
        for name, place in columns.items()
    }


@lru_cache(maxsize=4)
def rest_digest(run: RunFile) -> str:
    """Return a hash of everything in a file except its rows, taken at the first request; empty for a compressed file.

    Raises RunFileRefused if it is larger than that of any run.
    """
    if run.is_compressed:
        return ""
    with refusing(run.path):
        rest = between(places_of(run).values(), os.fstat(run.descriptor).st_size)
        if sum(map(len, rest)) > STRUCTURE_LIMIT:
            raise RunFileRefused(f"holds {sum(map(len, rest)):,} bytes that are no rows")
        return digest_of((place.start, disk.read(run.descriptor, len(place), place.start)) for place in rest)


def _differences(there: Inventory, right: Inventory) -> Iterator[str]:
    """Yield the differences between a file and the one that its description makes, rows left out."""
    found, expected = dict(_places(there)), dict(_places(right))
    for place in sorted({*found, *expected}):
        if place not in found:
            yield f"{place} is missing"
        elif place not in expected:
            yield f"{place} belongs to no run"
        elif found[place] != expected[place] and place not in ELSEWHERE:
            yield f"{place} is not that of a run"


def _places(objects: Inventory) -> Iterator[tuple[str, str]]:
    """Yield the storage and the attributes of each object as JSON, in which nan equals nan, and -0 differs from 0."""
    for path, about in objects.items():
        yield path, json.dumps({name: value for name, value in about.items() if name != "attributes"})
        for name, attribute in about["attributes"].items():
            yield f"{path} attribute {name}", json.dumps(attribute["value"] if name in OF_HDF5 else attribute)
