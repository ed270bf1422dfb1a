"""Births between their being counted and their being played."""

from dataclasses import replace

import numpy as np

from rubnoise.simulation import draws
from rubnoise.simulation.draws import CountedBirths, births_by_block, blocks_drawn_at_once, draw_blocks, first_birth
from tests.models import bare

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
    for name in ("birth", "gaps", "diameter", "strength", "first"):
        assert np.array_equal(getattr(drawn, name), getattr(played, name))
    assert drawn.next_birth == played.next_birth
