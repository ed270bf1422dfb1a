"""A seed stands for the same rows under every setting: golden values, to 1e-10 of the largest of a column."""

import json
import os
import subprocess
import sys
from pathlib import Path

import determinism
import pytest
from determinism import differing

from rubnoise.contact.laws import LAWS
from rubnoise.streams import STREAM_VERSION
from tests.architecture.sources import ROOT
from tests.golden.hashes import GOLDEN, GOLDEN_DRAWS, RUNS, SEED, SIZES, columns_of, draws
from tests.models import contents, recorded

EXPECTED = json.loads(GOLDEN.read_text(encoding="utf-8"))
BRIEF = "matched, relative spread, few"


# What is new gets its values by python -m tests.golden.hashes --write; those of before change with the stream version.
@pytest.mark.parametrize("name", RUNS)
def test_every_column_has_its_golden_values(name: str) -> None:
    assert differing({name: columns_of(RUNS[name])}, {name: EXPECTED[name]}) == []


def test_every_law_has_its_golden_draws() -> None:
    assert differing(draws(), json.loads(GOLDEN_DRAWS.read_text(encoding="utf-8"))) == []
    assert {type(law).__name__.lower() for law in SIZES} == {name for name, entry in LAWS.items() if not entry.own_keys}


@pytest.mark.parametrize("name", [name for name, run in RUNS.items() if run.is_two_way])
def test_a_slider_that_pushes_back_has_them_by_both_engines(name: str) -> None:
    assert differing({name: columns_of(RUNS[name], "batch")}, {name: EXPECTED[name]}) == []
    assert {"slider/phase", "landmarks/kind", "landmarks/time", "junctions/birth_time"} <= EXPECTED[name].keys()
    kinds = recorded(RUNS[name], SEED, engine="batch")["landmarks"]["kind"]
    assert set(kinds.tolist()) == ({0, 1, 2} if "reversals" in name else {0, 1})


def test_the_runs_are_long_enough_to_pass_blocks_and_draw_from_every_stream() -> None:
    assert STREAM_VERSION == 2
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


@pytest.mark.slow
def test_kernels_for_a_plain_processor_give_the_same_values(tmp_path: Path) -> None:
    """Compiled without vectors of eight and without an instruction that multiplies and adds at once."""
    plain = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "tests.golden.hashes", BRIEF]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=os.environ | plain)
    assert differing(json.loads(done.stdout), {BRIEF: EXPECTED[BRIEF]}) == []


# What must not change a bit: hash seeds, threads and what else tools/determinism.py tries, here for one brief run.
HERE = determinism.Place("here", Path(sys.executable))
HARMLESS = {
    setting.name: setting
    for setting in determinism.settings(determinism.features_of(HERE))
    if setting.name.startswith(("PYTHONHASHSEED", "threads", "numpy"))
}


TOGETHER = ("PYTHONHASHSEED=4242", "threads: 2", "numpy without SIMD")
"""One setting of each kind, in one process every day; --all tries each setting alone."""


@pytest.mark.slow
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
    assert differing(json.loads(done.stdout), {BRIEF: EXPECTED[BRIEF]}) == []
