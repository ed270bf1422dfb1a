"""`rubnoise check` and `rubnoise new`: what follows from a scenario, and a template that runs as it is."""

import re
import tomllib
from pathlib import Path

import pytest

import rubnoise
from rubnoise.scenario import loads
from rubnoise.scenario.document import SECTIONS, Sweeping
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.layers import shipped
from rubnoise.scenario.sweep import Sweep, load_either, load_sweep
from rubnoise.scenario.written import template
from rubnoise.storage import forecast
from tests.shell.terminal import call, names
from tests.shell.test_refusals import BROKEN, MANY

# `rubnoise check`: what follows from a scenario.
SHORT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")


DOUBTFUL = (
    ("paper/fig5", (), 1, 1),
    ("load/fig5_load", (), 1, 0),
    ("load/fig5_rough", ("--set", "load.damping_ratio=0.01"), 2, 0),
    ("load/fig5_rough", ("--set", 'sliding.speed="200 mm/s"'), 2, 2),
    ("load/bouncing", (), 0, 2),
)


@pytest.mark.parametrize(("name", "changes", "warnings", "notes"), DOUBTFUL)
def test_json_has_the_warnings_and_notes_of_the_text(
    name: str, changes: tuple[str, ...], warnings: int, notes: int, here: Path
) -> None:
    answer = call("check", name, *changes, "--json").json()["scenarios"][name]
    told = " ".join(call("check", name, *changes).out.split())
    assert (told.count("warning: "), told.count("note: ")) == (warnings, notes)
    assert len(answer["notes"]) == warnings + notes
    assert all(each in told for each in answer["notes"])
    assert names(here) == []


COUPLED_OTHERWISE = [
    ("load/fig5_load", ()),
    ("paper/fig5", ("birth.law=jittered", "birth.jitter=30 %", "interface.calibration=exact")),
    ("paper/fig5", ("birth.law=regular", "interface.calibration=exact")),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "changes"), COUPLED_OTHERWISE)
def test_a_coupling_strength_is_for_births_at_random_at_constant_separation(
    name: str, changes: tuple[str, ...], here: Path
) -> None:
    """Others have no slow force, so a Pi near 0 would be called weak beside a velocity above the sliding speed."""
    asked = (name, *(word for change in changes for word in ("--set", change)))
    assert "  coupling strength: not known: " in call("check", *asked).out
    for answer in (call("check", *asked, "--json").json()["scenarios"][name], call("theory", *asked, "--json").json()):
        assert "value" not in answer["slider"]["coupling_strength"]
        assert answer["slider"]["one_way_validity"]["value"] > 0.1
    assert names(here) == []


def test_every_file_is_reported_and_one_broken_file_is_enough_for_a_refusal(here: Path) -> None:
    (here / "broken.toml").write_text(BROKEN, encoding="utf-8")
    told = call("check", "broken.toml", SHORT, "missing.toml", SLIDER, "--json")
    assert told.code == 2
    assert sorted(told.json()["scenarios"]) == [str(SHORT), str(SLIDER)]
    assert sorted(told.json()["refused"]) == ["broken.toml", "missing.toml"]


@pytest.mark.slow
@pytest.mark.parametrize("scenario", [SLIDER, SHORT], ids=["with slider", "contact alone"])
def test_the_size_of_the_file_is_foreseen(here: Path, scenario: Path) -> None:
    longer = ("--set", "sliding.distance=20 mm")
    told = call("check", scenario, *longer, "--json").values()["scenarios"][str(scenario)]["cost"]["bytes"]
    assert call("run", scenario, *longer, "-q", "-o", "x.h5").code == 0
    assert told == pytest.approx((here / "x.h5").stat().st_size, rel=0.01)


def test_a_sweep_is_listed_point_by_point(here: Path) -> None:
    (here / "s.toml").write_text(SHORT.read_text(encoding="utf-8") + MANY, encoding="utf-8")
    told = call("check", "s.toml", "--json").json()["sweeps"]["s.toml"]
    assert told["seeds"]["point"] == [1, 1, 2, 2, 3, 3, 4, 4]
    assert len(set(told["seeds"]["seed"])) == 8
    assert told["points"]["interface.mean_junction_count"] == ["10", "10", "20", "20"]
    assert told["points"]["interface.mean_real_contact_area"][1] == "200 um^2"


