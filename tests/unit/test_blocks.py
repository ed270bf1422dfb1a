"""What an engine carries from block to block: ticks, counted births, its state."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.simulation.draws import start
from rubnoise.simulation.ticks import tick_ranges
from tests.models import bare

SHORT_RUN = bare(distance=10.0, tick=0.1)
BEGIN = start(SHORT_RUN, 1)


@pytest.mark.parametrize("tick", [0.1, 0.3, 1.0 / 3.0, 1e-3, 7.7])
def test_ticks_and_births_are_told_apart_to_the_last_bit(tick: float) -> None:
    """The distance of a tick is i * tick as a float, not what i * tick would be in exact arithmetic."""
    run = replace(SHORT_RUN, distance=1e6 * tick, tick=tick, tick_count=1_000_000)
    for i in (1, 3, 7, 999, 123_457):
        at = float(i) * tick
        for birth, last in ((np.nextafter(at, 0.0), i - 1), (at, i - 1), (np.nextafter(at, np.inf), i)):
            assert list(tick_ranges(run, BEGIN.ticks, float(birth), 1))[-1][-1] == last
