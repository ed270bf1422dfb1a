"""The Python interface, used as a person would: runs, tables for xarray and pandas, summaries of sweeps."""

import copy
import pickle
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import rubnoise
from rubnoise import Junction
from rubnoise.analysis.findings import from_attributes
from rubnoise.analysis.run_summary import SummarySink
from rubnoise.contact.pulses import LENS
from rubnoise.errors import RunFileRefused, RunStopped, ScenarioRefused
from rubnoise.record.rows import JunctionState
from rubnoise.runs.folder import numbers_in, summarised
from rubnoise.scenario.sweep import expand
from tests.shell.terminal import CONTACT, WITH_SLIDER, names
from tests.unit.scenarios import GRID, sweep_of


# The Python interface, used as a person would.
@pytest.fixture
def scenario(tmp_path: Path) -> Any:
    file = tmp_path / "given.toml"
    file.write_text(WITH_SLIDER, encoding="utf-8")
    return rubnoise.load(file)


@pytest.fixture
def contact(tmp_path: Path) -> Any:
    file = tmp_path / "contact.toml"
    file.write_text(CONTACT, encoding="utf-8")
    return rubnoise.load(file)


def test_a_run_in_memory_is_the_run_in_the_file(scenario: Any, tmp_path: Path) -> None:
    record = rubnoise.simulate(scenario)
    with rubnoise.run(scenario, tmp_path / "x.h5") as run:
        groups = {name: columns for name, columns in run.groups().items() if name != "life_curve"}
        assert {name: set(columns.names) for name, columns in groups.items()} == {
            name: set(columns) for name, columns in record.groups().items() if name != "life_curve"
        }
        for name, columns in groups.items():
            for column in columns.names:
                assert columns[column].dtype == record[name][column].dtype
                assert columns[column][:].tobytes() == record[name][column].tobytes(), (name, column)


def test_a_file_is_opened_and_closed(scenario: Any, tmp_path: Path) -> None:
    rubnoise.run(scenario, tmp_path / "x.h5").close()
    run = rubnoise.open(tmp_path / "x.h5")
    with run as same:
        assert same is run
        assert len(run.trace) == len(run.slider) == 3001
        assert run.trace.names == ("distance", "real_contact_area", "junction_count", "friction_force")
        assert run.trace["distance"][[0, 1, -1]].tolist() == [0.0, 0.1, 300.0]
        assert run.attributes["title"] == "x"
    with pytest.raises(ValueError, match=r"x\.h5: the run file is closed"):
        run.trace["distance"][:]


COPIES: dict[str, Callable[[Any], Any]] = {
    "copied": copy.copy,
    "copied deeply": copy.deepcopy,
    "pickled": lambda given: pickle.loads(pickle.dumps(given)),  # noqa: S301  (made here)
}


