"""What an engine carries from block to block: ticks, counted births, its state."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.model import Model
from rubnoise.simulation import draws
from rubnoise.simulation import ticks as module
from rubnoise.simulation.draws import (
    BlockBirths,
    births_by_block,
    blocks_drawn_at_once,
    draw_blocks,
    first_birth,
    start,
)
from rubnoise.simulation.state import State
from rubnoise.simulation.ticks import LARGEST_TICK_RANGE, tick_ranges
from tests.models import bare

# Births between their being counted and their being played.
RUN = bare(distance=3_000.0, tick=1.0)


def test_a_run_is_played_from_what_was_counted_to_the_same_bits() -> None:
    begin, together = first_birth(RUN, 7), blocks_drawn_at_once(RUN, 0)
    assert draws._counted.take(RUN, 7, (0, begin, together)) is None
    drawn = draw_blocks(RUN, 7, 0, begin, together)
    assert len(drawn) == sum(births_by_block(RUN, 7))
    assert draws._counted.look(RUN, 7, (0, begin, together)) is not None
    played = draw_blocks(RUN, 7, 0, begin, together)
    assert draws._counted.look(RUN, 7, (0, begin, together)) is None
    for name in ("birth", "gaps", "diameter", "strength"):
        assert np.array_equal(getattr(drawn, name), getattr(played, name))
    assert (drawn.blocks, drawn.next_birth) == (played.blocks, played.next_birth)


# Panels cover every tick once, whatever the block and however large they may be.
def block_up_to(next_birth: float) -> BlockBirths:
    none = np.empty(0)
    return BlockBirths(birth=none, gaps=none, diameter=none, strength=none, blocks=1, next_birth=next_birth)


def covered(run: Model, begin: State, next_birth: float, cells: int = 1) -> list[int]:
    return [
        tick
        for tick_range in tick_ranges(run, begin, block_up_to(next_birth), cells)
        for tick in range(tick_range.first, tick_range.end)
    ]


SHORT_RUN = bare(distance=10.0, tick=0.1)
BEGIN = start(SHORT_RUN, 1)


@pytest.mark.parametrize("tick", [0.1, 0.3, 1.0 / 3.0, 1e-3, 7.7])
def test_ticks_and_births_are_told_apart_to_the_last_bit(tick: float) -> None:
    """The distance of a tick is i * tick as a float, not what i * tick would be in exact arithmetic."""
    run = replace(SHORT_RUN, distance=1e6 * tick, tick=tick, tick_count=1_000_000)
    for i in (1, 3, 7, 999, 123_457):
        at = float(i) * tick
        for birth, last in ((np.nextafter(at, 0.0), i - 1), (at, i - 1), (np.nextafter(at, np.inf), i)):
            found = list(tick_ranges(run, BEGIN, block_up_to(float(birth)), 1))
            assert found[-1].end - 1 == last


@pytest.mark.parametrize("cells", [1, 4, 64, 2 * LARGEST_TICK_RANGE])
def test_panels_are_no_larger_than_allowed_and_cover_all(monkeypatch: pytest.MonkeyPatch, cells: int) -> None:
    monkeypatch.setattr(module, "LARGEST_TICK_RANGE", 128)
    assert covered(SHORT_RUN, BEGIN, 11.0, cells) == list(range(101))
    sizes = [
        tick_range.end - tick_range.first for tick_range in tick_ranges(SHORT_RUN, BEGIN, block_up_to(11.0), cells)
    ]
    assert max(sizes) == min(max(128 // cells, 1), 101)
