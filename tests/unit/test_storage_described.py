"""Whatever the attributes of a part say, it is resumed or refused in a sentence that names the part."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import rubnoise
from rubnoise.api import resuming
from rubnoise.errors import OutputRefused, Refused, RunFileRefused
from rubnoise.simulation import draws
from rubnoise.storage import writer
from rubnoise.storage.journal import Journal, frames
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.resume import look
from tests.format.runs import names
from tests.unit.test_storage_resuming import WHOLE, scenario, stop_after

RESOLVED = WHOLE.resolved()


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the part of a run that was stopped after two commits."""
    folder = tmp_path_factory.mktemp("stopped")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(writer, "COMMIT_SECONDS", 0.0)
        patch.setattr(draws, "_DRAWN_AT_ONCE", 1)
        stop_after(folder / "x.h5", WHOLE, 2)
    return folder / "x.h5.part"


@pytest.fixture
def part(tmp_path: Path, stopped: Path) -> Path:
    """Return a copy of it, with its journal."""
    for path in stopped.parent.iterdir():
        shutil.copy(path, tmp_path)
    return tmp_path / "x.h5.part"


def told(part: Path, **attributes: object) -> None:
    """Let a part say something else of its origin."""
    with h5py.File(part, "r+") as file:
        for name, value in attributes.items():
            owner = file["provenance"].attrs
            if name in owner:
                del owner[name]
            owner[name] = np.bytes_(value.encode()) if isinstance(value, str) else value


def with_key(section: str, **keys: object) -> str:
    return json.dumps(RESOLVED | {section: RESOLVED[section] | keys})


NOT_A_TABLE = ("null", "[]", '"text"', "1", "true", "NaN")
SCENARIOS = {
    **{text: f"/provenance scenario_resolved is {text}, not a table of values by name" for text in NOT_A_TABLE},
    "": "/provenance scenario_resolved is no JSON that can be read",
    "{": "/provenance scenario_resolved is no JSON that can be read",
    '{"a":' * 2000 + "1" + "}" * 2000: "/provenance scenario_resolved is no JSON that can be read",
    '{"format": ' + "9" * 5000 + "}": "/provenance scenario_resolved is no JSON that can be read",
    json.dumps(RESOLVED | {"output": None}): "/provenance scenario_resolved has null for output, not a table",
    json.dumps(RESOLVED | {"output": ["gzip"]}): '/provenance scenario_resolved has ["gzip"] for output, not a table',
    json.dumps(RESOLVED | {"pulse": None}): "the scenario in the file has the pulse shape 'None', which is not known",
    "{}": "the scenario in the file is not valid",
    json.dumps(RESOLVED | {"interface": None}): "the scenario in the file is not valid",
    json.dumps(RESOLVED | {"sliding": [1]}): "the scenario in the file is not valid",
    json.dumps(RESOLVED | {"diameter": "wide"}): "the scenario in the file is not valid",
    with_key("interface", mean_junction_count=[]): "the scenario in the file is not valid",
    with_key("run", seed=2): "has seed 1, and its scenario has 2",
    with_key("sliding", distance="1e12 km"): "the scenario in the file is not valid",
    with_key("interface", mean_junction_count=30): "has calibrated diameter",
    with_key("sliding", distance="2500 um"): "has another number of rows than here",
}  # fmt: skip


@pytest.mark.parametrize("text", SCENARIOS, ids=range(len(SCENARIOS)))
def test_a_scenario_that_is_none_of_the_part_is_refused(part: Path, text: str) -> None:
    told(part, scenario_resolved=text)
    before = part.read_bytes()
    with pytest.raises(Refused, match=re.escape(SCENARIOS[text])) as refused:
        rubnoise.resume(part)
    assert str(refused.value).startswith(f"{part}: ")
    assert str(refused.value).count(str(part)) == 1
    assert refused.value.exit_code == 2
    with pytest.raises(OutputRefused, match=r"\(force=True starts over"):
        rubnoise.run(WHOLE, part.with_suffix(""))
    assert part.read_bytes() == before
    assert names(part.parent) == ["x.h5.part", "x.h5.part.journal"]


