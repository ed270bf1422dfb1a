"""Draw the pictures of the paper's figures for the gallery: `.venv/bin/python tools/generate_paper.py`."""

import sys
from pathlib import Path

from small_png import small

from rubnoise.figures.paper import FIGURES, paper_figure
from rubnoise.figures.paper_sources import Sources

DOCS = Path(__file__).resolve().parent.parent / "docs"
PICTURES = DOCS / "pictures" / "paper"


def main() -> int:
    """Draw the figures."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        print(name, file=sys.stderr)
        (PICTURES / f"{name}.png").write_bytes(small(paper_figure(name, ["png"], Sources())["png"]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
