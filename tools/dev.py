"""Set the project up and work in it: `python3 tools/dev.py run FILE`, `test`, `lint`, `check`, `bench`, `docs`.

The first call makes `.venv` (`.venv-bench` for the benchmark and `.venv-docs` for the site, whose packages stay out of
it) and installs what the command needs; later calls find it there (tools/bootstrap.py). Nothing but Python 3.11 or
newer and its pip, or venv with ensurepip, is needed; set-up writes nothing outside these folders.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).resolve().parent))  # PYTHONSAFEPATH and -P leave it out

from bootstrap import BENCH, DOCS, ROOT, WORK, SetupFailed, set_up

if TYPE_CHECKING:
    from typing import NoReturn

LOCKS = {
    "run": ("run", "sync"),
    "test": ("run", "sync", "test"),
    "test --all": ("run", "sync", "test", "all"),
    "lint": ("run", "sync", "test"),
    "check": ("run", "sync", "test"),
    "sync": ("run", "sync"),
    "sync all": ("run", "sync", "test", "all"),
    "bench": ("run", "bench"),
    "docs": ("run", "docs"),
}
USAGE = """usage: python3 tools/dev.py COMMAND [ARGUMENTS]

  run [ARGUMENTS]    rubnoise run, with every argument passed on (try: run --help)
  test [ARGUMENTS]   the tests, with every argument passed on to pytest; test --all adds slow ones
  lint               ruff and mypy
  check NAME         a long guard, named below; arguments behind the name go to it
  sync [all]         only install, what pictures and tables need too; with all, everything that test --all needs
  bench [ARGUMENTS]  speed and errors beside everything else a user could pick; bench --quick takes a minute or two
  docs [FOLDER]      the site with all pages, the lesson and examples, into site/ or another folder
"""
GUARDS = {
    "times": ("check_times.py", "5 minutes: no everyday case is slow; --add lists those that are, --write all anew"),
    "faults": ("mutants.py", "2 hours: each of the faults put into a copy of the program is noticed"),
    "kills": ("survive.py", "minutes: after kills and on full disks nothing is lost"),
    "damage": ("fuzz_results.py", "10 minutes: damaged results get a sentence"),
    "bits": ("determinism.py", "10 minutes: equal bits on other processors, libraries, hash seeds and threads"),
    "paper": ("paper", "2 minutes: every claim of the paper and its field; with -o DIR its figures instead"),
    "right-runs": ("right_runs.py", "15 minutes: how many of some thousands of right runs `compare` rejects"),
}
"""The program of each guard, how long it takes on two cores, and what it asks."""


def main(arguments: list[str]) -> int:
    """Set up what the command needs, then become it; return an exit code only where that was not to be."""
    command, rest = (arguments[0], arguments[1:]) if arguments else ("", [])
    if command not in LOCKS or " " in command:
        asked = command in ("-h", "--help", "help")
        guards = "".join(f"  check {name:<12} {about}\n" for name, (_, about) in GUARDS.items())
        print(f"{USAGE}\n{guards}", end="", file=sys.stdout if asked else sys.stderr)
        return 0 if asked else 2
    signal.signal(signal.SIGTERM, _terminated)
    try:
        everything = next((word for word in ("all", "--all") if word in rest), None)
        set_up(LOCKS.get(f"{command} {everything}", LOCKS[command]), {"bench": BENCH, "docs": DOCS}.get(command, WORK))
        commands = {"run": run, "test": test, "lint": lint, "sync": sync, "check": check, "bench": bench, "docs": docs}
        return commands[command](rest)
    except SetupFailed as problem:
        print(f"dev.py: {problem}", file=sys.stderr)
        return 1
    except OSError as problem:
        print(f"dev.py: set-up failed: {problem}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("dev.py: interrupted; the same command starts again.", file=sys.stderr)
        return 130


def _terminated(number: int, _frame: object) -> NoReturn:
    raise SystemExit(128 + number)


def run(arguments: list[str]) -> NoReturn:
    """Become `rubnoise run`, so that signals and the exit code are its own."""
    os.execv(WORK.program, [str(WORK.program), "run", *arguments])


def test(arguments: list[str]) -> NoReturn:
    """Become pytest in the project's folder, with as many worker processes as tests/conftest.py says."""
    os.chdir(ROOT)
    # To compile every module in every process again takes longer than most tests.
    variables = {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    words = [str(WORK.python), "-m", "pytest", "--numprocesses=auto", "--dist=worksteal", *arguments]
    os.execve(WORK.python, words, variables)


def lint(arguments: list[str]) -> int:
    """Run every check, also after one that fails, and return 1 if any did."""
    if arguments:
        print("dev.py: lint takes no arguments", file=sys.stderr)
        return 2
    checks = (["ruff", "check"], ["ruff", "format", "--check"], ["mypy"])
    return max([min(1, subprocess.call([str(WORK.python), "-m", *check], cwd=ROOT)) for check in checks])


def check(arguments: list[str]) -> int:
    """Call the guard that is named."""
    if not arguments or arguments[0] not in GUARDS:
        print(f"dev.py: check takes one of these names: {', '.join(GUARDS)}", file=sys.stderr)
        return 2
    program, _ = GUARDS[arguments[0]]
    return subprocess.call([str(WORK.python), str(ROOT / "tools" / program), *arguments[1:]], cwd=ROOT)


def sync(arguments: list[str]) -> int:
    """Be content with what has been set up, so that `.venv/bin/rubnoise` can draw and export as well."""
    if arguments not in ([], ["all"]):
        print("dev.py: sync takes no arguments but all", file=sys.stderr)
        return 2
    return 0


def bench(arguments: list[str]) -> NoReturn:
    """Become the benchmark, which finds itself in tools and the references it is judged by in tests."""
    path = os.pathsep.join((str(ROOT / "tools"), str(ROOT)))
    variables = {**os.environ, "PYTHONPATH": path}
    os.execve(BENCH.python, [str(BENCH.python), "-m", "bench", *arguments], variables)


def docs(arguments: list[str]) -> NoReturn:
    """Become the builder of the site."""
    os.execv(DOCS.python, [str(DOCS.python), str(ROOT / "tools" / "build_site.py"), *arguments])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
