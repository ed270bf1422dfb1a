"""What tools/dev.py promises, in a folder whose path has a space, with a pip that needs no network."""

import ast
import importlib.util
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from tests.setup.sandbox import Sandbox


@pytest.fixture
def sandbox(tmp_path: Path) -> Sandbox:
    made = Sandbox(folder=tmp_path / "rub noise")
    made.fill()
    return made


def test_arguments_reach_rubnoise_untouched(sandbox: Sandbox) -> None:
    arguments = ["--help", "a b.toml", "--set", "run.seed=2", "", "$HOME", "--"]
    code, output, _ = sandbox.dev("run", *arguments)
    assert (code, output.split("\n")[:-1]) == (0, ["run", *arguments])


def test_nothing_but_the_program_writes_to_standard_output(sandbox: Sandbox) -> None:
    _, output, error = sandbox.dev("run", "x")
    assert output == "run\nx\n"
    assert "installing tools/run.lock" in error


def test_the_exit_code_is_the_programs(sandbox: Sandbox) -> None:
    assert sandbox.dev("run", "fail")[0] == 3


def test_a_signal_reaches_the_program(sandbox: Sandbox) -> None:
    sandbox.dev("run")
    with sandbox.start("run", "sleep") as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "run\n"
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=60) == -signal.SIGTERM


def test_the_second_call_installs_nothing(sandbox: Sandbox) -> None:
    sandbox.dev("run")
    before = sandbox.pip_calls()
    _, _, error = sandbox.dev("run")
    assert (sandbox.pip_calls(), error) == (before, "")


def test_a_run_installs_what_it_and_its_pictures_need(sandbox: Sandbox) -> None:
    sandbox.dev("run")
    packages, project = (call["arguments"] for call in sandbox.pip_calls())
    assert [Path(word).name for word in packages if word.startswith("--requirement")] == ["run.lock", "sync.lock"]
    assert {"--require-hashes", "--no-deps", "--only-binary=:all:"} <= set(packages)
    assert {f"--editable={sandbox.folder}", "--no-deps", "--no-build-isolation"} <= set(project)


def test_sync_installs_what_pictures_need_and_sync_all_everything(sandbox: Sandbox) -> None:
    for words, locks in ((("sync",), ["run", "sync"]), (("sync", "all"), ["run", "sync", "test", "all"])):
        known = len(sandbox.pip_calls())
        code, output, _ = sandbox.dev(*words)
        packages = sandbox.pip_calls()[known]["arguments"]
        required = [Path(word).name for word in packages if word.startswith("--requirement")]
        assert required == [f"{lock}.lock" for lock in locks]
        assert (code, output) == (0, "")
    assert sandbox.dev("sync", "more")[0] == 2


def test_tests_need_all_locks_and_a_run_is_content_with_them(sandbox: Sandbox) -> None:
    sandbox.dev("lint")
    packages = sandbox.pip_calls()[0]["arguments"]
    required = [Path(word).name for word in packages if word.startswith("--requirement")]
    assert required == ["run.lock", "sync.lock", "test.lock"]
    sandbox.dev("run")
    assert len(sandbox.pip_calls()) == 2


def test_the_benchmark_has_an_environment_of_its_own(sandbox: Sandbox) -> None:
    bench = sandbox.folder / "tools" / "bench"
    bench.mkdir()
    (bench / "__main__.py").write_text("import sys\nprint(*sys.argv[1:], sep='|')\nsys.exit(1)\n", encoding="utf-8")
    code, output, _ = sandbox.dev("bench", "--quick", "--output", "a b")
    packages = sandbox.pip_calls()[0]["arguments"]
    assert [Path(word).name for word in packages if word.startswith("--requirement")] == ["run.lock", "bench.lock"]
    assert (code, output) == (1, "--quick|--output|a b\n")
    assert (sandbox.folder / ".venv-bench" / "rubnoise-setup.json").exists()
    assert not sandbox.venv.exists()


@pytest.mark.parametrize("name", ["tools/run.lock", "pyproject.toml"])
def test_a_changed_lock_is_installed_into_what_is_there(sandbox: Sandbox, name: str) -> None:
    sandbox.dev("run")
    kept = sandbox.venv / "kept"
    kept.touch()
    (sandbox.folder / name).write_text("# changed\n", encoding="utf-8")
    assert sandbox.dev("run")[0] == 0
    assert (len(sandbox.pip_calls()), kept.exists()) == (4, True)


