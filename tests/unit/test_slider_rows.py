"""/slider has a number of rows of its own: nothing takes it for a copy of /trace."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.verification import verify
from rubnoise.figures.slider import slider_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.model import Model
from rubnoise.record.sink import Appender
from rubnoise.scenario import Scenario, build
from rubnoise.simulation.block_starts import BlockStarts
from rubnoise.storage.reader import open_run

KEYS = {
    "format": 1,
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "strength": {"mean": "250 MPa"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
    "sliding": {"distance": "16 mm", "speed": "1 mm/s"},
    "output": {"tick": "5 um"},
}
TICKS, FEWER = 3201, 2001


@pytest.fixture
def run() -> Scenario:
    return build(KEYS)


def shorten(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let sliders end before the run does."""
    append = Appender.append

    def at_most(self: Appender, columns: dict[str, Any]) -> None:
        append(self, {name: values[: FEWER - self.rows] for name, values in columns.items()})

    monkeypatch.setattr(Model, "slider_rows", FEWER)
    monkeypatch.setattr(Appender, "append", at_most)


def test_a_slider_may_have_fewer_rows_than_there_are_ticks(
    tmp_path: Path, run: Scenario, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = rubnoise.simulate(run)
    with monkeypatch.context() as patch:
        shorten(patch)
        short = rubnoise.simulate(run)
        rubnoise.run(run, tmp_path / "x.h5").close()
    assert (len(short.trace), len(short.slider)) == (TICKS, FEWER)
    with rubnoise.open(tmp_path / "x.h5") as opened:
        assert (len(opened.trace), len(opened.slider)) == (TICKS, FEWER)
        assert opened.to_xarray()["slider"].sizes == {"time": FEWER}
        for name in whole.slider:
            assert np.array_equal(opened.slider[name], whole["slider"][name][:FEWER])
            assert np.array_equal(short["slider"][name], whole["slider"][name][:FEWER])
    with open_run(tmp_path / "x.h5") as file:
        assert (file.extent.ticks, file.extent.slider) == (TICKS, FEWER)
        assert Stretch.of(file).rows("slider") == (0, FEWER)
        assert Stretch.of(file).rows("trace") == (0, TICKS)
        assert len(slider_figure(Stretch.of(file)).axes) == 3


def test_a_one_way_slider_of_other_rows_is_seen(tmp_path: Path, run: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        shorten(patch)
        rubnoise.run(run, tmp_path / "x.h5").close()
    with open_run(tmp_path / "x.h5") as file:
        [wrong] = verify(file).different
    assert (wrong.name, wrong.first.place) == ("layout", "/slider rows")
    assert (wrong.first.found, wrong.first.expected) == (str(FEWER), str(TICKS))


def test_a_block_begins_where_the_slider_was_last_before_it() -> None:
    """Whatever its rows are: here two to a tick, in panels that end between blocks."""
    places = np.array([0.0, 10.0, 20.0, 30.0])
    starts = BlockStarts(
        block=np.arange(4),
        birth_distance=places,
        first_junction=np.zeros(4, np.int64),
        first_tick=np.zeros(4, np.int64),
        time=np.zeros(4),
        distance=np.zeros(4),
        phase=np.zeros(4, np.uint8),
        displacement=np.full(4, -1.0),
        velocity=np.full(4, -1.0),
    )
    distance = np.arange(0.0, 25.0, 0.5)
    for panel in (distance[:7], distance[7:41], distance[41:]):
        starts.pass_slider({"distance": panel, "displacement": 2.0 * panel, "velocity": 3.0 * panel})
    assert starts.displacement.tolist() == [-1.0, 19.0, 39.0, 49.0]
    assert starts.velocity.tolist() == [-1.0, 28.5, 58.5, 73.5]
