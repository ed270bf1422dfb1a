"""Build the site: `python3 tools/dev.py docs [FOLDER]`, into site/ by default.

Pages are copied into a new folder as they lie in the repository, so that their links keep their meaning. Pages that
show output are written here from today's program: the lesson, a viewer, a sound, the help of commands. Sphinx
then builds all of it, and any warning fails. The folder gets its name only when the site is complete.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import rubnoise

ROOT: Final = Path(__file__).resolve().parent.parent
PAGES: Final = ROOT / "tools" / "site"
COPIED: Final = ("docs", "notebooks", "scenarios")
MARK: Final = "rubnoise-site.txt"
FIG5: Final = "scenarios/paper/fig5.toml"
RUN: Final = ["run", FIG5, "-o", "fig5.h5"]
SOUND: Final = ["listen", "fig5.h5", "-o", "site/fig5.wav", "--speed-up", "10"]
LESSON: Final = ["page", "-o", "site/lesson.html"]
NESTED: Final = {
    "docs/start": ("install", "lesson", "viewer", "docs/gallery"),
    "docs/command-line": ("commands", "docs/sweeps", "docs/json"),
    "docs/api": ("python", "notebooks/README"),
    "docs/scenarios": ("scenarios",),
    "docs/theory": ("docs/two-way", "docs/family", "docs/load", "docs/surfaces"),
    "docs/comparing": ("docs/paper", "docs/field"),
    "CONTRIBUTING": ("docs/design", "docs/reproducibility", "docs/performance", "docs/survival"),
    "CHANGELOG": ("SUPPORT", "SECURITY", "CODE_OF_CONDUCT"),
}
"""The pages that the sidebar shows below another one, when a reader is there."""
DRAWN: Final = re.compile(r"!\[([^\]]+)\]\((\S*pictures/drawn/\w+)\.svg\)")
VIEWER: Final = ["page", "fig5.h5", "--to", "1mm", "-o", "site/view.html"]


def main(arguments: list[str]) -> int:
    """Build everything in a new folder, and put it in the place of an older site."""
    parser = argparse.ArgumentParser(prog="dev.py docs", description="Build the site.")
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "site")
    folder = parser.parse_args(arguments).folder.resolve()
    if folder.exists() and not (folder / MARK).exists():
        print(f"build_site: {folder} is not a site; move it away or name another folder", file=sys.stderr)
        return 2
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".site-") as made:
        source, built = Path(made) / "source", Path(made) / "built"
        stage(source)
        sphinx = [sys.executable, "-m", "sphinx", "--fail-on-warning", "--keep-going", "--quiet", "--builder=html"]
        if subprocess.call([*sphinx, f"--conf-dir={source}", str(source), str(built)]):
            return 1
        shutil.rmtree(built / ".doctrees", ignore_errors=True)
        shutil.copytree(source / "site", built / "site")
        (built / MARK).write_text(f"rubnoise {rubnoise.__version__}\n", encoding="utf-8")
        shutil.rmtree(folder, ignore_errors=True)
        built.rename(folder)
    print(f"build_site: {folder / 'index.html'}")
    return 0


def stage(source: Path) -> None:
    """Put every page where Sphinx reads it."""
    source.mkdir()
    for name in COPIED:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__", "*.h5", "scans"))
    for path in [
        *(page for page in ROOT.glob("*.md") if page.name != "README.md"),
        ROOT / "LICENSE",
        ROOT / "CITATION.cff",
        *PAGES.iterdir(),
    ]:
        if path.is_file():
            shutil.copy(path, source)
    (source / "site").mkdir()
    for command in (RUN, SOUND, LESSON, VIEWER):
        answer(source, command)
    (source / "fig5.h5").unlink()
    written = {"commands": commands, "scenarios": scenarios, "python": python}
    for name, page in written.items():
        (source / f"{name}.md").write_text("\n".join(page(source)) + "\n", encoding="utf-8")
    for path in source.rglob("*.md"):
        name = path.relative_to(source).with_suffix("").as_posix()
        path.write_text(adapted(path.read_text(encoding="utf-8")) + below(name), encoding="utf-8")


def answer(folder: Path, words: list[str]) -> str:
    """Return what a command prints; raises CalledProcessError where it fails."""
    variables = {**os.environ, "COLUMNS": "90", "NO_COLOR": "1", "TERM": "dumb"}
    command = [sys.executable, "-m", "rubnoise", *words]
    done = subprocess.run(command, cwd=folder, env=variables, stdout=subprocess.PIPE, text=True, check=True)
    return "\n".join(line.rstrip() for line in done.stdout.splitlines()).strip("\n") + "\n"


def adapted(page: str) -> str:
    """Return a page with links to pages for folders, and drawings for light and dark."""
    page = page.replace("](notebooks)", "](notebooks/README.md)").replace("](scenarios)", "](scenarios.md)")
    page = page.replace("](../scenarios)", "](../scenarios.md)")
    return DRAWN.sub(r"![\1](\2.svg){.only-light} ![\1](\2-dark.svg){.only-dark}", page)


def below(name: str) -> str:
    """Return the list of pages that the sidebar shows below a page; empty without any."""
    pages = "\n".join(f"/{page}" for page in NESTED.get(name, ()))
    return f"\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n" if pages else ""


def commands(source: Path) -> Iterator[str]:
    """Yield the page with the help of every command."""
    yield "# Commands\n"
    yield "This is the text of `--help` for each command. [command-line.md](docs/command-line.md) explains them.\n"
    help_text = answer(source, ["--help"])
    yield f"```\n{help_text}```\n"
    for name in re.findall(r"^  (\w+) {2,}", help_text.partition("Begin and run")[2], re.MULTILINE):
        yield f"## {name}\n\n```\n{answer(source, [name, '--help'])}```\n"


def scenarios(source: Path) -> Iterator[str]:
    """Yield the page of all scenario files with their titles."""
    yield "# Scenarios that come with rubnoise\n"
    yield f"[scenarios.md](docs/scenarios.md) explains their keys.\n\n```\n{answer(source, ['examples'])}```\n"


def python(_source: Path) -> Iterator[str]:
    """Yield the page of the public names with their docstrings."""
    yield "# Python reference\n"
    yield "These are all public names. [api.md](docs/api.md) shows how to use them.\n"
    for name in sorted(rubnoise.__all__):
        kind = "autoclass" if isinstance(getattr(rubnoise, name), type) else "autofunction"
        if name.startswith("__"):
            continue
        members = "\n   :members:" if kind == "autoclass" else ""
        yield f"```{{eval-rst}}\n.. {kind}:: rubnoise.{name}{members}\n```\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
