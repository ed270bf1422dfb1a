"""What must not change a bit: hash seeds, threads and what else tools/determinism.py tries, here for one brief run."""

import json
import os
import subprocess
import sys
from pathlib import Path

import determinism
import pytest

from tests.golden.hashes import GOLDEN
from tests.golden.test_hashes import BRIEF

ROOT = Path(__file__).parents[2]
HERE = determinism.Place("here", Path(sys.executable))
HARMLESS = {
    setting.name: setting
    for setting in determinism.settings(determinism.features_of(HERE))
    if setting.name.startswith(("PYTHONHASHSEED", "threads", "numpy"))
}


TOGETHER = ("PYTHONHASHSEED=4242", "threads: 2", "numpy without SIMD")
"""One setting of each kind, in one process every day; --all tries each setting alone."""


@pytest.mark.parametrize(
    "names",
    [
        [name for name in TOGETHER if name in HARMLESS],
        *([name] for name in HARMLESS),
    ],
    ids=", ".join,
)
def test_a_brief_run_has_its_golden_bits(names: list[str]) -> None:
    assert names
    command = [sys.executable, "-m", "tests.golden.hashes", BRIEF]
    environment = dict(os.environ)
    for name in names:
        environment |= HARMLESS[name].variables
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=environment)
    assert json.loads(done.stdout)[BRIEF] == json.loads(GOLDEN.read_text(encoding="utf-8"))[BRIEF]


def test_every_kind_of_setting_is_tried() -> None:
    names = [setting.name for setting in determinism.settings(["X86_V3", "X86_V4", "AVX512_ICL"])]
    assert len(names) == 11
    (without,) = [
        setting.variables["NPY_DISABLE_CPU_FEATURES"]
        for setting in determinism.settings(["X86_V3", "X86_V4", "AVX512_ICL"])
        if setting.name == "numpy without AVX-512"
    ]
    assert without == "X86_V4 AVX512_ICL"
    assert "numpy without SIMD" not in [setting.name for setting in determinism.settings([])]


def test_a_bit_that_differs_is_named() -> None:
    expected = determinism.golden()
    assert expected["runs"].keys() >= {"figure 5", BRIEF}
    changed = json.loads(json.dumps(expected))
    assert determinism.differing(changed, expected) == []
    changed["runs"][BRIEF]["trace/real_contact_area"] = "0"
    del changed["draws"]["Fixed(value=250.0)"]
    assert determinism.differing(changed, expected) == [
        "draws, Fixed(value=250.0)",
        f"runs, {BRIEF}, trace/real_contact_area",
    ]


def test_the_oldest_libraries_are_those_of_the_project() -> None:
    oldest, newest = determinism.requirements(oldest=True), determinism.requirements(oldest=False)
    assert "numpy==2.1" in oldest
    assert "numpy" in newest
    assert len(oldest) == len(newest) > 8
