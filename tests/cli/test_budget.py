"""A run that its process is not allowed to make is refused before its first event, by the keys to change."""

import subprocess
from pathlib import Path

import pytest

from tests.cli.terminal import LONG, Answer, command, names, spawn_program

SHORT = Path("../given/contact.toml")
DENSE = ("--set", "interface.mean_junction_count=300000", "--set", "sliding.distance=1 um")
UNDER = """
import resource, sys
name, most = sys.argv.pop(1), int(sys.argv.pop(1))
if name == "AS":
    most += int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(getattr(resource, "RLIMIT_" + name), (most, most))
from rubnoise.__main__ import main
main()
"""
HOW = {"run": (), "dry run": ("--dry-run",)}


def _under(name: str, most: int, *words: str | Path) -> Answer:
    """Call the command line in a process that limits itself; a limit on address space adds to what is in use."""
    return spawn_program(UNDER, name, str(most), *words)


def _limited(limit: str, *words: str | Path) -> Answer:
    """Call the command line in a process under a limit of the shell."""
    line = ["sh", "-c", f'ulimit {limit} && exec "$@"', "sh", *command(*words)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    return Answer(code=done.returncode, out=done.stdout, err=done.stderr)


@pytest.mark.parametrize("how", HOW)
def test_a_file_larger_than_the_process_may_write(here: Path, how: str) -> None:
    answer = _under("FSIZE", 1_024_000, "run", SHORT, *LONG, *HOW[how])
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("contact.h5: the result may take ")
    assert "has room for 1,024,000; make sliding.distance shorter or interface.mean_junction_count" in answer.err
    assert names(here) == []


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="only Linux limits the address space")
@pytest.mark.parametrize("how", ["limited by the shell", *HOW])
def test_more_memory_than_the_process_may_have(here: Path, how: str) -> None:
    words = ("run", SHORT, *DENSE, *HOW.get(how, ()))
    answer = _under("AS", 500_000_000, *words) if how in HOW else _limited("-v 1200000", *words)
    assert (answer.code, answer.out) == (2, "")
    assert "of memory" in answer.err
    assert 'run.engine = "batch"' in answer.err or "interface.mean_junction_count" in answer.err
    assert len(answer.err.splitlines()) == 1
    assert names(here) == []


def test_limits_that_are_wide_enough_hinder_nothing(here: Path) -> None:
    assert _limited("-f 2000 && ulimit -v 1200000", "run", SHORT, "-q") == Answer(code=0, out="", err="")
    assert names(here) == ["contact.h5"]
