"""Damaged and hostile files: a few of each tool, and proof that the tool would notice."""

import json
import os
import signal
import time
from pathlib import Path
from random import Random

import numpy as np
import pytest
from fuzz.damage import DAMAGES, Damage, damaged, lookup3
from fuzz.hostile import CONSTRUCTIONS, Construction, make, watched
from fuzz.traces import made
from fuzz_results import COMMANDS, KINDS, MISSED, Judge, mutations, values
from survival.child import called, isolated
from survival.stories import NAME

from rubnoise.storage.reader import open_run
from tests.cli.terminal import call
from tests.unit.tampering import tell

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
@pytest.mark.parametrize("construction", CONSTRUCTIONS, ids=lambda each: each.__name__)
def test_hostile_files_do_no_harm(judge: Judge, construction: Construction) -> None:
    make(construction, judge.good["none"], judge.path, judge.canary)
    assert list(judge.judged("none", CONSTRUCTIONS.index(construction), forged=True)) == []


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
    assert isolated(_crash).fault(0) == "crashes (SIGSEGV)"
    assert isolated(_wait, seconds=0.3).fault(0) == "hangs"
    assert isolated(_fill).fault(0, 2, 3) == "exit code 99"
    assert isolated(lambda: 1 // int(not tmp_path)).fault(0) == "exit code 99"
    assert isolated(lambda: 2).fault(0, 2) == ""
    missing = called(["info", "missing.h5"], tmp_path)
    assert (missing.code, missing.out, missing.err) == (2, "", "missing.h5: no such file or directory\n")


@ON_LINUX
def test_the_checksum_is_that_of_hdf5(judge: Judge) -> None:
    content = judge.good["none"]
    assert lookup3(content[:44]) == int.from_bytes(content[44:48], "little")


@ON_LINUX
@pytest.mark.parametrize("damage", sorted(set(DAMAGES), key=lambda each: each.__name__), ids=lambda each: each.__name__)
def test_every_kind_of_damage_changes_the_file(judge: Judge, damage: Damage) -> None:
    content = judge.good["none"]
    changed = bytearray(content)
    damage(changed, judge.good["gzip"], Random(1))  # noqa: S311  (damage is no secret)
    assert changed != content


@ON_LINUX
def test_damage_can_be_made_again() -> None:
    first, second = (damaged(bytes(100), b"x" * 100, Random(3)) for _ in range(2))  # noqa: S311
    assert first == second


@ON_LINUX
def test_good_files_are_good(judge: Judge) -> None:
    """The control of all of the above."""
    for kind in KINDS:
        judge.path.write_bytes(judge.good[kind])
        assert list(judge.judged(kind, COMMANDS.index(("compare", NAME)), forged=False)) == []
        with open_run(judge.path) as run:
            assert run.damaged() == ()
        assert values(judge.path) == judge.truth[kind]


# Traces that are damaged, hostile or of the wrong kind: `infer` answers or refuses, in bounded time and memory.
SEED = 33
COUNT = 152
PER_TEST = 19
SECONDS = 20.0
"""Ten are allowed; a copy of a large process takes some of its own where other tests share the processors."""

MEMORY = 500 * 1024**2
LONGEST = 1500


@pytest.fixture(scope="module")
def _loaded(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Load here what `infer` loads, so that no copy of this process has to."""
    folder = tmp_path_factory.mktemp("loaded")
    for number in range(40):
        name, options = made(SEED, number, folder)
        if not name.startswith("/") and (folder / name.partition(":")[0]).is_file():
            call("infer", *options, "--law", "fixed", "--json", "--", str(folder / name))


@ON_LINUX
@pytest.mark.parametrize("first", range(0, COUNT, PER_TEST))
@pytest.mark.usefixtures("_loaded")
def test_infer_answers_or_refuses(first: int, tmp_path: Path) -> None:
    wrong = []
    for number in range(first, first + PER_TEST):
        name, options = made(SEED, number, tmp_path)
        done = called(
            ["infer", *options, "--law", "fixed", "--json", "--", name], tmp_path, seconds=SECONDS, memory=MEMORY
        )
        fault = done.fault(0, 2, 3)
        if not fault and len(done.err) > LONGEST + 1 and "Usage" not in done.err:
            fault = "too long an error"
        if not fault and (done.out == "") != (done.code == 2):
            fault = "an answer with an error, or none without"
        if not fault and done.out:
            answer = json.loads(done.out)
            if not answer["refused"] and any(len(each["interval"]) != 2 for each in answer["estimates"].values()):
                fault = "an estimate without its interval"
        if fault:
            wrong.append((number, name[:80], options, fault, done.err[-300:]))
    assert wrong == []
