"""A run that its process is not allowed to make is refused before its first event, by the keys to change."""

import subprocess
from pathlib import Path

import pytest

from tests.cli.terminal import LONG, Answer, command, names

SHORT = Path("../given/contact.toml")
DENSE = ("--set", "interface.mean_junction_count=300000", "--set", "sliding.distance=1 um")


def _limited(limit: str, *words: str | Path) -> Answer:
    """Call the command line in a process under a limit of the shell."""
    line = ["sh", "-c", f'ulimit {limit} && exec "$@"', "sh", *command(*words)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    return Answer(code=done.returncode, out=done.stdout, err=done.stderr)


@pytest.mark.parametrize("how", [(), ("--dry-run",)], ids=["run", "dry run"])
def test_a_file_larger_than_the_process_may_write(here: Path, how: tuple[str, ...]) -> None:
    answer = _limited("-f 2000", "run", SHORT, *LONG, *how)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("contact.h5: the result may take ")
    assert "has room for 1,024,000; make sliding.distance shorter or interface.mean_junction_count" in answer.err
    assert names(here) == []


@pytest.mark.parametrize("how", [(), ("--dry-run",)], ids=["run", "dry run"])
def test_more_memory_than_the_process_may_have(here: Path, how: tuple[str, ...]) -> None:
    answer = _limited("-v 1200000", "run", SHORT, *DENSE, *how)
    assert (answer.code, answer.out) == (2, "")
    assert "of memory" in answer.err
    assert 'run.engine = "batch"' in answer.err or "interface.mean_junction_count" in answer.err
    assert len(answer.err.splitlines()) == 1
    assert names(here) == []


def test_limits_that_are_wide_enough_hinder_nothing(here: Path) -> None:
    assert _limited("-f 2000 && ulimit -v 1200000", "run", SHORT, "-q") == Answer(code=0, out="", err="")
    assert names(here) == ["contact.h5"]
