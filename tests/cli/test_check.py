"""`rubnoise check` and `rubnoise new`: what follows from a scenario, and a template that runs as it is."""

import re
import tomllib
from pathlib import Path

import pytest

import rubnoise
from rubnoise.scenario import loads
from rubnoise.scenario.document import SECTIONS
from rubnoise.scenario.fields import keys_of
from rubnoise.scenario.shipped import by_name
from rubnoise.scenario.sweep import Sweep, load_either, load_sweep
from rubnoise.scenario.sweep_keys import Sweeping
from rubnoise.scenario.template import template
from rubnoise.storage import forecast
from tests.cli.terminal import PAPER, call, names

# `rubnoise check`: what follows from a scenario.
SHORT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")


def _value(text: str, label: str) -> str:
    """Return what stands behind a label."""
    found = [line for line in text.splitlines() if line.startswith(f"  {label}  ")]
    assert len(found) == 1, (label, text)
    return found[0].removeprefix(f"  {label}  ").strip()


def test_figure_5_says_what_follows_from_it(here: Path) -> None:
    answer = call("check", PAPER / "fig5.toml")
    assert (answer.code, answer.err) == (0, "")
    assert _value(answer.out, "calibrated diameter") == "5.530013 um (d_m, calibration paper)"
    assert _value(answer.out, "mean life distance") == "11.06003 um (L_jm)"
    assert _value(answer.out, "mean birth spacing") == "0.5530013 um (s_jm)"
    assert _value(answer.out, "junction count std") == "4.472136"
    assert _value(answer.out, "real contact area mean") == "204.6736 um^2"
    assert _value(answer.out, "real contact area std") == "56.42936 um^2"
    assert _value(answer.out, "friction force std") == "14107.34 uN"
    assert _value(answer.out, "natural frequency") == "38.98484 Hz"
    assert _value(answer.out, "damping ratio") == "0.02041241"
    assert _value(answer.out, "displacement mean") == "170.5613 um"
    assert _value(answer.out, "displacement std") == "195.3059 um"
    assert _value(answer.out, "velocity std") == "47241.1 um/s"
    assert _value(answer.out, "one way validity").startswith("47.2411 ")
    assert _value(answer.out, "coupling strength") == "2929.741 (Pi; weak below 0.03)"
    assert _value(answer.out, "stick number") == "16.86028 (theta; a slow slider sticks above 1)"
    assert "  expected change: not known: the coupling is too strong for the" in answer.out
    assert _value(answer.out, "expected births") == "36166"
    flat = " ".join(answer.out.split())
    assert "warning: the velocity of the slider spreads by 47.2 times the sliding speed" in flat
    assert 'two-way coupling (slider.coupling = "two-way") is needed above 0.1' in flat
    assert "differs by +2.3% from the specified 200 um^2" in answer.out
    assert names(here) == []


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


AT_RESONANCE, AT_CONSTANT_GAP = "32 mm/s", "3200 mm/s"


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


@pytest.mark.parametrize(("change", "warned"), [((), True), (("--set", "load.damping_ratio=0.05"), False)])
def test_free_motion_without_any_loss_is_warned_about(change: tuple[str, ...], *, warned: bool, here: Path) -> None:
    asked = ("load/bouncing", "--set", "load.restitution=1", *change)
    told = call("check", *asked).out, call("theory", *asked).out, call("run", *asked, "--dry-run").err
    assert {"levels grow as long as the run lasts" in " ".join(each.split()) for each in told} == {warned}
    assert ("first order velocity std" in told[0]) != warned
    assert names(here) == []


def test_two_way_coupling_is_advised_only_if_it_is_allowed(here: Path) -> None:
    two_way = ("--set", "slider.coupling=two-way")
    for name, allowed in (("paper/fig5", True), ("load/fig5_load", False)):
        notes = call("check", name, "--json").json()["scenarios"][name]["notes"]
        (warning,) = (note for note in notes if note.startswith("warning: "))
        assert ("is needed" in warning) == allowed
        assert call("check", name, *two_way).code == (0 if allowed else 2)
    assert names(here) == []


