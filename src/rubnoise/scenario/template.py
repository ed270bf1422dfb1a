"""A template of a scenario: every key of this version with its meaning, written from the definitions of the keys."""

import tomllib
from collections.abc import Iterator
from textwrap import wrap
from typing import Final

from rubnoise.scenario import layers
from rubnoise.scenario.document import SECTIONS, TOP, presence
from rubnoise.scenario.fields import Choice, Key, Section, keys_of
from rubnoise.scenario.keys import GRID
from rubnoise.scenario.shipped import by_name
from rubnoise.scenario.sweep_keys import SWEEP, Sweeping
from rubnoise.scenario.text import text_of, toml_value

WIDTH: Final = 100
HEADING: Final = """\
# A rubnoise scenario in TOML. Write a quantity as a text with its unit, and a plain number as a number.
# A line that begins with # is a comment; remove the # to set an optional key. A key marked "Needed." is
# required. All other values are defaults, and you may delete their lines."""
EXTENDS: Final = "A scenario file to extend, relative to this one; keys in this file replace its keys."

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


def template() -> str:
    """Return the text of a scenario that runs as it is, with all optional keys as comments."""
    lines = [HEADING, *_key("format", TOP["format"])]
    lines += [*_comment(EXTENDS), '#extends = "base.toml"']
    lines += _key("title", TOP["title"])
    for name, section in SECTIONS.items():
        lines += ["", *_section_lines(name, section)]
    return "\n".join([*lines, "", *_sweep()]) + "\n"


def _section_lines(name: str, section: type[Section]) -> Iterator[str]:
    """Yield the lines of a table; all lines of an optional table are comments."""
    optional = presence(name) == "optional"
    off = optional and name not in WITH_SLIDER
    text = " ".join((section.__doc__ or "").split())
    yield from _comment(f"{text} This table is optional." if optional else text)
    yield f"{'#' if off else ''}[{name}]"
    for key, about in keys_of(section).items():
        unset = off or (not about.is_needed and about.default is None and (name, key) not in SET)
        yield from _key(key, about, off=unset)


def _sweep() -> Iterator[str]:
    """Yield the table [sweep] as a comment, with an example of swept keys."""
    yield from _comment(f"{Sweeping.__doc__} This table is optional; `rubnoise sweep` makes the runs.")
    yield f"#[{SWEEP}]"
    for key, about in keys_of(Sweeping).items():
        yield from _key(key, about, off=True)
    yield from _comment(VARIED)
    yield f"#[{SWEEP}.{GRID}]"
    yield "#interface.mean_junction_count = [10, 20, 40]"


def _key(key: str, about: Key, *, off: bool = False) -> Iterator[str]:
    need = "Needed." if about.is_needed else ""
    yield from _comment(" ".join(filter(None, (about.about, _choices(about), need, about.remark))))
    yield f"{'#' if off else ''}{key} = {toml_value(about.sample if about.default is None else about.default)}"


def _choices(about: Key) -> str:
    """Return the words of a choice, if its description does not name all of them."""
    words = about.kind.available if isinstance(about.kind, Choice) else ()
    missing = [word for word in words if word not in about.about]
    return f"One of {', '.join(words)}." if missing else ""


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in wrap(text, WIDTH - 2, break_long_words=False, break_on_hyphens=False)]


def copy_of(name: str) -> str:
    """Return the text of a shipped scenario as a complete file; the keys that it extends come before its own.

    Raises Refused, with near names, for an unknown name.
    """
    path = by_name(name)
    text = path.read_text(encoding="utf-8")
    if "extends" in tomllib.loads(text):
        comments = [f"{line}\n" for line in text.splitlines() if line.startswith("# ")]
        return "".join(comments) + text_of(layers.from_file(path).data)
    # A first line may name a schema, by a path that holds in the checkout alone.
    first, _, rest = text.partition("\n")
    return rest if first.startswith("#:schema") else text
