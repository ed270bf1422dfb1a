"""Everything that a file holds beside its rows, compared with what the program itself would write there.

What is expected is composed anew from the scenario, by the code that composes results. So whatever is written with a
fixed or derived value is compared to the last bit, a new attribute as well, and only what cannot be known from the
scenario has a rule in RULES.
"""

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from shlex import join, split
from typing import Any, Final

from rubnoise.analysis.verifying.findings import Check
from rubnoise.analysis.verifying.hashes import is_early
from rubnoise.analysis.verifying.notes import Notes
from rubnoise.scenario import Scenario
from rubnoise.scenario.scenario import flattened
from rubnoise.simulation.run import slider_constants
from rubnoise.storage.inventory import DATASET, Inventory, expected_inventory, stored_texts
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.provenance import TIME, Provenance, environment, software
from rubnoise.storage.reader import RunFile
from rubnoise.storage.schema import BLOCKS, HASH, Scalar
from rubnoise.streams import STREAM_VERSION

OF_HDF5: Final = frozenset(("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"))
"""Attributes that HDF5 writes itself, in types of its own choice."""

LONGEST: Final = 160
"""Characters of a value that are shown."""

_VERSION: Final = re.compile(r"[0-9][0-9A-Za-z.+!_-]*|not installed")
_DIGEST: Final = re.compile(r"[0-9a-f]{32}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """The file that rules are asked about: its scenario, and what it says of its origin."""

    scenario: Scenario
    provenance: Mapping[str, Scalar]

    @property
    def version(self) -> object:
        """The version of rubnoise that wrote the file, as far as that can be told."""
        told = _parsed(self.provenance["software"])
        return told.get("rubnoise") if isinstance(told, dict) else None


Rule = Callable[[str, Subject], str | None]
"""Returns what a text should be, in words or as it should stand there; None where it is right."""


def _title(text: str, subject: Subject) -> str | None:
    """The title of the scenario; without one it was the name of the file, which may have another name by now."""
    title = subject.scenario.title
    if title:
        return None if text == title else title
    return None if text.strip() else "the name that the file was given"


def _source(text: str, subject: Subject) -> str | None:
    expected = f"rubnoise {subject.version}"
    return None if text == expected else f"{expected}, as in software"


def _software(text: str, _subject: Subject) -> str | None:
    names = list(software())
    told = _parsed(text)
    if not isinstance(told, dict) or json.dumps(told) != text or list(told) != names:
        return f"a JSON object with the versions of {', '.join(names)}"
    wrong = [name for name, value in told.items() if not isinstance(value, str) or not _VERSION.fullmatch(value)]
    return f"a version of {wrong[0]} such as 1.2.3" if wrong else None


def _environment(text: str, _subject: Subject) -> str | None:
    like = environment()
    told = _parsed(text)
    right = (
        isinstance(told, dict)
        and json.dumps(told) == text
        and {name: type(value) for name, value in told.items()} == {name: type(value) for name, value in like.items()}
        and told["cpu_count"] >= 0
    )
    return None if right else f"a JSON object with {', '.join(like)}"


def _command(text: str, _subject: Subject) -> str | None:
    try:
        right = bool(text) and join(split(text)) == text
    except ValueError:
        right = False
    return None if right else "a command line as a shell reads it"


def _started(text: str, _subject: Subject) -> str | None:
    return None if _moment(text) else "a time in UTC such as 2026-01-31T12:00:00Z"


def _finished(text: str, subject: Subject) -> str | None:
    begun, ended = _moment(str(subject.provenance["started"])), _moment(text)
    if ended is None:
        return _started(text, subject)
    return f"at or after {subject.provenance['started']}" if begun is not None and ended < begun else None


def _resolved(text: str, subject: Subject) -> str | None:
    """Every key as it is written for this scenario; keys that came later, whose defaults hold, may be missing."""
    told = _parsed(text)
    if not isinstance(told, dict) or json.dumps(told, ensure_ascii=False) != text:
        return "JSON as the program writes it"
    there, here = flattened(told), flattened(subject.scenario.resolved())
    for key, value in there.items():
        if json.dumps(here.get(key)) != json.dumps(value):
            return f"{key} = {json.dumps(here.get(key), ensure_ascii=False)}"
    return None


def _constants(text: str, subject: Subject) -> str | None:
    """The constants of the slider's step to the last bit; an origin check beside this derives them another way."""
    constants = slider_constants(subject.scenario.model())
    named = {} if constants is None else constants.named()
    if text == json.dumps(named):
        return None
    told = _parsed(text)
    if not isinstance(told, dict):
        return json.dumps(named)
    key = next((key for key, value in named.items() if json.dumps(told.get(key)) != json.dumps(value)), None)
    return f"{key} = {named[key]!r}" if key else "nothing but the constants of the slider's step"


def _digest(text: str, _subject: Subject) -> str | None:
    return None if _DIGEST.fullmatch(text) else "32 hexadecimal digits"


def _any_text(_text: str, _subject: Subject) -> str | None:
    """Right as it is here: a check of its own compares it with the scenario."""
    return None


RULES: Final[Mapping[tuple[str, str], Rule]] = {
    ("/", "title"): _title,
    ("/", "source"): _source,
    ("/provenance", "scenario_toml"): _any_text,
    ("/provenance", "scenario_resolved"): _resolved,
    ("/provenance", "software"): _software,
    ("/provenance", "environment"): _environment,
    ("/provenance", "propagator_constants"): _constants,
    ("/provenance", "command"): _command,
    ("/provenance", "started"): _started,
    ("/provenance", "finished"): _finished,
    ("/provenance", HASH): _digest,
}
"""What the scenario alone does not tell to the last character; hashes of columns are compared with their columns."""


def attribute_checks(scenario: Scenario, run: RunFile, found: Inventory) -> list[Check]:
    """Return whether a file has the groups, columns and attributes that a run of its scenario has, and no others."""
    expected = expected_inventory(_description(scenario, run))
    if is_early(run):
        del expected["/provenance"]["attributes"][HASH]
        expected = {path: about for path, about in expected.items() if not f"{path}/".startswith(f"/{BLOCKS.name}/")}
    return [
        _structure_check(found, expected),
        _attribute_check(Subject(scenario=scenario, provenance=run.provenance), found, expected),
    ]


def _description(scenario: Scenario, run: RunFile) -> RunDescription:
    """Return the description of a run of the scenario; what it does not tell is empty, and has a rule."""
    model, streams = scenario.model(), run.provenance["stream_version"]
    return RunDescription(
        title="",
        extent=run.extent,
        features=features_of(model),
        compression="gzip" if scenario.output.compression == "gzip" else "none",
        scenario_toml="",
        scenario_resolved=scenario.resolved(),
        provenance=Provenance(
            software={},
            environment={},
            seed=scenario.run.seed,
            stream_version=streams if isinstance(streams, int) and 1 <= streams <= STREAM_VERSION else STREAM_VERSION,
            calibrated_diameter=model.calibrated_diameter,
            propagator_constants={},
            command="",
            started="",
        ),
    )


def _structure_check(found: Inventory, expected: Inventory) -> Check:
    notes = Notes("structure")
    for path in dict.fromkeys([*expected, *found]):
        there, right = found.get(path, {}), expected.get(path, {})
        notes.say(path, found=there.get("kind", "missing"), expected=right.get("kind", "nothing of this name"))
        if there.get("kind") == right.get("kind") == DATASET:
            for about in ("type", "shape", "storage"):
                notes.say(f"{path} {about}", found=there[about], expected=right[about])
    return notes.check()


def _attribute_check(subject: Subject, found: Inventory, expected: Inventory) -> Check:
    notes = Notes("attributes")
    for path in (path for path in expected if path in found):
        there, right = found[path]["attributes"], expected[path]["attributes"]
        for name in dict.fromkeys([*right, *there]):
            if path == "/summary" and name not in right:
                _compare_figure(notes, name, there[name])
            elif name not in right or name not in there:
                _compare_presence(notes, f"{path} {name}", there.get(name), right.get(name))
            else:
                _compare(notes, subject, (path, name), there[name], right[name])
    return notes.check()


def _compare_figure(notes: Notes, name: str, there: Mapping[str, Any]) -> None:
    """Ask of a figure that it is a number of the right type; the check of the summary knows which there should be."""
    notes.say(f"/summary {name} type", found=(there["type"], there["shape"]), expected=("<f8", []))


def _compare_presence(
    notes: Notes, place: str, there: Mapping[str, Any] | None, right: Mapping[str, Any] | None
) -> None:
    notes.say(
        place,
        found="missing" if there is None else _shown(there["value"]),
        expected="no attribute of this name" if right is None else _shown(right["value"]),
    )


def _compare(
    notes: Notes, subject: Subject, name: tuple[str, str], there: Mapping[str, Any], right: Mapping[str, Any]
) -> None:
    place, value = " ".join(name), there["value"]
    rule = RULES.get(name) or (_digest if name[1] == HASH else None)
    if rule is not None and isinstance(value, str):
        should = rule(value, subject)
        notes.say(place, found=_shown(value), expected=_shown(value) if should is None else should)
        right = stored_texts({name[1]: value})[name[1]]
    elif json.dumps(value) != json.dumps(right["value"]):
        notes.say(place, found=_shown(value), expected=_shown(right["value"]))
        return
    of_library = name[1] in OF_HDF5
    notes.say(
        f"{place} type",
        found="of HDF5" if of_library else (there["type"], there["shape"]),
        expected="of HDF5" if of_library else (right["type"], right["shape"]),
    )


def _shown(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}... ({len(text)} characters)"


def _parsed(text: object) -> Any:
    """Return what a JSON text says, or None."""
    try:
        return json.loads(str(text))
    except (ValueError, RecursionError):
        return None


def _moment(text: str) -> datetime | None:
    try:
        moment = datetime.strptime(text, TIME).replace(tzinfo=UTC)
    except ValueError:
        return None
    return moment if moment.strftime(TIME) == text else None
