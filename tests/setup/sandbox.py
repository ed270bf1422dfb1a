"""A project folder with the real tools/dev.py in it and a pip that needs no network."""

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

TOOLS = Path(__file__).resolve().parents[2] / "tools"

DRIVER = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job starts with it ignored
sys.path.insert(0, {tools!r})
import bootstrap, dev
bootstrap.find_spec = lambda name: name in {found!r} or None
bootstrap.pip_command = lambda target: [sys.executable, {pip!r}, str(target.folder)]
{more}
sys.exit(dev.main(sys.argv[1:]))
"""

# It notes how it was called, does what FAKE_PIP asks for, and "installs" a rubnoise that shows its arguments.
PIP = """
import json, os, signal, sys, time
from pathlib import Path
here, target = Path(__file__).parent, Path(sys.argv.pop(1))
if sys.argv[1] == "config":
    print(os.environ.get("FAKE_CONFIG", ""))
    sys.exit()
settings = {key: value for key, value in os.environ.items() if key.startswith(("PIP_", "PYTHON"))}
call = {"arguments": sys.argv[1:], "settings": settings}
with open(here / "calls.jsonl", "a") as log:
    log.write(json.dumps(call) + "\\n")
order = (here / "order").read_text() if (here / "order").exists() else ""
if order == "fail":
    sys.exit("no route to the index")
if order in ("wait", "stay"):
    if order == "stay":
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    (here / "waiting").write_text(str(os.getpid()))
    time.sleep(60)
if "--require-hashes" not in sys.argv:
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
    """A project in `folder`; `found` says which of pip and ensurepip this Python has, `more` is run before dev.py."""

    folder: Path
    found: tuple[str, ...] = ("pip",)
    variables: dict[str, str] = field(default_factory=dict)
    more: str = ""

    @property
    def venv(self) -> Path:
        return self.folder / ".venv"

    def fill(self) -> None:
        """Put the tools, the locks, metadata and the network-free pip into the folder."""
        (self.folder / "tools").mkdir(parents=True)
        for name in ("dev.py", "bootstrap.py"):
            shutil.copy(TOOLS / name, self.folder / "tools")
        for name in (
            "tools/run.lock",
            "tools/sync.lock",
            "tools/test.lock",
            "tools/all.lock",
            "tools/bench.lock",
            "pyproject.toml",
        ):
            (self.folder / name).write_text(f"# {name}\n", encoding="utf-8")
        (self.folder / "pip.py").write_text(f"PROGRAM = {PROGRAM!r}\n{PIP}", encoding="utf-8")

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        """Start dev.py with its output caught."""
        tools, pip = str(self.folder / "tools"), str(self.folder / "pip.py")
        driver = DRIVER.format(tools=tools, pip=pip, found=self.found, more=self.more)
        return subprocess.Popen(
            [sys.executable, "-c", driver, *arguments],
            env={**os.environ, **self.variables},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def dev(self, *arguments: str) -> tuple[int, str, str]:
        """Return exit code, standard output and standard error of dev.py."""
        with self.start(*arguments) as process:
            output, error = process.communicate(timeout=60)
            return process.returncode, output, error

    def order(self, behaviour: str) -> None:
        """Set how pip behaves from now on: fail, wait, stay (wait and ignore Ctrl-C), or (empty) work."""
        (self.folder / "order").write_text(behaviour, encoding="utf-8")

    def pip_calls(self) -> list[dict[str, list[str] | dict[str, str]]]:
        """Return what pip was called with, oldest first."""
        log = self.folder / "calls.jsonl"
        return [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()] if log.exists() else []

    def stamp(self) -> dict[str, str] | None:
        """Return the stamp of `.venv`, if it has one."""
        path = self.venv / "rubnoise-setup.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
