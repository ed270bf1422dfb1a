"""Traces that are damaged, hostile or of the wrong kind: `infer` answers or refuses, in bounded time and memory."""

import json
from pathlib import Path

import pytest
from fuzz.isolated import called
from fuzz.traces import made

from tests.cli.terminal import call

pytestmark = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the limits are those of Linux")
SEED = 33
COUNT = 304
PER_TEST = 38
SECONDS = 20.0
"""Ten are allowed; a copy of a large process takes some of its own where other tests share the processors."""

MEMORY = 500 * 1024**2
LONGEST = 1500


@pytest.fixture(scope="module", autouse=True)
def _loaded(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Load here what `infer` loads, so that no copy of this process has to."""
    folder = tmp_path_factory.mktemp("loaded")
    for number in range(40):
        name, options = made(SEED, number, folder)
        if not name.startswith("/") and (folder / name.partition(":")[0]).is_file():
            call("infer", *options, "--law", "fixed", "--json", "--", str(folder / name))


@pytest.mark.parametrize("first", range(0, COUNT, PER_TEST))
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
