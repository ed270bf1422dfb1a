"""Draw the pictures of the documentation: `.venv/bin/python tools/make_pictures.py`, after `tools/dev.py sync`."""

import sys
import tempfile
from pathlib import Path

from small_png import small

import rubnoise
from rubnoise.figures.overview import overview_png

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"
JUNCTION = 60


def main() -> int:
    """Run the scenario of Figure 5 and draw it."""
    PICTURES.mkdir(exist_ok=True)
    scenario = rubnoise.load(ROOT / "scenarios" / "paper" / "fig5.toml")
    with tempfile.TemporaryDirectory() as folder, rubnoise.run(scenario, Path(folder) / "fig5.h5") as run:
        (PICTURES / "fig5.png").write_bytes(small(overview_png(run, JUNCTION)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
