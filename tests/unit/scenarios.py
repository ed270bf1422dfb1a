"""Scenario texts for the tests: a whole one, and the same with lines replaced."""

import re

import pytest

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import loads

WHOLE = """\
format = 1
title = "whole"

[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20
calibration = "paper"

[diameter]
law = "normal"
spread = "0.2 um"

[strength]
mean = "250 MPa"

[sliding]
speed = "1 mm/s"
distance = "20 mm"

[slider]
mass = "5 g"
stiffness = "300 N/m"
damping = "0.05 N*s/m"

[output]
tick = "0.1 um"

[run]
seed = 1
"""
BARE = """\
format = 1
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20
[sliding]
distance = "20 mm"
"""


def whole(**values: str) -> str:
    """Return the whole scenario with the TOML values of some keys replaced, or their lines left out for None."""
    text = WHOLE
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^{key} = .*$", lambda _, new=f"{key} = {value}": new, text)
        assert count == 1, key
    return text


def without(*lines: str, text: str = WHOLE) -> str:
    """Return a scenario without the lines that begin so."""
    kept = [line for line in text.splitlines() if not line.startswith(lines)]
    assert len(kept) < len(text.splitlines())
    return "\n".join(kept)


def refusal(text: str, *overrides: str) -> str:
    """Return the report on a text of which no run must be possible."""
    with pytest.raises(ScenarioRefused) as refused:
        loads(text, "run.toml", overrides).check_size()
    assert refused.value.exit_code == 2
    return str(refused.value)