def test_a_moved_project_gets_a_new_environment(sandbox: Sandbox) -> None:
    sandbox.dev("run")
    (sandbox.venv / "kept").touch()
    moved = replace(sandbox, folder=sandbox.folder.with_name("moved"))
    shutil.move(sandbox.folder, moved.folder)
    assert moved.dev("run")[0] == 0
    assert not (moved.venv / "kept").exists()


def test_a_failing_pip_is_explained_and_the_next_call_starts_again(sandbox: Sandbox) -> None:
    sandbox.order("fail")
    code, _, error = sandbox.dev("run")
    assert code == 1
    assert "needs the network once, for the package index that pip uses" in error
    assert not re.search(r"\w\.(org|com|net|io)\b", error)
    assert "Traceback" not in error
    assert sandbox.stamp() == {}
    sandbox.order("")
    assert sandbox.dev("run")[0] == 0


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_interrupted_set_up_leaves_no_pip_and_is_repaired(sandbox: Sandbox, number: int, code: int) -> None:
    pip = _interrupt(sandbox, number, code)
    with pytest.raises(ProcessLookupError):
        os.kill(pip, 0)
    assert sandbox.stamp() == {}
    _expect_repair(sandbox)


def test_a_pip_that_does_not_stop_has_ended_before_set_up_ends(sandbox: Sandbox) -> None:
    pip = _interrupt(sandbox, signal.SIGINT, 130, behaviour="stay")
    with pytest.raises(ProcessLookupError):
        os.kill(pip, 0)


# The signal comes when pip is already at work and its process id is not known yet.
SLOW_POPEN = """
import os, signal, subprocess, time
from pathlib import Path

class SlowPopen(subprocess.Popen):
    def __init__(self, *words, **options):
        super().__init__(*words, **options)
        if "install" in words[0]:
            while not Path({waiting!r}).exists():
                time.sleep(0.01)
            os.kill(os.getpid(), signal.SIGTERM)

subprocess.Popen = SlowPopen
"""


def test_a_signal_while_pip_is_being_started_leaves_no_pip(sandbox: Sandbox) -> None:
    waiting = sandbox.folder / "waiting"
    sandbox.order("wait")
    assert replace(sandbox, more=SLOW_POPEN.format(waiting=str(waiting))).dev("run")[0] == 143
    with pytest.raises(ProcessLookupError):
        os.kill(int(waiting.read_text(encoding="utf-8")), 0)
    _expect_repair(sandbox)


def test_killed_set_up_is_repaired_after_its_pip_has_ended(sandbox: Sandbox) -> None:
    pip = _interrupt(sandbox, signal.SIGKILL, -signal.SIGKILL)
    with sandbox.start("run") as second:
        assert second.stderr is not None
        assert "another set-up is at work" in second.stderr.readline()
        sandbox.order("")
        os.kill(pip, signal.SIGTERM)
        second.communicate(timeout=60)
        assert second.returncode == 0


def _interrupt(sandbox: Sandbox, number: int, code: int, *, behaviour: str = "wait") -> int:
    """Send a signal while pip is at work; return pip's process id."""
    sandbox.order(behaviour)
    waiting = sandbox.folder / "waiting"
    with sandbox.start("run") as process:
        deadline = time.monotonic() + 60
        while not (waiting.exists() and waiting.read_text(encoding="utf-8")):
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.send_signal(number)
        assert process.wait(timeout=60) == code
    return int(waiting.read_text(encoding="utf-8"))


def _expect_repair(sandbox: Sandbox) -> None:
    sandbox.order("")
    (sandbox.venv / "half-made").touch()
    assert sandbox.dev("run")[0] == 0
    assert not (sandbox.venv / "half-made").exists()
    assert sandbox.stamp() != {}


def test_an_environment_without_a_python_is_made_anew(sandbox: Sandbox) -> None:
    sandbox.dev("run")
    (sandbox.venv / "bin" / "python").unlink()
    assert sandbox.dev("run")[0] == 0


def test_somebody_elses_environment_is_used(sandbox: Sandbox) -> None:
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(sandbox.venv)], check=True)
    (sandbox.venv / "theirs").touch()
    assert sandbox.dev("run")[0] == 0
    assert (sandbox.venv / "theirs").exists()


