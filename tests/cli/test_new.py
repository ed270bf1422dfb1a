"""`rubnoise new`: a template that runs as it is, names every key, and replaces nothing."""

import re
import tomllib
from pathlib import Path

import pytest

import rubnoise
from rubnoise.scenario import loads
from rubnoise.scenario.keys import LAW_SAMPLES, SECTIONS
from rubnoise.scenario.shipped import by_name
from rubnoise.scenario.sweep import Sweep, load_either, load_sweep
from rubnoise.scenario.sweep_table import Sweeping
from rubnoise.scenario.template import template
from tests.cli.terminal import call, names

OPTIONAL = re.compile(r"^#(?=[\[a-z])", re.MULTILINE)
# One needs another file, some exclude others, one another coupling, and the rest belong to laws without a spread.
ELSEWHERE = ("extends", "load", "hardness", "patch_area", "damping_ratio", "tolerance", *LAW_SAMPLES)


def _everything() -> str:
    """Return the template with every optional key of one run set."""
    one_run, _, _ = template().partition("#[sweep]")
    lines = [line for line in one_run.splitlines() if not line.startswith(tuple(f"#{key} " for key in ELSEWHERE))]
    return (
        OPTIONAL.sub("", "\n".join(lines)).replace('law = "fixed"', 'law = "normal"').replace('constant"', 'weibull"')
    )


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


def test_the_scenario_that_new_makes_is_the_first_one() -> None:
    first, new = rubnoise.load("first/rubbing").resolved(), loads(_everything()).resolved()
    for table in ("sliding", "slider", "output"):
        assert new[table] == first[table]


def test_every_key_is_there_with_its_meaning() -> None:
    keys = tomllib.loads(OPTIONAL.sub("", template()))
    assert {name: set(keys[name]) for name in SECTIONS} == {
        name: set(section.model_fields) for name, section in SECTIONS.items()
    }
    flat = " ".join(template().replace("\n#", "").split())
    assert set(keys["sweep"]) == {*Sweeping.model_fields, "grid"}
    for section in (*SECTIONS.values(), Sweeping):
        for about in section.model_fields.values():
            assert about.description
            assert " ".join(about.description.split()) in flat


def test_every_optional_key_may_be_set() -> None:
    scenario = loads(_everything())
    assert scenario.slider is not None
    assert scenario.warnings == ()
    ratio = _everything().replace('damping = "5 N*s/m"', "damping_ratio = 0.02")
    assert loads(ratio).model().slider != scenario.model().slider


def test_the_sweep_may_be_switched_on(here: Path) -> None:
    one_run, _, sweep = template().partition("#[sweep]")
    text = one_run + OPTIONAL.sub("", "#[sweep]" + sweep).replace("replicates = 1\n", "replicates = 8\n")
    (here / "s.toml").write_text(text, encoding="utf-8")
    assert load_sweep("s.toml").keys == ("interface.mean_junction_count",)
    assert call("check", "s.toml").code == 0


def test_an_existing_file_is_left_alone(here: Path) -> None:
    (here / "mine.toml").write_text("precious", encoding="utf-8")
    answer = call("new", "mine.toml")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "mine.toml: exists already; choose another name\n"
    assert (here / "mine.toml").read_text(encoding="utf-8") == "precious"


def test_a_dangling_link_is_left_alone(here: Path) -> None:
    (here / "link.toml").symlink_to("elsewhere.toml")
    assert call("new", "link.toml").code == 2
    assert names(here) == ["link.toml"]


def test_a_missing_folder_is_named(here: Path) -> None:
    answer = call("new", "nowhere/mine.toml")
    assert (answer.code, answer.err) == (2, f"{here / 'nowhere'}: no such folder\n")
    assert names(here) == []


def test_a_place_that_cannot_be_written_is_named(here: Path) -> None:
    (here / "file").touch()
    answer = call("new", "file/mine.toml")
    assert (answer.code, answer.err) == (2, f"{here / 'file'}: no such folder\n")


def test_a_newcomers_first_run_can_be_heard(here: Path) -> None:
    assert call("new", "contact.toml").code == 0
    assert call("run", "contact.toml", "--set", "sliding.distance=2 mm", "-q").code == 0
    assert call("listen", "contact.h5", "-o", "noise.wav").code == 0


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
    mine, theirs = load_either("mine.toml"), load_either(by_name(name))
    if isinstance(mine, Sweep) and isinstance(theirs, Sweep):
        assert [case.scenario.resolved() for case in mine.cases] == [case.scenario.resolved() for case in theirs.cases]
    else:
        assert mine.resolved() == theirs.resolved()


def test_an_existing_file_wins_over_a_shipped_name(here: Path) -> None:
    (here / "paper").mkdir()
    (here / "paper" / "fig5").write_text(template().replace("seed = 1", "seed = 99"), encoding="utf-8")
    assert rubnoise.load("paper/fig5").run.seed == 99
