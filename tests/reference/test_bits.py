"""A seed stands for the same rows on every processor, under every setting: golden values."""

import json
from pathlib import Path

import pytest
from determinism import SETTINGS, differing, made

from rubnoise.contact.laws import LAWS
from rubnoise.streams import STREAM_VERSION
from tests.models import contents, recorded
from tests.reference.hashes import GOLDEN, GOLDEN_DRAWS, RUNS, SEED, SIZES, columns_of, draws

# A seed stands for the same bits on every processor and with every version of the libraries.
EXPECTED = json.loads(GOLDEN.read_text(encoding="utf-8"))
BRIEF = "matched, relative spread, few"


# What is new gets its values by python -m tests.reference.hashes --write; others change with the stream version.
@pytest.mark.parametrize("name", RUNS)
def test_every_column_has_its_golden_values(name: str) -> None:
    assert differing({name: columns_of(RUNS[name])}, {name: EXPECTED[name]}) == []


def test_every_law_has_its_golden_draws() -> None:
    assert differing(draws(), json.loads(GOLDEN_DRAWS.read_text(encoding="utf-8"))) == []
    known = {type(law).__name__.lower() for law in SIZES} | {"exponential"}  # which is a Weibull law
    assert known == {name for name, entry in LAWS.items() if not entry.own_keys}


@pytest.mark.parametrize("name", [name for name, run in RUNS.items() if run.is_two_way])
def test_a_slider_that_pushes_back_has_them_by_both_engines(name: str) -> None:
    assert differing({name: columns_of(RUNS[name], "batch")}, {name: EXPECTED[name]}) == []
    assert {"slider/phase", "landmarks/kind", "landmarks/time", "junctions/birth_time"} <= EXPECTED[name].keys()
    kinds = recorded(RUNS[name], SEED, engine="batch")["landmarks"]["kind"]
    assert set(kinds.tolist()) == ({0, 1, 2} if "reversals" in name else {0, 1})


def test_the_runs_are_long_enough_to_pass_blocks_and_draw_from_every_stream() -> None:
    assert STREAM_VERSION == 2
    assert recorded(RUNS["figure 5"], SEED).extent["junctions"] > 9_500
    assert recorded(RUNS["wide sizes, slow, from empty"], SEED).extent["junctions"] > 300
    assert all(
        recorded(run, SEED).extent["junctions"] > 1_000 for name, run in RUNS.items() if "tri" in name or "reg" in name
    )


def test_one_bit_changes_a_hash() -> None:
    record = recorded(RUNS["figure 5"], SEED)
    before = contents(record)
    record["trace"]["real_contact_area"].view("u8")[77] ^= 1
    changed = [column for column, data in contents(record).items() if data != before[column]]
    assert changed == [("trace", "real_contact_area")]


# What must not change a bit: hash seeds, threads and what else tools/determinism.py tries, here for one brief run.
TOGETHER = ("PYTHONHASHSEED=4242", "threads: 2", "numpy without SIMD")


@pytest.mark.slow
def test_kernels_for_a_plain_processor_give_the_same_values(tmp_path: Path) -> None:
    """Compiled without vectors of eight and without an instruction that multiplies and adds at once."""
    plain = SETTINGS["kernels for any processor"] | {"NUMBA_CACHE_DIR": str(tmp_path)}
    assert differing(made(BRIEF, **plain), {BRIEF: EXPECTED[BRIEF]}) == []


@pytest.mark.slow
def test_a_brief_run_has_its_golden_bits() -> None:
    """One setting of each kind in one process; `dev.py check bits` tries each alone."""
    variables = {name: value for each in TOGETHER for name, value in SETTINGS[each].items()}
    assert differing(made(BRIEF, **variables), {BRIEF: EXPECTED[BRIEF]}) == []
