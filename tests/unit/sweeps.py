"""Sweep files for the tests."""

from collections.abc import Callable
from pathlib import Path

import pytest

from rubnoise.errors import ScenarioRefused
from rubnoise.scenario.sweep import Sweep, load_sweep

HEAD = """\
format = 1
title = "swept"
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20
[sliding]
distance = "2 mm"
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
