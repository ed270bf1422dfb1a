"""The page as a file: one, small, and without requests."""

import re
from pathlib import Path

import pytest

from rubnoise.errors import Refused
from rubnoise.lesson.page import page, script_parts
from rubnoise.lesson.settings import LESSON_SLIDER, settings_of
from rubnoise.scenario import build, load
from tests.architecture.sources import ROOT
from tests.lesson.node import PARTS
from tests.lesson.worlds import scenario_of, world_with

FIG5 = ROOT / "scenarios" / "paper" / "fig5.toml"
BARE = {
    "format": 1,
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
    "sliding": {"distance": "300 um"},
}


def text_of(title: str = "a title") -> str:
    return page(title, settings_of(load(FIG5)))


def test_it_is_small_and_whole() -> None:
    text = text_of()
    assert len(text.encode()) < 400_000
    assert "http:" not in text
    assert "https:" not in text
    assert re.findall(r"(?:src|href)=\"([^\"]*)\"", text) == ["data:,"]
    assert re.findall(r"url\(|@import|\bimport\b\s*[({'\"]", text) == []
    assert "default-src 'none'" in text


def test_a_title_is_text_wherever_it_stands() -> None:
    text = text_of('</script><b>@data@ & "more"</b>')
    assert "<b>" not in text
    assert "&lt;b&gt;@data@ &amp; &quot;more&quot;" in text
    assert text.count("</script>") == 2


def test_every_part_runs_once_and_the_last_one_last() -> None:
    parts = script_parts()
    assert sorted(parts) == sorted(path.name for path in PARTS.glob("*.js"))
    assert parts[-1] == "main.js"


@pytest.mark.parametrize("path", sorted(PARTS.iterdir()), ids=lambda path: path.name)
def test_a_part_stays_readable(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 300
    if path.suffix == ".js":
        assert path.name.startswith("lessons_text") or max(map(len, text.splitlines())) <= 120
        assert text.startswith("'use strict';\n/* ")


def test_knobs_stand_as_the_scenario_says() -> None:
    world = world_with(births="regular", spread=0.25, calibration="matched", pulse="triangle", damping=0.07, seed=9)
    settings = settings_of(scenario_of(world, distance=300.0))
    assert settings.world == world
    assert (settings.distance, settings.slider_start, settings.borrowed) == (300.0, "equilibrium", ())


def test_passes_off_the_centre_line_stand_as_the_scenario_says() -> None:
    world = world_with(offset="uniform", calibration="matched")
    assert settings_of(scenario_of(world)).world == world
    assert '"offset": "uniform"' in page("off", settings_of(scenario_of(world)))


def test_what_a_scenario_lacks_is_borrowed_and_said() -> None:
    settings = settings_of(build(BARE))
    assert settings.borrowed == ("strength", "sliding.speed", "slider")
    assert LESSON_SLIDER.items() <= settings.world.items()
    assert (settings.world["spread"], settings.world["strength"], settings.world["speed"]) == (0.0, 250.0, 1000.0)
    assert "The scenario has no strength and no sliding.speed and no slider: that of the paper&#x27;s Figure 5" in page(
        "bare", settings
    )


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"diameter": {"law": "gamma", "spread": "1 um"}}, "diameter.law"),
        ({"strength": {"law": "normal", "mean": "250 MPa", "spread": "20 %"}}, "strength.law"),
    ],
)
def test_what_the_page_cannot_draw_is_refused(table: dict[str, object], said: str) -> None:
    with pytest.raises(Refused, match=said):
        settings_of(build(BARE | table))
