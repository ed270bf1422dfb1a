"""Build the source distribution and, from it, the wheel: `.venv/bin/python tools/build_package.py FOLDER`.

The wheel is built from the unpacked source distribution, so that a file missing there shows here. Nothing is fetched.
"""

import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = "import sys; from hatchling import build; print(getattr(build, sys.argv[1])(sys.argv[2]))"


def main(arguments: list[str]) -> int:
    """Build both files into a folder and print their names."""
    if len(arguments) != 1:
        print("usage: build_package.py FOLDER", file=sys.stderr)
        return 2
    folder = Path(arguments[0]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for path in build(folder):
        print(path)
    return 0


def build(folder: Path) -> tuple[Path, Path]:
    """Build the source distribution and the wheel into a folder, and return their paths."""
    source = _built("build_sdist", ROOT, folder)
    with tempfile.TemporaryDirectory() as made, tarfile.open(source) as archive:
        archive.extractall(made, filter="data")
        return source, _built("build_wheel", Path(made) / source.name.removesuffix(".tar.gz"), folder)


def _built(kind: str, root: Path, folder: Path) -> Path:
    command = [sys.executable, "-c", BUILD, kind, str(folder)]
    done = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, text=True, check=True)
    return folder / done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
