"""Make an environment what the locks beside this file ask for: what tools/dev.py does before anything else.

Standard library only; it parses with Python 3.7, so that an old Python gets a sentence and not a traceback.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

ROOT = Path(__file__).resolve().parent.parent


class VirtualEnvironment(NamedTuple):
    """A virtual environment of the project's, by its folder."""

    folder: Path

    @property
    def stamp(self) -> Path:
        """The file that says what has been installed here."""
        return self.folder / "rubnoise-setup.json"

    @property
    def python(self) -> Path:
        """The interpreter."""
        return self.folder / "bin" / "python"

    @property
    def program(self) -> Path:
        """The command `rubnoise`."""
        return self.folder / "bin" / "rubnoise"


WORK = VirtualEnvironment(ROOT / ".venv")
BENCH = VirtualEnvironment(ROOT / ".venv-bench")
"""The benchmark's peers bring packages of their own, which the environment of run and tests stays free of."""
DOCS = VirtualEnvironment(ROOT / ".venv-docs")
"""The site's builder likewise."""

# How an index is reached is the user's business, and the hashes make any index as good as another. Everything else in
# pip's configuration (a target folder, --user, constraints, building from source) would change what is installed, or
# where.
CONNECTION_SETTINGS = frozenset(
    {
        "cache-dir",
        "cert",
        "client-cert",
        "default-timeout",
        "extra-index-url",
        "find-links",
        "index-url",
        "keyring-provider",
        "no-index",
        "proxy",
        "retries",
        "timeout",
        "trusted-host",
    }
)


class SetupFailed(Exception):  # noqa: N818  (a message for a person, printed as it is)
    """Set-up cannot go on; the message says why and what to do."""


def set_up(locks: tuple[str, ...], target: VirtualEnvironment = WORK) -> None:
    """Bring an environment to what the locks ask for; do nothing where its stamp says that it is so."""
    refuse_what_cannot_work()
    wanted = wanted_stamp(locks)
    if is_current(target, read_stamp(target), wanted):
        return
    with only_one_at_a_time() as lock_file:
        stamp = read_stamp(target)
        if is_current(target, stamp, wanted):
            return
        if has_to_be_made(target, stamp, wanted):
            make_environment(target, lock_file)
        install(target, locks, lock_file)
        write_stamp(target, wanted)


def refuse_what_cannot_work() -> None:
    """Refuse a Python that is too old and a system without POSIX file locks."""
    if sys.version_info < (3, 11):  # noqa: UP036  (this file is called with whatever python3 is)
        version = ".".join(map(str, sys.version_info[:3]))
        raise SetupFailed(
            f"Python 3.11 or newer is needed, and {sys.executable} is Python {version}."
            " Where a newer one is installed, name it: python3.12 tools/dev.py ..."
        )
    if os.name != "posix":
        raise SetupFailed("Linux and macOS are supported; on Windows, please use WSL.")


def wanted_stamp(locks: tuple[str, ...]) -> dict[str, str]:
    """Return what an environment depends on: the interpreter, its folder, the project's metadata, the locks."""
    stamp = {
        "python": f"{sys.version} at {os.path.realpath(sys.executable)}",
        "folder": str(ROOT),
        "project": _digest(ROOT / "pyproject.toml"),
    }
    return {**stamp, **{f"{lock}.lock": _digest(ROOT / "tools" / f"{lock}.lock") for lock in locks}}


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def read_stamp(target: VirtualEnvironment) -> dict[str, str] | None:
    """Return what was installed here: empty where that was stopped half-way, None where something else made it."""
    try:
        stamp = json.loads(target.stamp.read_text(encoding="utf-8"))
    except OSError:
        return None
    except ValueError:
        return {}
    return stamp if isinstance(stamp, dict) else {}


def write_stamp(target: VirtualEnvironment, stamp: Mapping[str, str]) -> None:
    """Write the stamp in one step, so that it is the old one or the new one whenever the machine stops."""
    partial = target.stamp.with_suffix(".part")
    partial.write_text(json.dumps(stamp, indent=1), encoding="utf-8")
    partial.replace(target.stamp)


def is_current(target: VirtualEnvironment, stamp: Mapping[str, str] | None, wanted: Mapping[str, str]) -> bool:
    """Return whether everything wanted is installed; more than that (the tests' lock too) will do."""
    if not (stamp and target.python.exists() and target.program.exists()):
        return False
    return all(stamp.get(key) == value for key, value in wanted.items())


def has_to_be_made(target: VirtualEnvironment, stamp: Mapping[str, str] | None, wanted: Mapping[str, str]) -> bool:
    """Return whether to start from nothing: half-made, moved, of another Python, or no environment at all."""
    version = version_of(target)
    if stamp is None and version not in (None, sys.version):
        raise SetupFailed(
            f"{target.folder} was made by something else, with Python {str(version).split()[0]}."
            " Move it away, then call this again."
        )
    if stamp is None:
        return version is None
    return version is None or any(stamp.get(key) != wanted[key] for key in ("python", "folder"))


