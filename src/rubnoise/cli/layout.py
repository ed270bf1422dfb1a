"""Print an answer: lines of a label, a value and a unit, tables as wide as the terminal, and JSON.

An answer has values by name, which texts refer to: `std {slider.velocity_std} um/s` prints a number with seven digits.
After a colon comes another form of the value: a name of FORMS, or a format of Python.
"""

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import reduce
from math import isfinite
from operator import getitem
from string import Formatter
from textwrap import fill
from typing import TYPE_CHECKING, Any, Final, TextIO

if TYPE_CHECKING:
    from rubnoise.analysis.agreement import Agreement

WIDTH = 80
"""Columns of text that goes to no terminal."""

NARROWEST = 40
"""Columns below which nothing is laid out any narrower."""


def columns_of(stream: TextIO) -> int | None:
    """Return the width of a stream's terminal, None without a terminal; COLUMNS in the environment takes precedence."""
    with suppress(ValueError):
        if (wanted := int(os.environ.get("COLUMNS", ""))) > 0:
            return wanted
    try:
        # A terminal that does not know its size says 0.
        return os.get_terminal_size(stream.fileno()).columns or None
    except (OSError, ValueError):
        return None


def width() -> int:
    """Return the width of text on standard output."""
    return max(columns_of(sys.stdout) or WIDTH, NARROWEST)


def filled(text: str, first: str = "", others: str = "") -> str:
    """Return a text in lines of the terminal's width, broken between words, each with its indentation."""
    return fill(
        text, width(), initial_indent=first, subsequent_indent=others, break_long_words=False, break_on_hyphens=False
    )


def sentence(text: str) -> str:
    """Return a sentence broken between words on a terminal, otherwise in one line."""
    return text if columns_of(sys.stdout) is None else filled(text, "", "  ")


def table_row(label: str, numbers: str) -> str:
    """Return a row of a table, with its label above its numbers if the terminal is too narrow for one line.

    Both are padded to the width of their column, so that all rows are broken or none.
    """
    most = columns_of(sys.stdout)
    if most is None or len(label) + len(numbers) <= most:
        return (label + numbers).rstrip()
    return "\n".join(part.rstrip() for part in (label, f"  {numbers}") if part.strip())


def groups_that_fit(widths: Sequence[int]) -> list[list[int]]:
    """Return the numbers of a table's columns in groups that fit a terminal, each beginning with the first column.

    Without a terminal they are one group, for programs that read one row per line.
    """
    most = columns_of(sys.stdout)
    groups = [[0]]
    for number in range(1, len(widths)):
        taken = sum(widths[each] for each in groups[-1]) + widths[number]
        if most is not None and taken > max(most, NARROWEST) and len(groups[-1]) > 1:
            groups.append([0])
        groups[-1].append(number)
    return groups


def cut(text: str, stream: TextIO) -> str:
    """Return a line cut to the width of the terminal, since the next line of progress cannot overwrite a broken one."""
    columns = columns_of(stream)
    return text if columns is None else text[: columns - 1]


LABEL_WIDTH, SHORTER_LABEL_WIDTH, NARROW = 30, 25, 72
"""Columns of labels before their values, and the same on terminals of fewer columns than the last."""


def line(label: str, value: str, *, whole: bool = False) -> str:
    """Return one labelled value, indented below its heading; a long one takes several lines unless it is ``whole``."""
    head = f"  {label:<{LABEL_WIDTH if width() >= NARROW else SHORTER_LABEL_WIDTH}}"
    return head + printable(value) if whole else filled(printable(value), head, " " * len(head)) or head.rstrip()


def remark(text: str) -> str:
    """Return a sentence below the values."""
    return filled(text, "  ", "    ")