def test_births_beyond_all_bounds_are_not_counted(part: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A part may claim a run of which counting alone takes hours."""

    def count(*_: object) -> None:
        raise AssertionError("births were counted")

    description = look(part).description
    assert resuming._has_its_rows(WHOLE, description)
    monkeypatch.setattr("rubnoise.storage.forecast.extent", count)
    many = scenario(interface={"mean_real_contact_area": "200000 um^2", "mean_junction_count": 20_000})
    for other in (many, scenario(sliding={"distance": "3 mm", "speed": "1 mm/s"})):
        assert not resuming._has_its_rows(other, description)


ORIGINS: list[tuple[dict[str, Any], str]] = [
    ({"software": "null"}, "/provenance software is null, not a table of values by name"),
    ({"environment": "[1, 2]"}, "/provenance environment is [1, 2], not a table of values by name"),
    ({"propagator_constants": "7"}, "/provenance propagator_constants is 7, not a table of values by name"),
    ({"propagator_constants": '{"cells_per_tick": "' + "x" * 100}, "/provenance propagator_constants is no JSON"),
    ({"propagator_constants": '{"a": null}'}, "has other constants of the slider's step than here"),
    ({"seed": "one"}, '/provenance seed is "one", not a whole number'),
    ({"seed": float("nan")}, "/provenance seed is NaN, not a whole number"),
    ({"seed": -1}, "has seed -1, and its scenario has 1"),
    ({"stream_version": 0.5}, "/provenance stream_version is 0.5, not a whole number"),
    ({"calibrated_diameter": "wide"}, '/provenance calibrated_diameter is "wide", not a number'),
    ({"calibrated_diameter": float("inf")}, "has calibrated diameter inf um"),
    ({"started": np.zeros(3)}, "attribute started is not a plain number or text"),
]


@pytest.mark.parametrize(("attributes", "said"), ORIGINS, ids=lambda each: str(each)[:40])
def test_an_origin_that_is_none_is_refused(part: Path, attributes: dict[str, Any], said: str) -> None:
    told(part, **attributes)
    before = part.read_bytes()
    with pytest.raises(Refused, match=re.escape(said)) as refused:
        rubnoise.resume(part)
    assert str(refused.value).startswith(f"{part}: ")
    assert refused.value.exit_code == 2
    assert part.read_bytes() == before


@pytest.mark.parametrize("text", NOT_A_TABLE)
def test_a_look_refuses_it_too(part: Path, text: str) -> None:
    told(part, scenario_resolved=text)
    with pytest.raises(RunFileRefused, match="not a table of values by name"):
        look(part)


def test_a_part_without_rows_is_looked_at(part: Path) -> None:
    with h5py.File(part, "r+") as file:
        for name in ("trace", "slider"):
            for column in list(file[name]):
                dtype = file[name][column].dtype
                del file[name][column]
                file[name].create_dataset(column, (0,), dtype)
    assert look(part).share == 0.0
    with pytest.raises(RunFileRefused, match="damaged"):
        rubnoise.resume(part)


def other_columns(path: Path) -> None:
    """Give a journal columns that the run does not have."""
    (first, *_) = frames(path)
    run = json.loads(first.content)
    run["columns"][0] = ["junctions", "temperature"]
    path.unlink()
    rewritten(path, first=json.dumps(run).encode())


def no_ending(path: Path) -> None:
    """Let a journal hold last changes that are none."""
    (first, *_) = frames(path)
    path.unlink()
    rewritten(path, first=first.content, kind="end", content=b"\xff" * 15)


def far_moment(path: Path) -> None:
    """Let a commit be of a time that never comes."""
    (first, second, *_) = frames(path)
    path.unlink()
    rewritten(path, first=first.content, content=np.float64("inf").tobytes() + second.content[8:])


def rewritten(path: Path, *, first: bytes, kind: str = "rows", content: bytes = b"") -> None:
    journal = Journal(path, first)
    journal.append(kind, content, durable=False)  # type: ignore[arg-type]
    journal.close()


@pytest.mark.parametrize("forge", [other_columns, no_ending, far_moment])
def test_a_journal_that_makes_no_sense_is_refused(part: Path, forge: Callable[[Path], None]) -> None:
    journal = OutputPaths.of(part.with_suffix("")).journal
    forge(journal)
    for door in (lambda: rubnoise.resume(part), lambda: look(part)):
        with pytest.raises(RunFileRefused, match=r"x\.h5\.part\.journal: is no journal of rubnoise"):
            door()
