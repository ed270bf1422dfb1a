"""What an engine carries from block to block: ticks, counted births, its state."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.model import Model
from rubnoise.simulation import draws
from rubnoise.simulation import ticks as module
from rubnoise.simulation.draws import (
    BlockBirths,
    CountedBirths,
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
BIRTHS = (np.arange(3.0), np.ones(2))
PLACE = (0, 0.5, 16)


def test_births_are_looked_at_often_and_taken_once() -> None:
    kept = CountedBirths()
    assert kept.look(RUN, 1, PLACE) is None
    kept.keep(RUN, 1, PLACE, BIRTHS)
    for _ in range(2):
        assert kept.look(replace(RUN), 1, PLACE) is BIRTHS
    assert kept.take(RUN, 1, PLACE) is BIRTHS
    assert kept.take(RUN, 1, PLACE) is kept.look(RUN, 1, PLACE) is None


def test_another_run_or_place_has_other_births() -> None:
    kept = CountedBirths()
    kept.keep(RUN, 1, PLACE, BIRTHS)
    for run, seed, place in ((RUN, 2, PLACE), (replace(RUN, tick=0.5), 1, PLACE), (RUN, 1, (1, 0.5, 16))):
        assert kept.look(run, seed, place) is kept.take(run, seed, place) is None
    kept.keep(RUN, 2, PLACE, (BIRTHS[1], BIRTHS[0]))
    assert kept.look(RUN, 1, PLACE) is None
    assert kept.look(RUN, 2, PLACE) is not None


def test_no_more_are_kept_than_fit() -> None:
    kept = CountedBirths()
    for block in range(draws._MOST_KEPT + 5):
        kept.keep(RUN, 1, (block, 0.5, 16), BIRTHS)
    found = [kept.look(RUN, 1, (block, 0.5, 16)) is not None for block in range(draws._MOST_KEPT + 5)]
    assert found == [True] * draws._MOST_KEPT + [False] * 5


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
