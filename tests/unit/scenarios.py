"""Scenario texts for the tests: a whole one, the same with lines replaced, and sweeps of it."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from rubnoise.analysis.measured import Measured
from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import loads
from rubnoise.scenario.sweep import Point, Sweep, load_sweep
from rubnoise.simulation.run import simulate


def std_of(point: Point, name: str) -> float:
    """Run a point, and return the standard deviation of a column of its trace."""
    seen = Measured(point.scenario.model())
    simulate(seen.model, point.seed, seen, engine="batch")
    return seen.moments["trace", name].std


# Scenario texts for the tests: a whole one, and the same with lines replaced.
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


# Sweep files for the tests.
HEAD = """\
format = 1
title = "swept"
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20
[sliding]
distance = "2 mm"
"""
SHORT_HEAD = HEAD.replace("2 mm", "100 um")
SMALL = """\
[output]
tick = "5 um"
[sweep]
replicates = 2
[sweep.grid]
interface.mean_junction_count = [10, 20]
"""
GRID = """\
[sweep]
replicates = 2
[sweep.grid]
interface.mean_real_contact_area = ["100 um^2", "200 um^2"]
interface.mean_junction_count = [10, 20, 30]
"""

Written = Callable[[str], Path]


def sweep_of(folder: Path, table: str, *overrides: str, head: str = HEAD) -> Sweep:
    """Return the sweep of a file that is written for it."""
    (path := folder / "s.toml").write_text(head + table, encoding="utf-8")
    return load_sweep(path, overrides)


def sweep_refusal(folder: Path, table: str, *overrides: str, head: str = HEAD) -> str:
    """Return the report on a sweep that must be refused, without the folder's name."""
    with pytest.raises(ScenarioRefused) as refused:
        sweep_of(folder, table, *overrides, head=head)
    assert refused.value.exit_code == 2
    return str(refused.value).replace(f"{folder}/", "")
