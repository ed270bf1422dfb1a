"""How an answer, which has its values by name, is printed: as JSON without infinities, and as lines of words.

Words name values: `std {slider.velocity_std} um/s` prints a number to seven digits. After a colon stands another way to
write a value: a name of FORMS, or a format of Python.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import reduce
from math import isfinite
from operator import getitem
from string import Formatter
from typing import Any, Final

from rubnoise.cli.layout import about, duration, grouped, line, number, size

LineWords = tuple[str, ...]
"""A label and the words beside it. Of several words, the first count whose values are all known, and else the last."""


def plain(value: Any) -> str:
    """Return a value as text: a number to seven digits, yes or no, none where it is not known."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else number(value) if isinstance(value, float) else str(value)


FORMS: Final[Mapping[str, Callable[[Any], str]]] = {
    "": plain,
    "about": about,
    "change": lambda ratio: f"{ratio - 1.0:+.2%}",
    "duration": duration,
    "grouped": grouped,
    "percent": lambda share: f"{100.0 * share:.3g} %",
    "size": size,
}
"""How a value may be written, by name."""


class _Words(Formatter):
    def get_field(self, field_name: str, _args: object, kwargs: Mapping[str, Any]) -> tuple[Any, str]:
        return reduce(getitem, field_name.split("."), kwargs), field_name

    def format_field(self, value: Any, format_spec: str) -> str:
        return FORMS[format_spec](value) if format_spec in FORMS else format(value, format_spec)


def words(text: str, answer: Mapping[str, Any]) -> str:
    """Return a text with the values of an answer where it names them; raises KeyError for one that is not there."""
    return _Words().vformat(text, (), answer)


def lines(answer: Mapping[str, Any], wanted: Iterable[LineWords]) -> Iterator[str]:
    """Yield the lines of an answer; a line with a value that the answer does not have is left out."""
    known = {name: value for name, value in answer.items() if value is not None}
    for label, *ways, last in wanted:
        for way, values in (*((way, known) for way in ways), (last, answer)):
            with suppress(KeyError):
                yield line(label, words(way, values))
                break


def json_text(answer: Any, *, indent: int | None = None) -> str:
    """Return an answer as JSON: arrays as lists, and null for what is no finite number."""
    return json.dumps(finite(answer), allow_nan=False, indent=indent)


def finite(value: Any) -> Any:
    """Return a value as JSON has it: arrays as lists, and None for what is no finite number."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {name: finite(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
