"""How a table of text is written: what parts its cells, its numbers in the forms of many countries, its times."""

import csv
import re
from dataclasses import dataclass
from datetime import date
from typing import Final

from rubnoise.storage.text_heads import LONGEST_NAME

MARKS: Final = ("#", "%")
"""What a comment begins with, or a line of names."""

SHOWN: Final = 40
"""Characters of a cell in a message."""

_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?|[+-]?(?:nan|inf)", re.IGNORECASE)
_THOUSANDS: Final = {
    ",": re.compile(r"[+-]?[1-9][0-9]{0,2}(?:\.[0-9]{3})+(?:,[0-9]+)?"),
    ".": re.compile(r"[+-]?[1-9][0-9]{0,2}(?:,[0-9]{3})+\.[0-9]+"),
}
_GAP: Final = re.compile("(?<=[0-9])[ '\u2019\u00a0\u2009\u202f](?=[0-9]{3}(?![0-9]))")
_EXPONENT: Final = re.compile("(?<=[0-9.])[dD](?=[+-]?[0-9])")
_MOMENT: Final = re.compile(
    r"(?:([0-9]{4})[-/.]([0-9]{1,2})[-/.]([0-9]{1,2})[T ]|([0-9]{1,2})[-/.]([0-9]{1,2})[-/.]([0-9]{4}) )? *"
    r"([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}(?:[.,][0-9]+)?))? *([aApP][mM])?(?:Z| ?[+-][0-9]{2}:?[0-9]{2})?"
)
_NAMES_BY_SPACES: Final = re.compile(r"[^\s(\[]+(?: ?[(\[][^)\]]*[)\]])?")


@dataclass(frozen=True, slots=True)
class Form:
    """How a table is written: the separator of its cells (a space: any number), and what decimals follow."""

    separator: str
    decimal: str

    def cells(self, text: str) -> list[str]:
        """Return the cells of a row; quotes around a cell are no part of it."""
        if self.separator == " ":
            return text.split()
        if '"' in text and len(text) < csv.field_size_limit():
            return next(csv.reader([text], delimiter=self.separator, skipinitialspace=True))
        return [cell.strip() for cell in text.split(self.separator)]

    def width(self, text: str) -> int:
        """Return the number of cells of a row without quotes."""
        return len(text.split()) if self.separator == " " else text.count(self.separator) + 1

    def names(self, text: str, width: int) -> list[str]:
        """Return the cells of a line of names, whose spaces part words as well as columns."""
        text = text.lstrip("".join(MARKS)).strip(" \r")
        if self.separator != " ":
            return [cell.strip().strip('"').strip() for cell in self.cells(text)]
        ways = (re.split(r"\s{2,}|\t", text), _NAMES_BY_SPACES.findall(text[: 20 * LONGEST_NAME]))
        return next((way for way in ways if len(way) == width), text.split())

    def number(self, cell: str) -> float | None:
        """Return the number in a cell; None if it is not a number."""
        text = cell.strip().replace("\u2212", "-")
        if self.decimal == "." and _NUMBER.fullmatch(text):
            return float(text)
        if len(text) > 2 * SHOWN:
            return None
        text = _EXPONENT.sub("e", _GAP.sub("", text))
        other = "." if self.decimal == "," else ","
        if other in text:
            text = text.replace(other, "") if _THOUSANDS[self.decimal].fullmatch(text) else ""
        text = text.replace(self.decimal, ".")
        return float(text) if _NUMBER.fullmatch(text) and not (self.decimal == "," and text[-1] == ".") else None


def moment(cell: str, first_day: int = 0) -> float | None:
    """Return the seconds since the begin of a day (counted as Python does) of a date with time, or of a clock."""
    found = _MOMENT.fullmatch(cell.strip()) if ":" in cell and len(cell) < SHOWN else None
    if found is None:
        return None
    year, month, day, day_first, month_next, year_last, hours, minutes, seconds, half = found.groups()
    days = 0
    if year or year_last:
        try:
            days = date(int(year or year_last), int(month or month_next), int(day or day_first)).toordinal() - first_day
        except ValueError:
            return None
    hour = int(hours) if half is None else int(hours) % 12 + 12 * (half in "pmPM")
    return 86400.0 * days + 3600.0 * hour + 60.0 * int(minutes) + float((seconds or "0").replace(",", "."))
