"""What tools/dev.py promises, in a folder whose path has a space, with a pip that needs no network."""

import ast
import json
import os
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

TOOLS = Path(__file__).resolve().parents[2] / "tools"
PROJECT = """
[project]
dependencies = ["of-a-run"]
[dependency-groups]
build = ["to-build"]
sync = ["for-pictures"]
test = ["for-tests"]
all = ["for-slow-tests"]
bench = ["a-peer"]
docs = ["a-builder"]
"""
DRIVER = """
import sys
sys.path.insert(0, "tools")
import dev
dev.find_spec = lambda name: name in {found!r} or None
sys.exit(dev.main(sys.argv[1:]))
"""
# Its pip notes how it was called, does what `order` asks for, and "installs" a rubnoise that shows its arguments.
PIP = """
import json, os, sys
from pathlib import Path
target = Path(sys.argv[sys.argv.index("--python") + 1]).parent.parent
settings = {name: os.environ.get(name) for name in ("PIP_TARGET", "PIP_CONSTRAINT", "PIP_INDEX_URL")}
with open("calls.jsonl", "a") as log:
    log.write(json.dumps([sys.argv[1:], settings]) + "\\n")
order = Path("order").read_text() if Path("order").exists() else ""
if order == "fail":
    sys.exit("no route to the index")
if "--editable=." in sys.argv:
    program = target / "bin" / "rubnoise"
    program.write_text(PROGRAM)
    program.chmod(0o755)
"""
PROGRAM = """#!/bin/sh
printf '%s\\n' "$@"
case "$2" in
sleep) exec sleep 60 ;;
fail) exit 3 ;;
esac
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sandbox:
    """A project in `folder`; `found` says which of pip and ensurepip this Python has."""

    folder: Path
    found: tuple[str, ...] = ("pip",)

    @property
    def venv(self) -> Path:
        return self.folder / ".venv"

    def start(self, *arguments: str, **variables: str) -> subprocess.Popen[str]:
        """Start dev.py with its output caught; a folder `pip` beside it stands for the real one."""
        return subprocess.Popen(
            [sys.executable, "-c", DRIVER.format(found=self.found), *arguments],
            cwd=self.folder,
            env={**os.environ, **variables},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def dev(self, *arguments: str, **variables: str) -> tuple[int, str, str]:
        """Return exit code, standard output and standard error of dev.py."""
        with self.start(*arguments, **variables) as process:
            output, error = process.communicate(timeout=60)
            return process.returncode, output, error

    def calls(self) -> list[tuple[list[str], dict[str, str]]]:
        """Return words and settings that pip was called with, oldest first."""
        log = self.folder / "calls.jsonl"
        return [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()] if log.exists() else []

    def packages(self) -> set[str]:
        """Return what pip was last asked for before the project itself."""
        return {word for word in self.calls()[-2][0] if word[0] != "-" and "/" not in word} - {"install"}


@pytest.fixture
def sandbox(tmp_path: Path) -> Sandbox:
    folder = tmp_path / "rub noise"
    (folder / "tools").mkdir(parents=True)
    shutil.copy(TOOLS / "dev.py", folder / "tools")
    (folder / "pip").mkdir()
    (folder / "pip" / "__init__.py").touch()
    (folder / "pip" / "__main__.py").write_text(f"PROGRAM = {PROGRAM!r}\n{PIP}", encoding="utf-8")
    (folder / "pyproject.toml").write_text(PROJECT, encoding="utf-8")
    (folder / "tools" / "constraints.txt").touch()
    return Sandbox(folder=folder)


def test_arguments_reach_rubnoise_untouched_and_nothing_else_writes(sandbox: Sandbox) -> None:
    arguments = ["--help", "a b.toml", "--set", "run.seed=2", "", "$HOME", "--"]
    code, output, error = sandbox.dev("run", *arguments)
    assert (code, output.split("\n")[:-1]) == (0, ["run", *arguments])
    assert "installing packages" in error
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
    before = sandbox.calls()
    _, _, error = sandbox.dev("run")
    assert (sandbox.calls(), error) == (before, "")


@pytest.mark.parametrize(
    ("words", "more"),
    [
        (["run"], {"for-pictures"}),
        (["sync"], {"for-pictures"}),
        (["sync", "all"], {"for-pictures", "for-tests", "for-slow-tests"}),
        (["lint"], {"for-pictures", "for-tests"}),
    ],
)
def test_each_command_installs_what_it_needs_in_the_versions_of_the_constraints(
    sandbox: Sandbox, words: list[str], more: set[str]
) -> None:
    sandbox.dev(*words)
    assert sandbox.packages() == {"of-a-run", "to-build", *more}
    (first, settings), (project, _) = sandbox.calls()
    assert settings["PIP_CONSTRAINT"] == "tools/constraints.txt"
    assert "--only-binary=:all:" in first
    assert {"--editable=.", "--no-deps", "--no-build-isolation"} <= set(project)
    sandbox.dev("run")
    assert len(sandbox.calls()) == 2


def test_the_benchmark_has_an_environment_of_its_own(sandbox: Sandbox) -> None:
    bench = sandbox.folder / "tools" / "bench"
    bench.mkdir()
    (bench / "__main__.py").write_text("import sys\nprint(*sys.argv[1:], sep='|')\nsys.exit(1)\n", encoding="utf-8")
    code, output, _ = sandbox.dev("bench", "--quick", "--output", "a b")
    assert (code, output) == (1, "--quick|--output|a b\n")
    assert sandbox.packages() == {"of-a-run", "to-build", "a-peer"}
    assert (sandbox.folder / ".venv-bench").exists()
    assert not sandbox.venv.exists()


@pytest.mark.parametrize("name", ["tools/constraints.txt", "pyproject.toml"])
def test_what_has_changed_is_installed_into_what_is_there(sandbox: Sandbox, name: str) -> None:
    sandbox.dev("run")
    kept = sandbox.venv / "kept"
    kept.touch()
    with (sandbox.folder / name).open("a") as file:
        file.write("# changed\n")
    assert sandbox.dev("run")[0] == 0
    assert (len(sandbox.calls()), kept.exists()) == (4, True)


def test_a_failing_pip_is_explained_and_the_next_call_starts_again(sandbox: Sandbox) -> None:
    (sandbox.folder / "order").write_text("fail", encoding="utf-8")
    code, _, error = sandbox.dev("run")
    assert code == 1
    assert "needs the network once" in error
    assert "Traceback" not in error
    (sandbox.folder / "order").unlink()
    assert sandbox.dev("run")[:2] == (0, "run\n")


def test_an_environment_of_another_program_is_left_alone(sandbox: Sandbox) -> None:
    (sandbox.venv / "theirs").mkdir(parents=True)
    code, _, error = sandbox.dev("run")
    assert (code, (sandbox.venv / "theirs").exists()) == (1, True)
    assert "made by something else" in error


def test_pip_keeps_the_way_to_the_index_and_installs_nowhere_else(sandbox: Sandbox) -> None:
    assert sandbox.dev("run", PIP_TARGET="/x", PIP_CONSTRAINT="/y", PIP_INDEX_URL="https://mirror/simple")[0] == 0
    assert sandbox.calls()[0][1] == {
        "PIP_TARGET": None,
        "PIP_CONSTRAINT": "tools/constraints.txt",
        "PIP_INDEX_URL": "https://mirror/simple",
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
    assert sandbox.dev("check", "nonsense")[0] == 1
    assert not sandbox.venv.exists()


def test_an_old_python_reads_the_file_and_only_the_standard_library_is_imported() -> None:
    tree = ast.parse((TOOLS / "dev.py").read_text(encoding="utf-8"), feature_version=(3, 7))
    plain = {
        alias.name.split(".")[0] for each in ast.walk(tree) if isinstance(each, ast.Import) for alias in each.names
    }
    named = {str(each.module).split(".")[0] for each in ast.walk(tree) if isinstance(each, ast.ImportFrom)}
    assert plain | named <= sys.stdlib_module_names
