"""The picture of the README."""

from pathlib import Path

import pytest

import rubnoise
from rubnoise.figures.overview import overview_png

ROOT = Path(__file__).parents[2]
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    pytest.importorskip("matplotlib")
    scenario = rubnoise.load(ROOT / "scenarios" / "paper" / "fig5.toml", ["sliding.distance=500 um"])
    with rubnoise.run(scenario, tmp_path_factory.mktemp("overview") / "run.h5") as opened:
        yield opened


def test_it_is_a_png_and_the_same_each_time(run):
    picture = overview_png(run, 60)
    assert picture.startswith(PNG)
    assert overview_png(run, 60) == picture


def test_another_junction_makes_another_picture(run):
    assert overview_png(run, 60) != overview_png(run, 61)


def test_a_junction_that_is_not_there_is_refused(run):
    with pytest.raises(IndexError, match="100000"):
        overview_png(run, 100_000)


def test_the_readme_shows_it():
    picture = "docs/pictures/fig5.png"
    assert f"]({picture})" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert (ROOT / picture).read_bytes().startswith(PNG)
