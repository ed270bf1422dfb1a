"""Compare everything in a file except its rows with what the program itself would write.

The expected content is composed from the scenario by the code that composes results. So every fixed or derived value
is compared to the last bit, also that of a new attribute, and only values that do not follow from the scenario have a
rule in RULES.
"""

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from shlex import join, split
from typing import Any, Final

from rubnoise.analysis.answer import LeftOut
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.record.reader import HashedReader
from rubnoise.scenario import Scenario
from rubnoise.scenario.scenario import flattened
from rubnoise.simulation.run import slider_constants
from rubnoise.storage.inventory import DATASET, OF_HDF5, Inventory, expected_inventory, form_of_text
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.provenance import TIME, Provenance, environment, software
from rubnoise.storage.schema import HASH, INTERVENTION, Scalar
from rubnoise.streams import STREAM_VERSION

VERSION: Final = re.compile(r"[0-9][0-9A-Za-z.+!_-]*|not installed")
_DIGEST: Final = re.compile(r"[0-9a-f]{32}")


def digits_form(text: str) -> str | None:
    """Return the right form of a hash, or None if the value has it."""
    return None if _DIGEST.fullmatch(text) else "32 hexadecimal digits"


def command_form(text: str) -> str | None:
    """Return the right form of a command line, or None if the value has it."""
    try:
        right = bool(text) and join(split(text)) == text
    except ValueError:
        right = False
    return None if right else "a command line as a shell reads it"


def moment_form(text: str) -> str | None:
    """Return the right form of a time, or None if the value has it."""
    return None if moment(text) else "a time in UTC such as 2026-01-31T12:00:00Z"


def moment(text: str) -> datetime | None:
    """Return the time in a text of the form that results use; None for another text."""
    try:
        found = datetime.strptime(text, TIME).replace(tzinfo=UTC)
    except ValueError:
        return None
    return found if found.strftime(TIME) == text else None


def parsed(text: object) -> Any:
    """Return the value of a JSON text; None for another text."""
    try:
        return json.loads(str(text))
    except (ValueError, RecursionError):
        return None


Rule = Callable[[str], str | None]
"""Returns what a text should be, in words or as it should stand there; None if it is right."""

Rules = Mapping[tuple[str, str], Rule]
"""Rules by the path of an object and the name of its attribute; other attributes are as they are expected."""

LONGEST: Final = 160
"""Characters of a value that are shown."""


def compare_structure(notes: Notes, found: Inventory, expected: Inventory) -> None:
    """Note each group or column that is missing, additional, or stored in another way."""
    for path in dict.fromkeys([*expected, *found]):
        there, right = found.get(path, {}), expected.get(path, {})
        notes.say(path, found=there.get("kind", "missing"), expected=right.get("kind", "nothing of this name"))
        if there.get("kind") == right.get("kind") == DATASET:
            for about in ("type", "shape", "storage"):
                notes.say(f"{path} {about}", found=there[about], expected=right[about])


def compare_attributes(
    notes: Notes, rules: Rules, found: Inventory, expected: Inventory, *, free: tuple[str, ...] = ()
) -> None:
    """Note each attribute that is missing, unknown or wrong; of hashes of columns only the form is checked.

    ``free`` objects may have further numbers: only the type of those is checked.
    """
    for path in (path for path in expected if path in found):
        there, right = found[path]["attributes"], expected[path]["attributes"]
        for name in dict.fromkeys([*right, *there]):
            if path in free and name not in right:
                form = (there[name]["type"], there[name]["shape"])
                notes.say(f"{path} {name} type", found=form, expected=("<f8", []))
            elif name in right and name in there:
                rule = rules.get((path, name)) or (digits_form if name == HASH else None)
                _compare(notes, f"{path} {name}", rule, there[name], right[name])
            else:
                notes.say(
                    f"{path} {name}",
                    found=shown(there[name]["value"]) if name in there else "missing",
                    expected=shown(right[name]["value"]) if name in right else "no attribute of this name",
                )


def shown(value: Any) -> str:
    """Return a value as text, cut short if it is long."""
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}... ({len(text)} characters)"


def _compare(notes: Notes, place: str, rule: Rule | None, there: Mapping[str, Any], right: Mapping[str, Any]) -> None:
    value, name = there["value"], place.rpartition(" ")[2]
    if rule is not None and isinstance(value, str):
        should = rule(value)
        notes.say(place, found=shown(value), expected=shown(value) if should is None else should)
        right = form_of_text(value)
    elif json.dumps(value) != json.dumps(right["value"]):
        notes.say(place, found=shown(value), expected=shown(right["value"]))
        return
    form = ("type", "shape")
    same = name in OF_HDF5 or all(there[about] == right[about] for about in form)
    found, expected = ([each[about] for about in form] for each in (there, right))
    notes.say(f"{place} type", found=expected if same else found, expected=expected)


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """The file to which rules apply: its scenario, and the attributes of its origin."""

    scenario: Scenario
    provenance: Mapping[str, Scalar]

    @property
    def version(self) -> object:
        """The version of rubnoise that wrote the file, if it is known."""
        given = parsed(self.provenance["software"])
        return given.get("rubnoise") if isinstance(given, dict) else None


