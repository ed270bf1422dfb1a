"""Make one run: describe it, and write it into its file, or measure it as its rows come."""

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import join

from rubnoise.analysis.figures import summarise
from rubnoise.analysis.findings import attributes_of
from rubnoise.analysis.measured import Measured
from rubnoise.arrays import slices
from rubnoise.record.rows import Attributes, Extent, MemoryRecord, Sink, Tee
from rubnoise.scenario import Scenario
from rubnoise.simulation.draws import extent
from rubnoise.simulation.linear import named_constants
from rubnoise.simulation.observer import Intervention, Observer
from rubnoise.simulation.run import simulate
from rubnoise.simulation.state import Watch
from rubnoise.storage.layout import RunDescription, environment, features_of, now, software
from rubnoise.storage.schema import INTERVENTION
from rubnoise.storage.writer import RunWriter
from rubnoise.streams import STREAM_VERSION


@dataclass(frozen=True, slots=True, repr=False, eq=False, kw_only=True)
class KeptRun(MemoryRecord):
    """A run in memory that says what was run; ``intervention`` names the function that may have ended lives."""

    scenario: Scenario
    intervention: str = ""
    path: Path = Path("memory")

    @property
    def attributes(self) -> Attributes:
        """The title."""
        return {"title": self.scenario.title}

    @property
    def provenance(self) -> Attributes:
        """Scenario, seed and intervention, by the names that they have in a file."""
        return {
            "scenario_resolved": json.dumps(self.scenario.resolved()),
            "seed": self.scenario.run.seed,
            **({"intervention": self.intervention} if self.intervention else {}),
        }

    @property
    def summary(self) -> Attributes:
        """What was measured beside what is exact, as a file keeps it."""
        seen = Measured(self.scenario.model())
        self.play_into(seen)
        return {**attributes_of(summarise(seen))}

    def play_into(self, sink: Sink) -> None:
        """Write all rows to a sink, some at a time."""
        for group, columns in self.groups.items():
            for part in slices(0, self.rows(group)):
                sink.write(group, part.start, {name: values[part] for name, values in columns.items()})


def describe(
    scenario: Scenario,
    path: str | os.PathLike[str],
    command: Sequence[str],
    intervention: str = "",
    known: Extent | None = None,
) -> RunDescription:
    """Return the description of a result that begins now; this counts its births, if its rows are not ``known``."""
    model, seed = scenario.model(), scenario.run.seed
    return RunDescription(
        title=scenario.title or Path(path).stem,
        extent=known or extent(model, seed),
        features=features_of(model),
        compression=scenario.output.compression,
        pulse=model.pulse,
        provenance={
            "scenario_toml": scenario.text,
            "scenario_resolved": json.dumps(scenario.resolved(), ensure_ascii=False),
            "software": json.dumps(software()),
            "environment": json.dumps(environment()),
            "seed": seed,
            "stream_version": STREAM_VERSION,
            "calibrated_diameter": model.calibrated_diameter,
            "propagator_constants": json.dumps(named_constants(model)),
            "command": join(command),
            **({INTERVENTION: intervention} if intervention else {}),
            "started": now(),
        },
    )


def play(
    writer: RunWriter,
    scenario: Scenario,
    *,
    watch: Watch | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
) -> dict[str, float | int | str]:
    """Play a scenario into an entered writer, publish the file and return its figures; ``watch`` may raise."""
    seen = Measured(scenario.model())
    end = simulate(
        seen.model,
        scenario.run.seed,
        Tee((writer, seen)),
        engine=scenario.run.engine,
        observe=observe,
        intervene=intervene,
        watch=watch,
    )

    def between() -> None:
        if watch is not None:
            watch(seen.model.distance, end.junctions, len(end.live))

    figures: dict[str, float | int | str] = {**attributes_of(summarise(seen))}
    between()  # theory may take seconds, in which someone may have asked to stop
    writer.publish(figures, between=between)
    return figures
