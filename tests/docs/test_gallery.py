"""The gallery shows every picture with its command, and is what its tool writes."""

from io import BytesIO
from pathlib import Path
from shlex import split
from typing import get_args

import numpy as np
import pytest
from PIL import Image

from rubnoise.cli.app import COMMANDS
from rubnoise.figures.catalogue import PICTURES
from rubnoise.figures.motion_spectrum import Heard
from rubnoise.figures.paper import FIGURES
from tests.architecture.sources import ROOT
from tools import generate_gallery as tool
from tools.small_png import COLOURS, small

SHOWN = [shown for room in tool.ROOMS for shown in room.pictures]
COMMAND_LINES = [
    *(shown.command for shown in SHOWN),
    *(command for room in tool.ROOMS for command in (*room.before, *room.elsewhere)),
]


def test_the_page_is_what_the_tool_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert tool.main(["--check"]) == 0
    changed = tmp_path / "gallery.md"
    changed.write_text(tool.PAGE.read_text(encoding="utf-8").replace("psd", "spectrum", 1), encoding="utf-8")
    monkeypatch.setattr(tool, "PAGE", changed)
    assert tool.main(["--check"]) == 1
    assert "docs/gallery.md is out of date" in capsys.readouterr().out


def test_it_shows_every_picture_that_can_be_drawn() -> None:
    drawn = [split(shown.command)[3:] for shown in SHOWN if shown.command.startswith("rubnoise plot")]
    assert {words[0] for words in drawn} >= set(PICTURES)
    assert {words[2] for words in drawn if "--of" in words} == set(get_args(Heard))
    assert {words[2] for words in map(split, COMMAND_LINES) if words[1] == "figures"} == set(FIGURES)
    assert {"junction", "theory", "animate"} <= {split(command)[1] for command in COMMAND_LINES}


def test_its_commands_are_there() -> None:
    for command in COMMAND_LINES:
        program, first, *_ = split(command)
        assert first in COMMANDS if program == "rubnoise" else (ROOT / first).exists(), command
        for word in split(command):
            assert not word.startswith("scenarios/") or (ROOT / word).is_file(), command


def test_its_pictures_are_there_and_small() -> None:
    files = {shown.kept: (tool.PICTURES / shown.kept).read_bytes() for shown in SHOWN}
    assert all(content.startswith(b"\x89PNG") for content in files.values())
    assert {path.name for path in (tool.PICTURES / "gallery").iterdir()} == {
        Path(name).name for name in files if name.startswith("gallery/")
    }
    assert sum(len(content) for name, content in files.items() if name.startswith("gallery/")) < 1_000_000


def test_a_small_picture_looks_like_the_large_one() -> None:
    across, down = np.meshgrid(np.linspace(0.0, 255.0, 200), np.linspace(0.0, 255.0, 150))
    many = np.stack([across, down, 0.5 * (across + down)], axis=-1).astype(np.uint8)
    stream = BytesIO()
    Image.fromarray(many).save(stream, format="PNG")
    with Image.open(BytesIO(small(stream.getvalue()))) as less:
        seen = np.asarray(less.convert("RGB"))
    assert seen.shape == many.shape
    assert len(np.unique(seen.reshape(-1, 3), axis=0)) <= COLOURS
    assert np.abs(seen.astype(int) - many).mean() < 20.0
    assert np.abs(seen.astype(int) - many[::-1]).mean() > 40.0, "another picture is noticed"


def test_its_pictures_are_what_its_commands_draw(tmp_path: Path) -> None:
    tool.draw(tmp_path, tmp_path / "pictures")
    for path in (tmp_path / "pictures" / "gallery").iterdir():
        with Image.open(path) as new, Image.open(tool.PICTURES / "gallery" / path.name) as old:
            assert new.size == old.size, path.name
            away = np.abs(np.asarray(new.convert("L"), dtype=int) - np.asarray(old.convert("L")))
        assert away.mean() < 1.0, path.name
