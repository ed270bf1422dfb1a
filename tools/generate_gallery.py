"""Draw the pictures of docs/gallery.md and docs/two-way.md: `python3 tools/dev.py generate gallery`.

Every command of these pages is called in a new folder, and the pictures that they write are kept small below
docs/pictures, with the figures of the paper.
"""

import subprocess
import sys
import tempfile
from io import BytesIO
from pathlib import Path
from shlex import split
from typing import Final

from paper.figures import FIGURES, Sources, paper_figure
from PIL import Image

ROOT: Final = Path(__file__).resolve().parent.parent
PAGES: Final = ("gallery", "two-way")
"""Pages whose pictures lie in a folder of the same name; the second uses results of the first."""

PICTURES: Final = ROOT / "docs" / "pictures"
COLOURS: Final = 256
"""Of a small picture, enough for curves and their smooth edges, in a third of the size."""


def small(png: bytes) -> bytes:
    """Return a png with a palette in place of full colours."""
    with Image.open(BytesIO(png)) as picture:
        flat = picture.convert("RGB").quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    stream = BytesIO()
    flat.save(stream, format="PNG", optimize=True)
    return stream.getvalue()


def commands(page: str) -> list[list[str]]:
    """Return the words of every command of a page, in its order."""
    lines = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8").splitlines()
    return [split(line.removeprefix("    $ ")) for line in lines if line.startswith(("rubnoise ", "    $ rubnoise "))]


def draw(folder: Path, pictures: Path, *pages: str) -> None:
    """Call the commands of pages in a folder, and keep their pictures in another."""
    (folder / "scenarios").symlink_to(ROOT / "scenarios")
    for name in ("paper", *pages):
        (pictures / name).mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        (pictures / "paper" / f"{name}.png").write_bytes(small(paper_figure(name, ("png",), Sources())["png"]))
    for page in pages:
        for _, *words in commands(page):
            call(folder, words)
        for path in folder.glob("*.png"):
            (pictures / page / path.name).write_bytes(small(path.read_bytes()))
            path.unlink()


def call(folder: Path, words: list[str]) -> None:
    """Call a command in a folder; raises CalledProcessError where it fails."""
    print("rubnoise", *words, file=sys.stderr)
    subprocess.run([sys.executable, "-m", "rubnoise", *words], cwd=folder, stdout=subprocess.DEVNULL, check=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        draw(Path(place), PICTURES, *PAGES)
