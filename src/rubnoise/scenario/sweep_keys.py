"""The keys of the table `[sweep]`, which a scenario file has if it stands for many runs."""

from dataclasses import dataclass
from typing import Final, Literal

from rubnoise.figure_names import QUANTITIES
from rubnoise.scenario.fields import Choice, Number, Range, Section, key

SWEEP: Final = "sweep"
"""The table of many runs, which is read apart: a scenario is one run."""

SWEEP_RUNS: Final = 100_000
FEWEST: Final = 8
"""Runs from which their scatter says how precise their mean is: to some 27 %, 1/sqrt(2 (n - 1))."""

Keep = Literal["runs", "summary"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweeping(Section):
    """Many runs from one file; `[sweep.grid]` and `[sweep.zip]` list the values that vary."""

    replicates: int = key(
        Number(Range(1, SWEEP_RUNS), whole=True),
        f"Runs of each point, each with its own seed; with a precision, the first runs, {FEWEST} or more.",
        1,
    )
    keep: Keep = key(  # noqa: RUF009
        Choice(("runs", "summary")),
        "runs: a result file for each run; summary: only its figures and curves, without traces.",
        "runs",
    )
    precision: float | None = key(
        Number(Range(1e-6, 1.0)),
        "Target for the relative standard error of the quantity's mean; runs are added to meet it.",
        sample=0.005,
    )
    quantity: str = key(
        Choice(tuple(QUANTITIES)), "The figure of a run that must reach this precision.", "real_contact_area_std"
    )
    most_replicates: int = key(
        Number(Range(FEWEST, SWEEP_RUNS), whole=True),
        "Most runs of a point, even if it does not reach the precision.",
        1000,
    )

    @property
    def largest(self) -> int:
        """Largest number of runs of a point."""
        return self.replicates if self.precision is None else self.most_replicates
