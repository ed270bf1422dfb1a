"""The output of `rubnoise --version`: the version and, for a checkout or a package made from a commit, that commit."""

import json
import subprocess
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Final

import rubnoise

PACKAGE: Final = Path(rubnoise.__file__).parent
SHOWN_DIGITS: Final = 12


def version_line() -> str:
    """Return the name of the program with its version, and with its commit if that is known."""
    commit = commit_of_checkout(PACKAGE) or _commit_of_package()
    return f"rubnoise {rubnoise.__version__}" + (f" (commit {commit[:SHOWN_DIGITS]})" if commit else "")


def commit_of_checkout(package: Path) -> str:
    """Return the commit of the checkout that a package is in, as git says; "" if it is in none of this project."""
    root = package.parent.parent
    if package.parent.name != "src" or not (root / "pyproject.toml").is_file():
        return ""
    try:
        words = ["git", "-C", str(root), "rev-parse", "HEAD"]
        found = subprocess.run(words, capture_output=True, text=True, check=True)  # noqa: S603  (words of our own)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return found.stdout.strip()


def _commit_of_package() -> str:
    """Return the commit from which pip installed the package, which pip records for a repository."""
    try:
        origin = json.loads(distribution("rubnoise").read_text("direct_url.json") or "{}")
    except (PackageNotFoundError, OSError, ValueError):
        return ""
    return str(origin.get("vcs_info", {}).get("commit_id", ""))
