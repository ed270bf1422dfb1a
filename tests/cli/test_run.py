"""`rubnoise run`: what it writes, prints and leaves alone, how soon it starts, and copies that start at once."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import h5py
import pytest

from tests.cli.terminal import CONTACT, LONG, Answer, call, columns, command, names, spawn, spawn_program, start

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


def test_settings_are_numbers_quoted_texts_or_plain_texts(here: Path) -> None:
    settings = ["interface.mean_junction_count=5", 'sliding.distance="50 um"', "output.tick=1 um", "title=set by hand"]
    assert call("run", SHORT, *(word for text in settings for word in ("--set", text))).code == 0
    with h5py.File(here / "contact.h5") as file:
        assert file["trace/distance"][:].tolist() == list(range(51))
        assert file.attrs["title"] == b"set by hand"


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


def test_what_is_foreseen_of_free_motion_is_called_an_estimate(here: Path) -> None:
    """Text and JSON say the same of it, and nothing of the kind if the separation is held."""
    told = call("run", "load/bouncing", "--dry-run", "--json").json()["notes"]
    checked = call("check", "load/bouncing", "--json").json()["scenarios"]["load/bouncing"]["notes"]
    assert [note for note in checked if "estimate" in note] == told
    assert any("constant separation" in note for note in checked)
    for words, notes in ((("run", "load/bouncing", "--dry-run"), told), (("check", "load/bouncing"), checked)):
        text = " ".join(call(*words).out.split())
        assert all(note in text for note in notes)
    assert call("run", SHORT, "--dry-run", "--json").json()["notes"] == []


def test_json_is_one_object_and_nothing_else(here: Path) -> None:
    answer = spawn("run", SLIDER, "--json", "--seed", "3")
    assert (answer.code, answer.err) == (0, "")
    told = answer.values()["result"]
    assert (told["output"], told["seed"], told["ticks"]) == ("slider.h5", 3, 3001)
    assert told["bytes"] == (here / "slider.h5").stat().st_size
    assert answer.json()["summary"]["real_contact_area_mean"]["exact"] == pytest.approx(204.6736, abs=5e-5)
    assert "one-way coupling" in answer.json()["notes"][0]


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


@pytest.mark.parametrize(
    ("name", "speed", "doubt"),
    [
        ("paper/fig5", "1 mm/s", "the velocity of the slider"),
        ("load/fig5_rough", "200 mm/s", "the load would be negative"),
    ],
)
def test_a_forecast_warns_as_a_run_does(name: str, speed: str, doubt: str, here: Path) -> None:
    asked = ("run", name, "--set", f'sliding.speed="{speed}"', "--dry-run")
    assert f"warning: {doubt}" in call(*asked).err
    assert call(*asked, "-q").err == ""
    assert any(each.startswith(f"warning: {doubt}") for each in call(*asked, "--json").json()["notes"])
    assert names(here) == []


def test_a_run_too_short_for_its_slider_says_what_it_needs(here: Path) -> None:
    weak = ("--set", "strength.mean=0.1 MPa", "-o", "x.h5", "--force")
    told = call("run", SLIDER, *weak)
    said = "the run is too short for standard errors of the slider's motion: it lasts 1.5 of its decay times;"
    assert f"warning: {said} it needs about 5.2 mm" in " ".join(told.err.split())
    row = next(line for line in told.out.splitlines() if line.startswith("  displacement std (um)"))
    assert len(row.split()) == 5  # measured and exact, and neither error nor z
    assert call("run", SLIDER, *weak, "--json").json()["notes"] == [f"warning: {said} it needs about 5.2 mm"]
    assert call("run", SLIDER, *weak, "-q").err == ""


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "bad.toml: cannot be read: no such file or directory"),
        (b"", "bad.toml:1: error: format: missing"),
        (b'title = "\xff"\n', "bad.toml:1: error: not UTF-8 text"),
        (
            CONTACT.encode() + b"[sweep]\nreplicates = 4\n",
            "bad.toml:10: error: sweep: a sweep is many runs, but this command needs one scenario",
        ),
        (CONTACT.encode().replace(b"300 um", b"300 um^2"), "bad.toml:9: error: sliding.distance: "),
    ],
    ids=["missing", "empty", "not UTF-8", "a sweep", "a wrong unit"],
)
def test_a_scenario_that_is_none_is_refused_and_nothing_written(here: Path, content: bytes | None, said: str) -> None:
    scenario = here.parent / "given" / "bad.toml"
    if content is not None:
        scenario.write_bytes(content)
    answer = call("run", scenario)
    assert (answer.code, answer.out) == (2, "")
    assert said in answer.err
    assert "Traceback" not in answer.err
    assert names(here) == []


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


def test_a_run_loads_no_statistics(here: Path) -> None:
    assert _told(AFTER_A_RUN) == ["loaded:"]


QUESTIONS = """
import contextlib, sys
from rubnoise.cli.app import main
for words in (["check", "../given/slider.toml", "--json"], ["run", "../given/slider.toml", "--dry-run", "--json"]):
    sys.argv = ["rubnoise", *words]
    with contextlib.suppress(SystemExit):
        main()
print("loaded:", *sorted({"h5py", "matplotlib", "numba", "pandas"} & set(sys.modules)))
"""
KEPT_CODE = """
import sys
import rubnoise
rubnoise.simulate("../given/slider.toml")
print(*sorted({"numba.np.arraymath", "numba.np.linalg"} & set(sys.modules)))
import numba
print(numba.njit(lambda a: (a * a).sum())(__import__("numpy").array([3.0, 4.0])))
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


