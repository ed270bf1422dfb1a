"""`rubnoise run`: what it writes, prints and leaves alone, how soon it starts, and copies that start at once."""

import json
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from tests.shell.terminal import CONTACT, LONG, Answer, call, columns, command, names, spawn_program

# `rubnoise run`: what it writes, prints and leaves alone, how soon it starts, and what it refuses to begin.
# `rubnoise run`: what it writes, what it prints, what it leaves alone.
SHORT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")


def test_the_result_bears_the_name_of_the_scenario_in_the_current_folder(here: Path) -> None:
    answer = call("run", SHORT)
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.startswith("contact.h5: ")
    assert names(here) == ["contact.h5"]


def test_the_seed_is_the_one_of_the_file_option_or_setting(here: Path) -> None:
    (here / "seven.toml").write_text(CONTACT + "[run]\nseed = 7\n", encoding="utf-8")
    for output, arguments in {
        "file.h5": ("seven.toml",),
        "option.h5": (SHORT, "--seed", "7"),
        "setting.h5": (SHORT, "--set", "run.seed=7"),
        "other.h5": (SHORT,),
    }.items():
        assert call("run", *arguments, "-o", output).code == 0
    seven = columns(here / "file.h5")
    assert seven == columns(here / "option.h5") == columns(here / "setting.h5")
    assert seven["junctions/diameter"] != b""
    assert seven["trace/real_contact_area"] != columns(here / "other.h5")["trace/real_contact_area"]


def _fed(given: bytes, *words: str | Path) -> Answer:
    """Return the answer of a command that reads its file from standard input."""
    done = subprocess.run(command(*words), input=given, capture_output=True, check=False)
    return Answer(code=done.returncode, out=done.stdout.decode(), err=done.stderr.decode())


@pytest.mark.slow
def test_a_scenario_and_a_trace_may_come_through_a_pipe(here: Path) -> None:
    text = CONTACT + "[run]\nseed = 7\n"
    (here / "seven.toml").write_text(text, encoding="utf-8")
    assert call("run", "seven.toml").code == 0
    assert _fed(text.encode(), "run", "-").out.startswith("rubnoise.h5: ")
    assert columns(here / "rubnoise.h5") == columns(here / "seven.h5")
    assert "-:2: error: bad: " in _fed(b"format = 1\nbad = 2\n", "check", "-").err

    assert call("export", "seven.h5", "--to", "csv", "--group", "trace", "-o", "trace.csv").code == 0
    asked = ("infer", "--speed", "1 mm/s", "--zero", "known", "--json", "--column", "real_contact_area_um2")
    named, piped = call(*asked, "trace.csv"), _fed((here / "trace.csv").read_bytes(), *asked, "-")
    assert (piped.code, piped.out) == (named.code, named.out.replace("trace.csv", "-"))
    assert piped.err == named.err.replace("trace.csv", "-")


def test_the_engine_may_be_chosen_and_is_kept(here: Path) -> None:
    for engine in ("events", "batch"):
        assert call("run", SHORT, "--engine", engine, "-o", f"{engine}.h5").code == 0
        with h5py.File(here / f"{engine}.h5") as file:
            assert json.loads(file["provenance"].attrs["scenario_resolved"])["run"]["engine"] == engine
    assert columns(here / "batch.h5") == columns(here / "events.h5")
    answer = call("run", SHORT, "--engine", "evnts", "--force")
    assert answer.code == 2
    assert 'did you mean "events"?' in answer.err
    assert answer.err.startswith("--engine: error: run.engine: ")


def test_a_dry_run_writes_nothing_and_refuses_what_a_run_would(here: Path) -> None:
    answer = call("run", SHORT, "--dry-run")
    assert (answer.code, answer.err) == (0, "")
    assert "nothing written" in answer.out
    foreseen = call("run", SHORT, "--dry-run", "--json").values()["cost"]
    assert call("run", SHORT, "--dry-run", "-q").out == ""
    assert names(here) == []
    call("run", SHORT)
    with h5py.File(here / "contact.h5") as file:
        assert foreseen["junctions"] == file["junctions/diameter"].size
        assert foreseen["ticks"] == file["trace/distance"].size
    assert call("run", SHORT, "--dry-run").code == 2


