"""Resolve the dependencies of pyproject.toml into tools/*.lock.

`python3 tools/relock.py [run|sync|test|all|bench|docs ...] [--upgrade]`, with uv on the PATH; without names, all six.
They hold for every supported Python and platform, name neither an index nor a path, and carry the hashes of the files
on the public index. All but the run's hold only what is needed on top of a run, the tests' on top of sync,
those of slow tests on top of these.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from bootstrap import ROOT
from dev import LOCKS

COMPILE = ["uv", "pip", "compile", "pyproject.toml", "--no-config", "--default-index=https://pypi.org/simple"]
BELOW = {locks[-1]: locks[:-1] for locks in LOCKS.values()}
"""Each lock with those on top of which it is installed."""
FOR_EVERYONE = ["--universal", "--python-version=3.11", "--generate-hashes", "--quiet"]


def main(arguments: list[str]) -> int:
    """Write the locks asked for, the run's first, because it constrains the others."""
    if not shutil.which("uv"):
        print("relock.py: uv is needed on the PATH (https://docs.astral.sh/uv/)", file=sys.stderr)
        return 1
    options = [word for word in arguments if word not in BELOW]
    asked = [lock for lock in BELOW if lock in arguments] or BELOW
    for lock in sorted(asked, key=lambda lock: len(BELOW[lock])):
        group = "build" if lock == "run" else lock
        if failed := resolve(lock, [f"--group={group}", *on_top_of(BELOW[lock]), *options]):
            return failed
    return 0


def on_top_of(locks: tuple[str, ...]) -> list[str]:
    """Return options that leave out what other locks hold, and keep to their versions."""
    held = sorted({name for lock in locks for name in names(ROOT / "tools" / f"{lock}.lock")})
    constraints = [f"--constraints=tools/{lock}.lock" for lock in locks]
    return [*constraints, *(f"--no-emit-package={name}" for name in held)]


def names(lock: Path) -> list[str]:
    """Return the names of the packages in a lock, each once."""
    return sorted(set(re.findall(r"^([\w.-]+)==", lock.read_text(encoding="utf-8"), re.MULTILINE)))


def resolve(name: str, options: list[str]) -> int:
    """Write one lock from the public index alone, whatever this machine is configured to use."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PIP_", "UV_"))}
    told = ["--custom-compile-command=python3 tools/relock.py", f"--output-file=tools/{name}.lock"]
    return subprocess.call(
        [*COMPILE, *FOR_EVERYONE, *told, *options], cwd=ROOT, env=environment, stdout=subprocess.DEVNULL
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
