"""Changes of a result that nothing else in it contradicts, if the hash of its attributes is corrected too.

These are the ones that docs/verifying.md lists: what only the machine and the moment of the run knew.
"""

import json
import re
import tomllib
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from shlex import join, split
from typing import Any, Final

import h5py

from fuzz.changing import Places
from rubnoise import build
from rubnoise.errors import RubnoiseError
from rubnoise.scenario.reading import loads
from rubnoise.scenario.scenario import flattened

TIME: Final = "%Y-%m-%dT%H:%M:%SZ"
VERSION: Final = re.compile(r"[0-9][0-9A-Za-z.+!_-]*|not installed")
CLOSE: Final = {"_exact": 1e-6, "_standard_error": 1e-4, "": 1e-9}
"""By how much a figure may differ from what it is worked out to be, by the end of its name."""


def is_hidden(right: Path, changed: Path, places: Places) -> bool:
    """Whether a change of one attribute is one that `verify` cannot find."""
    (place,) = places
    with h5py.File(right) as before, h5py.File(changed) as after:
        if place.attribute not in before[place.path].attrs:
            return False
        one, two = (file[place.path].attrs[place.attribute] for file in (before, after))
        if place.path == "/summary" and not isinstance(one, bytes):
            end = next(end for end in CLOSE if place.attribute.endswith(end))
            return bool(abs(two - one) <= CLOSE[end] * abs(one))
        told = HIDDEN.get((place.path, place.attribute))
        return told is not None and isinstance(two, bytes) and told(one.decode(), two.decode(), after)


def _title(_before: str, after: str, file: h5py.File) -> bool:
    """Without a title of the scenario it was the name of the file."""
    return not json.loads(file["provenance"].attrs["scenario_resolved"])["title"] and bool(after.strip())


def _software(before: str, after: str, _file: h5py.File) -> bool:
    one, two = _as_json(before), _as_json(after)
    right = isinstance(two, dict) and list(one) == list(two) and json.dumps(two) == after
    return right and all(VERSION.fullmatch(version) for version in two.values()) and one["rubnoise"] == two["rubnoise"]


def _environment(before: str, after: str, _file: h5py.File) -> bool:
    one, two = _as_json(before), _as_json(after)
    return (
        isinstance(two, dict) and json.dumps(two) == after and [*map(type, one.values())] == [*map(type, two.values())]
    )


def _command(before: str, after: str, _file: h5py.File) -> bool:
    """What changes the scenario stands in it as options; what another program changed is unknown."""
    try:
        one, two = split(before), split(after)
    except ValueError:
        return False
    return join(two) == after and bool(two) and (one[:2] != two[:2] or _changes(one) == _changes(two))


def _changes(words: list[str]) -> list[tuple[str, str]]:
    options = ("--set", "--seed", "--engine")
    return [(word, after) for word, after in zip(words, [*words[1:], ""], strict=True) if word.startswith(options)]


def _moment(_before: str, _after: str, file: h5py.File) -> bool:
    begun, ended = (file["provenance"].attrs[name].decode() for name in ("started", "finished"))
    try:
        right = all(datetime.strptime(each, TIME).strftime(TIME) == each for each in (begun, ended))  # noqa: DTZ007
    except ValueError:
        return False
    return right and begun <= ended


def _text(before: str, after: str, _file: h5py.File) -> bool:
    """A comment, or another way to write the same; what a text lacks may stand in the file that it extends."""
    one, two = _meant(before), _meant(after)
    if one is None or two is None:
        return False
    return one == two or ("extends" in two and two.items() <= one.items())


def _meant(text: str) -> dict[str, Any] | None:
    """Return the keys of a scenario, each as it is resolved; of one that extends another those that it gives itself."""
    try:
        given = flattened(tomllib.loads(text))
        if "extends" not in given:
            return flattened(loads(text).resolved())
        whole = flattened(
            loads(BASE + "\n".join(line for line in text.split("\n") if not line.startswith(TOP))).resolved()
        )
    except (RubnoiseError, ValueError):
        return None
    told = {key: value for key, value in given.items() if value != {}}  # a table without keys says nothing
    return {key: "another file" if key == "extends" else whole[key] for key in told}


TOP: Final = ("extends", "format")
BASE: Final = """\
format = 1
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 5
[sliding]
distance = "1 mm"
"""


def _resolved(before: str, after: str, _file: h5py.File) -> bool:
    """A key that has its default may be missing, as in a file from before there was that key."""
    try:
        return json.dumps(json.loads(after), ensure_ascii=False) == after and (
            build(json.loads(after)).resolved() == build(json.loads(before)).resolved()
        )
    except (RubnoiseError, ValueError):
        return False


def _as_json(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return None


Telling = Callable[[str, str, h5py.File], bool]

HIDDEN: Final[dict[tuple[str, str], Telling]] = {
    ("/", "title"): _title,
    ("/provenance", "software"): _software,
    ("/provenance", "environment"): _environment,
    ("/provenance", "command"): _command,
    ("/provenance", "started"): _moment,
    ("/provenance", "finished"): _moment,
    ("/provenance", "scenario_toml"): _text,
    ("/provenance", "scenario_resolved"): _resolved,
}
