"""Every trap of a scenario file is refused, or warned of, with its line, a caret and advice."""

from pathlib import Path

import pytest

import rubnoise
from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import loads
from rubnoise.scenario.fields import Line
from rubnoise.units import Unfit
from tests.frozen import Said
from tests.unit.scenarios import BARE, WHOLE, refusal, whole

AREA = "run.toml:5: error: interface.mean_real_contact_area: "


def shown(head: str, line: str, marked: str, hint: str = "") -> str:
    """Return the report of one problem: head, line, caret under what is marked, hint."""
    caret = " " * line.index(marked) + "^" * len(marked)
    return "\n".join([head, f"    {line}", f"    {caret}", *([f"    {hint}"] if hint else [])])


SAID = Said(Path(__file__).with_name("scenario_refusals.txt"))


@pytest.mark.parametrize("line", SAID.kept)
def test_a_line_that_is_none_is_refused_with_its_number_and_a_caret(line: str) -> None:
    """A line of the whole scenario is replaced; scenario_refusals.txt has what is said of it."""
    key, _, value = line.partition(" = ")
    said = refusal(whole(**{key: value}))
    assert said.startswith("run.toml:")
    SAID.assert_said(line, said)


def test_milli_for_mega_is_warned_of() -> None:
    scenario = loads(WHOLE.replace("250 MPa", "250 mPa"), "run.toml")
    head = "run.toml:14: warning: strength.mean: implausibly small (2.5e-07 MPa)"
    assert scenario.warnings == (shown(head, 'mean = "250 mPa"', '"250 mPa"', 'did you mean "250 MPa"?'),)
    assert loads(WHOLE).warnings == ()


IGNORABLE = (
    *(0x00AD, 0x034F, 0x061C, 0x115F, 0x1160, 0x17B4, 0x17B5, 0x3164, 0xFEFF, 0xFFA0),
    *(*range(0x180B, 0x1810), *range(0x200B, 0x2010), *range(0x202A, 0x202F), *range(0x2060, 0x2070)),
    *(*range(0xFE00, 0xFE10), *range(0xFFF0, 0xFFF9), *range(0x1BCA0, 0x1BCA4), *range(0x1D173, 0x1D17B)),
    *range(0xE0000, 0xE1000),
)
"""What Unicode 15 calls Default_Ignorable_Code_Point (DerivedCoreProperties.txt): none of it shows by itself."""


@pytest.mark.parametrize("title", ["{}", "a{}{}b", "a {}", " {} ", "{}\u0301"])
def test_a_title_of_invisible_letters_is_none(title: str) -> None:
    line = Line()
    for place in IGNORABLE:
        with pytest.raises(Unfit, match=r"does not print|cannot be seen"):
            line.read(title.replace("{}", chr(place)))


def test_a_suggested_unit_is_one() -> None:
    (warning,) = loads(whole(mass='"1e12 mile*kg/mile"'), "run.toml").warnings
    assert warning.endswith("^")  # Mile is no unit to suggest


def test_theory_does_not_ask_how_long_a_run_would_be(tmp_path: Path) -> None:
    endless = loads(whole(distance='"1e12 km"'))
    assert rubnoise.exact(endless).area.mean == rubnoise.exact(loads(whole())).area.mean
    for start in (rubnoise.simulate, lambda scenario: rubnoise.run(scenario, tmp_path / "x.h5")):
        with pytest.raises(ScenarioRefused, match="too long a run"):
            start(endless)
    assert not list(tmp_path.iterdir())


def test_a_contact_too_crowded_for_memory_is_refused_however_short_the_run() -> None:
    short = BARE.replace("20 mm", "0.001 um")
    fine = "output.tick=0.0001 um"
    assert "too large" in refusal(short, "interface.mean_junction_count=1.1e6", fine)
    assert loads(short, overrides=("interface.mean_junction_count=1e6", fine)).model().tick_count == 10


def test_matched_without_a_solution() -> None:
    text = whole(calibration='"matched"', spread='"3 um"')
    head = (
        AREA + 'calibration "matched" has no solution: with this spread the exact mean area is at least '
        "1.609247 mean_junction_count * spread^2 = 289.6645 um^2"
    )
    hint = 'a larger area, fewer junctions, a smaller spread, or calibration = "exact"'
    line = 'mean_real_contact_area = "200 um^2"'
    assert refusal(text) == shown(head, line, '"200 um^2"', hint)
    assert loads(text.replace("3 um", "0.2 um")).model().calibrated_diameter == pytest.approx(5.46626015, abs=5e-9)
