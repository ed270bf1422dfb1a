"""The structure derived from what was written is what read_structure finds in the file."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from rubnoise.errors import RunStopped
from rubnoise.storage.read_structure import read_structure
from rubnoise.storage.reader import open_run

PLAIN: dict[str, Any] = {
    "format": 1,
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": 0.2},
    "sliding": {"distance": 300.0},
    "output": {"tick": 0.5},
}
MOVING = PLAIN | {
    "title": 'µm "mean\\slash" and 名',
    "sliding": {"distance": 300.0, "speed": 1000.0},
    "strength": {"law": "constant", "mean": 250.0},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
}


def found(path: Path) -> dict[str, Any]:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        told: dict[str, Any] = json.loads(read_structure(descriptor))
        return told
    finally:
        os.close(descriptor)


@pytest.mark.parametrize("values", [PLAIN, MOVING, MOVING | {"title": "?"}], ids=["plain", "moving", "short"])
def test_a_new_result_is_what_a_survey_finds(values: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "new.h5"
    with rubnoise.run(rubnoise.build(values), path) as run:
        told = run._file._found
        assert told == found(path)
        assert not run._file.damaged()


def test_so_is_one_that_was_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "long.h5"
    scenario = rubnoise.build(MOVING | {"sliding": {"distance": 3000.0, "speed": 1000.0}})

    def stop(distance: float, born: int, live: int) -> None:
        del born, live
        if distance > 1000.0:
            raise RunStopped(15)

    with pytest.raises(RunStopped):
        rubnoise.run(scenario, path, watch=stop)
    with rubnoise.run(scenario, path) as run:
        assert run._file._found == found(path)


def test_a_compressed_one_is_looked_at(tmp_path: Path) -> None:
    path = tmp_path / "packed.h5"
    scenario = rubnoise.build(PLAIN | {"output": {"tick": 0.5, "compression": "gzip"}})
    with rubnoise.run(scenario, path) as run:
        assert "chunks" in run._file._found["columns"]["trace"]["distance"]
        assert run._file._found == found(path)


def test_a_file_that_was_touched_meanwhile_is_looked_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "new.h5"
    written: list[Any] = []
    opened = open_run
    monkeypatch.setattr("rubnoise.api.running.open_run", lambda *given, own: written.append(own) or opened(*given, own))
    rubnoise.run(rubnoise.build(PLAIN), path).close()
    os.utime(path, ns=(0, 0))
    with path.open("r+b") as stream:
        stream.write(b"nonsense")
    with pytest.raises(rubnoise.Refused, match="not an HDF5 file"):
        open_run(path, written[0])
