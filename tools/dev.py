"""Set the project up and work in it: `python3 tools/dev.py run FILE`, `test`, `lint`, `check`, `bench`, `docs`.

The first call makes `.venv` (`.venv-bench`, `.venv-docs`) and installs what the command needs, in the versions of
tools/constraints.txt. Nothing but Python 3.11 and pip is needed, and nothing is written outside these folders.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
USAGE = """usage: python3 tools/dev.py COMMAND [ARGUMENTS]

  run [ARGUMENTS]    rubnoise run, with every argument passed on (try: run --help)
  test [ARGUMENTS]   the tests, with every argument passed on to pytest; test --all adds slow ones
  lint               ruff and mypy
  check NAME         a long guard, named below; arguments behind the name go to it
  generate [NAME]    every generated and frozen file, or those of one name; generate --help tells them
  sync [all]         only install, what pictures and tables need too; with all, everything that test --all needs
  bench [ARGUMENTS]  speed and errors beside what a user could pick; bench --quick takes a minute or two
  docs [FOLDER]      the site with all pages, the lesson and examples, into site/ or another folder

"""
GROUPS = {
    **dict.fromkeys(("run", "sync"), ("build", "sync")),
    **dict.fromkeys(("test", "lint", "check"), ("build", "sync", "test")),
    "generate": ("build", "sync", "test", "all"),
    "bench": ("build", "bench"),
    "docs": ("build", "docs"),
}
"""The groups of dependencies in pyproject.toml that each command needs beside what rubnoise itself needs."""
GUARDS = {
    "times": ("check_times.py", "5 minutes: no everyday case is slow; with --all, an hour: no slow one is fast"),
    "faults": ("mutants.py", "2 hours: each of the faults put into a copy of the program is noticed"),
    "kills": ("survive.py", "minutes: after kills and on full disks nothing is lost"),
    "damage": ("fuzz_results.py", "10 minutes: damaged results get a sentence"),
    "bits": ("determinism.py", "5 minutes: golden runs on other processors, hash seeds and threads"),
    "paper": ("paper", "2 minutes: every claim of the paper and its field; with -o DIR its figures instead"),
    "right-runs": ("right_runs.py", "15 minutes: how many of some thousands of right runs `compare` rejects"),
}
"""The program of each guard, how long it takes on two cores, and what it asks."""


def main(arguments: list[str]) -> int:
    """Set up what the command needs, then become it; return an exit code only where that was not to be."""
    command, rest = (arguments[0], arguments[1:]) if arguments else ("", [])
    if command not in GROUPS:
        asked = command in ("-h", "--help", "help")
        guards = "".join(f"  check {name:<12} {about}\n" for name, (_, about) in GUARDS.items())
        print(f"{USAGE}{guards}", end="", file=sys.stdout if asked else sys.stderr)
        return 0 if asked else 2
    if command == "check" and (not rest or rest[0] not in GUARDS):
        raise SystemExit(f"dev.py: check takes one of these names: {', '.join(GUARDS)}")
    everything = (command, *rest) == ("sync", "all") or (command == "test" and "--all" in rest)
    folder = ROOT / {"bench": ".venv-bench", "docs": ".venv-docs"}.get(command, ".venv")
    set_up(folder, {*GROUPS["generate" if everything else command]})
    python, tools = str(folder / "bin" / "python"), ROOT / "tools"
    if command == "lint":
        checks = (("ruff", "check"), ("ruff", "format", "--check"), ("mypy",))
        return min(1, sum(subprocess.call([python, "-m", *check], cwd=ROOT) for check in checks))
    if command == "check":
        return subprocess.call([python, str(tools / GUARDS[rest[0]][0]), *rest[1:]], cwd=ROOT)
    if command == "test":
        os.chdir(ROOT)
        # To compile every module in every process again takes longer than most tests.
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    if command == "bench":
        os.environ["PYTHONPATH"] = os.pathsep.join((str(tools), str(ROOT)))
    programs = {
        "run": [str(folder / "bin" / "rubnoise"), "run"],
        "test": [python, "-m", "pytest", "--numprocesses=auto", "--dist=worksteal"],
        "bench": [python, "-m", "bench"],
        "docs": [python, str(tools / "build_site.py")],
        "generate": [python, str(tools / "generate.py")],
    }
    if command in programs:  # become it, so that signals and the exit code are its own
        os.execv(programs[command][0], [*programs[command], *rest])
    return 0


def set_up(folder: Path, groups: set[str]) -> None:
    """Make an environment and install what the groups ask for; do nothing where its stamp says that it is so."""
    if sys.version_info < (3, 11):  # noqa: UP036  (this file is called with whatever python3 is)
        raise SystemExit(f"dev.py: Python 3.11 or newer is needed, and {sys.executable} is {sys.version.split()[0]}.")
    if os.name != "posix":
        raise SystemExit("dev.py: Linux and macOS are supported; on Windows, please use WSL.")
    import fcntl

    lock, stamp = os.open(ROOT, os.O_RDONLY), folder / "rubnoise-setup.json"
    os.set_inheritable(lock, True)  # noqa: FBT003  (pip holds it, too: one that outlives a kill is waited for)
    fcntl.flock(lock, fcntl.LOCK_EX)
    files = [(ROOT / name).read_text(encoding="utf-8") for name in ("pyproject.toml", "tools/constraints.txt")]
    wanted = [hashlib.sha256("".join(each).encode()).hexdigest() for each in ([sys.version, str(ROOT)], files)]
    known = re.findall(r"\w+", stamp.read_text(encoding="utf-8")) if stamp.exists() else []
    there = known[:1] == wanted[:1] and (folder / "bin" / "python").exists()
    if not (there and known[:2] == wanted and groups <= set(known[2:])):
        if folder.exists() and not stamp.exists():
            raise SystemExit(f"dev.py: {folder} was made by something else. Move it away, then call this again.")
        if not there:
            make(folder, stamp)
        stamp.write_text(json.dumps(wanted[:1]), encoding="utf-8")
        install(folder, groups)
        stamp.write_text(json.dumps([*wanted, *groups.union(known[2:] if there else ())]), encoding="utf-8")
    os.close(lock)


def make(folder: Path, stamp: Path) -> None:
    """Make an environment from nothing, with a pip of its own where this Python can do that."""
    if not (find_spec("ensurepip") or find_spec("pip")):
        raise SystemExit(f"dev.py: {sys.executable} has no pip. Debian and Ubuntu: apt install python3-pip")
    print(f"dev.py: making {folder}", file=sys.stderr)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    stamp.touch()
    options = () if find_spec("ensurepip") else ("--without-pip",)
    subprocess.run([sys.executable, "-m", "venv", *options, str(folder)], stdout=sys.stderr, check=True)


def install(folder: Path, groups: set[str]) -> None:
    """Install the packages of some groups in the versions of the constraints, then the project as a link to src."""
    import tomllib

    print("dev.py: installing packages (the first time fetches some hundred MB)", file=sys.stderr)
    about = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = {*about["project"]["dependencies"]}.union(*(about["dependency-groups"][group] for group in groups))
    python, own = str(folder / "bin" / "python"), (folder / "bin" / "pip").exists()
    pip = [python, "-m", "pip"] if own else [sys.executable, "-m", "pip", "--python", python]
    # How an index is reached is the user's business; what is installed, and where, is not. The path is relative, since
    # pip takes a blank in this variable for the end of a name.
    dropped = ("PYTHON", "__PYVENV", "PIP_USER", "PIP_TARGET", "PIP_PREFIX")
    variables = {name: text for name, text in os.environ.items() if not name.startswith(dropped)}
    variables |= {"PIP_CONSTRAINT": "tools/constraints.txt", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_USER": "0"}
    project = ["--no-deps", "--no-index", "--no-build-isolation", "--editable=."]
    for words in (["--no-compile", "--only-binary=:all:", *sorted(wanted)], project):
        command = [*pip, "install", *([] if sys.stderr.isatty() else ["--quiet"]), *words]
        if subprocess.run(command, cwd=ROOT, env=variables, stdout=sys.stderr, close_fds=False, check=False).returncode:
            raise SystemExit("dev.py: installing failed (see above). It needs the network once; call this again.")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
