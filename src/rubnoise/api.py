"""Everything rubnoise does, as Python functions: load a scenario, run it, open a result, ask the theory."""

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rubnoise.analysis.agreement import Agreement, from_attributes
from rubnoise.analysis.summary import summarise
from rubnoise.contact.overlap import junction_area
from rubnoise.errors import ScenarioRefused
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.sink import Tee
from rubnoise.record.tally import Tally
from rubnoise.scenario import Scenario, build, load
from rubnoise.scenario.limits import SEED_END
from rubnoise.simulation.block import Watch
from rubnoise.simulation.run import extent, slider_constants
from rubnoise.simulation.run import simulate as run_events
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.output import check_output
from rubnoise.storage.provenance import gather
from rubnoise.storage.reader import RunFile, open_run
from rubnoise.storage.writer import RunWriter
from rubnoise.theory.exact import Exact
from rubnoise.theory.exact import exact as exact_of_model

__all__ = ["Exact", "Junction", "Run", "Scenario", "exact", "load", "open", "run", "simulate"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Junction:
    """One junction's row: distances in um, area in um^2; times in s and strength in MPa where the run has them."""

    number: int
    birth_distance: float
    death_distance: float
    life_distance: float
    diameter: float
    max_area: float
    state: int
    shear_strength: float | None = None
    birth_time: float | None = None
    death_time: float | None = None

    def area(self, distance: ArrayLike) -> NDArray[np.float64]:
        """Return its area in um^2 at sliding distances in um (any shape); 0 before birth and from death on."""
        s = np.asarray(distance, dtype=np.float64)
        alive = (self.birth_distance <= s) & (s < self.death_distance)
        return np.where(alive, junction_area(s - self.birth_distance, self.diameter), 0.0)


class Columns:
    """The columns of one group of a result file, each read when it is asked for: ``run.trace["distance"]``."""

    def __init__(self, file: RunFile, group: str) -> None:
        """Stand for a group of an open file."""
        self._file = file
        self._group = group

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Read one column; raises KeyError with the names there are."""
        if name not in self.names:
            raise KeyError(f"/{self._group} has no column {name!r}; it has {', '.join(self.names)}")
        return self._file.column(self._group, name)

    def __len__(self) -> int:
        """Return the number of rows."""
        return self._file.rows(self._group)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, the one that the others depend on first."""
        return self._file.columns[self._group]


class Run:
    """An open result file; a context manager. Opening reads its structure, asking for a column reads that column."""

    def __init__(self, file: RunFile) -> None:
        """Take over an open run file."""
        self._file = file

    def __enter__(self) -> Self:
        """Return the run."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file; nothing can be read any more."""
        self._file.close()

    @property
    def junctions(self) -> Columns:
        """One row a junction, in order of birth."""
        return Columns(self._file, "junctions")

    @property
    def trace(self) -> Columns:
        """Real contact area, junction count and friction force at every tick."""
        return Columns(self._file, "trace")

    @property
    def slider(self) -> Columns:
        """The slider's motion at every tick; raises KeyError where the run has no slider."""
        if "slider" not in self._file.columns:
            raise KeyError("the run has no slider")
        return Columns(self._file, "slider")

    def junction(self, number: int) -> Junction:
        """Return one junction by its row number; raises IndexError where there is no such row."""
        if not 0 <= number < len(self.junctions):
            raise IndexError(f"junction {number}: the run has junctions 0 to {len(self.junctions) - 1}")
        names = [name for name in self.junctions.names if name != "junction"]
        values = {name: self._file.column("junctions", name, number, number + 1)[0].item() for name in names}
        return Junction(number=number, **values)

    def groups(self) -> dict[str, Columns]:
        """Return every group of columns by name."""
        return {name: Columns(self._file, name) for name in self._file.columns}

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario of the run, with every default and change of it made explicit."""
        return build(json.loads(str(self.provenance["scenario_resolved"])))

    @cached_property
    def summary(self) -> list[Agreement]:
        """What was measured beside what is exact."""
        return from_attributes(self._file.summary)

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Format, title, source and formula, as they stand at the root of the file."""
        return self._file.attributes

    @property
    def provenance(self) -> dict[str, float | int | str]:
        """Scenario, software, seed, command and times of the run."""
        return self._file.provenance


def simulate(scenario: Scenario, seed: int | None = None) -> MemoryRecord:
    """Run a scenario and keep the result in memory: ``simulate(scenario)["trace"]["real_contact_area"]``.

    ``seed`` replaces that of the scenario; raises ScenarioRefused where it is none.
    """
    scenario = _seeded(scenario, seed)
    model, seed = scenario.model(), scenario.run.seed
    record = MemoryRecord(extent(model, seed))
    run_events(model, seed, record)
    return record


def run(
    scenario: Scenario,
    path: str | os.PathLike[str],
    *,
    seed: int | None = None,
    force: bool = False,
    command: Sequence[str] | None = None,
    watch: Watch | None = None,
) -> Run:
    """Run a scenario into a result file and open it.

    ``seed`` replaces that of the scenario; ``force`` allows an existing file to be replaced, once the new one is whole;
    ``command`` is what /provenance says was called; ``watch`` is told at the start, before anything is created, and
    after each panel. Raises OutputRefused before anything is created, ScenarioRefused for a seed that is none.
    """
    check_output(path, force=force)
    scenario = _seeded(scenario, seed)
    model = scenario.model()
    description = _description(scenario, path, command or [Path(sys.argv[0]).name, *sys.argv[1:]])
    if watch is not None:
        watch(0.0, 0, 0)
    tally = Tally()
    with RunWriter(path, description, force=force) as writer:
        run_events(model, scenario.run.seed, Tee((writer, tally)), watch=watch)
        figures: dict[str, float | int | str] = {}
        for figure in summarise(model, tally):
            figures |= figure.as_attributes()
        writer.publish(figures)
    return open(path)


def open(path: str | os.PathLike[str]) -> Run:  # noqa: A001  (rubnoise.open reads like h5py.File)
    """Open a result file for reading; raises RunFileRefused with the reason where it is none of ours or damaged."""
    return Run(open_run(path))


def exact(scenario: Scenario) -> Exact:
    """Return what theory says about a scenario: moments of area, count and force, the slider's response."""
    return exact_of_model(scenario.model())


def _seeded(scenario: Scenario, seed: int | None) -> Scenario:
    """Return the scenario with another seed, so that what is kept of it says what was run."""
    if seed is None:
        return scenario
    if not 0 <= seed < SEED_END:
        raise ScenarioRefused(f"run.seed: {seed} is not from 0 to {SEED_END - 1}")
    return replace(scenario, run=scenario.run.model_copy(update={"seed": seed}))


def _description(scenario: Scenario, path: str | os.PathLike[str], command: Sequence[str]) -> RunDescription:
    model, seed = scenario.model(), scenario.run.seed
    return RunDescription(
        title=scenario.title or Path(path).stem,
        extent=extent(model, seed),
        features=features_of(model),
        compression="gzip" if scenario.output.compression == "gzip" else "none",
        scenario_toml=scenario.text,
        scenario_resolved=scenario.resolved(),
        provenance=gather(
            seed=seed,
            calibrated_diameter=model.calibrated_diameter,
            propagator_constants=_named_constants(scenario),
            command=command,
        ),
    )


def _named_constants(scenario: Scenario) -> dict[str, float]:
    constants = slider_constants(scenario.model())
    if constants is None:
        return {}
    named = {"cells_per_tick": float(constants.cells_per_tick)}
    for name, matrix in (("transition", constants.transition), ("gain", constants.gains)):
        for (row, column), value in np.ndenumerate(matrix):
            named[f"{name}_{row}{column}"] = float(value)
    return named
