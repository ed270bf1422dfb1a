"""`rubnoise --version` names the commit of a checkout, however git keeps it, and starts no git for it."""

import json
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

import rubnoise
from rubnoise.cli import version
from rubnoise.cli.version import commit_of_checkout, version_line
from tests.architecture.sources import ROOT
from tests.cli.terminal import call

ONE, OTHER = "1" * 40, "2a" * 32


def checkout(folder: Path, files: dict[str, str]) -> Path:
    """Make a checkout with some of git's own files, and return the package in it."""
    package = folder / "src" / "rubnoise"
    package.mkdir(parents=True)
    (folder / "pyproject.toml").touch()
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return package


@pytest.mark.parametrize(
    ("files", "commit"),
    [
        ({".git/HEAD": f"{ONE}\n"}, ONE),
        ({".git/HEAD": "ref: refs/heads/main\n", ".git/refs/heads/main": f"{OTHER}\n"}, OTHER),
        (
            {
                ".git/HEAD": "ref: refs/heads/a/b\n",
                ".git/packed-refs": f"# pack-refs with: peeled\n{OTHER} refs/heads/a\n{ONE} refs/heads/a/b\n^{OTHER}\n",
            },
            ONE,
        ),
        (
            {
                ".git": "gitdir: elsewhere/.git/worktrees/this\n",
                "elsewhere/.git/worktrees/this/HEAD": "ref: refs/heads/this\n",
                "elsewhere/.git/worktrees/this/commondir": "../..\n",
                "elsewhere/.git/refs/heads/this": f"{ONE}\n",
            },
            ONE,
        ),
        ({".git/HEAD": "ref: refs/heads/unborn\n"}, ""),
        ({".git/HEAD": "\x1b[2J\n"}, ""),
        ({}, ""),
    ],
    ids=["detached", "branch", "packed", "worktree", "unborn", "nonsense", "no git"],
)
def test_the_commit_is_read_from_files_of_git(tmp_path: Path, files: dict[str, str], commit: str) -> None:
    assert commit_of_checkout(checkout(tmp_path, files)) == commit


def test_it_is_the_commit_that_git_names() -> None:
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("this is no checkout")
    git = ["git", "-C", str(ROOT), "rev-parse", "HEAD"]
    told = subprocess.run(git, capture_output=True, text=True, check=True).stdout.strip()
    assert commit_of_checkout(ROOT / "src" / "rubnoise") == told
    assert call("--version").out == f"rubnoise {rubnoise.__version__} (commit {told[:12]})\n"


def test_a_package_inside_another_checkout_takes_no_commit_from_it(tmp_path: Path) -> None:
    checkout(tmp_path, {".git/HEAD": f"{ONE}\n"})
    for place in ("lib/site-packages/rubnoise", ".venv/lib/python3.11/site-packages/rubnoise"):
        (tmp_path / place).mkdir(parents=True)
        assert commit_of_checkout(tmp_path / place) == ""


@pytest.mark.parametrize(
    ("origin", "shown"),
    [
        (json.dumps({"url": "x", "vcs_info": {"vcs": "git", "commit_id": ONE}}), f" (commit {ONE[:12]})"),
        (json.dumps({"url": "file:///x", "dir_info": {}}), ""),
        (None, ""),
        ("{", ""),
    ],
)
def test_a_package_that_pip_made_of_a_commit_names_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, origin: str | None, shown: str
) -> None:
    installed = SimpleNamespace(read_text=lambda name: origin if name == "direct_url.json" else None)
    monkeypatch.setattr(version, "distribution", lambda _name: installed)
    monkeypatch.setattr(version, "PACKAGE", tmp_path / "site-packages" / "rubnoise")
    assert version_line() == f"rubnoise {rubnoise.__version__}{shown}"
