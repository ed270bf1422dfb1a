"""An observer gets every birth, mid-life and death once, where and in the order in which they happen."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import TRIANGLE
from rubnoise.errors import Refused
from rubnoise.record.memory import MemoryRecord
from rubnoise.simulation import block_starts, draws
from rubnoise.simulation.extent import extent
from rubnoise.simulation.observer import Observer
from rubnoise.simulation.run import simulate
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
    """Records what it gets."""

    def __init__(self):
        self.entries = []
        self.observer = Observer(birth=self.noting("birth"), mid_life=self.noting("middle"), death=self.noting("death"))

    def noting(self, what):
        return lambda junction, distance: self.entries.append((what, junction, distance))

    def of(self, what):
        return {junction: distance for name, junction, distance in self.entries if name == what}


def expected(run, rows):
    """Return the expected events of rows, by junction."""
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


def two_way(run):
    return replace(run, slider=replace(run.slider, coupling="two-way"))


MOTION = ("stick", "slip", "reversal", "forward")
TWO_WAY = {
    "figure 5": two_way(model(distance=1500.0, tick=0.5)),
    "few, with reversals": two_way(model(distance=12_000.0, count=2.0, tick=0.5)),
    "without a contact at the start": two_way(model(distance=300.0, tick=0.5, start="empty")),
}


class Log:
    """Writes down in one list whatever happens, a birth or death under its time in the rows."""

    def __init__(self, *names):
        self.entries = []
        told = {name: self.noting(name) for name in names or (*MOTION, "birth", "mid_life", "death")}
        self.observer = Observer(**told)

    def noting(self, what):
        return lambda *told: self.entries.append((what, *told))

    def landmarks(self):
        return [(MOTION.index(what), *told) for what, *told in self.entries if what in MOTION]


def rows_of(landmarks):
    return list(zip(*(landmarks[name].tolist() for name in ("kind", "time", "distance", "velocity")), strict=True))


@pytest.mark.parametrize("engine", ["events", "batch"])
@pytest.mark.parametrize("name", TWO_WAY)
def test_landmarks_are_told_as_they_are_written(name, engine):
    run, log = TWO_WAY[name], Log(*MOTION)
    record = recorded(run, 3, engine=engine, observe=log.observer)
    assert log.landmarks() == rows_of(record["landmarks"])
    assert len(log.entries) > 5
    assert contents(record) == contents(recorded(run, 3, engine="batch"))


@pytest.mark.parametrize("name", TWO_WAY)
def test_lives_and_landmarks_come_in_order_of_time(name):
    run, log = TWO_WAY[name], Log()
    record = recorded(run, 3, observe=log.observer)
    rows = record["junctions"]
    for what, places in expected(run, rows).items():
        called = {"middle": "mid_life"}.get(what, what)
        assert {told[0]: told[1] for name, *told in log.entries if name == called} == places
    assert log.landmarks() == rows_of(record["landmarks"])
    times = {"birth": rows["birth_time"], "death": rows["death_time"]}
    clock = [told[0] if what in MOTION else times[what][told[0]] for what, *told in log.entries if what != "mid_life"]
    assert np.diff(clock).min() >= -1e-9
    # Were the contact told before the slider goes through it, landmarks would come late.
    assert len({what in MOTION for what, *_ in log.entries[: len(log.entries) // 4]}) == 2


def test_a_two_way_run_that_goes_on_tells_the_rest(monkeypatch):
    for each in (draws, block_starts):
        monkeypatch.setattr(each, "births_per_block", lambda _model: 60)
    run, whole, states = TWO_WAY["few, with reversals"], Log(), []
    simulate(run, 3, MemoryRecord(extent(run, 3)), observe=whole.observer, commit=states.append, alone=True)
    assert len(states) > 5
    for state in states[:-1]:
        rest = Log()
        simulate(run, 3, MemoryRecord(extent(run, 3)), observe=rest.observer, state=state)
        assert 100 < len(rest.entries) < len(whole.entries)
        assert rest.entries == whole.entries[-len(rest.entries) :]
        births = [told[0] for what, *told in whole.entries[: -len(rest.entries)] if what == "birth"]
        # Everything that the slider had not passed is observed, also before the next block.
        assert births[-1] < rest_births(rest)[0] == births[-1] + 1


def rest_births(log):
    return [told[0] for what, *told in log.entries if what == "birth"]


def test_landmarks_of_a_slider_that_does_not_push_back_are_refused():
    for name in MOTION:
        with pytest.raises(
            Refused, match=f'observe: {name}: only a slider .* slider.coupling = "two-way" makes it one'
        ):
            recorded(model(distance=20.0), observe=Log(name).observer)
    with pytest.raises(Refused, match='births, mid-lives and deaths are events: it needs the engine "events"'):
        recorded(TWO_WAY["figure 5"], engine="batch", observe=Log("stick", "birth").observer)
    with pytest.raises(Refused, match="Observer: slip: 3 is no function of a time, a distance and a velocity"):
        Observer(slip=3)


def test_an_observer_that_fails_is_not_taken_for_the_motion():
    def fails(*_told):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        recorded(TWO_WAY["figure 5"], observe=Observer(slip=fails))