FAST = ("--set", "sliding.speed=100 mm/s")


def test_a_weak_coupling_foretells_what_it_would_change(here: Path) -> None:
    answer = call("check", PAPER / "fig5.toml", *FAST)
    assert _value(answer.out, "coupling strength").startswith("0.002929741 ")
    assert _value(answer.out, "expected change").startswith("1.004")
    assert "is needed above 0.1" not in " ".join(answer.out.split())
    told = call("check", PAPER / "fig5.toml", *FAST, "--json").values()["scenarios"][str(PAPER / "fig5.toml")]["slider"]
    assert told["expected_change"] == pytest.approx(1.00479, abs=5e-6)


def test_redrawn_diameters_are_noted(here: Path) -> None:
    answer = call("check", SLIDER, "--set", "diameter.spread=5.530012636 um")
    assert answer.code == 0
    flat = " ".join(answer.out.split())
    assert "the mean diameter of the law normal changes the mean count by +28.8% from the specified 20" in flat


def test_redrawn_strengths_are_noted(here: Path) -> None:
    law = ("--set", "strength.law=normal", "--set")
    wide = " ".join(call("check", SLIDER, *law, 'strength.spread="100 %"').out.split())
    assert "the law normal changes the mean strength by +28.8% from 250 MPa" in wide
    assert "strengths" not in call("check", SLIDER, *law, 'strength.spread="20 %"').out


def test_every_file_is_reported_and_one_broken_file_is_enough_for_a_refusal(here: Path) -> None:
    (here / "broken.toml").write_text("format = 1\n[interface]\nmean_junction_count = -1\n", encoding="utf-8")
    answer = call("check", "broken.toml", SHORT, "missing.toml", SLIDER)
    assert answer.code == 2
    assert "broken.toml:3: error: interface.mean_junction_count: " in answer.err
    assert "broken.toml:2: error: interface.mean_real_contact_area: missing" in answer.err
    assert "missing.toml: cannot be read" in answer.err
    assert f"{SHORT}: ok" in answer.out
    assert f"{SLIDER}: ok" in answer.out
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


SWEEP = """\
[sweep]
replicates = 2
[sweep.grid]
interface.mean_junction_count = [10, 20]
interface.mean_real_contact_area = ["100 um^2", "200 um^2"]
"""


def test_a_sweep_is_listed_point_by_point(here: Path) -> None:
    (here / "s.toml").write_text(SHORT.read_text(encoding="utf-8") + SWEEP, encoding="utf-8")
    answer = call("check", "s.toml")
    assert (answer.code, answer.err) == (0, "")
    assert _value(answer.out, "runs") == "8, 2 of each point"
    rows = [line.split() for line in answer.out.splitlines() if line.lstrip()[:1].isdigit()]
    assert [row[:4] for row in rows] == [
        ["1", "10", "100", "um^2"], ["2", "10", "200", "um^2"], ["3", "20", "100", "um^2"], ["4", "20", "200", "um^2"],
    ]  # fmt: skip
    assert rows[3][4:6] == ["5.4772", "200.00"]  # sqrt(3 * 200 / 20), and the exact mean
    assert max(map(len, answer.out.splitlines())) <= 80
    points = call("check", "s.toml", "--json").json()["sweeps"]["s.toml"]["points"]
    assert [len(set(point["seeds"])) for point in points] == [2, 2, 2, 2]
    assert points[1]["values"] == {"interface.mean_junction_count": 10, "interface.mean_real_contact_area": "200 um^2"}


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
    mine, theirs = load_either("mine.toml"), load_either(by_name(name))
    if isinstance(mine, Sweep) and isinstance(theirs, Sweep):
        assert [case.scenario.resolved() for case in mine.cases] == [case.scenario.resolved() for case in theirs.cases]
    else:
        assert mine.resolved() == theirs.resolved()