@pytest.mark.parametrize("how", COPIES)
def test_a_copy_of_a_run_is_open_for_itself(
    scenario: Any, tmp_path: Path, how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    rubnoise.run(scenario, "x.h5").close()
    with rubnoise.open("x.h5") as run:
        monkeypatch.chdir("/")
        column = COPIES[how](run.trace["distance"])
        with COPIES[how](run) as again:
            assert again.trace["distance"][:].tobytes() == run.trace["distance"][:].tobytes()
            assert again.scenario == run.scenario
        assert run.trace["distance"][1] == column[1] == 0.1
    with pytest.raises(ValueError, match="closed"):
        again.trace["distance"][:]


def test_a_junction_is_the_overlap_of_two_circles(scenario: Any, tmp_path: Path) -> None:
    with rubnoise.run(scenario, tmp_path / "x.h5") as run:
        junction = run.junction(40)
        assert junction.number == 40
        assert junction.state == JunctionState.COMPLETE
        assert junction.birth_distance == run.junctions["birth_distance"][40] > 0.0
        assert junction.birth_time == pytest.approx(junction.birth_distance / 1000.0)
        assert junction.shear_strength == 250.0
        born, died = junction.birth_distance, junction.death_distance
        inside = np.linspace(born, died, 51)[:-1].reshape(5, 10)
        area = junction.area(inside)
        assert area.shape == (5, 10)
        np.testing.assert_array_equal(area, LENS.area(inside - born, junction.diameter))
        assert junction.area([born - 1.0, born - 1e-9, died, died + 1.0]).tolist() == [0.0] * 4
        assert junction.area(born + junction.diameter) == pytest.approx(junction.max_area, rel=1e-14)


def test_a_junction_that_was_ended_early_is_gone_from_then_on() -> None:
    junction = Junction(
        number=0, birth_distance=1.0, death_distance=4.0, life_distance=3.0, diameter=2.0, max_area=np.pi, state=4
    )
    assert junction.area([3.9, 4.0, 4.5]).tolist() == [float(LENS.area(np.array(2.9), 2.0)), 0.0, 0.0]


def test_what_is_not_there_is_named(contact: Any, tmp_path: Path) -> None:
    with rubnoise.run(contact, tmp_path / "x.h5") as run:
        rows = len(run.junctions)
        for number in (-1, rows):
            with pytest.raises(IndexError, match=rf"junction {number}: the run has junctions 0 to {rows - 1}"):
                run.junction(number)
        with pytest.raises(KeyError, match="/trace has no column 'force'; it has distance, real_contact_area"):
            run.trace["force"]
        with pytest.raises(KeyError, match="the run has no slider"):
            _ = run.slider
        assert run.junction(0).shear_strength is None
        assert run.junction(0).birth_time is None
    with pytest.raises(RunFileRefused, match=r"nothing\.h5: no such file"):
        rubnoise.open(tmp_path / "nothing.h5")


def test_the_scenario_of_a_run_runs_again_to_the_same_bits(scenario: Any, tmp_path: Path) -> None:
    with rubnoise.run(scenario, tmp_path / "x.h5", seed=77) as run:
        again = run.scenario
        area = run.trace["real_contact_area"][:]
        assert run.provenance["seed"] == again.run.seed == 77
    assert again.model() == scenario.model()
    assert again.resolved() == scenario.resolved() | {"run": {"seed": 77, "engine": "events"}}
    assert rubnoise.simulate(again)["trace"]["real_contact_area"].tobytes() == area.tobytes()


@pytest.mark.parametrize("seed", [-1, 2**53, 1.5, True, "7"])
def test_a_seed_that_is_none_is_refused(contact: Any, tmp_path: Path, seed: Any) -> None:
    with pytest.raises(ScenarioRefused, match=r"run\.seed: (too|needs)"):
        rubnoise.simulate(contact, seed=seed)
    with pytest.raises(ScenarioRefused, match=r"run\.seed"):
        rubnoise.run(contact, tmp_path / "x.h5", seed=seed)
    assert names(tmp_path) == ["contact.toml"]


def test_a_watcher_is_told_from_the_start_and_may_stop_the_run(contact: Any, tmp_path: Path) -> None:
    told: list[tuple[float, int, int]] = []
    created: list[list[str]] = []

    def watch(distance: float, junctions: int, live: int) -> None:
        told.append((distance, junctions, live))
        created.append(names(tmp_path))
        if distance > 0.0:
            raise RunStopped(2)

    with pytest.raises(RunStopped):
        rubnoise.run(contact, tmp_path / "x.h5", watch=watch)
    assert told[0] == (0.0, 0, 0)
    assert created[0] == ["contact.toml"]
    assert told[1][0] > 0.0
    assert "x.h5.part" in created[1]
    assert names(tmp_path) == ["contact.toml"]


# Results as xarray and pandas have them.
@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("labelled")
    (folder / "given.toml").write_text(WITH_SLIDER, encoding="utf-8")
    rubnoise.run(rubnoise.load(folder / "given.toml"), folder / "x.h5").close()
    return folder / "x.h5"


@pytest.fixture
def run(path: Path) -> Iterator[rubnoise.Run]:
    with rubnoise.open(path) as opened:
        yield opened


@pytest.mark.parametrize("index", [True, False])
def test_a_tree_holds_every_group_with_units(run: rubnoise.Run, index: bool) -> None:  # noqa: FBT001
    tree = run.to_xarray(index=index)
    assert set(tree.children) == {"junctions", "trace", "slider", "life_curve"}
    assert tree.attrs == run.attributes
    for name, columns in run.groups().items():
        for column in columns:
            variable = tree[name][column]
            assert variable.attrs["units"] == columns[column].units
            assert variable.dtype == columns[column].dtype
            np.testing.assert_array_equal(variable.values, columns[column][:])
    assert ("distance" in tree["trace"].to_dataset().xindexes) == index


def test_it_is_what_xarray_finds_in_the_file_itself(run: rubnoise.Run, path: Path) -> None:
    for name, columns in run.groups().items():
        with xr.open_dataset(path, group=name, engine="h5netcdf") as theirs:
            xr.testing.assert_equal(columns.to_xarray(), theirs)


def test_what_is_no_name_of_a_column_is_answered_with_the_way(run: rubnoise.Run) -> None:
    wrong: Any
    rows = "a column has the rows"
    for wrong, way in ((slice(1, 3), rows), (3, rows), (np.ones(3), rows), (["diameter", "state"], "to_pandas")):
        with pytest.raises(KeyError, match=way):
            run.junctions[wrong]


# What a sweep keeps of a run without keeping the run.
def test_a_summary_is_that_of_the_run_with_a_file(tmp_path: Path) -> None:
    for point in expand(sweep_of(tmp_path, GRID))[:2]:
        row = summarised(point.scenario, first=True)
        with rubnoise.run(point.scenario, tmp_path / f"{point.run_id}.h5") as run:
            assert from_attributes(numbers_in(row)) == run.summary
            assert row["histogram"].sum() > 0.0
            assert row["autocovariance"][0] == pytest.approx(run.trace["real_contact_area"][:].var(), rel=1e-10)


def test_what_is_expected_comes_once_a_point(tmp_path: Path) -> None:
    first, second = (summarised(p.scenario, first=not p.replicate) for p in expand(sweep_of(tmp_path, GRID))[:2])
    theory = SummarySink(expand(sweep_of(tmp_path, GRID))[0].scenario.model()).theory()
    assert first.keys() - second.keys() == theory.keys()
    assert first["spectrum_place"].tobytes() == theory["spectrum_place"].tobytes()
