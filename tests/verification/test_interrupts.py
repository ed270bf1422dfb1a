"""The live set is what the processes make it: an interrupted junction is gone from there on, in every column."""

import numpy as np
import pytest

from rubnoise.contact.overlap import junction_area
from rubnoise.record.rows import JunctionState
from tests.models import contents, model, recorded, run_to_end

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
        missing[gone] += junction_area(s[gone] - rows["birth_distance"][number], rows["diameter"][number])
        lost[gone] += 1
    assert lost.any()
    counts = [record["trace"]["junction_count"].astype(np.int64) for record in (whole, cut)]
    assert np.array_equal(counts[0] - counts[1], lost)
    areas = [record["trace"]["real_contact_area"] for record in (whole, cut)]
    assert np.abs(areas[0] - areas[1] - missing).max() < 1e-11
    assert np.array_equal(cut["trace"]["friction_force"], 250.0 * areas[1])


def test_the_slider_feels_it_from_there_on(pair):
    whole, cut, when = pair
    s, first = whole["trace"]["distance"], min(when.values())
    difference = whole["slider"]["displacement"] - cut["slider"]["displacement"]
    assert not difference[s < first].any()
    assert np.abs(difference[s > first + 1.0]).max() > 0.1


def test_a_run_with_interrupts_repeats_itself(pair):
    _, cut, when = pair
    assert contents(recorded(RUN, intervene=ends(when))) == contents(cut)


def test_one_event_less_or_more_for_nobody():
    """An intervention that does nothing changes no bit."""

    def looks_on(env, live):
        assert len(live) > 0
        yield env.timeout(0.0)

    assert contents(recorded(RUN, intervene=looks_on)) == contents(recorded(RUN))


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
