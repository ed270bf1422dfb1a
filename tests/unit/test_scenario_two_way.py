"""Two-way coupling in scenarios: its keys, what they leave out, and what is refused beside them."""

import json
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.scenario import build, loads
from rubnoise.scenario.sweep import load_sweep
from tests.unit.scenarios import WHOLE, refusal
from tests.unit.test_scenario_traps import shown

TWO_WAY = WHOLE.replace('damping = "0.05 N*s/m"\n', 'damping = "0.05 N*s/m"\ncoupling = "two-way"\n')
LINE = 1 + TWO_WAY[: TWO_WAY.index("coupling")].count("\n")


def with_tolerance(value: str, text: str = TWO_WAY) -> str:
    return text.replace("\n[output]", f"tolerance = {value}\n\n[output]").replace('"\n\ntolerance', '"\ntolerance')


def test_one_way_is_what_a_scenario_without_the_key_means_and_says_nothing_of_a_tolerance() -> None:
    scenario = loads(WHOLE)
    assert not scenario.model().is_two_way
    assert scenario.resolved()["slider"] == {
        "mass": "0.005 kg",
        "stiffness": "300 N/m",
        "damping": "0.05 N*s/m",
        "coupling": "one-way",
        "start": "equilibrium",
    }


def test_two_way_has_a_tolerance_and_is_the_same_when_read_again() -> None:
    scenario = loads(TWO_WAY)
    slider = scenario.model().slider
    assert slider is not None
    assert (slider.coupling, slider.tolerance) == ("two-way", 1e-9)
    assert scenario.resolved()["slider"]["tolerance"] == 1e-9
    again = build(json.loads(json.dumps(scenario.resolved())))
    assert again.model() == scenario.model()
    assert again.resolved() == scenario.resolved()


@pytest.mark.parametrize("value", ["1e-12", "1e-4", "3e-7"])
def test_a_tolerance_in_range_is_taken(value: str) -> None:
    slider = loads(with_tolerance(value)).model().slider
    assert slider is not None
    assert slider.tolerance == float(value)


@pytest.mark.parametrize(
    ("value", "message", "hint"),
    [
        ("0.9e-12", "too small", "possible: 1e-12 to 0.0001"),
        ("1.1e-4", "too large", "possible: 1e-12 to 0.0001"),
        ("0.0", "must be above 0", "possible: 1e-12 to 0.0001"),
        ('"1e-9"', "needs a number, not a text", "write 1e-9 without quotation marks"),
    ],
)
def test_a_tolerance_out_of_range_is_refused(value: str, message: str, hint: str) -> None:
    head = f"run.toml:{LINE + 1}: error: slider.tolerance: {message}"
    assert refusal(with_tolerance(value)) == shown(head, f"tolerance = {value}", value, hint)


def test_one_way_coupling_takes_no_tolerance() -> None:
    hint = 'write coupling = "two-way", or leave the tolerance out'
    head = f"run.toml:{LINE}: error: slider.tolerance: one-way coupling takes no tolerance: its motion is exact"
    said = refusal(with_tolerance("1e-9", WHOLE))
    assert said == shown(f'{head}, and "one-way" is the default', "tolerance = 1e-9", "1e-9", hint)
    said = refusal(with_tolerance("1e-9", TWO_WAY.replace("two-way", "one-way")))
    assert said.startswith(head.replace(f":{LINE}:", f":{LINE + 1}:") + "\n")


def test_coupling_alone_makes_no_slider() -> None:
    """Without a slider nothing can push back: what a slider has is asked for, at the key that asks for one."""
    text = TWO_WAY[: TWO_WAY.index("mass = ")] + 'coupling = "two-way"\n'
    said = refusal(text)
    line = 1 + text[: text.index("[slider]")].count("\n")
    for key, example in (
        ("damping", '"0.05 N*s/m" or damping_ratio = 0.02'),
        ("mass", '"5 g"'),
        ("stiffness", '"300 N/m"'),
    ):
        assert f"run.toml:{line}: error: slider.{key}: missing" in said
        assert f"write {key} = {example}" in said
    assert "sliding.speed: missing" in refusal(TWO_WAY.replace('speed = "1 mm/s"\n', ""))
    assert "strength.mean: missing" in refusal(TWO_WAY.replace('[strength]\nmean = "250 MPa"\n', ""))


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("250 MPa", "0 MPa", "strength.mean"),
        ("300 N/m", "0 N/m", "slider.stiffness"),
        ("1 mm/s", "0 mm/s", "sliding.speed"),
        ("1 mm/s", "-1 mm/s", "sliding.speed"),
        ("200 um^2", "0 um^2", "interface.mean_real_contact_area"),
    ],
)
def test_a_contact_that_bears_nothing_by_its_keys_is_refused(old: str, new: str, key: str) -> None:
    said = refusal(TWO_WAY.replace(f'"{old}"', f'"{new}"'))
    assert f"error: {key}: must be above 0" in said
    assert f'"{new}"' in said


def test_a_contact_that_bears_nothing_here_and_there_is_taken() -> None:
    """G = 0 is a place like any other: before the first birth of an empty start, and between junctions that are few."""
    few = TWO_WAY.replace("mean_junction_count = 20", "mean_junction_count = 0.2")
    few = few.replace('distance = "20 mm"', 'distance = "2 mm"\nstart = "empty"').replace("0.1 um", "1 um")
    record = rubnoise.simulate(loads(few))
    slider, area = record["slider"], record["trace"]["real_contact_area"]
    assert area[0] == 0.0
    assert (area == 0.0).mean() > 0.5
    free = (slider["phase"] != 1) & (slider["friction_force"] == 0.0)
    assert free.any()
    assert np.isfinite(slider["displacement"]).all()


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ('"two_way"', 'unknown value "two_way"'),
        ("true", "needs a word in quotation marks, not a boolean"),
        ("2", "needs a word in quotation marks, not a"),
    ],
)
def test_another_coupling_is_refused(value: str, said: str) -> None:
    head = f"run.toml:{LINE}: error: slider.coupling: "
    told = refusal(TWO_WAY.replace('"two-way"', value))
    assert told.startswith(head)
    assert said in told
    assert "two-way" in told.splitlines()[-1]


def test_an_intervention_is_refused_before_anything_runs(tmp_path: Any) -> None:
    def process(env: Any, _live: Any) -> Any:
        yield env.timeout(1.0)

    with pytest.raises(Refused, match=r'slider\.coupling = "one-way" takes interventions'):
        rubnoise.simulate(loads(TWO_WAY), intervene=process)
    with pytest.raises(Refused, match=r'slider\.coupling = "one-way" takes interventions'):
        rubnoise.run(loads(TWO_WAY), tmp_path / "x.h5", intervene=process)
    assert not list(tmp_path.iterdir())


def test_a_sweep_cannot_ask_for_the_validity_of_what_is_not_there(tmp_path: Any) -> None:
    path = tmp_path / "sweep.toml"
    sweep = '\n[sweep]\nkeep = "summary"\nprecision = 0.1\nquantity = "{}"\n[sweep.grid]\nslider.coupling = {}\n'
    path.write_text(TWO_WAY.replace('coupling = "two-way"\n', "") + sweep.format("one_way_validity", '["two-way"]'))
    with pytest.raises(Refused, match="one_way_validity is no quantity of a run with two-way coupling"):
        load_sweep(path)
    path.write_text(
        TWO_WAY.replace('coupling = "two-way"\n', "") + sweep.format("velocity_std", '["one-way", "two-way"]')
    )
    assert [case.scenario.model().is_two_way for case in load_sweep(path).cases] == [False, True]
