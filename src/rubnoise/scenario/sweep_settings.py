"""The keys of `[sweep]` beside its lists: how many runs of each point, what is kept of them, how precise they are."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal, cast

from pydantic import Field as About

from rubnoise.scenario import limits
from rubnoise.scenario.document import Section
from rubnoise.scenario.fields import Choice, Field, Number, Range, Unfit
from rubnoise.scenario.keys import SWEEP
from rubnoise.scenario.layers import Layers
from rubnoise.scenario.precision import FEWEST, QUANTITIES, Precision
from rubnoise.scenario.problems import Problem

Keep = Literal["runs", "summary"]


class Sweeping(Section):
    """Many runs from one file; `[sweep.grid]` and `[sweep.zip]` list the values that vary."""

    replicates: Annotated[
        int,
        Number(Range(1, limits.SWEEP_RUNS), whole=True),
        About(
            description=f"Runs of each point, each with its own seed; with a precision, the first runs, {FEWEST} or "
            "more."
        ),
    ] = 1
    keep: Annotated[
        str,
        Choice(("runs", "summary")),
        About(description="runs: a result file for each run; summary: only its figures and curves, without traces."),
    ] = "runs"
    precision: Annotated[
        float | None,
        Number(Range(1e-6, 1.0)),
        About(description="Target for the relative standard error of the quantity's mean; runs are added to meet it."),
    ] = None
    quantity: Annotated[
        str, Choice(tuple(QUANTITIES)), About(description="The figure of a run that must reach this precision.")
    ] = "real_contact_area_std"
    most_replicates: Annotated[
        int,
        Number(Range(FEWEST, limits.SWEEP_RUNS), whole=True),
        About(description="Most runs of a point, even if it does not reach the precision."),
    ] = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """What `[sweep]` says of all its points; without a precision there are so many replicates, and no more."""

    replicates: int = 1
    keep: Keep = "runs"
    precision: Precision | None = None

    @property
    def most_replicates(self) -> int:
        """How many runs a point may come to have."""
        return self.replicates if self.precision is None else self.precision.most_replicates


_ONLY_WITH_PRECISION: Final = ("quantity", "most_replicates")


def read_settings(layers: Layers, table: Mapping[str, Any]) -> tuple[Settings, list[Problem]]:
    """Return the settings of a `[sweep]` table, defaults in place of what is wrong, and everything that is."""
    values: dict[str, Any] = {}
    problems = []
    for key, about in Sweeping.model_fields.items():
        field = next(each for each in about.metadata if isinstance(each, Field))
        values[key] = about.default
        try:
            values[key] = field.read(table[key]) if key in table else about.default
        except Unfit as unfit:
            problems.append(_problem(layers, key, str(unfit), unfit.hint))
    problems += [] if problems else list(_at_odds(layers, table, values))
    return _settings(values, counted="replicates" in table), problems


def _settings(values: Mapping[str, Any], *, counted: bool) -> Settings:
    keep, replicates = cast(Keep, values["keep"]), int(values["replicates"])
    if values["precision"] is None:
        return Settings(replicates=replicates, keep=keep)
    precision = Precision(
        relative=values["precision"], quantity=values["quantity"], most_replicates=values["most_replicates"]
    )
    return Settings(replicates=replicates if counted else FEWEST, keep=keep, precision=precision)


def _at_odds(layers: Layers, table: Mapping[str, Any], values: Mapping[str, Any]) -> Iterator[Problem]:
    """Yield what keys ask of one another."""
    if values["precision"] is None:
        for key in _ONLY_WITH_PRECISION:
            if key in table:
                yield _problem(layers, key, "needs a precision", "add precision = 0.01")
        return
    if "replicates" in table and values["replicates"] < FEWEST:
        hint = f"replicates = {FEWEST}, or leave it out"
        yield _problem(layers, "replicates", "too few to estimate the precision", hint)
    if values["replicates"] > values["most_replicates"]:
        hint = f"most_replicates = {values['replicates']} or more"
        yield _problem(layers, "most_replicates", "fewer than the replicates to begin with", hint)


def _problem(layers: Layers, key: str, message: str, hint: str) -> Problem:
    path = (SWEEP, key)
    return Problem(path=path, message=message, place=layers.value_place(path), hint=hint)
