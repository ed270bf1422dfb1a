"""Damaged and hostile files: a few of each tool, and proof that the tool would notice."""

import os
import signal
import time
from pathlib import Path
from random import Random

import numpy as np
import pytest
from child import Child, called
from fuzz_results import COMMANDS, CONSTRUCTIONS, DAMAGES, KINDS, MISSED, Damage, Judge, mutations, values, watched
from survive import NAME

from rubnoise.storage.reader import open_run
from tests.unit.tampering import tell

pytestmark = pytest.mark.slow

# A few of the damaged and hostile files of `tools/fuzz_results.py`, and proof that the script would notice.
ON_LINUX = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the limits are those of Linux")
FEW = 12


@pytest.fixture(scope="module")
def judge(tmp_path_factory: pytest.TempPathFactory) -> Judge:
    return Judge(tmp_path_factory.mktemp("judge"))


@ON_LINUX
def test_damage_is_refused_or_found() -> None:
    outcome = mutations(1, range(FEW))
    assert outcome.counts.total() == FEW
    assert outcome.findings == []


@ON_LINUX
@pytest.mark.parametrize("name", CONSTRUCTIONS)
def test_hostile_files_do_no_harm(judge: Judge, name: str) -> None:
    judge.make(CONSTRUCTIONS[name])
    assert list(judge.judged("none", list(CONSTRUCTIONS).index(name), forged=True)) == []


@ON_LINUX
def test_a_change_that_verify_missed_would_be_seen(judge: Judge) -> None:
    """A change that is sealed again is good to verify; not said to be forged, it stands for one missed."""
    judge.path.write_bytes(judge.good["none"])
    tell(judge.path, "provenance", "command", "rubnoise run another.toml")
    assert list(judge.judged("none", 0, forged=False)) == [f"verify: {MISSED}"]


@ON_LINUX
def test_a_file_that_was_opened_would_be_seen(judge: Judge) -> None:
    with watched(judge.canary) as opened:
        pass
    assert not opened
    with watched(judge.canary) as opened, judge.canary.open("rb"):
        pass
    assert opened


def _crash() -> int:
    os.kill(os.getpid(), signal.SIGSEGV)
    return 0


def _fill() -> int:
    np.ones(1 << 30)
    return 0


def _wait() -> int:
    time.sleep(60.0)
    return 0


@ON_LINUX
def test_every_bad_ending_would_be_seen(tmp_path: Path) -> None:
    assert Child(_crash).end().fault(0) == "crashes (SIGSEGV)"
    assert Child(_wait).end(0.3).fault(0) == "hangs"
    assert Child(_fill).end().fault(0, 2, 3) == "exit code 99"
    assert Child(lambda: 1 // int(not tmp_path)).end().fault(0) == "exit code 99"
    assert Child(lambda: 2).end().fault(0, 2) == ""
    missing = called(["info", "missing.h5"], tmp_path)
    assert (missing.code, missing.out, missing.err) == (2, "", "missing.h5: no such file or directory\n")


@ON_LINUX
@pytest.mark.parametrize("damage", sorted(set(DAMAGES), key=lambda each: each.__name__), ids=lambda each: each.__name__)
def test_every_kind_of_damage_changes_the_file(judge: Judge, damage: Damage) -> None:
    content = judge.good["none"]
    changed = bytearray(content)
    damage(changed, judge.good["gzip"], Random(1))  # noqa: S311  (damage is no secret)
    assert changed != content


@ON_LINUX
def test_good_files_are_good(judge: Judge) -> None:
    """The control of all of the above."""
    for kind in KINDS:
        judge.path.write_bytes(judge.good[kind])
        assert list(judge.judged(kind, COMMANDS.index(("compare", NAME)), forged=False)) == []
        with open_run(judge.path) as run:
            assert run.damaged() == {}
        assert values(judge.path) == judge.truth[kind]