def test_json_holds_the_warnings_that_others_get_on_stderr(here: Path) -> None:
    weak = ("--set", "strength.mean=250 mPa")
    assert 'did you mean "250 MPa"?' in call("run", SLIDER, *weak).err
    for answer in (
        call("run", SLIDER, *weak, "--json", "--force"),
        call("run", SLIDER, *weak, "--json", "--dry-run", "--force"),
    ):
        assert (answer.code, answer.err) == (0, "")
        assert 'did you mean "250 MPa"?' in answer.json()["notes"][0]


def test_a_broken_assumption_is_told_on_stderr_unless_quiet(here: Path) -> None:
    told = call("run", SLIDER)
    assert told.code == 0
    assert "warning: the velocity of the slider spreads by" in told.err
    assert call("run", SLIDER, "-q", "--force").err == ""
    weak = ("--set", "strength.mean=0.1 MPa", "--set", "output.tick=1 um")
    slow = call("run", SLIDER, "--force", *weak, "--set", "sliding.distance=2 mm")
    assert (slow.code, slow.err) == (0, "")


# A run does not wait for what it does not need.
AFTER_A_RUN = """
import contextlib, sys
from rubnoise.cli.app import main
sys.argv = ["rubnoise", "run", "../given/slider.toml", "-q"]
with contextlib.suppress(SystemExit):
    main()
print("loaded:", *sorted({"scipy.stats", "matplotlib"} & set(sys.modules)))
"""


def _told(program: str) -> list[str]:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.splitlines()


QUESTIONS = """
import contextlib, sys
from rubnoise.cli.app import main
for words in (["check", "../given/slider.toml", "--json"], ["run", "../given/slider.toml", "--dry-run", "--json"]):
    sys.argv = ["rubnoise", *words]
    with contextlib.suppress(SystemExit):
        main()
print("loaded:", *sorted({"h5py", "matplotlib", "numba", "pandas"} & set(sys.modules)))
"""
CLOSED = ([0], [1], [2], [1, 2], [0, 1, 2])
CLOSING = """
import os, sys
for number in map(int, sys.argv.pop(1).split()):
    os.close(number)
    setattr(sys, ("stdin", "stdout", "stderr")[number], None)
"""
AS_A_PROGRAM = f"{CLOSING}from rubnoise.__main__ import main; main()"
AS_A_LIBRARY = f"""{CLOSING}import rubnoise
with rubnoise.open(sys.argv[1]) as run:
    os._exit(10 + (run.trace["distance"][1] > 0.0))
"""


@pytest.mark.slow
@pytest.mark.parametrize("numbers", CLOSED, ids=str)
def test_streams_that_are_closed_keep_nothing_from_being_written_and_read(here: Path, numbers: list[int]) -> None:
    closed = " ".join(map(str, numbers))
    answer = spawn_program(AS_A_PROGRAM, closed, "run", "../given/contact.toml", "-o", "x.h5")
    assert answer.code == 0
    assert answer.out.startswith("x.h5: ") is (1 not in numbers)
    assert spawn_program(AS_A_LIBRARY, closed, "x.h5").code == 11


@pytest.mark.slow
def test_questions_about_a_scenario_load_no_compiler_and_no_file_format(here: Path) -> None:
    assert _told(QUESTIONS)[-1] == "loaded:"


# A run that its process is not allowed to make is refused before its first event, by the keys to change.
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


@pytest.mark.slow("limited by the shell")
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


def test_a_run_loads_no_statistics(here: Path) -> None:
    assert _told(AFTER_A_RUN) == ["loaded:"]