THREADS = """
import atexit, os
atexit.register(lambda: print(os.environ["OPENBLAS_NUM_THREADS"]))
from rubnoise.__main__ import main
main()
"""


@pytest.mark.parametrize("asked", ["", "3"])
def test_linear_algebra_has_one_thread_unless_another_number_is_asked_for(
    monkeypatch: pytest.MonkeyPatch, asked: str
) -> None:
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    if asked:
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", asked)
    assert spawn_program(THREADS, "--version").out.splitlines()[-1] == (asked or "1")


@pytest.mark.parametrize("numbers", CLOSED, ids=str)
def test_streams_that_are_closed_keep_nothing_from_being_written_and_read(here: Path, numbers: list[int]) -> None:
    closed = " ".join(map(str, numbers))
    answer = spawn_program(AS_A_PROGRAM, closed, "run", "../given/contact.toml", "-o", "x.h5")
    assert answer.code == 0
    assert answer.out.startswith("x.h5: ") is (1 not in numbers)
    assert spawn_program(AS_A_LIBRARY, closed, "x.h5").code == 11


def test_questions_about_a_scenario_load_no_compiler_and_no_file_format(here: Path) -> None:
    assert _told(QUESTIONS)[-1] == "loaded:"


def test_kept_code_is_loaded_without_what_compiles(here: Path) -> None:
    """Others may compile after it as before."""
    _told(KEPT_CODE)  # which keeps the code, where none is kept yet
    assert _told(KEPT_CODE) == ["", "25.0"]


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


# Copies of a process that has loaded the program behave like new processes.
@pytest.mark.parametrize(
    "words",
    [("check", SHORT, "--json"), ("info", "missing.h5"), ("run", SHORT, "--seed", "x"), ("new", "mine.toml")],
    ids=["answers", "refuses", "explains its use", "writes"],
)
def test_a_warm_call_answers_as_a_cold_one(here: Path, words: tuple[str | Path, ...]) -> None:
    answers = []
    for cold in (False, True):
        (here / "mine.toml").unlink(missing_ok=True)
        answers.append(spawn(*words, cold=cold, COLUMNS="100"))
    warm, cold = answers
    assert (warm.code, warm.err) == (cold.code, cold.err)
    assert warm.out == cold.out or warm.json().keys() == cold.json().keys()  # it foretells a time


def test_folder_variables_words_and_input_are_its_own(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ONE", "here")
    told = "import os, sys; print(os.getcwd(), os.environ['ONE'], sys.argv[1:], sys.stdin.read())"
    with start(
        [sys.executable, "-c", told, "a b", ""], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as run:
        out, _ = run.communicate("typed")
    assert out == f"{here} here ['a b', ''] typed\n"


def test_it_leaves_as_a_process_does() -> None:
    assert spawn_program("import sys; sys.exit(7)").code == 7
    assert spawn_program("import sys; sys.exit('why')").code == 1
    assert spawn_program("import atexit; atexit.register(print, 'at the end')").out == "at the end\n"
    failed = spawn_program("1 // 0")
    assert failed.code == 1
    assert failed.err.endswith("ZeroDivisionError: integer division or modulo by zero\n")
    assert spawn_program("import os; os.kill(os.getpid(), 9)").code == -signal.SIGKILL


def test_it_can_be_ended_and_waited_for() -> None:
    with start([sys.executable, "-c", "import time; time.sleep(60)"]) as run:
        assert run.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            run.wait(0.05)
        run.terminate()
        assert run.wait(10) == -signal.SIGTERM


def test_it_is_a_process_of_its_own_whose_traces_are_lost() -> None:
    first = spawn_program("import os, rubnoise; rubnoise.trace = 1; print(os.getpid())")
    second = spawn_program("import os, rubnoise; print(os.getpid(), hasattr(rubnoise, 'trace'))")
    assert second.out.split()[1] == "False"
    assert len({first.out.split()[0], second.out.split()[0], str(os.getpid())}) == 3


@pytest.mark.parametrize("sent", ["half of a request", "a request whose answer nobody reads"])
def test_one_that_is_killed_while_it_asks_for_a_copy_keeps_no_other_from_one(sent: str) -> None:
    request = {"words": ["-c", ""], "folder": "/", "environment": {}, "passed": [], "process_group": -1}
    content = json.dumps(request).encode()
    if sent.startswith("half"):
        content = content[: len(content) // 2]
    asks = f"""
import os, signal, socket
from tests import warm
socket.send_fds(warm.CHANNELS[0], [({len(json.dumps(request))}).to_bytes(warm.LENGTH_BYTES, "big")], [1, 0, 1, 2])
warm.CHANNELS[0].sendall({content!r})
os.kill(os.getpid(), signal.SIGKILL)
"""
    assert spawn_program(asks).code == -signal.SIGKILL
    with start([sys.executable, "-c", "print('there')"], stdout=subprocess.PIPE, text=True) as after:
        assert after.communicate(timeout=60)[0] == "there\n"


def test_variables_that_python_reads_make_a_fresh_one() -> None:
    program = "import sys; print('rubnoise.cli.app' in sys.modules)"
    words = [sys.executable, "-c", program]
    for environment, warm in (({}, True), ({"PYTHONHASHSEED": "7"}, False)):
        with start(words, environment, stdout=subprocess.PIPE, text=True) as run:
            assert run.communicate()[0] == f"{warm}\n"
    with start(command("--help"), cold=True, stdout=subprocess.PIPE) as run:
        assert run.args == command("--help")
        run.communicate()
