"""A template of a scenario: every key of this version with its meaning, written from the definitions of the keys."""

from collections.abc import Iterator
from textwrap import wrap
from typing import Any, Final

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from rubnoise.scenario.document import Document, Section
from rubnoise.scenario.fields import Choice
from rubnoise.scenario.keys import BIRTH_SAMPLES, LAW_SAMPLES, SECTIONS, SWEEP
from rubnoise.scenario.sweep_table import GRID, Sweeping
from rubnoise.scenario.writing import toml_value

WIDTH: Final = 100
HEADING: Final = """\
# A rubnoise scenario in TOML. Write a quantity as a text with its unit, and a plain number as a number.
# A line that begins with # is a comment; remove the # to set an optional key. A key marked "Needed." is
# required. All other values are defaults, and you may delete their lines."""
EXTENDS: Final = "A scenario file to extend, relative to this one; keys in this file replace its keys."

SAMPLES: Final[dict[tuple[str, str], Any]] = {
    ("interface", "mean_real_contact_area"): "200 um^2",
    ("interface", "load"): "0.2 N",
    ("interface", "hardness"): "1 GPa",
    ("interface", "mean_junction_count"): 20,
    ("interface", "patch_area"): "10 um^2",
    ("diameter", "spread"): "10 %",
    ("diameter", "weights"): [0.7, 0.3],
    ("diameter", "parts"): [{"law": "fixed", "mean": 4.0}, {"law": "normal", "mean": 9.0, "spread": "20 %"}],
    ("diameter", "values"): [4.1, 5.3, 6.0],
    ("diameter", "sampled"): "alive",
    ("diameter", "file"): "sizes.csv",
    ("diameter", "column"): "diameter",
    ("diameter", "hash"): "2b2a067e28d6b407c6503c591e07fe6db2e0bf09bff4e5ac753fa369e2e7cc35",
    **{(table, key): value for table in ("diameter", "strength") for key, value in LAW_SAMPLES.items()},
    **{("birth", key): value for key, value in BIRTH_SAMPLES.items()},
    ("strength", "mean"): "250 MPa",
    ("strength", "spread"): "20 %",
    ("sliding", "distance"): "40 mm",
    ("sliding", "speed"): "20 mm/s",
    ("slider", "mass"): "50 g",
    ("slider", "stiffness"): "100 kN/m",
    ("slider", "damping"): "5 N*s/m",
    ("slider", "damping_ratio"): 0.02,
    ("slider", "tolerance"): 1e-9,
    ("load", "height_scale"): "0.5 um",
    ("load", "mass"): "5 g",
    ("load", "damping"): "4 N*s/m",
    ("load", "damping_ratio"): 0.05,
    ("load", "restitution"): 0.7,
    ("load", "impact_damping"): "60 s/m",
    ("slider", "excitation"): "friction",
    ("slider", "asperity_height"): "2 %",
    ("slider", "heights"): "sum",
    ("slider", "slope"): "10 N*s/m",
    ("output", "tick"): "0.1 um",
    (SWEEP, "precision"): 0.005,
}
"""A sensible value for every key that has no default: those of the scenario first/rubbing."""

VARIED: Final = "Each value of a key is combined with each value of the others; lists of [sweep.zip] go in parallel."

WITH_SLIDER: Final = ("strength", "slider")
"""Optional tables that the template sets, so that a first run has a motion to look at and to listen to."""

SET: Final = (
    ("interface", "mean_real_contact_area"),
    ("interface", "mean_junction_count"),
    ("sliding", "speed"),
    ("slider", "damping"),
)
"""Keys without a default that the template sets beside those that are needed."""

REMARKS: Final[dict[tuple[str, str], str]] = {
    ("slider", "damping_ratio"): "Instead of damping.",
    ("load", "damping_ratio"): "Instead of damping.",
    ("load", "restitution"): "Only for free motion.",
    ("load", "impact_damping"): "Only for free motion.",
    ("slider", "tolerance"): "Only for two-way coupling.",
}


def template() -> str:
    """Return the text of a scenario that runs as it is, with all optional keys as comments."""
    lines = [HEADING, *_key("format", 1, Document.model_fields["format"])]
    lines += [*_comment(EXTENDS), '#extends = "base.toml"']
    lines += _key("title", "", Document.model_fields["title"])
    for name, section in SECTIONS.items():
        lines += ["", *_section_lines(name, section)]
    return "\n".join([*lines, "", *_sweep()]) + "\n"


def _section_lines(name: str, section: type[Section] | Any) -> Iterator[str]:
    """Yield the lines of a table; all lines of an optional table are comments."""
    optional = Document.model_fields[name].default is None
    off = optional and name not in WITH_SLIDER
    text = " ".join((section.__doc__ or "").split())
    yield from _comment(f"{text} This table is optional." if optional else text)
    yield f"{'#' if off else ''}[{name}]"
    for key, about in section.model_fields.items():
        value = _value(name, key, about)
        unset = off or (not about.is_required() and about.default is None and (name, key) not in SET)
        yield from _key(key, value, about, off=unset, remark=REMARKS.get((name, key), ""))


def _sweep() -> Iterator[str]:
    """Yield the table [sweep] as a comment, with an example of swept keys."""
    yield from _comment(f"{Sweeping.__doc__} This table is optional; `rubnoise sweep` makes the runs.")
    yield f"#[{SWEEP}]"
    for key, about in Sweeping.model_fields.items():
        yield from _key(key, _value(SWEEP, key, about), about, off=True)
    yield from _comment(VARIED)
    yield f"#[{SWEEP}.{GRID}]"
    yield "#interface.mean_junction_count = [10, 20, 40]"


def _value(table: str, key: str, about: FieldInfo) -> Any:
    given = about.default not in (None, PydanticUndefined)
    return about.default if given else SAMPLES[table, key]


def _key(key: str, value: Any, about: FieldInfo, *, off: bool = False, remark: str = "") -> Iterator[str]:
    need = "Needed." if about.is_required() else ""
    yield from _comment(" ".join(filter(None, (about.description, _choices(about), need, remark))))
    yield f"{'#' if off else ''}{key} = {toml_value(value)}"


def _choices(about: FieldInfo) -> str:
    """Return the words of a choice, if its description does not name all of them."""
    words = next((each.available for each in about.metadata if isinstance(each, Choice)), ())
    missing = [word for word in words if word not in (about.description or "")]
    return f"One of {', '.join(words)}." if missing else ""


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in wrap(text, WIDTH - 2, break_long_words=False, break_on_hyphens=False)]