def test_somebody_elses_environment_of_another_python_is_left_alone(sandbox: Sandbox) -> None:
    (sandbox.venv / "bin").mkdir(parents=True)
    other = sandbox.venv / "bin" / "python"
    other.write_text("#!/bin/sh\nprintf '3.9.2 (an old one)'\n", encoding="utf-8")
    other.chmod(0o755)
    code, _, error = sandbox.dev("run")
    assert (code, other.exists()) == (1, True)
    assert "made by something else, with Python 3.9.2" in error


def test_only_the_way_to_the_index_is_kept_of_pips_configuration(sandbox: Sandbox) -> None:
    configured = (
        "global.index-url='https://mirror/simple'\ninstall.target='/elsewhere'\n:env:.proxy='http://proxy:3128'"
    )
    variables = {
        "FAKE_CONFIG": configured,
        "PIP_TARGET": "/x",
        "PIP_USER": "1",
        "PYTHONPATH": "/y",
        "PYTHONWARNINGS": "error",
    }
    assert replace(sandbox, variables=variables).dev("run")[0] == 0
    settings = sandbox.pip_calls()[0]["settings"]
    assert settings == {
        "PIP_CONFIG_FILE": "/dev/null",
        "PIP_DISABLE_PIP_VERSION_CHECK": "1",
        "PIP_INDEX_URL": "https://mirror/simple",
        "PIP_NO_INPUT": "1",
        "PIP_PROXY": "http://proxy:3128",
    }


def test_a_python_without_pip_and_ensurepip_is_told_what_to_install(sandbox: Sandbox) -> None:
    code, _, error = replace(sandbox, found=()).dev("run")
    assert (code, sandbox.venv.exists()) == (1, False)
    assert "apt install python3-pip" in error


def test_no_command_shows_the_usage_and_touches_nothing(sandbox: Sandbox) -> None:
    for arguments, expected in (((), 2), (("nonsense",), 2), (("--help",), 0)):
        code, output, error = sandbox.dev(*arguments)
        assert code == expected
        assert (output or error).startswith("usage: python3 tools/dev.py COMMAND")
    assert not sandbox.venv.exists()


# Parts of tools/bootstrap.py that a whole set-up does not reach.
TOOLS = Path(__file__).resolve().parents[2] / "tools"


@pytest.fixture(scope="module")
def bootstrap() -> ModuleType:
    spec = importlib.util.spec_from_file_location("bootstrap", TOOLS / "bootstrap.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_old_python_is_named_and_told_what_is_needed(bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "version_info", (3, 9, 2, "final", 0))
    with pytest.raises(bootstrap.SetupFailed, match=r"Python 3\.11 or newer is needed, and .* is Python 3\.9\.2"):
        bootstrap.refuse_what_cannot_work()


@pytest.mark.parametrize("name", ["dev.py", "bootstrap.py"])
def test_an_old_python_can_read_the_file_that_refuses_it(name: str) -> None:
    assert ast.parse((TOOLS / name).read_text(encoding="utf-8"), feature_version=(3, 7))


@pytest.mark.parametrize("name", ["dev.py", "bootstrap.py"])
def test_only_the_standard_library_is_imported(name: str) -> None:
    tree = ast.parse((TOOLS / name).read_text(encoding="utf-8"))
    plain = {
        alias.name.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names
    }
    named = {str(node.module).split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert plain | named <= sys.stdlib_module_names | {"bootstrap"}


def test_a_system_without_posix_is_refused(bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bootstrap.os, "name", "nt")
    with pytest.raises(bootstrap.SetupFailed, match="WSL"):
        bootstrap.refuse_what_cannot_work()


@pytest.mark.parametrize(
    "listing",
    [
        "global.cert='a'\n:env:.cert='b'",
        ":env:.cert='b'\nglobal.cert='a'",
        "install.cert='b'\nglobal.cert='a'\nglobal.no-binary=':all:'\ndownload.cert='c'",
    ],
)
def test_the_stronger_setting_wins_in_any_order(bootstrap: ModuleType, listing: str) -> None:
    assert bootstrap.parse_settings(listing) == {"cert": "b"}


@pytest.mark.parametrize("text", ["", "{", "[]", '{"python": 1'])
def test_a_spoiled_stamp_counts_as_unfinished(bootstrap: ModuleType, tmp_path: Path, text: str) -> None:
    target = bootstrap.VirtualEnvironment(tmp_path)
    target.stamp.write_text(text, encoding="utf-8")
    assert bootstrap.read_stamp(target) == {}