Asked = Callable[[Subject, str], str | None]
"""A rule of a file of which more has to be known than the text itself."""


def _title(subject: Subject, text: str) -> str | None:
    """Rule for the title of the scenario; without one it was the name of the file, which may have changed since."""
    title = subject.scenario.title
    if title:
        return None if text == title else title
    return None if text.strip() else "the name that the file was given"


def _source(subject: Subject, text: str) -> str | None:
    expected = f"rubnoise {subject.version}"
    return None if text == expected else f"{expected}, as in software"


def _software(_subject: Subject, text: str) -> str | None:
    names = list(software())
    given = parsed(text)
    if not isinstance(given, dict) or json.dumps(given) != text or list(given) != names:
        return f"a JSON object with the versions of {', '.join(names)}"
    wrong = [name for name, value in given.items() if not isinstance(value, str) or not VERSION.fullmatch(value)]
    return f"a version of {wrong[0]} such as 1.2.3" if wrong else None


def _environment(_subject: Subject, text: str) -> str | None:
    like = environment()
    given = parsed(text)
    right = (
        isinstance(given, dict)
        and json.dumps(given) == text
        and [(name, type(value)) for name, value in given.items()] == [(name, type(like[name])) for name in like]
        and given["cpu_count"] >= 0
    )
    return None if right else f"a JSON object with {', '.join(like)}"


def clock_notes(provenance: Mapping[str, Scalar]) -> list[LeftOut]:
    """Return a note if a run ended before it began: a clock may be set back, so that is not a fault of the file."""
    begun, ended = (moment(str(provenance[name])) for name in ("started", "finished"))
    if begun is None or ended is None or ended >= begun:
        return []
    return [LeftOut(name="finished", reason="it lies before started: the clock was set back during the run")]


def _resolved(subject: Subject, text: str) -> str | None:
    """Rule for the resolved scenario: every key as written today; newer keys at their defaults may be missing."""
    given = parsed(text)
    if not isinstance(given, dict) or json.dumps(given, ensure_ascii=False) != text:
        return "JSON as the program writes it"
    there, here = flattened(given), flattened(subject.scenario.resolved())
    for key, value in there.items():
        if json.dumps(here.get(key)) != json.dumps(value):
            return f"{key} = {json.dumps(here.get(key), ensure_ascii=False)}"
    return None


def _constants(subject: Subject, text: str) -> str | None:
    """Rule for the constants of the slider's step, to the last bit; another check derives them in another way."""
    constants = slider_constants(subject.scenario.model())
    named = {} if constants is None else constants.named()
    if text == json.dumps(named):
        return None
    given = parsed(text)
    if not isinstance(given, dict):
        return json.dumps(named)
    key = next((key for key, value in named.items() if json.dumps(given.get(key)) != json.dumps(value)), None)
    return f"{key} = {named[key]!r}" if key else "nothing but the constants of the slider's step"


RULES: Final[Mapping[tuple[str, str], Asked]] = {
    ("/", "title"): _title,
    ("/", "source"): _source,
    ("/provenance", "scenario_toml"): lambda _subject, _text: None,  # a check of its own compares it
    ("/provenance", "scenario_resolved"): _resolved,
    ("/provenance", "software"): _software,
    ("/provenance", "environment"): _environment,
    ("/provenance", "propagator_constants"): _constants,
    ("/provenance", "command"): lambda _subject, text: command_form(text),
    ("/provenance", "started"): lambda _subject, text: moment_form(text),
    ("/provenance", "finished"): lambda _subject, text: moment_form(text),
    ("/provenance", HASH): lambda _subject, text: digits_form(text),
}
"""What the scenario alone does not fix to the last character; hashes of columns are compared with their columns."""


def attribute_checks(scenario: Scenario, run: HashedReader, found: Inventory) -> list[Check]:
    """Check that a file has the groups, columns and attributes of a run of its scenario, and no others."""
    expected = expected_inventory(_description(scenario, run))
    structure, attributes = Notes("structure"), Notes("attributes")
    compare_structure(structure, found, expected)
    subject = Subject(scenario=scenario, provenance=run.provenance)
    rules = {place: partial(asked, subject) for place, asked in RULES.items()}
    compare_attributes(attributes, rules, found, expected, free=("/summary",))
    return [structure.check(), attributes.check()]


def _description(scenario: Scenario, run: HashedReader) -> RunDescription:
    """Return the description of a run of the scenario; values that it does not determine are empty, and have a rule."""
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
            intervention=str(run.provenance.get(INTERVENTION, "")),
        ),
    )