def printable(text: str) -> str:
    """Return a text from a file with characters that control a terminal escaped."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def number(value: float) -> str:
    """Return a number to seven digits."""
    return f"{value:.7g}"


def grouped(value: float) -> str:
    """Return a whole number with separated thousands."""
    return f"{round(value):,}" if isfinite(value) else str(value)


def about(value: float) -> str:
    """Return an estimated whole number, with three digits."""
    return f"about {grouped(float(f'{value:.3g}'))}"


def size(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000.0
    return f"{count:.3g} TB"


def distance(um: float) -> str:
    """Return an estimated sliding distance, with two digits, in the unit that suits it."""
    for unit, length in (("m", 1e6), ("mm", 1e3)):
        if um >= length:
            return f"{_two_digits(um / length)} {unit}"
    return f"{_two_digits(um)} um"


def _two_digits(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.10g}"


ONE_WAY_ALONE = (
    "the slider pushes back: its displacement and velocity here are those of one-way coupling; a run shows the others"
)
"""What to say beside the exact motion of a slider that is coupled two ways."""


def too_short_for_motion(decays: float, needed: float) -> str:
    """Return that a run is too short for standard errors of its slider's motion, and the distance that it needs."""
    return (
        f"the run is too short for standard errors of the slider's motion: it lasts {decays:.2g} of its decay times;"
        f" it needs about {distance(needed)}"
    )


UNITS = {
    "birth_gap": "um",
    "asked_mean_area": "um^2",
    "asked_area_from_rows": "um^2",
    "start_": "",
    "diameter": "um",
    "shear_strength": "MPa",
    "area_from_rows": "um^2",
    "life_": "",
    "life": "um",
    "death": "um",
    "real_contact_area_autocovariance": "um^4",
    "real_contact_area": "um^2",
    "friction_force": "uN",
    "spectrum": "um^4",
    "displacement": "um",
    "velocity": "um/s",
    "separation": "um",
    "normal_velocity": "um/s",
    "load": "uN",
    "mean_force": "uN",
}
"""Units of figures, by how their names begin; the first that fits."""

PLAIN = ("kolmogorov", "variation", "skewness", "kurtosis")
"""Ends of names of figures without a unit."""

FIGURE_HEADS = f"{'measured':>13}{'exact':>14}{'std error':>11}{'z':>7}"


def agreement_table(figures: Iterable["Agreement"]) -> list[str]:
    """Return a table of measured beside exact figures, with z-scores if there are any."""
    rows = (agreement_row(printable(each.name).replace("one_way", "one-way"), each, width=33) for each in figures)
    return [table_row(f"  {'':<33}", FIGURE_HEADS), *rows]


def agreement_row(
    name: str,
    figure: "Agreement",
    *,
    width: int,
    score: Callable[[float], str] = "{:+.2f}".format,
    mark: str = "",
) -> str:
    """Return a figure's row under a name, with its unit, and a mark at its end."""
    unit = "" if figure.name.endswith(PLAIN) else next((UNITS[key] for key in UNITS if figure.name.startswith(key)), "")
    label = name.replace("_", " ") + (f" ({unit})" if unit else "")
    expected = "" if figure.expected is None else number(figure.expected)
    error = "" if figure.standard_error is None else f"{figure.standard_error:.3g}"
    z = "" if figure.z is None else score(figure.z)
    return table_row(f"  {label:<{width}}", f"{number(figure.observed):>13}{expected:>14}{error:>11}{z:>7}{mark}")


LineWords = tuple[str, ...]
"""A label and the words beside it. Of several words, the first count whose values are all known, and else the last."""


def plain(value: Any) -> str:
    """Return a value as text: a number with seven digits, yes or no, none if it is not known."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else number(value) if isinstance(value, float) else str(value)


FORMS: Final[Mapping[str, Callable[[Any], str]]] = {
    "": plain,
    "about": about,
    "change": lambda ratio: f"{ratio - 1.0:+.2%}",
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
    """Return a text with its names replaced by the values of an answer; raises KeyError for a missing value."""
    return _Words().vformat(text, (), answer)


def lines(answer: Mapping[str, Any], wanted: Iterable[LineWords]) -> Iterator[str]:
    """Yield the lines of an answer; lines with a missing value are left out."""
    known = {name: value for name, value in answer.items() if value is not None}
    for label, *ways, last in wanted:
        for way, values in (*((way, known) for way in ways), (last, answer)):
            with suppress(KeyError):
                yield line(label, words(way, values))
                break


def json_text(answer: Any, *, indent: int | None = None) -> str:
    """Return an answer as JSON: arrays as lists, and null for numbers that are not finite."""
    return json.dumps(finite(answer), allow_nan=False, indent=indent)


def finite(value: Any) -> Any:
    """Return a value for JSON: arrays as lists, and None for numbers that are not finite."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {name: finite(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
