"""A stretch of a result: which rows it holds, and what is left of them where there are many."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.figures import stretch as stretches
from rubnoise.figures.stretch import MOST_POINTS, Stretch
from rubnoise.storage.reader import RunFile, open_run

SCENARIO = {
    "format": 1,
    "title": "a contact",
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "sliding": {"distance": 3000.0},
    "output": {"tick": "0.1 um"},
}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stretch") / "run.h5"
    rubnoise.run(rubnoise.build(SCENARIO), path).close()
    return path


@pytest.fixture
def file(path: Path) -> Iterator[RunFile]:
    with open_run(path) as opened:
        yield opened


def test_all_of_a_run_is_shown_unless_somebody_chooses(file: RunFile) -> None:
    whole = Stretch.of(file)
    assert (whole.start, whole.stop, whole.rows("trace")) == (0.0, 3000.0, (0, 30_001))
    assert not whole.chosen
    assert whole.title == "a contact"
    chosen = Stretch.of(file, 1.0, 2.0)
    assert chosen.chosen
    assert chosen.rows("trace") == (10, 21)
    assert Stretch.of(file, stop=1e9).rows("trace") == (0, 30_001)


def test_narrowing_leaves_a_choice_alone(file: RunFile) -> None:
    whole = Stretch.of(file, None, None)
    assert (whole.narrowed(30.0).start, whole.narrowed(30.0).stop) == (0.0, 30.0)
    assert whole.narrowed(1e6) == whole
    chosen = Stretch.of(file, 500.0, None)
    assert chosen.narrowed(30.0) == chosen
    assert chosen.whole().rows("trace") == whole.rows("trace")


def test_the_ends_are_ticks_even_where_division_rounds(file: RunFile) -> None:
    for tick in (3, 7, 29, 57, 1234, 29_999):
        assert Stretch.of(file, 0.1 * tick, 0.1 * (tick + 1)).rows("trace") == (tick, tick + 2)


@pytest.mark.parametrize(
    ("start", "stop", "said"),
    [
        (5.0, 5.0, "nothing lies in 5 to 5 um; the run goes from 0 to 3000 um"),
        (6.0, 5.0, "nothing lies in 6 to 5 um"),
        (-1.0, 5.0, "nothing lies in -1 to 5 um"),
        (4000.0, None, "nothing lies in 4000 to 3000 um"),
        (1.0, 1.05, "1 to 1.05 um is too short to draw; the run has a tick every 0.1 um"),
    ],
)
def test_a_stretch_of_nothing_is_refused(file: RunFile, start: float, stop: float | None, said: str) -> None:
    with pytest.raises(Refused, match=said):
        Stretch.of(file, start, stop)


def test_few_rows_are_drawn_as_they_are(file: RunFile) -> None:
    distance, area = Stretch.of(file, 100.0, 200.0).curve("trace", "real_contact_area")
    np.testing.assert_array_equal(area, file.column("trace", "real_contact_area", 1000, 2001))
    np.testing.assert_allclose(distance, file.column("trace", "distance", 1000, 2001), rtol=1e-15)


def test_of_many_rows_the_extremes_are_kept(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stretches, "CHUNK_ROWS", 999)
    whole = Stretch.of(file)
    distance, area = whole.curve("trace", "real_contact_area")
    values = file.column("trace", "real_contact_area")
    assert area.size <= MOST_POINTS + 2
    assert distance.size == area.size
    assert (area.min(), area.max()) == (values.min(), values.max())
    np.testing.assert_array_equal(area[:2], [values[:22].min(), values[:22].max()])
    assert distance[0] == distance[1] == pytest.approx(1.05)
    assert np.all(np.diff(distance) >= 0.0)
    monkeypatch.undo()
    np.testing.assert_array_equal(area, whole.curve("trace", "real_contact_area")[1])


def test_panels_are_the_rows_in_order(file: RunFile) -> None:
    panels = list(Stretch.of(file, 10.0, 20.0).chunks("trace", "junction_count", 40))
    assert [chunk.size for chunk in panels] == [40, 40, 21]
    np.testing.assert_array_equal(np.concatenate(panels), file.column("trace", "junction_count", 100, 201))


def test_of_a_long_record_the_beginning_is_read(file: RunFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stretches, "MOST_READ", 50)
    record = Stretch.of(file, 10.0, 20.0).record("trace", "real_contact_area")
    np.testing.assert_array_equal(record, file.column("trace", "real_contact_area", 100, 150))
