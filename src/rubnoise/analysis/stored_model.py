"""The physics of a run, from the scenario that its file keeps."""

import json

from rubnoise.errors import Refused, RunFileRefused
from rubnoise.model import Model
from rubnoise.scenario import build
from rubnoise.storage.reader import RunFile


def stored_model(file: RunFile) -> Model:
    """Return the model of a run; raises RunFileRefused where its file has no scenario that can be run."""
    try:
        return build(json.loads(str(file.provenance["scenario_resolved"]))).model()
    except (ValueError, RecursionError, AttributeError, Refused) as problem:
        raise RunFileRefused("the scenario in the file is none that can be run, so theory is silent") from problem