def test_what_has_no_room_here_is_noted(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(forecast, "free_disk_bytes", lambda path: 1000)
    answer = call("check", SHORT)
    assert answer.code == 0
    assert "note: contact.h5: the result may take" in " ".join(answer.out.split())
    assert "sliding.distance" in call("check", SHORT, "--json").json()["scenarios"][str(SHORT)]["notes"][-1]


# `rubnoise new`: a template that runs as it is, names every key, and replaces nothing.
OPTIONAL = re.compile(r"^#(?=[\[a-z])", re.MULTILINE)


def test_the_template_is_written_checked_and_run(here: Path) -> None:
    made = call("new", "contact.toml")
    assert (made.code, made.err) == (0, "")
    assert "rubnoise check contact.toml" in made.out
    assert names(here) == ["contact.toml"]
    checked = call("check", "contact.toml")
    assert checked.code == 0
    assert call("run", "contact.toml", "--set", "sliding.distance=100 um").code == 0


def test_what_is_set_beside_what_is_needed_is_the_default() -> None:
    bare = (
        'format = 1\n[interface]\nmean_real_contact_area = "200 um^2"\nmean_junction_count = 20\n'
        '[strength]\nmean = "250 MPa"\n[sliding]\ndistance = "40 mm"\nspeed = "20 mm/s"\n'
        '[slider]\nmass = "50 g"\nstiffness = "100 kN/m"\ndamping = "5 N*s/m"\n'
    )
    assert loads(template()).resolved() == loads(bare).resolved()


@pytest.mark.parametrize("start", ["first/rubbing", "new.toml"])
def test_a_newcomer_begins_with_a_contact_that_keeps_the_papers_assumption(here: Path, start: str) -> None:
    assert call("new", "new.toml").code == 0
    scenario = rubnoise.load(start)
    assert rubnoise.exact(scenario).slider.one_way_validity < 0.1
    ran = call("run", start, "--set", "sliding.distance=4 mm", "-o", "x.h5")
    assert (ran.code, ran.err) == (0, "")


def test_every_key_is_there_with_its_meaning() -> None:
    keys = tomllib.loads(OPTIONAL.sub("", template()))
    assert {name: set(keys[name]) for name in SECTIONS} == {
        name: set(keys_of(section)) for name, section in SECTIONS.items()
    }
    flat = " ".join(template().replace("\n#", "").split())
    assert set(keys["sweep"]) == {*keys_of(Sweeping), "grid"}
    for section in (*SECTIONS.values(), Sweeping):
        for about in keys_of(section).values():
            assert about.about
            assert " ".join(about.about.split()) in flat


def test_the_sweep_may_be_switched_on(here: Path) -> None:
    one_run, _, sweep = template().partition("#[sweep]")
    text = one_run + OPTIONAL.sub("", "#[sweep]" + sweep).replace("replicates = 1\n", "replicates = 8\n")
    (here / "s.toml").write_text(text, encoding="utf-8")
    assert load_sweep("s.toml").keys == ("interface.mean_junction_count",)
    assert call("check", "s.toml").code == 0


def test_shipped_scenarios_are_listed_and_taken_by_name(here: Path) -> None:
    listed = call("examples")
    assert listed.code == 0
    assert "paper/fig5 " in listed.out
    assert call("run", "paper/fig4", "--set", "sliding.distance=1 mm", "-q").code == 0
    assert names(here) == ["fig4.h5"]
    assert call("check", "paper/fig9").code == 0
    wrong = call("run", "paper/fg4")
    assert (wrong.code, "did you mean paper/fig4" in wrong.err) == (2, True)


@pytest.mark.parametrize("name", ["paper/fig5", "paper/fig5_two_way", "studies/rise"])
def test_a_copy_of_a_shipped_scenario_needs_no_other_file(here: Path, name: str) -> None:
    assert call("new", "mine.toml", "--from", name).code == 0
    mine, theirs = load_either("mine.toml"), load_either(shipped(name))
    if isinstance(mine, Sweep) and isinstance(theirs, Sweep):
        assert [case.scenario.resolved() for case in mine.cases] == [case.scenario.resolved() for case in theirs.cases]
    else:
        assert mine.resolved() == theirs.resolved()
