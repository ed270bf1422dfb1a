"""What studies with rows of data have in common: a file that keeps the rows, and tables on a page drawn from it."""

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, Generic, TypeVar

from parts import fill
from pydantic import TypeAdapter

DOCS: Final = Path(__file__).resolve().parents[2] / "docs"
Row = TypeVar("Row")


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
        adapter = TypeAdapter(self.row)
        rows = json.loads((self.docs / self.data).read_text("utf-8"))["rows"]
        return [adapter.validate_python(each) for each in rows]

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