def version_of(target: VirtualEnvironment) -> str | None:
    """Return the version of the Python in an environment, or None where none starts."""
    try:
        asked = [str(target.python), "-c", "import sys; sys.stdout.write(sys.version)"]
        return subprocess.run(asked, env=environment({}), capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None


@contextlib.contextmanager
def only_one_at_a_time() -> Iterator[int]:
    """Hold a kernel lock on the project's folder; pip inherits it, so that one outliving a kill is waited for too."""
    import fcntl

    folder = os.open(ROOT, os.O_RDONLY)
    try:
        try:
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("dev.py: another set-up is at work here; waiting for it.", file=sys.stderr)
            fcntl.flock(folder, fcntl.LOCK_EX)
        yield folder
    finally:
        os.close(folder)


def make_environment(target: VirtualEnvironment, lock_file: int) -> None:
    """Make an environment from nothing, with a pip of its own where this Python can do that."""
    if not (has_ensurepip() or find_spec("pip")):
        raise SetupFailed(f"{sys.executable} has neither pip nor ensurepip. Debian and Ubuntu: apt install python3-pip")
    if Path(sys.prefix).resolve() == target.folder.resolve():
        raise SetupFailed(
            f"{target.folder} has to be made anew, and not by its own Python. Call this with another python3."
        )
    print(f"dev.py: making {target.folder}", file=sys.stderr)
    if target.folder.is_symlink() or target.folder.is_file():
        target.folder.unlink()
    elif target.folder.exists():
        shutil.rmtree(target.folder)
    target.folder.mkdir()
    write_stamp(target, {})
    options = [] if has_ensurepip() else ["--without-pip"]
    if call([sys.executable, "-m", "venv", *options, str(target.folder)], {}, lock_file):
        raise SetupFailed("Python could not make a virtual environment (its message is above).")


def has_ensurepip() -> bool:
    """Return whether venv can put a pip into a new environment (Debian keeps that in a package of its own)."""
    return find_spec("ensurepip") is not None


def install(target: VirtualEnvironment, locks: tuple[str, ...], lock_file: int) -> None:
    """Install the locked packages, then the project itself as a link to src."""
    pip = pip_command(target)
    settings = connection_settings(pip)
    write_stamp(target, {})
    files = [f"tools/{lock}.lock" for lock in locks]
    print(f"dev.py: installing {' and '.join(files)} (the first time fetches some hundred MB)", file=sys.stderr)
    # On a terminal pip says which file it fetches, and how far it is.
    options = ["install", *([] if sys.stderr.isatty() else ["--quiet"]), "--no-deps", "--no-compile"]
    locked = ["--require-hashes", "--only-binary=:all:", *(f"--requirement={ROOT / file}" for file in files)]
    project = ["--no-index", "--no-build-isolation", f"--editable={ROOT}"]
    if call([*pip, *options, *locked], settings, lock_file) or call([*pip, *options, *project], settings, lock_file):
        raise SetupFailed(
            "installing failed (pip's message is above). Set-up needs the network once, for the package index that pip"
            " uses. The same command starts again."
        )


def pip_command(target: VirtualEnvironment) -> list[str]:
    """Return how pip is called for an environment: its own, or this Python's."""
    if (target.folder / "bin" / "pip").exists():
        return [str(target.python), "-m", "pip"]
    return [sys.executable, "-m", "pip", "--python", str(target.python)]


def connection_settings(pip: list[str]) -> dict[str, str]:
    """Return the variables that make pip ignore its configuration but for how the index is reached."""
    listing = subprocess.run([*pip, "config", "list"], env=environment({}), capture_output=True, text=True, check=False)
    found = parse_settings(listing.stdout)
    settings = {f"PIP_{name.upper().replace('-', '_')}": value for name, value in found.items()}
    return {**settings, "PIP_CONFIG_FILE": os.devnull, "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_NO_INPUT": "1"}


def parse_settings(listing: str) -> dict[str, str]:
    """Return the connection settings in a `pip config list`; variables beat files, [install] beats [global]."""
    strength = {"global": 0, "install": 1, ":env:": 2}
    found = re.findall(r"^(global|install|:env:)\.([\w-]+)=(.*)$", listing, re.MULTILINE)
    ranked = sorted(found, key=lambda setting: strength[setting[0]])
    return {name: ast.literal_eval(value) for _, name, value in ranked if name in CONNECTION_SETTINGS}


def environment(settings: Mapping[str, str]) -> dict[str, str]:
    """Return this process's variables without Python's own, and with the given settings in place of all of pip's."""
    dropped = ("PYTHON", "__PYVENV", "PIP_") if settings else ("PYTHON", "__PYVENV")
    return {**{key: value for key, value in os.environ.items() if not key.startswith(dropped)}, **settings}


def call(command: list[str], settings: Mapping[str, str], lock_file: int) -> int:
    """Run a command to its end, in a process group of its own that is ended with this process; it writes to stderr."""
    # A signal during Popen would end this process before it knows the child's process id, so the child would stay.
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        child = subprocess.Popen(
            command,
            env=environment(settings),
            stdin=subprocess.DEVNULL,
            stdout=sys.stderr,
            process_group=0,
            pass_fds=[lock_file],
            preexec_fn=lambda: signal.pthread_sigmask(signal.SIG_SETMASK, before),  # noqa: PLW1509  (one thread)
        )
        try:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            return child.wait()
        except BaseException:
            end(child)
            raise
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end(child: subprocess.Popen[bytes]) -> None:
    """Let a child and its children clear up for some seconds, then kill what is left of them."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.pid, signal.SIGINT)
    try:
        child.wait(timeout=5)
    except subprocess.TimeoutExpired:
        print("dev.py: pip does not stop by itself; ending it.", file=sys.stderr)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(child.pid, signal.SIGKILL)
        child.wait()
