"""What studies with rows of data have in common: a file that keeps the rows, and tables on a page drawn from it."""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, is_dataclass
from pathlib import Path
from typing import Any, Final, Generic, TypeVar, cast, get_args, get_origin, get_type_hints

from parts import fill

DOCS: Final = Path(__file__).resolve().parents[2] / "docs"
Row = TypeVar("Row")


def built(kind: Any, value: Any) -> Any:
    """Return what JSON holds of a value as its kind says: dataclasses, and tuples of them or of numbers."""
    if isinstance(value, dict) and is_dataclass(kind):
        hints, make = get_type_hints(kind), cast(Callable[..., Any], kind)
        return make(**{name: built(hints[name], each) for name, each in value.items()})
    if isinstance(value, list):
        of_tuple = next((each for each in (kind, *get_args(kind)) if get_origin(each) is tuple), None)
        return tuple(built(get_args(of_tuple)[0] if of_tuple else None, each) for each in value)
    return value


@dataclass(frozen=True, kw_only=True)
class Study(Generic[Row]):
    """A study: how its rows are made, what would be wrong with them, and the tables that show them, by their names.

    row: the dataclass of a row; page, data: files below docs; facts: what else is kept beside the rows.
    """

    about: str
    page: str
    data: str
    row: type[Row]
    make: Callable[[], Iterable[Row]]
    faults: Callable[[Sequence[Row]], list[str]]
    tables: Callable[[Sequence[Row]], dict[str, str]]
    facts: Mapping[str, Any] = field(default_factory=dict)
    docs: Path = DOCS

    def kept(self) -> list[Row]:
        """Return the rows of the data."""
        rows = json.loads((self.docs / self.data).read_text("utf-8"))["rows"]
        return [built(self.row, each) for each in rows]

    def main(self) -> int:
        """Make the rows and keep them, or take those of before with --table; draw the tables unless a row is wrong."""
        parser = argparse.ArgumentParser(description=self.about, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--table", action="store_true", help=f"draw the tables from docs/{self.data}")
        if not parser.parse_args().table:
            made = {**self.facts, "rows": [asdict(each) for each in self.make()]}  # type: ignore[call-overload]
            (self.docs / self.data).write_text(json.dumps(made, indent=1) + "\n", "utf-8")
        rows = self.kept()
        if wrong := self.faults(rows):
            print(*wrong, sep="\n", file=sys.stderr)
            return 1
        fill(self.docs / self.page, self.tables(rows))
        return 0
