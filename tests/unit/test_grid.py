"""Positions with whole blocks around them: where they lie, to the bit."""

import numpy as np
import pytest

from rubnoise.simulation.kernels.grid import Grid
from rubnoise.simulation.kernels.taylor import BLOCK


@pytest.mark.parametrize("cells", [1, 2, 8, 512])
def test_cells_of_a_divided_tick_hold_the_ticks_to_the_bit(cells: int) -> None:
    ticks, edges = Grid.around(37, 90, 0.1), Grid.around(36 * cells, 89 * cells + 1, 0.1 / cells)
    assert np.array_equal(edges.position[edges.wanted][cells::cells], ticks.position[ticks.wanted])
    assert np.array_equal(ticks.position[ticks.wanted], np.arange(37, 90) * 0.1)
    assert np.all(np.diff(edges.position) > 0.0)


@pytest.mark.parametrize(("first", "end"), [(0, 1), (1, 64), (63, 65), (64, 129), (1000, 5000)])
def test_there_is_a_block_before_and_after_what_is_wanted(first: int, end: int) -> None:
    grid = Grid.around(first, end, 0.25)
    assert grid.origin % BLOCK == 0
    assert grid.position.size % BLOCK == 0
    assert grid.wanted.start >= BLOCK
    assert grid.wanted.stop + BLOCK <= grid.position.size
    assert grid.position[grid.wanted][0] == first * 0.25
    assert grid.position[grid.cells()].size == end - first + 1
