"""The picture of one life: it shows what it should, in grey too, and nothing of it is cut off."""

import sys
import warnings
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import matplotlib as mpl
import matplotlib.image
import numpy as np
import pytest

from rubnoise.analysis.life import Life, life_of
from rubnoise.figures import style
from rubnoise.figures.life import life_png
from rubnoise.figures.style import PicturesMissing
from rubnoise.record.rows import JunctionState
from tests.unit.lives import bare_file, lives_file


@pytest.fixture
def lives(tmp_path: Path) -> list[Life]:
    with lives_file(tmp_path / "x.h5") as file:
        return [life_of(file, number) for number in range(8)]


def _pixels(png: bytes) -> np.ndarray:
    return np.asarray(matplotlib.image.imread(BytesIO(png)))[:, :, :3]


def _of_colour(pixels: np.ndarray, colour: str) -> np.ndarray:
    wanted = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    return np.all(np.abs(pixels - wanted) < 0.02, axis=2)


@pytest.mark.parametrize("number", [0, 2, 3, 4, 7])
def test_every_life_can_be_drawn_with_nothing_cut_off(lives: list[Life], number: int) -> None:
    pixels = _pixels(life_png(lives[number], "x.h5"))
    assert pixels.shape == (840, 990, 3)
    border = np.concatenate([pixels[:2].reshape(-1, 3), pixels[-2:].reshape(-1, 3), pixels[:, :2].reshape(-1, 3)])
    assert np.all(border == 1.0)
    blue = _of_colour(pixels, style.BLUE)
    assert blue[:420].sum() > 1000  # its curve, above


def test_nothing_is_written_over_the_axis_beside_a_narrow_band(lives: list[Life]) -> None:
    life = replace(lives[1], birth_distance=-0.3, death_distance=7.7)
    dark = np.all(_pixels(life_png(life, "x.h5")) < 0.3, axis=2)
    spine = int(np.argmax(dark[:, :200].sum(axis=0)))
    lines = np.flatnonzero(dark.sum(axis=1) > 800)
    feet = lines[lines > 200]  # above is the axis of times
    assert np.ptp(feet) > 300  # of both axes
    for foot in feet[[0, -1]]:
        assert np.all(dark[foot - 100 : foot, spine])


def test_a_life_ended_after_its_peak_is_told_from_a_whole_one(lives: list[Life]) -> None:
    whole = replace(lives[4], state=JunctionState.COMPLETE)
    assert life_png(lives[4]) != life_png(whole)


def test_its_part_of_the_contact_grows_with_its_share(lives: list[Life]) -> None:
    large, small = (_of_colour(_pixels(life_png(lives[n])), style.BLUE)[450:].sum() for n in (6, 4))
    assert lives[6].area_share == 1.0
    assert lives[4].area_share < 0.4
    assert large > 2 * small


def _luminance(colour: str) -> float:
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue


def test_colours_are_told_apart_in_grey() -> None:
    greys = sorted(map(_luminance, (style.INK, style.BLUE, style.VERMILION, style.FAINT, style.PALE, "#ffffff")))
    assert np.diff(greys).min() > 0.08


def test_the_same_life_gives_the_same_picture_whatever_is_set(lives: list[Life]) -> None:
    with mpl.rc_context({"font.size": 30.0, "axes.facecolor": "red"}):
        assert life_png(lives[2]) == life_png(lives[2])
        red = life_png(lives[2])
    assert red == life_png(lives[2])
    assert red != life_png(lives[6])


@pytest.mark.parametrize("name", ["cost$5_{x", "表面.h5", "x" * 300])
def test_odd_names_are_drawn_as_they_are(lives: list[Life], name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pixels = _pixels(life_png(lives[2], name))
    assert np.all(pixels[:, -2:] == 1.0)


def test_a_bare_run_is_drawn_without_times(tmp_path: Path, lives: list[Life]) -> None:
    with bare_file(tmp_path / "bare.h5") as file:
        assert life_png(life_of(file, 2)) != life_png(lives[2])


def test_without_matplotlib_it_is_said_how_to_get_it(lives: list[Life], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(PicturesMissing, match=r"a picture needs matplotlib: python3 .*tools/dev\.py sync$"):
        life_png(lives[2])
