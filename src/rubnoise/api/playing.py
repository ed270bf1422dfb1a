"""Describe a run, and write it into its file from its start or from where it stopped."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import cast

from rubnoise.analysis.summary import summarise
from rubnoise.model import Model
from rubnoise.record.sink import Tee
from rubnoise.record.tally import Tally
from rubnoise.scenario import Scenario
from rubnoise.simulation.block import Watch
from rubnoise.simulation.intervention import Intervention, name_of
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import Engine, extent, simulate, slider_constants
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.provenance import gather
from rubnoise.storage.writer import RunWriter


def describe(
    scenario: Scenario, path: str | os.PathLike[str], command: Sequence[str], intervene: Intervention | None = None
) -> RunDescription:
    """Return the description of a result: its births are counted, nothing else is done."""
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
            propagator_constants=named_constants(model),
            command=command,
            intervention="" if intervene is None else name_of(intervene),
        ),
    )


def named_constants(model: Model) -> dict[str, float]:
    """Return the rounded constants of the slider's exact step by name; none without a slider."""
    constants = slider_constants(model)
    return {} if constants is None else constants.named()


def play(
    writer: RunWriter,
    scenario: Scenario,
    *,
    watch: Watch | None = None,
    observe: Observer | None = None,
    intervene: Intervention | None = None,
) -> None:
    """Play a scenario into an entered writer, from the state that it says, and publish the file.

    ``watch`` is called after each range of ticks, and now and then while a file is compressed; ``observe`` and
    ``intervene`` are those of `rubnoise.run`.
    """
    model = scenario.model()
    tally = Tally.of(model)
    writer.replay(tally)
    end = simulate(
        model,
        scenario.run.seed,
        Tee((writer, tally)),
        engine=cast(Engine, scenario.run.engine),
        state=writer.state,
        observe=observe,
        intervene=intervene,
        watch=watch,
        commit=writer.commit,
    )
    figures: dict[str, float | int | str] = {}
    for figure in summarise(model, tally):
        figures |= figure.as_attributes()

    def between() -> None:
        if watch is not None:
            watch(model.distance, end.junctions, len(end.live))

    writer.publish(figures, between=between)
