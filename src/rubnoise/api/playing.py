"""A run played into its file, from its start or from where it stopped."""

from typing import cast

from rubnoise.analysis.summary import summarise
from rubnoise.record.sink import Tee
from rubnoise.record.tally import Tally
from rubnoise.scenario import Scenario
from rubnoise.simulation.block import Watch
from rubnoise.simulation.intervention import Intervention
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import Engine, simulate
from rubnoise.storage.writer import RunWriter


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
