"""Life-lines and the ratio of spectra: lanes without overlaps, the count as bars crossed, estimate over expected."""

from collections.abc import Iterator

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.figures.catalogue import PICTURES, picture
from rubnoise.figures.lifelines import lanes
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import house_style
from rubnoise.storage.reader import open_run

VALUES = {
    "format": 1,
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "1 um"},
    "sliding": {"distance": "6 mm"},
    "output": {"tick": "0.5 um"},
    "run": {"engine": "batch"},
}


@pytest.fixture(scope="module")
def full(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    path = tmp_path_factory.mktemp("lifelines") / "run.h5"
    rubnoise.run(rubnoise.build(VALUES), path, seed=5).close()
    with open_run(path) as file:
        yield Stretch.of(file)


def lives(stretch: Stretch) -> tuple[np.ndarray, np.ndarray]:
    return stretch.file.column("junctions", "birth_distance"), stretch.file.column("junctions", "death_distance")


def overlaps(birth: np.ndarray, death: np.ndarray, lane: np.ndarray) -> int:
    """Return how many lives begin before the one before them in their lane has ended."""
    order = np.lexsort((birth, lane))
    same = np.diff(lane[order]) == 0
    return int(np.sum(same & (birth[order][1:] < death[order][:-1])))


def test_no_two_lives_of_a_lane_overlap_and_there_are_no_more_lanes_than_lives_at_once(full: Stretch) -> None:
    birth, death = lives(full)
    lane = lanes(birth, death)
    assert overlaps(birth, death, lane) == 0
    most = max(int(np.sum((birth <= place) & (place < death))) for place in birth)
    assert lane.max() + 1 == most
    assert overlaps(birth, death, np.minimum(lane, 5)) > 0, "lanes that overlap are noticed"


def test_the_line_crosses_as_many_bars_as_junctions_are_alive(full: Stretch) -> None:
    stretch = Stretch.of(full.file, 1000.0, 1040.0)
    birth, death = lives(full)
    with house_style():
        above, _ = PICTURES["lifelines"](stretch).axes
        names = {str(each.get_label()): each for each in above.collections}
        bars = np.array([path.get_extents().get_points() for path in names["other lives"].get_paths()])
    alive = int(np.sum((birth <= 1020.0) & (death > 1020.0)))
    assert f"{alive} alive at the line" in names
    assert len(names[f"{alive} alive at the line"].get_paths()) == alive
    assert not np.any((bars[:, 0, 0] <= 1020.0) & (bars[:, 1, 0] > 1020.0))
    assert len(bars) + alive == int(np.sum((birth <= 1040.0) & (death >= 1000.0)))


def test_too_many_bars_are_refused(full: Stretch) -> None:
    with pytest.raises(Refused, match=r"of which a picture shows 2,000 at most"):
        picture("lifelines", Stretch.of(full.file, 0.0, 5000.0), "png")


def test_the_ratio_of_the_spectrum_is_one_within_its_band(full: Stretch) -> None:
    with house_style():
        _, ratio = PICTURES["psd"](full).axes
    values = ratio.lines[-1].get_ydata()
    low, high = ratio.patches[0].get_extents().transformed(ratio.transData.inverted()).intervaly
    assert (low + high) / 2.0 == pytest.approx(1.0)
    # Of independent values with two standard errors some 5 % are outside; neighbours share some of their error.
    outside = np.mean((values < low) | (values > high))
    assert outside < 0.15
    assert np.mean((1.5 * values < low) | (1.5 * values > high)) > 0.3, "a spectrum half as high again is noticed"


def test_the_length_of_a_life_is_marked(full: Stretch) -> None:
    with house_style():
        (axes,) = PICTURES["acf"](full).axes
    marks = [line for line in axes.lines if "life, 2d" in str(line.get_label())]
    assert [line.get_xdata()[0] for line in marks] == [full.model.mean_life_distance]
