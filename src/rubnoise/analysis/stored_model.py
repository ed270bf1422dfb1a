"""The scenario of a run and its physics, from what the file keeps of them."""

import json

from rubnoise.errors import Refused, RunFileRefused
from rubnoise.model import Model
from rubnoise.record.reader import Reader
from rubnoise.scenario import Scenario, build


def stored_scenario(file: Reader) -> Scenario:
    """Return the scenario of a run; raises RunFileRefused where its file has none that can be run."""
    try:
        return build(json.loads(str(file.provenance["scenario_resolved"])))
    except (ValueError, RecursionError, AttributeError, TypeError, Refused) as problem:
        raise RunFileRefused("the scenario in the file is not valid, so there are no exact values") from problem


def stored_model(file: Reader) -> Model:
    """Return the model of a run; raises RunFileRefused where its file has no scenario that can be run."""
    return stored_scenario(file).model()
