"""Observers see everything once, and an interrupted junction is gone from there on."""

from dataclasses import replace

import numpy as np
import pytest

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, TRIANGLE
from rubnoise.record.rows import JunctionState
from rubnoise.simulation.observer import Observer
from tests.models import bare, contents, model, recorded, run_to_end

# An observer gets every birth, mid-life and death once, where and in the order in which they happen.
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


@pytest.mark.slow("dense")
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


# The live set is what the processes make it: an interrupted junction is gone from there on, in every column.
RUN = model(distance=1000.0, tick=0.1)


def ends(when):
    """An intervention that ends junctions at given distances, however the run is cut into blocks."""
    left = dict(when)

    def intervene(env, live):
        for number, distance in sorted(left.items(), key=lambda item: item[1]):
            if distance > env.now:
                yield env.timeout(distance - env.now)
                if number in live:
                    live.end(number)
                    left.pop(number)
        yield env.timeout(0)

    return intervene


def targets(record):
    """Some junctions in the first and second block, each with a place within its life."""
    rows = record["junctions"]
    birth, diameter = rows["birth_distance"], rows["diameter"]
    share = {0: 1.9, 30: 0.3, 500: 1.0, 501: 1.2, 1200: 1.7, 1500: 0.05}
    return {
        n: float(max(birth[n] + s * diameter[n], 0.37)) for n, s in share.items() if birth[n] + 2 * diameter[n] > 0.4
    }


@pytest.fixture(scope="module")
def pair():
    whole = recorded(RUN)
    when = targets(whole)
    return whole, recorded(RUN, intervene=ends(when)), when


def test_rows_show_when_and_how_they_ended(pair):
    whole, cut, when = pair
    rows, before = cut["junctions"], whole["junctions"]
    for number, distance in when.items():
        assert rows["death_distance"][number] == pytest.approx(distance, rel=1e-14)
        assert rows["life_distance"][number] == rows["death_distance"][number] - rows["birth_distance"][number]
        assert rows["death_time"][number] == rows["death_distance"][number] / RUN.sliding_speed
        assert rows["state"][number] & JunctionState.ENDED_EARLY
    others = np.setdiff1d(np.arange(rows["state"].size), list(when))
    for column, values in rows.items():
        assert np.array_equal(values[others], before[column][others])


def test_count_and_area_lose_exactly_those_junctions(pair):
    whole, cut, when = pair
    s = whole["trace"]["distance"]
    missing, lost = np.zeros(s.size), np.zeros(s.size, dtype=np.int64)
    rows = whole["junctions"]
    for number in when:
        gone = (s >= cut["junctions"]["death_distance"][number]) & (s < rows["death_distance"][number])
        missing[gone] += LENS.area(s[gone] - rows["birth_distance"][number], rows["diameter"][number])
        lost[gone] += 1
    assert lost.any()
    counts = [record["trace"]["junction_count"].astype(np.int64) for record in (whole, cut)]
    assert np.array_equal(counts[0] - counts[1], lost)
    areas = [record["trace"]["real_contact_area"] for record in (whole, cut)]
    assert np.abs(areas[0] - areas[1] - missing).max() < 1e-10
    assert np.array_equal(cut["trace"]["friction_force"], 250.0 * areas[1])


def test_a_junction_interrupted_in_a_later_block_is_written_again():
    whole, _ = run_to_end(RUN)
    births = whole["junctions"]["birth_distance"]
    number = 995 + int(np.sum(births < 0))
    distance = float(births[number] + 1.9 * whole["junctions"]["diameter"][number])
    boundary = float(births[1000 + int(np.sum(births < 0))])
    assert births[number] < boundary < distance
    cut = recorded(RUN, intervene=ends({number: distance}))
    assert cut["junctions"]["death_distance"][number] == pytest.approx(distance, rel=1e-14)
    assert cut["junctions"]["state"][number] == JunctionState.ENDED_EARLY
