"""Two-way coupling in scenarios: its keys, what they leave out, and what is refused beside them."""

import json
from typing import Any

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
