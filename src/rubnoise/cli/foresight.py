"""What a run will take: counted exactly from its seed, before any event."""

from rubnoise.scenario import Scenario
from rubnoise.simulation.run import extent
from rubnoise.storage.layout import expected_bytes, features_of


def counted(scenario: Scenario) -> dict[str, int]:
    """Return the rows, ticks and bytes of a scenario's result."""
    model = scenario.model()
    rows = extent(model, scenario.run.seed)
    size = expected_bytes(rows, features_of(model)) + len(scenario.text.encode())
    return {"junctions": rows.junctions, "ticks": rows.ticks, "bytes": size}
