"""Make one run: describe it, and write it into its file."""

import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol, cast

from rubnoise.analysis.summary import summarise
from rubnoise.arrays import slices
from rubnoise.model import Model
from rubnoise.record.sink import Columns, Sink, Tee
from rubnoise.record.tally import Tally
from rubnoise.scenario import Scenario
from rubnoise.simulation.block import Watch
from rubnoise.simulation.extent import Engine, extent
from rubnoise.simulation.intervention import Intervention, name_of
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import simulate, slider_constants
from rubnoise.storage.forecast import check_disk_space, expected
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.output import check_output
from rubnoise.storage.provenance import gather
from rubnoise.storage.writer import RunWriter


class Kept(Protocol):
    """A run in memory that says what was run."""

    @property
    def groups(self) -> Mapping[str, Columns]:
        """The columns of each group."""
        ...

    @property
    def intervention(self) -> str:
        """The function that may have ended lives."""
        ...

    def known_scenario(self) -> Scenario:
        """Return the scenario; raises Refused if it is not known."""
        ...

    def rows(self, group: str) -> int:
        """Return the number of rows of a group."""
        ...


def describe(
    scenario: Scenario,
    path: str | os.PathLike[str],
    command: Sequence[str],
    intervene: Intervention | str | None = None,
) -> RunDescription:
    """Return the description of a result; this counts its births and does nothing else.

    ``intervene`` is the function that may end lives, or its name.
    """
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
            intervention=intervene if isinstance(intervene, str) else "" if intervene is None else name_of(intervene),
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
) -> dict[str, float | int | str]:
    """Play a scenario into an entered writer, publish the file, and return its figures.

    ``watch`` is called after each range of ticks, and now and then while a file is compressed; ``observe`` and
    ``intervene`` are those of `rubnoise.run`.
    """
    model = scenario.model()
    tally = Tally.of(model)
    end = simulate(
        model,
        scenario.run.seed,
        Tee((writer, tally)),
        engine=cast(Engine, scenario.run.engine),
        observe=observe,
        intervene=intervene,
        watch=watch,
    )

    def between() -> None:
        if watch is not None:
            watch(model.distance, end.junctions, len(end.live))

    figures = _figures(model, tally)
    between()  # theory may take seconds, in which someone may have asked to stop
    writer.publish(figures, between=between)
    return figures


def save(record: Kept, path: str | os.PathLike[str], *, force: bool = False) -> None:
    """Write a run from memory into a result file (see Record.save)."""
    scenario = record.known_scenario()
    check_output(path, force=force)
    check_disk_space(scenario, expected(scenario), path)
    command = [Path(sys.argv[0]).name, *sys.argv[1:]]
    with RunWriter(path, describe(scenario, path, command, record.intervention), force=force) as writer:
        _play_again(record, writer)
        writer.publish(figures_of(record, scenario.model()))


def figures_of(record: Kept, model: Model) -> dict[str, float | int | str]:
    """Return the figures for /summary of a run in memory."""
    tally = Tally.of(model)
    _play_again(record, tally)
    return _figures(model, tally)


def _play_again(record: Kept, sink: Sink) -> None:
    """Write all rows of a run in memory to a sink, some at a time."""
    for group, columns in record.groups.items():
        for part in slices(0, record.rows(group)):
            sink.write(group, part.start, {name: values[part] for name, values in columns.items()})


def _figures(model: Model, tally: Tally) -> dict[str, float | int | str]:
    figures: dict[str, float | int | str] = {}
    for figure in summarise(model, tally):
        figures |= figure.as_attributes()
    return figures
