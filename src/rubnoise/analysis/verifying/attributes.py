"""Everything that a file holds beside its rows, compared with what the program itself would write there.

What is expected is composed anew from the scenario, by the code that composes results. So whatever is written with a
fixed or derived value is compared to the last bit, a new attribute as well, and only what cannot be known from the
scenario has a rule in RULES.
"""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Final

from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.analysis.verifying.forms import VERSION, command_form, digits_form, moment, moment_form, parsed
from rubnoise.analysis.verifying.inventories import compare_attributes, compare_structure
from rubnoise.record.reader import HashedReader
from rubnoise.scenario import Scenario
from rubnoise.scenario.scenario import flattened
from rubnoise.simulation.run import slider_constants
from rubnoise.storage.inventory import Inventory, expected_inventory
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.provenance import Provenance, environment, software
from rubnoise.storage.schema import HASH, Scalar
from rubnoise.storage.seal import INTERVENTION
from rubnoise.streams import STREAM_VERSION


@dataclass(frozen=True, slots=True, kw_only=True)
class Subject:
    """The file that rules are asked about: its scenario, and what it says of its origin."""

    scenario: Scenario
    provenance: Mapping[str, Scalar]

    @property
    def version(self) -> object:
        """The version of rubnoise that wrote the file, as far as that can be told."""
        told = parsed(self.provenance["software"])
        return told.get("rubnoise") if isinstance(told, dict) else None


Asked = Callable[[str, Subject], str | None]
"""A rule of a file of which more has to be known than the text itself."""


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
    told = parsed(text)
    if not isinstance(told, dict) or json.dumps(told) != text or list(told) != names:
        return f"a JSON object with the versions of {', '.join(names)}"
    wrong = [name for name, value in told.items() if not isinstance(value, str) or not VERSION.fullmatch(value)]
    return f"a version of {wrong[0]} such as 1.2.3" if wrong else None


def _environment(text: str, _subject: Subject) -> str | None:
    like = environment()
    told = parsed(text)
    right = (
        isinstance(told, dict)
        and json.dumps(told) == text
        and [(name, type(value)) for name, value in told.items()] == [(name, type(like[name])) for name in like]
        and told["cpu_count"] >= 0
    )
    return None if right else f"a JSON object with {', '.join(like)}"


def _finished(text: str, subject: Subject) -> str | None:
    begun, ended = moment(str(subject.provenance["started"])), moment(text)
    if ended is None:
        return moment_form(text)
    return f"at or after {subject.provenance['started']}" if begun is not None and ended < begun else None


def _resolved(text: str, subject: Subject) -> str | None:
    """Every key as it is written for this scenario; keys that came later, whose defaults hold, may be missing."""
    told = parsed(text)
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
    told = parsed(text)
    if not isinstance(told, dict):
        return json.dumps(named)
    key = next((key for key, value in named.items() if json.dumps(told.get(key)) != json.dumps(value)), None)
    return f"{key} = {named[key]!r}" if key else "nothing but the constants of the slider's step"


def _any_text(_text: str, _subject: Subject) -> str | None:
    """Right as it is here: a check of its own compares it with the scenario."""
    return None


RULES: Final[Mapping[tuple[str, str], Asked]] = {
    ("/", "title"): _title,
    ("/", "source"): _source,
    ("/provenance", "scenario_toml"): _any_text,
    ("/provenance", "scenario_resolved"): _resolved,
    ("/provenance", "software"): _software,
    ("/provenance", "environment"): _environment,
    ("/provenance", "propagator_constants"): _constants,
    ("/provenance", "command"): lambda text, _subject: command_form(text),
    ("/provenance", "started"): lambda text, _subject: moment_form(text),
    ("/provenance", "finished"): _finished,
    ("/provenance", HASH): lambda text, _subject: digits_form(text),
}
"""What the scenario alone does not tell to the last character; hashes of columns are compared with their columns."""


def attribute_checks(scenario: Scenario, run: HashedReader, found: Inventory) -> list[Check]:
    """Return whether a file has the groups, columns and attributes that a run of its scenario has, and no others."""
    expected = expected_inventory(_description(scenario, run))
    structure, attributes = Notes("structure"), Notes("attributes")
    compare_structure(structure, found, expected)
    subject = Subject(scenario=scenario, provenance=run.provenance)
    rules = {place: partial(_asked, asked, subject) for place, asked in RULES.items()}
    compare_attributes(attributes, rules, found, expected, free=("/summary",))
    return [structure.check(), attributes.check()]


def _asked(asked: Asked, subject: Subject, text: str) -> str | None:
    return asked(text, subject)


def _description(scenario: Scenario, run: HashedReader) -> RunDescription:
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
            intervention=str(run.provenance.get(INTERVENTION, "")),
        ),
    )
