"""A seed stands for the same bits on every processor, under every setting."""

import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

import determinism
import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from rubnoise.streams import STREAM_VERSION
from tests.golden.draws import GOLDEN as GOLDEN_DRAWS
from tests.golden.draws import hashes
from tests.golden.hashes import GOLDEN, RUNS, SEED, columns_of
from tests.models import contents, recorded

# A seed stands for the same bits on every processor and with every version of the libraries.
EXPECTED = json.loads(GOLDEN.read_text(encoding="utf-8"))
BRIEF = "matched, relative spread, few"
ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", RUNS)
def test_every_column_has_its_golden_bits(name: str) -> None:
    assert columns_of(RUNS[name]) == EXPECTED[name]


@pytest.mark.parametrize("name", [name for name, run in RUNS.items() if run.is_two_way])
def test_a_slider_that_pushes_back_has_them_by_both_engines(name: str) -> None:
    assert columns_of(RUNS[name], "batch") == EXPECTED[name]
    assert {"slider/phase", "landmarks/kind", "landmarks/time", "junctions/birth_time"} <= EXPECTED[name].keys()
    kinds = recorded(RUNS[name], SEED, engine="batch")["landmarks"]["kind"]
    assert set(kinds.tolist()) == ({0, 1, 2} if "reversals" in name else {0, 1})


def test_the_runs_are_long_enough_to_pass_blocks_and_draw_from_every_stream() -> None:
    assert STREAM_VERSION == 1
    assert recorded(RUNS["figure 5"], SEED).extent.junctions > 9_500
    assert recorded(RUNS["wide sizes, slow, from empty"], SEED).extent.junctions > 300
    assert all(
        recorded(run, SEED).extent.junctions > 1_000 for name, run in RUNS.items() if "tri" in name or "reg" in name
    )


def test_one_bit_changes_a_hash() -> None:
    record = recorded(RUNS["figure 5"], SEED)
    before = contents(record)
    record["trace"]["real_contact_area"].view("u8")[77] ^= 1
    changed = [column for column, data in contents(record).items() if data != before[column]]
    assert changed == [("trace", "real_contact_area")]


def test_kernels_for_a_plain_processor_give_the_same_bits(tmp_path: Path) -> None:
    """Compiled without vectors of eight and without an instruction that multiplies and adds at once."""
    plain = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "tests.golden.hashes", BRIEF]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=os.environ | plain)
    assert json.loads(done.stdout) == {BRIEF: EXPECTED[BRIEF]}


# What must not change a bit: hash seeds, threads and what else tools/determinism.py tries, here for one brief run.
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


# A uniform stands for the same diameter and the same strength on every processor.
OPTIONAL = [name for name in __cpu_dispatch__ if __cpu_features__[name]]
EXPECTED_DRAWS = json.loads(GOLDEN_DRAWS.read_text(encoding="utf-8"))
PLAIN = {
    "NPY_DISABLE_CPU_FEATURES": " ".join(OPTIONAL),
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F",
}
LIBRARY = "import numpy as np, zlib; print(zlib.crc32(np.exp(np.linspace(0.1, 9.0, 100_000)).tobytes()))"


def in_plain_arithmetic(*command: str) -> str:
    """Return what Python prints with every instruction set that a library may choose by itself switched off."""
    environment = os.environ | PLAIN
    done = subprocess.run(
        [sys.executable, *command], capture_output=True, text=True, check=True, cwd=ROOT, env=environment
    )
    return done.stdout


def test_every_law_has_its_golden_bits() -> None:
    assert hashes() == EXPECTED_DRAWS
    assert len(set(EXPECTED_DRAWS.values())) == len(EXPECTED_DRAWS) - 1  # one size alone is the same among the living


def test_no_bit_depends_on_the_instructions_of_the_processor() -> None:
    assert json.loads(in_plain_arithmetic("-m", "tests.golden.draws")) == EXPECTED_DRAWS


@pytest.mark.skipif("X86_V3" not in OPTIONAL, reason="this processor has nothing that changes a library's exp")
def test_a_librarys_exponential_depends_on_them() -> None:
    here = zlib.crc32(np.exp(np.linspace(0.1, 9.0, 100_000)).tobytes())
    assert int(in_plain_arithmetic("-c", LIBRARY)) != here
