"""What an engine carries from block to block: ticks, counted births, its state."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.model import Model
from rubnoise.simulation import ticks as module
from rubnoise.simulation.draws import (
    birth_distances,
    blocks_drawn_at_once,
    count_births,
    draw_blocks,
    first_birth,
    start,
)
from rubnoise.simulation.state import State
from rubnoise.simulation.ticks import LARGEST_TICK_RANGE, tick_ranges
from tests.models import bare

RUN = bare(distance=3_000.0, tick=1.0)


def test_a_run_is_played_from_what_was_counted() -> None:
    count, begin, together = count_births(RUN, 7), first_birth(RUN, 7), blocks_drawn_at_once(RUN, 0)
    counted = birth_distances(RUN, 7, 0, begin, together)
    drawn = draw_blocks(RUN, 7, 0, begin, together)
    assert len(drawn) == count
    assert np.shares_memory(drawn.birth, counted)
    with pytest.raises(ValueError, match="read-only"):
        drawn.birth[0] = 1.0


# Panels cover every tick once, whatever the block and however large they may be.
def covered(run: Model, begin: State, next_birth: float, cells: int = 1) -> list[int]:
    return [
        tick
        for tick_range in tick_ranges(run, begin.ticks, next_birth, cells)
        for tick in range(tick_range.first, tick_range.end)
    ]


SHORT_RUN = bare(distance=10.0, tick=0.1)
BEGIN = start(SHORT_RUN, 1)


def test_a_block_owns_the_ticks_before_the_next_birth() -> None:
    assert covered(SHORT_RUN, BEGIN, 2.05) == list(range(21))
    assert covered(SHORT_RUN, BEGIN, 2.0) == list(range(20))  # a tick at the birth itself sees the newborn
    assert covered(SHORT_RUN, BEGIN, np.nextafter(2.0, 3.0)) == list(range(21))
    assert covered(SHORT_RUN, BEGIN, 0.0) == []


def test_the_last_block_ends_the_run() -> None:
    assert covered(SHORT_RUN, BEGIN, 11.0) == list(range(101))
    assert covered(SHORT_RUN, BEGIN, np.nextafter(10.0, 11.0)) == list(range(101))
    assert covered(SHORT_RUN, BEGIN, 10.0) == list(range(100))


def test_a_birth_after_the_last_tick_but_within_the_run_ends_nothing_early() -> None:
    run = bare(distance=10.05, tick=0.1)
    assert covered(run, start(run, 1), 10.04) == list(range(101))


def test_a_block_begins_where_the_one_before_ended() -> None:
    assert covered(SHORT_RUN, replace(BEGIN, ticks=21), 5.05) == list(range(21, 51))
    assert covered(SHORT_RUN, replace(BEGIN, ticks=21), 2.08) == []


@pytest.mark.parametrize("tick", [0.1, 0.3, 1.0 / 3.0, 1e-3, 7.7])
def test_ticks_and_births_are_told_apart_to_the_last_bit(tick: float) -> None:
    """The distance of a tick is i * tick as a float, not what i * tick would be in exact arithmetic."""
    run = replace(SHORT_RUN, distance=1e6 * tick, tick=tick, tick_count=1_000_000)
    for i in (1, 3, 7, 999, 123_457):
        at = float(i) * tick
        for birth, last in ((np.nextafter(at, 0.0), i - 1), (at, i - 1), (np.nextafter(at, np.inf), i)):
            found = list(tick_ranges(run, BEGIN.ticks, float(birth), 1))
            assert found[-1].end - 1 == last


@pytest.mark.parametrize("cells", [1, 4, 64, 2 * LARGEST_TICK_RANGE])
def test_panels_are_no_larger_than_allowed_and_cover_all(monkeypatch: pytest.MonkeyPatch, cells: int) -> None:
    monkeypatch.setattr(module, "LARGEST_TICK_RANGE", 128)
    assert covered(SHORT_RUN, BEGIN, 11.0, cells) == list(range(101))
    sizes = [tick_range.end - tick_range.first for tick_range in tick_ranges(SHORT_RUN, BEGIN.ticks, 11.0, cells)]
    assert max(sizes) == min(max(128 // cells, 1), 101)
