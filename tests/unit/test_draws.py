"""What a seed decides, block by block."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.deviates import exponential
from rubnoise.contact.laws import Spread
from rubnoise.simulation import draws
from rubnoise.simulation.draws import (
    birth_distances,
    births_by_block,
    births_per_block,
    draw_blocks,
    first_birth,
    start,
)
from rubnoise.streams import Stream, generator
from tests.models import UNEQUAL, bare, model

RUN = bare(distance=3_000.0, tick=1.0)


@pytest.mark.parametrize(
    ("count", "births"), [(0.01, 1000), (20.0, 1000), (100.0, 1000), (100.01, 1001), (5000.0, 50_000)]
)
def test_a_block_has_a_thousand_births_or_ten_lives(count: float, births: int) -> None:
    assert births_per_block(bare(count=count)) == births


def test_each_birth_is_the_one_before_plus_its_gap() -> None:
    birth, gaps = birth_distances(RUN, 4, 2, 812.25)
    assert birth[0] == 812.25
    at = 812.25
    for gap, following in zip(gaps.tolist(), birth[1:].tolist(), strict=True):
        at += gap
        assert at == following


def test_blocks_follow_each_other_without_a_gap() -> None:
    block, begin, seen = 0, first_birth(RUN, 4), []
    while begin <= RUN.distance:
        births = draw_blocks(RUN, 4, block, begin)
        assert births.birth[0] == begin
        seen.extend(births.birth.tolist())
        block, begin = block + 1, births.next_birth
    assert len(seen) == sum(births_by_block(RUN, 4))
    assert block == -(-len(seen) // 1000)
    assert seen[-1] <= RUN.distance < begin


def test_a_birth_at_the_very_end_is_still_of_the_run() -> None:
    birth, _ = birth_distances(RUN, 4, 0, first_birth(RUN, 4))
    at = replace(RUN, distance=float(birth[10]))
    assert sum(births_by_block(at, 4)) == 11
    assert draw_blocks(at, 4, 0, first_birth(at, 4)).next_birth == birth[11]
    assert sum(births_by_block(replace(RUN, distance=float(np.nextafter(birth[10], 0.0))), 4)) == 10


def test_no_birth_within_the_run() -> None:
    run = bare(count=0.01, distance=1e-3, tick=1e-3)
    assert sum(births_by_block(run, 1)) == 0
    assert len(draw_blocks(run, 1, 0, first_birth(run, 1))) == 0


def test_one_purpose_never_shifts_another() -> None:
    """Births are the same whatever the sizes, sizes the same whatever the strength: each has its own stream."""
    wide = bare(distance=3_000.0, spread=Spread(absolute=1.0), start="empty")
    first = draw_blocks(RUN, 4, 0, 1.0)
    assert np.array_equal(draw_blocks(wide, 4, 0, 1.0).birth, first.birth)
    stressed = model(distance=3_000.0)
    assert np.array_equal(draw_blocks(stressed, 4, 0, 1.0).diameter, first.diameter)
    assert np.all(draw_blocks(stressed, 4, 0, 1.0).strength == 250.0)
    assert np.all(first.strength == 1.0)


def test_the_start_is_in_order_of_birth_and_alive() -> None:
    state = start(RUN, 4)
    assert np.all(np.diff(state.live.birth) >= 0.0)
    assert np.all(state.live.birth <= 0.0)
    assert np.all(state.live.death > 0.0)
    assert state.junctions == len(state.live) == state.live.junction[-1] + 1
    assert (state.block, state.ticks, state.begin, state.velocity) == (0, 0, 0.0, 0.0)
    assert len(start(replace(RUN, start="empty"), 4).live) == 0


def test_the_slider_starts_where_the_model_says() -> None:
    assert start(model(), 4).displacement == pytest.approx(170.561, rel=1e-5)
    assert start(RUN, 4).displacement == 0.0


@pytest.mark.parametrize("mean", [0.0, 0.3, 20.0, 1024.0, 5000.0])
def test_a_poisson_count_is_how_many_unit_exponentials_fit(mean: float) -> None:
    """Also beyond the 1024 that are drawn at a time."""
    waits = exponential(generator(8, Stream.START_COUNT).random(9_000))
    total, count = 0.0, 0
    while total + waits[count] <= mean:
        total += waits[count]
        count += 1
    assert draws._poisson(8, mean) == count


@pytest.mark.parametrize("births", ["poisson", "regular"])
def test_blocks_drawn_together_are_the_blocks_drawn_alone(monkeypatch, births):
    run = model(distance=6000.0, births=births, strength=UNEQUAL)
    together = draw_blocks(run, 5, 9, 4977.0)
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)
    alone = draw_blocks(run, 5, 9, 4977.0)
    assert len(together) == len(alone) > 500
    for column in ("birth", "gaps", "diameter", "strength"):
        assert getattr(together, column).tobytes() == getattr(alone, column).tobytes()
    with pytest.raises(ValueError, match="read-only"):
        together.diameter[0] = 1.0
