"""The output of `rubnoise --version`: the version and, for a checkout or a package made from a commit, that commit."""

import json
import re
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Final

import rubnoise

PACKAGE: Final = Path(rubnoise.__file__).parent
SHOWN_DIGITS: Final = 12
MOST_BYTES: Final = 1 << 22
_COMMIT: Final = re.compile(r"[0-9a-f]{40}(?:[0-9a-f]{24})?")


def version_line() -> str:
    """Return the name of the program with its version, and with its commit if that is known."""
    commit = commit_of_checkout(PACKAGE) or _commit_of_package()
    return f"rubnoise {rubnoise.__version__}" + (f" (commit {commit[:SHOWN_DIGITS]})" if commit else "")


def commit_of_checkout(package: Path) -> str:
    """Return the commit of the checkout that a package is in, "" if it is in no checkout of this project.

    git's own files are read: HEAD is a commit, or names a branch, whose commit is in a file of its own or among those
    packed into one. Changes that are not committed do not show.
    """
    root = package.parent.parent
    if package.parent.name != "src" or not (root / "pyproject.toml").is_file():
        return ""
    folder = root / ".git"
    if pointer := _text(folder).removeprefix("gitdir:").strip():  # of a further working tree, or of a submodule
        folder = root / pointer
    head = _text(folder / "HEAD").strip()
    if not head.startswith("ref:"):
        return _commit(head)
    branch = head.removeprefix("ref:").strip()
    shared = folder / (_text(folder / "commondir").strip() or ".")
    return _commit(_text(folder / branch)) or _commit(_text(shared / branch)) or _packed(shared, branch)


def _packed(folder: Path, branch: str) -> str:
    lines = (line.partition(" ") for line in _text(folder / "packed-refs").splitlines())
    return next((_commit(commit) for commit, _, name in lines if name == branch), "")


def _commit_of_package() -> str:
    """Return the commit from which pip installed the package, which pip records for a repository."""
    try:
        origin = json.loads(distribution("rubnoise").read_text("direct_url.json") or "{}")
    except (PackageNotFoundError, OSError, ValueError):
        return ""
    return _commit(str(origin.get("vcs_info", {}).get("commit_id", "")))


def _commit(text: str) -> str:
    found = _COMMIT.fullmatch(text.strip())
    return found[0] if found else ""


def _text(path: Path) -> str:
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            return file.read(MOST_BYTES)
    except OSError:
        return ""
