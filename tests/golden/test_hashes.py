"""A seed stands for the same bits on every processor and with every version of the libraries."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from rubnoise.streams import STREAM_VERSION
from tests.golden.hashes import GOLDEN, RUNS, SEED, columns_of
from tests.models import contents, recorded

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
