"""Draw the pictures of docs/gallery.md: `python3 tools/dev.py generate gallery`.

Every command of the page is called in a new folder, and the pictures that they write are kept small below
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
PAGE: Final = ROOT / "docs" / "gallery.md"
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


def commands() -> list[list[str]]:
    """Return the words of every command of the page, in its order."""
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    return [split(line) for line in lines if line.startswith("rubnoise ")]


def draw(folder: Path, pictures: Path) -> None:
    """Call the commands in a folder, and keep their pictures in another."""
    (folder / "scenarios").symlink_to(ROOT / "scenarios")
    for name in ("paper", "gallery"):
        (pictures / name).mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        (pictures / "paper" / f"{name}.png").write_bytes(small(paper_figure(name, ("png",), Sources())["png"]))
    for _, *words in commands():
        call(folder, words)
    for path in folder.glob("*.png"):
        (pictures / "gallery" / path.name).write_bytes(small(path.read_bytes()))


def call(folder: Path, words: list[str]) -> None:
    """Call a command in a folder; raises CalledProcessError where it fails."""
    print("rubnoise", *words, file=sys.stderr)
    subprocess.run([sys.executable, "-m", "rubnoise", *words], cwd=folder, stdout=subprocess.DEVNULL, check=True)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        draw(Path(place), PICTURES)
