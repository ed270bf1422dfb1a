"""From a scenario's text to a file anyone opens: the same bytes as in memory, for thin, dense, short and empty runs."""

from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.scenario.reading import loads

SCENARIO = """
format = 1
title = "{name}"
[interface]
mean_real_contact_area = "{area} um^2"
mean_junction_count = {count}
[diameter]
law = "{law}"
{spread}
[strength]
mean = "250 MPa"
[sliding]
speed = "{speed} mm/s"
distance = "{distance} um"
start = "{start}"
[slider]
mass = "5 g"
stiffness = "300 N/m"
damping = "0.05 N*s/m"
[output]
tick = "{tick} um"
"""


def scenario(
    name: str,
    *,
    area: float = 200,
    count: float = 20,
    spread: str = "0.2 um",
    distance: float = 100,
    tick: float = 0.1,
    speed: float = 1,
    start: str = "stationary",
) -> str:
    law, line = ("normal", f'spread = "{spread}"') if spread else ("fixed", "")
    return SCENARIO.format(
        name=name,
        area=area,
        count=count,
        law=law,
        spread=line,
        distance=distance,
        tick=tick,
        speed=speed,
        start=start,
    )


RUNS = {
    text.split('"')[1]: text
    for text in (
        scenario("thin", count=0.01, distance=50_000, tick=10, speed=100),
        scenario("one in ten", count=0.1, distance=5_000, tick=5),
        scenario("figure 5", distance=2_000),
        scenario("a thousand", count=1_000, distance=20, tick=0.02),
        scenario("dense", count=5_000, distance=2, tick=0.005),
        scenario("shorter than a life", distance=0.7),
        scenario("a single step", distance=0.19),
        scenario("no birth", count=0.01, distance=5, start="empty"),
        scenario("one size", spread=""),
        scenario("spread above the mean", area=3, count=1, spread="8 um", distance=2_000, tick=0.5),
        scenario("relative spread", spread="30 %"),
    )
}


@pytest.mark.parametrize("name", RUNS)
def test_a_file_holds_what_memory_holds(tmp_path: Path, name: str) -> None:
    given = loads(RUNS[name])
    record = rubnoise.simulate(given)
    path = tmp_path / "run.h5"
    with rubnoise.run(given, path) as run:
        names = {group: set(columns.names) for group, columns in run.groups().items() if group != "life_curve"}
        assert names == {group: set(columns) for group, columns in record.groups.items()}
        for group, columns in record.groups.items():
            for column, values in columns.items():
                assert run.groups()[group][column][:].tobytes() == values.tobytes()
        assert run.scenario.model() == given.model()
        assert all(np.isfinite(figure.observed) for figure in run.summary)
    with h5py.File(path, "r") as file:
        assert file["junctions/diameter"].shape == record["junctions"]["diameter"].shape
        assert file["trace/real_contact_area"].shape == (given.model().tick_count + 1,)


def test_the_runs_are_what_they_are_called() -> None:
    records = {name: rubnoise.simulate(loads(RUNS[name])) for name in ("no birth", "one size", "spread above the mean")}
    assert records["no birth"].extent.junctions == 0
    assert np.unique(records["one size"]["junctions"]["diameter"]).size == 1
    law = loads(RUNS["spread above the mean"]).model()
    assert law.calibrated_diameter < 8.0
    assert records["spread above the mean"]["junctions"]["diameter"].min() > 0.0
    assert loads(RUNS["shorter than a life"]).model().distance < 11.0
    assert loads(RUNS["a single step"]).model().tick_count == 1
