import pytest

from rubnoise.errors import Refused
from rubnoise.scenario import load
from rubnoise.scenario.shipped import shipped


def test_a_scenario_of_the_paper_is_found_and_can_be_read() -> None:
    assert load(shipped("paper/fig5.toml")).title == "Figure 5: excitation force and vibration"


def test_what_is_not_there_is_named() -> None:
    with pytest.raises(Refused, match=r"scenarios/paper/fig99\.toml: not found"):
        shipped("paper/fig99.toml")
