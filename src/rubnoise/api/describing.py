"""What is known of a result before its first row, from its scenario."""

import os
from collections.abc import Sequence
from pathlib import Path

from rubnoise.model import Model
from rubnoise.scenario import Scenario
from rubnoise.simulation.intervention import Intervention, name_of
from rubnoise.simulation.run import extent, slider_constants
from rubnoise.storage.layout import RunDescription, features_of
from rubnoise.storage.provenance import gather


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
