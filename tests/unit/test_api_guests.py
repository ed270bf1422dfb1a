"""Watching a run and stepping into it from Python: observers and interventions, as a person would have them."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.contact.pulses import LENS
from rubnoise.record.rows import JunctionState
from rubnoise.runs.verification import verify
from rubnoise.scenario import Scenario, build
from rubnoise.simulation import draws
from rubnoise.storage.reader import open_run
from tests.shell.terminal import call, names
from tests.unit.tampering import tell

EVERY = 50.0
"""um between two junctions that an intervention ends."""


class Sheared(Exception):  # noqa: N818
    """What a callback raises."""


@pytest.fixture
def scenario(monkeypatch: pytest.MonkeyPatch) -> Scenario:
    """Return a run of three blocks, of which none are played together."""
    monkeypatch.setattr(draws, "BLOCK", 1000)
    return build(
        {
            "format": 1,
            "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
            "strength": {"mean": "250 MPa"},
            "sliding": {"speed": "1 mm/s", "distance": "1500 um"},
            "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
            "output": {"tick": "0.5 um"},
        }
    )


def batch(scenario: Scenario) -> Scenario:
    resolved = scenario.resolved()
    return build(resolved | {"run": resolved["run"] | {"engine": "batch"}})


def largest_goes(env: Any, live: rubnoise.LiveJunctions) -> Iterator[Any]:
    """End the largest live junction at every multiple of a distance, wherever it begins."""
    while True:
        yield env.timeout(EVERY * (np.floor(env.now / EVERY + 1e-6) + 1.0) - env.now)
        live.end(max(live, key=lambda junction: junction.area).number)


def contents(result: Any) -> dict[tuple[str, str], bytes]:
    return {
        (group, column): np.asarray(getattr(result, group)[column]).tobytes()
        for group in ("junctions", "trace", "slider")
        for column in getattr(result, group).names
    }


def raising_after(times: int) -> rubnoise.Observer:
    """Return who raises at a later birth."""
    seen: list[int] = []

    def birth(junction: int, _distance: float) -> None:
        seen.append(junction)
        if len(seen) > times:
            raise Sheared(junction)

    return rubnoise.Observer(birth=birth)


@pytest.mark.slow
def test_what_an_intervention_ends_is_ended_early_and_verifies(scenario: Scenario, tmp_path: Path) -> None:
    with rubnoise.run(scenario, tmp_path / "x.h5", intervene=largest_goes) as run:
        ended = (run.junctions["state"][:] & JunctionState.ENDED_EARLY) > 0
        deaths = run.junctions["death_distance"][:][ended]
        np.testing.assert_allclose(np.sort(deaths), EVERY * np.arange(1, deaths.size + 1), rtol=1e-12)
        assert deaths.size == 30
        assert run.provenance["intervention"] == f"{__name__}.largest_goes"
        assert contents(run) == contents(rubnoise.simulate(scenario, intervene=largest_goes))
    told = call("info", tmp_path / "x.h5", "--json").json()["intervention"]
    assert told["value"] == f"{__name__}.largest_goes"
    assert re.search(r"^ +intervention +\S+\.largest_goes$", call("info", tmp_path / "x.h5").out, re.MULTILINE)
    with open_run(tmp_path / "x.h5") as file:
        found = verify(file)
    assert [str(check.first) for check in found.different] == []
    tell(tmp_path / "x.h5", "provenance", "intervention", "another", seal=False)
    with open_run(tmp_path / "x.h5") as file:
        assert [check.name for check in verify(file).different] == ["hashes"]


def test_who_lives_is_shown_with_number_birth_diameter_and_area(scenario: Scenario) -> None:
    shown: list[tuple[float, list[Any]]] = []

    def looks(env: Any, live: rubnoise.LiveJunctions) -> Iterator[Any]:
        yield env.timeout(400.0)
        there = list(live)
        shown.append((env.now, there))
        gone = there[3].number
        assert gone in live
        assert len(live) == len(there)
        live.end(np.int64(gone))
        assert gone not in live
        assert len(live) == len(there) - 1
        assert [each.number for each in live] == [each.number for each in there if each.number != gone]
        with pytest.raises(ValueError, match=f"junction {gone} is not alive at 400 um"):
            live.end(gone)
        yield env.timeout(1.0)
        assert gone not in live
        assert repr(live) == f"{len(live)} junctions alive at 401 um"

    record = rubnoise.simulate(scenario, intervene=looks)
    ((now, there),) = shown
    rows = {name: record.junctions[name][:] for name in ("birth_distance", "death_distance", "diameter")}
    alive = (rows["birth_distance"] <= now) & (now <= rows["death_distance"])
    assert [each.number for each in there] == np.flatnonzero(alive).tolist()
    assert [each.birth_distance for each in there] == rows["birth_distance"][alive].tolist()
    assert [each.diameter for each in there] == rows["diameter"][alive].tolist()
    ages = now - rows["birth_distance"][alive]
    np.testing.assert_allclose([each.area for each in there], LENS.area(ages, rows["diameter"][alive]), atol=1e-9)
    assert record.trace["junction_count"][:][800] == len(there) - 1


def waits(places: list[float]) -> Any:
    def process(env: Any, _live: Any) -> Iterator[Any]:
        env.process(twice(env))
        while True:
            yield env.timeout(7.0)
            places.append(env.now)

    def twice(env: Any) -> Iterator[Any]:
        for _ in range(2):
            yield env.timeout(600.0)
            places.append(-env.now)

    return process


def test_an_intervention_knows_nothing_of_blocks(scenario: Scenario) -> None:
    places: list[float] = []
    record = rubnoise.simulate(scenario, intervene=waits(places))
    assert len(record.junctions) > 2 * draws.births_per_block(scenario.model())
    np.testing.assert_allclose([place for place in places if place > 0.0], np.arange(7.0, 1500.0, 7.0), rtol=1e-12)
    np.testing.assert_allclose([-place for place in places if place < 0.0], [600.0, 1200.0], rtol=1e-12)


def test_what_a_callback_raises_comes_out_and_nothing_is_left(scenario: Scenario, tmp_path: Path) -> None:
    def breaks(env: Any, _live: Any) -> Iterator[Any]:
        yield env.timeout(700.0)
        raise Sheared(700)

    with pytest.raises(Sheared, match="700"):
        rubnoise.simulate(scenario, intervene=breaks)
    for guest in ({"observe": raising_after(1500)}, {"intervene": breaks}):
        with pytest.raises(Sheared):
            rubnoise.run(scenario, tmp_path / "x.h5", **guest)
        assert names(tmp_path) == []
    rubnoise.run(scenario, tmp_path / "x.h5", observe=raising_after(10_000)).close()
    assert names(tmp_path) == ["x.h5"]
