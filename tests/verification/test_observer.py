"""An observer is told of every birth, mid-life and death once, where and in the order in which they happen."""

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation import draws
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import extent, simulate
from tests.models import bare, contents, model, recorded

RUNS = {
    "figure 5": model(distance=1500.0, tick=0.5),
    "from empty": bare(distance=900.0, tick=0.7, start="empty"),
    "dense": bare(count=3000.0, distance=25.0, tick=0.5),
    "thin": bare(count=0.2, distance=20_000.0, tick=50.0),
    "Rabinowicz, where births meet deaths": bare(
        pulse=TRIANGLE, births="regular", spread=Spread(), distance=1500.0, tick=0.5
    ),
}


class Diary:
    """Writes down what it is told."""

    def __init__(self):
        self.entries = []
        self.observer = Observer(birth=self.noting("birth"), mid_life=self.noting("middle"), death=self.noting("death"))

    def noting(self, what):
        return lambda junction, distance: self.entries.append((what, junction, distance))

    def of(self, what):
        return {junction: distance for name, junction, distance in self.entries if name == what}


def expected(run, rows):
    """Return what has to be told of rows, by junction."""
    birth, death = rows["birth_distance"], rows["death_distance"]
    middle = birth + rows["diameter"]
    places = {"birth": birth, "middle": np.where(middle < death, middle, np.inf), "death": death}
    return {
        what: {n: s for n, s in enumerate(place.tolist()) if s <= run.distance and not np.signbit(s)}
        for what, place in places.items()
    }


@pytest.mark.parametrize("name", RUNS)
def test_everything_is_told_once_and_in_order(name):
    run, diary = RUNS[name], Diary()
    record = recorded(run, 3, observe=diary.observer)
    for what, places in expected(run, record["junctions"]).items():
        assert diary.of(what) == places
    assert len(diary.entries) == len({entry[:2] for entry in diary.entries}) > 100
    clock = [distance for _, _, distance in diary.entries]
    assert np.diff(clock).min() > -1e-9 * run.distance
    assert contents(record) == contents(recorded(run, 3))


def test_an_interrupted_life_is_told_to_its_end():
    run, diary = RUNS["figure 5"], Diary()

    def ends(env, live):
        if env.now < 100.0:
            yield env.timeout(100.0 - env.now)
            for junction in live:
                live.end(junction.number)
        yield env.timeout(0.0)

    rows = recorded(run, 3, observe=diary.observer, intervene=ends)["junctions"]
    assert np.sum(rows["death_distance"] == 100.0) > 10
    for what, places in expected(run, rows).items():
        assert diary.of(what) == places


def test_a_run_that_goes_on_tells_the_rest(monkeypatch):
    monkeypatch.setattr(draws, "_DRAWN_AT_ONCE", 1)
    run, whole, states = RUNS["figure 5"], Diary(), []
    simulate(run, 3, MemoryRecord(extent(run, 3)), observe=whole.observer, commit=states.append)
    rest = Diary()
    simulate(run, 3, MemoryRecord(extent(run, 3)), observe=rest.observer, state=states[0])
    assert 100 < len(rest.entries) < len(whole.entries)
    assert rest.entries == whole.entries[-len(rest.entries) :]


def test_who_asks_for_deaths_alone_hears_of_nothing_else():
    run, deaths = RUNS["figure 5"], {}
    record = recorded(run, 3, observe=Observer(death=deaths.__setitem__))
    assert deaths == expected(run, record["junctions"])["death"]
