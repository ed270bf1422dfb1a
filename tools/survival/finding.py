"""What came of it all: counts by name, and everything that should not have been."""

import sys
from collections import Counter
from dataclasses import dataclass, field


@dataclass(kw_only=True)
class Outcome:
    """Counts of what happened, and a line for each thing that was lost or wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def count(self, what: str, number: int = 1) -> None:
        """Count something that happened."""
        self.counts[what] += number

    def find(self, what: str) -> None:
        """Keep something that should not be, and say so at once."""
        print(what, file=sys.stderr, flush=True)
        self.findings.append(what)

    def add(self, other: "Outcome") -> None:
        """Take over what another one holds."""
        self.counts += other.counts
        self.findings += other.findings

    def told(self) -> str:
        """Return all of it as text, most of it counts."""
        width = max(map(len, self.counts), default=0)
        rows = [f"{what:<{width}}  {number:>8,}" for what, number in self.counts.items()]
        return "\n".join([*rows, *(f"- {finding}" for finding in self.findings), f"{len(self.findings)} found"])
