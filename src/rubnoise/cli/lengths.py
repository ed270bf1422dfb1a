"""Sliding distances as options of the command line take them."""

import re

from rubnoise.cli.layout import printable
from rubnoise.errors import Refused
from rubnoise.units import LENGTH, NUMBER, QuantityError, read_quantity


def distance(option: str, text: str | None) -> float | None:
    """Return a sliding distance in um, which is what a number without a unit is in; None for none.

    Raises Refused, naming the option, for what is no length.
    """
    if text is None:
        return None
    try:
        return float(read_quantity(f"{text} um" if re.fullmatch(NUMBER, text) else text, LENGTH))
    except QuantityError as problem:
        hint = f"; {problem.hint}" if problem.hint else ""
        raise Refused(f"{option}: {printable(text)}: {problem}{hint}") from problem
