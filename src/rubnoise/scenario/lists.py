"""Keys that hold a list: weights, measured sizes, and the parts of a mixture."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from rubnoise.contact.laws import LAWS
from rubnoise.scenario.fields import Choice, Field, Measure, Number, Range, Unfit
from rubnoise.units import LENGTH, RATIO, Quantity, read_quantity

MOST: Final = 2000
"""Values of a list at most: a result file keeps them all."""

_POSSIBLE = Range(1e-12, 1e12)
_LAWS = tuple(name for name, entry in LAWS.items() if not (entry.own_keys or entry.parameters))
_RATIO = Measure((RATIO,), possible=Range(1e-12, 1e12), plausible=Range(1e-12, 1e12))


@dataclass(frozen=True, slots=True)
class Sizes(Field):
    """A list of positive numbers, or of lengths as texts, which become um."""

    what: str

    @property
    def words(self) -> str:
        """What a page says of the value."""
        return f"list of {self.what}, each a positive number or a length"

    def read(self, value: Any) -> tuple[float, ...]:
        """Return the numbers."""
        if not isinstance(value, list | tuple) or not 1 <= len(value) <= MOST:
            raise Unfit(f"needs a list of 1 to {MOST} {self.what}", "in brackets: [4.1, 5.3]")
        return tuple(_size(each) for each in value)

    def describe(self) -> dict[str, Any]:
        """Return a bounded array."""
        return {"type": "array", "minItems": 1, "maxItems": MOST, "items": {"type": ["number", "string"]}}


@dataclass(frozen=True, slots=True)
class Parts(Field):
    """A list of tables: law, mean, and spread if the law takes one."""

    @property
    def words(self) -> str:
        """What a page says of the value."""
        return "list of tables with `law`, `mean` and `spread`"

    def read(self, value: Any) -> tuple[dict[str, Any], ...]:
        """Return the tables, means in um and spreads as they are written."""
        if not isinstance(value, list | tuple) or not 1 <= len(value) <= MOST:
            raise Unfit(f"needs a list of 1 to {MOST} tables", 'such as [{law = "fixed", mean = 4}]')
        return tuple(_part(number, each) for number, each in enumerate(value, 1))

    def describe(self) -> dict[str, Any]:
        """Return an array of tables."""
        size = {"type": ["number", "string"]}
        properties = {"law": {"enum": list(_LAWS)}, "mean": size, "spread": {"type": "string"}}
        table = {"type": "object", "additionalProperties": False, "properties": properties}
        return {"type": "array", "minItems": 1, "items": table | {"required": ["law", "mean"]}}


def ratio_of(part: Mapping[str, Any]) -> float:
    """Return the standard deviation of a part over its mean; 0 without a spread."""
    return float(read_quantity(part["spread"], RATIO)) if "spread" in part else 0.0


def _size(value: Any) -> float:
    if isinstance(value, str):
        return float(Measure((LENGTH,), possible=_POSSIBLE, plausible=_POSSIBLE).read(value))
    return float(Number(_POSSIBLE).read(value))


def _part(number: int, value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping) or not {"law", "mean"} <= value.keys() <= {"law", "mean", "spread"}:
        raise Unfit(f"part {number} needs a law and a mean, and may have a spread", '{law = "fixed", mean = 4}')
    law = Choice(_LAWS).read(value["law"])
    if LAWS[law].takes_spread != ("spread" in value):
        raise Unfit(f'part {number}: the law "{law}" {"needs a" if LAWS[law].takes_spread else "takes no"} spread')
    spread = {"spread": _spread(number, law, value["spread"])} if "spread" in value else {}
    return {"law": law, "mean": _size(value["mean"]), **spread}


def _spread(number: int, law: str, value: Any) -> str:
    spread: Quantity = _RATIO.read(value)
    if spread > LAWS[law].widest:
        raise Unfit(f'part {number}: too wide for the law "{law}"', f'up to "{100.0 * LAWS[law].widest:g} %"')
    return spread.as_text()
