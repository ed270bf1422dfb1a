"""What a table of a scenario is: keys, each with its values, meaning and default, and nothing else."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from rubnoise.scenario.fields import Field
from rubnoise.scenario.text import toml_value


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """A key of a table: the values it takes, its meaning, its default, and whether a scenario must have it.

    ``sample`` is an ordinary value; ``form`` is what a refusal advises, if that is more than the sample; ``remark`` is
    what the template adds.
    """

    kind: Field
    about: str
    default: Any = None
    is_needed: bool = False
    sample: Any = None
    form: str = ""
    remark: str = ""


def key(kind: Field, about: str, default: Any = None, **more: Any) -> Any:
    """Return a field of a table that a scenario may leave out."""
    return field(default=default, metadata={Key: Key(kind=kind, about=about, default=default, **more)})


def needed(kind: Field, about: str, **more: Any) -> Any:
    """Return a field of a table that a scenario must have."""
    return field(metadata={Key: Key(kind=kind, about=about, is_needed=True, **more)})


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """The values of a table, all of whose keys are known."""


def keys_of(section: type[Section]) -> Mapping[str, Key]:
    """Return the keys of a table by their names."""
    return {each.name: each.metadata[Key] for each in fields(section) if Key in each.metadata}


def right_form(name: str, known: Key) -> str:
    """Return a line that sets a key, and other ways to say the same."""
    return known.form or f"{name} = {toml_value(known.default if known.sample is None else known.sample)}"
